// Draws what is stale: the views, then the markers over them.

import { Renderer } from "./renderer.js";

const $ = (id) => document.getElementById(id);
export const STYLES = ["shaded", "wire", "points"];
// Lowest and highest value of each heat map, and what the legend says of them.
export const HEATS = {
  distance: [0, 0.01, "0", "1 % of the longest side"],
  stretch: [1, 2, "1", "2"],
  angle: [0, 30, "0°", "30°"],
  flipped: [0, 1, "as it should be", "flipped"],
};
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

export class Painter {
  constructor(app, canvas) {
    this.app = app;
    this.canvas = canvas;
    this.renderer = new Renderer(canvas);
    this.isWaiting = false;
  }

  // These views are to be drawn again; all where none is named.
  invalidate(...views) {
    const stale = views.length > 0 ? views : (this.app.views?.list ?? []);
    stale.forEach((view) => (view.isStale = true));
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
    if (!app.views) return;
    const isResized = renderer.begin();
    const landmarks = app.state?.landmarks ?? [];
    for (const view of app.views.list) {
      if (view.isStale || isResized) this.drawView(view, landmarks);
      else if (view.isUnprobed) this.probe(view, landmarks);
      [view.isStale, view.isUnprobed] = [false, false];
      if (view.probes.collect()) this.refresh();
      view.showMarkers(landmarks, app.chosen);
    }
    app.panels.showMisses(app.stage.misses(landmarks), app.chosen);
  }

  aim(view) {
    const { box } = view;
    this.renderer.aim(box, view.camera.matrices(box.width / box.height));
  }

  drawView(view, landmarks) {
    const { app, renderer } = this;
    const { style } = app.preferences;
    const colours = COLOURS[app.theme];
    this.aim(view);
    renderer.clear(colours.back);
    if (!view.shape) return;
    const isResult = view.name === "result";
    const range = isResult ? (app.stage.heat ? HEATS[app.stage.heat] : null) : [0, 1];
    renderer.draw(view.shape, { style, colour: colours[view.name], line: colours.line, ink: ink(view), range });
    this.probe(view, landmarks);
    const ranges = view.name === "source" ? app.parts.pointedRanges : [];
    if (ranges.length > 0 && view.shape.values) renderer.through(view.shape, ranges, range);
    if (isResult && this.overlay > 0 && app.views.target.shape) {
      renderer.draw(app.views.target.shape, { style: "shaded", colour: colours.target, alpha: this.overlay });
    }
  }

  // Asks which landmarks of a view are hidden by its shape, as it was last drawn.
  probe(view, landmarks) {
    this.aim(view);
    view.probe(landmarks, this.app.preferences.style === "points");
  }
}
