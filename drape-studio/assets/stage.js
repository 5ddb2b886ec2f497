// The shapes in the views: loaded, moved, coloured.

import { HEATS } from "./heats.js";
import { fetchShape } from "./link.js";
import { Paint, fetchPaint } from "./paint.js";
import { length, subtract } from "./maths.js";
import { Shape } from "./shapes.js";

const $ = (id) => document.getElementById(id);
// With fewer landmarks the source's view is not turned by itself.
const ENOUGH_TO_ALIGN = 4;
// In milliseconds.
const SOON = 120;

export class Stage {
  constructor(app) {
    this.app = app;
    this.shown = null;
    this.heat = "";
    this.isHeatAsked = false;
    this.heatSerial = null;
    this.hashes = {};
  }

  // Loads a shape if it is another than the one shown.
  async load(name, about) {
    const { app } = this;
    const hash = about ? about.hash : null;
    if (this.hashes[name] === hash) return;
    this.hashes[name] = hash;
    [name, "result"].forEach((dropped) => this.drop(app.views.of(dropped)));
    app.setFigures(null);
    const view = app.views.of(name);
    view.wait(hash ? "Loading…" : "");
    if (!hash) return;
    try {
      const [buffers, paint] = await Promise.all([fetchShape(name, hash), fetchPaint(name, hash, about.looks)]);
      if (this.hashes[name] !== hash) return;
      const { gl } = app.painter.renderer;
      view.shape = new Shape(gl, buffers);
      if (paint) view.shape.wear(new Paint(gl, paint, buffers.triangles.length / 3));
      if (!app.memory.look(view)) {
        view.camera.home();
        app.cameras.frame(view);
      }
      if (name === "source") app.parts.colour();
      this.takeShown();
      app.words.nameViews();
      app.painter.invalidate();
    } catch (error) {
      this.hashes[name] = undefined;
      app.words.complain(error);
    }
    if (this.hashes[name] === hash) view.wait("");
  }

  drop(view) {
    if (view.name !== "result") view.shape?.paint?.free();
    else this.app.strip?.compare(null);
    view.shape?.free();
    view.shape = null;
    this.app.painter.invalidate(view);
  }

  // A shape of the result: four numbers (1, serial, kind, iteration), then positions. Or a heat map: (2, serial,
  // kind, whether by triangle), then values.
  receive(bytes) {
    const { views, words, painter } = this.app;
    const [what, serial, kind, more] = new Uint32Array(bytes, 0, 4);
    const numbers = new Float32Array(bytes, 16);
    if (what === 1) {
      this.shown = { serial, kind, iteration: more, positions: numbers };
      this.takeShown();
      this.acknowledge(serial);
    } else if (views.result.shape && this.heat) {
      this.isHeatAsked = false;
      views.result.shape.colour(numbers, more === 1);
      this.heatSerial = serial;
      this.askHeat();
    }
    words.nameViews();
    painter.invalidate(views.result);
  }

  // The next shape may come once this one is drawn, or soon where drawing takes long.
  acknowledge(serial) {
    let isTold = false;
    const tell = () => {
      if (!isTold) this.app.link.tell({ ready: serial });
      isTold = true;
    };
    requestAnimationFrame(tell);
    setTimeout(tell, SOON);
  }

  // Puts the newest positions into the result's view.
  takeShown() {
    const { app, shown } = this;
    const { source, target, result } = app.views;
    if (!shown || !source.shape || !target.shape) return;
    if (shown.positions.length !== source.shape.positions.length) return;
    if (result.shape) {
      result.shape.move(shown.positions);
    } else {
      const { triangles, edges } = source.shape;
      result.shape = new Shape(app.painter.renderer.gl, { positions: shown.positions, triangles, edges, normals: null });
      result.shape.wear(source.shape.paint);
      if (!app.memory.look(result)) this.lookAtResult();
    }
    this.askHeat();
  }

  lookAtResult() {
    const { app } = this;
    const { target, result } = app.views;
    result.camera.look(target.camera.yaw, target.camera.pitch);
    app.cameras.frame(result);
    const isMarked = app.landmarks.filter((l) => l.source && l.target).length >= ENOUGH_TO_ALIGN;
    if (isMarked) app.cameras.align();
  }

  // The colours and the overlay of the page before it was loaded again.
  remember({ heat = "", overlay = 0 }) {
    if (overlay > 0) $("opacity").value = overlay;
    if (heat in HEATS) this.setHeat(heat);
  }

  askHeat() {
    if (this.heat === "difference") return void this.showDifference();
    if (!this.shown || !this.heat || this.isHeatAsked || this.heatSerial === this.shown?.serial) return;
    this.isHeatAsked = true;
    this.app.link.tell({ heat: this.heat });
  }

  // The map of differences needs no studio: the page has both shapes.
  showDifference() {
    const { shape } = this.app.views.result;
    shape?.colour(this.app.strip.differences(shape.positions), false);
  }

  setHeat(heat) {
    const { views, painter } = this.app;
    [this.heat, this.heatSerial, this.isHeatAsked] = [heat, null, false];
    $("heat").value = heat;
    this.app.legend.show();
    views.result.shape?.colour(null, false);
    this.askHeat();
    painter.invalidate();
  }

  // How far each landmark of the shown result is from its place, in longest sides of the target's box.
  misses(landmarks) {
    const { result } = this.app.views;
    const entries = landmarks.filter((l) => l.source && l.target && result.shape);
    return new Map(entries.map((l) => [l.id, length(subtract(result.place(l).point, l.target.point))]));
  }
}
