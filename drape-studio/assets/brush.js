// Weights of attraction, painted on the source or on the result.

import { Ring } from "./ring.js";

const $ = (id) => document.getElementById(id);

export class Brush {
  constructor(app) {
    this.app = app;
    [this.isOn, this.pointer, this.asked, this.weights, this.key] = [false, null, Promise.resolve(), null, null];
    this.ring = new Ring();
    $("brush").addEventListener("click", () => this.toggle());
    $("clear-weights").addEventListener("click", () => app.edit("clear_weights"));
    for (const view of app.views.list) {
      view.element.addEventListener("pointermove", (event) => this.follow(view, event));
      view.element.addEventListener("pointerleave", () => this.ring.hide());
    }
  }

  toggle() {
    this.isOn = !this.isOn;
    $("brush").setAttribute("aria-pressed", String(this.isOn));
    $("brush-controls").hidden = !this.isOn;
    this.ring.hide();
    if (this.isOn) this.app.sculpt.choose(null);
    if (this.isOn) return void this.fetch();
    this.app.views.source.shape?.colour(null, false);
    this.app.parts.colour();
    this.app.painter.invalidate(this.app.views.source);
  }

  // The weights as the studio tells them; those of a stroke that goes on are newer.
  show({ parts, source }) {
    $("clear-weights").hidden = !parts.weights;
    $("brush").disabled = !this.app.state.can.export;
    const key = `${source?.hash} ${parts.weights}`;
    if (key === this.key) return;
    this.key = key;
    if (this.isOn && this.pointer === null) this.fetch();
  }

  async fetch() {
    const { source } = this.app.views;
    if (!source.shape) return;
    const weights = await this.app.query("weights");
    this.weights = Float32Array.from(weights ?? new Array(source.shape.positions.length / 3).fill(1));
    this.colour();
  }

  colour() {
    const { source } = this.app.views;
    if (!this.isOn || !source.shape || this.weights?.length !== source.shape.positions.length / 3) return;
    source.shape.colour(this.weights, false);
    this.app.painter.invalidate(source);
  }

  // Whether a press paints: the first button alone, where the brush is on.
  takes(view, event) {
    return this.isOn && view.name !== "target" && event.button === 0 && !event.shiftKey && !event.ctrlKey && !event.metaKey;
  }

  isAt(event) {
    return this.pointer === event.pointerId;
  }

  begin(view, event) {
    this.pointer = event.pointerId;
    this.isAsking = false;
    this.dab(view, view.ray(event), false);
  }

  // Places that come while one is painted are passed over.
  go(view, event) {
    if (!this.isAsking) this.dab(view, view.ray(event), false);
  }

  async end(view, event) {
    this.pointer = null;
    await this.asked;
    await this.dab(view, event && view.ray(event), true);
  }

  dab(view, ray, done) {
    this.isAsking = true;
    const more = { weight: Number($("brush-weight").value), strength: Number($("brush-strength").value), radius: Number($("brush-size").value), done };
    this.asked = this.app.edit("paint", { shape: view.name, ray, ...more }).then((changed) => {
      this.isAsking = false;
      if (!changed) return this.fetch();
      if (!this.weights) return undefined;
      for (const [v, weight] of changed) this.weights[v] = weight;
      return this.colour();
    });
    return this.asked;
  }

  follow(view, event) {
    if (this.isOn && view.name !== "target" && view.shape) this.ring.follow(view, event, Number($("brush-size").value));
    else this.ring.hide();
  }
}
