// Draws what is stale: the views, then the markers over them.

import { Detail } from "./detail.js";
import { Renderer } from "./renderer.js";

const $ = (id) => document.getElementById(id);
export const STYLES = ["shaded", "wire", "points"];
// As it was scanned, with wrinkles brought out, or plain.
export const LOOKS = ["scan", "matcap", "clay"];
const COLOURS = {
  light: { back: [0.89, 0.905, 0.92], source: [0.93, 0.80, 0.58], target: [0.62, 0.70, 0.78], result: [0.93, 0.80, 0.58], line: [0.1, 0.12, 0.15] },
  dark: { back: [0.125, 0.145, 0.165], source: [0.88, 0.73, 0.50], target: [0.48, 0.57, 0.66], result: [0.88, 0.73, 0.50], line: [0.02, 0.03, 0.04] },
};

// Edges fade where they are shorter than some pixels: they would blacken the shape, and take long to draw.
const EDGE = { none: 2, full: 6, ink: 0.55 };
const ink = ({ camera, shape, box }) => {
  const pixels = camera.pixels(shape.meanEdge, box.width, box.height);
  return EDGE.ink * Math.max(0, Math.min(1, (pixels - EDGE.none) / (EDGE.full - EDGE.none)));
};

// What lies behind points is hidden where these are nearer to each other than this many mean distances.
const CLOSED = 2.5;
// How far before a surface its own marks are sought, in longest sides; and where fewer triangles are drawn, some of
// which lie so much outside.
const BEFORE = 0.004;
const BEFORE_FEWER = 0.012;

export class Painter {
  constructor(app, canvas) {
    this.app = app;
    this.canvas = canvas;
    this.renderer = new Renderer(canvas);
    this.isWaiting = false;
    this.detail = new Detail(this);
    // The system takes a graphics card away when it sleeps, or when a driver is renewed.
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => this.restore());
  }

  // Everything goes to the graphics card again.
  restore() {
    this.renderer = new Renderer(this.canvas);
    this.app.views.list.forEach((view) => view.restore(this.renderer));
    this.app.strip.shape?.upload(this.renderer.gl);
    this.invalidate();
  }

  // These views are to be drawn again; all where none is named.
  invalidate(...views) {
    const stale = views.length > 0 ? views : (this.app.views?.list ?? []);
    stale.forEach((view) => ([view.isStale, view.isResting] = [true, false]));
    this.refresh();
  }

  // Landmarks moved: their markers may have come before or behind a surface.
  moved() {
    this.app.views.list.forEach((view) => (view.isUnprobed = true));
    if (this.overlay > 0) this.invalidate(this.app.views.result);
    this.refresh();
  }

  // Markers are to be put where they belong.
  refresh() {
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.draw();
    });
  }

  // How much of the target is laid over the result.
  get overlay() {
    return Number($("opacity").value);
  }

  draw() {
    const { app, renderer } = this;
    if (!app.views || renderer.gl.isContextLost()) return;
    const isResized = renderer.begin(app.views.size);
    const { landmarks } = app;
    app.loupe?.draw(this);
    const drawn = app.views.list.filter((view) => view.box.width > 1 && (view.isStale || isResized));
    for (const view of app.views.list) {
      if (view.box.width <= 1) continue;
      if (view.isStale || isResized) this.drawView(view, landmarks);
      else if (view.isUnprobed) this.probe(view, landmarks);
      [view.isStale, view.isUnprobed] = [false, false];
      if (view.probes.collect()) this.refresh();
      view.markers.show(landmarks, app.chosen);
      app.curves.draw(view);
    }
    this.detail.drawn(drawn);
    app.panels.showMisses(app.stage.misses(landmarks), app.chosen);
  }

  aim(view) {
    const { box } = view;
    this.renderer.aim(box, view.camera.matrices(box.width / box.height));
  }

  // The shape of a view as it is shown alone, where the renderer is aimed; how that was done.
  drawShape(view) {
    const { app, renderer } = this;
    const { style, look } = app.preferences;
    const colours = COLOURS[app.theme];
    renderer.clear(colours.back);
    view.isCoarse = Boolean(view.shape) && this.detail.isCoarse(view);
    if (!view.shape) return null;
    const isResult = view.name === "result";
    const range = isResult ? app.legend.range : [0, 1];
    const how = { style, look, colour: colours[view.name], line: colours.line, ink: ink(view), isCoarse: view.isCoarse };
    renderer.draw(view.shape, { ...how, range, isGrey: isResult });
    return { colours, isResult, range, how };
  }

  drawView(view, landmarks) {
    const { app, renderer } = this;
    this.aim(view);
    const drawn = this.drawShape(view);
    if (!drawn) return;
    const { colours, isResult, range, how } = drawn;
    this.probe(view, landmarks);
    const ranges = view.name === "source" ? app.parts.pointedRanges : [];
    if (ranges.length > 0 && view.shape.values) renderer.through(view.shape, ranges, range);
    if (isResult && this.overlay > 0 && app.views.target.shape) {
      renderer.draw(app.views.target.shape, { style: "shaded", colour: colours.target, alpha: this.overlay, isCoarse: view.isCoarse || this.detail.isCoarse({ ...app.views.target, isResting: view.isResting }) });
    }
    if (isResult && app.strip.share > 0) {
      renderer.cut(app.strip.share);
      renderer.clear(colours.back);
      renderer.draw(app.strip.shape, how);
    }
  }

  // Asks which landmarks of a view are hidden by its shape, as it was last drawn.
  probe(view, landmarks) {
    this.aim(view);
    let before = view.isCoarse ? BEFORE_FEWER : BEFORE;
    if (view.shape && (view.shape.isCloud || this.app.preferences.style === "points")) {
      const reach = CLOSED * view.shape.meanEdge;
      this.renderer.close(view.shape, view.camera.pixels(reach, view.box.width, view.box.height));
      // What closes the gap beside a point of a slope lies before it.
      before = Math.max(before, reach / 2);
    }
    view.probe(landmarks, before);
  }
}
