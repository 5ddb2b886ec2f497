// Weights of attraction and rigid places, painted on the source or on the result.

import { Ring } from "./ring.js";

const $ = (id) => document.getElementById(id);

export class Brush {
  constructor(app) {
    this.app = app;
    [this.isOn, this.pointer, this.asked, this.weights, this.key] = [false, null, Promise.resolve(), null, null];
    this.ring = new Ring();
    $("brush").addEventListener("click", () => this.toggle());
    $("clear-weights").addEventListener("click", () => app.edit("clear_weights"));
    $("clear-rigid").addEventListener("click", () => app.edit("clear_rigid"));
    $("brush-weight").addEventListener("change", () => this.isOn && this.fetch());
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

  // What is painted, and with which weight.
  get paint() {
    const [weight, layer] = $("brush-weight").value.split(" ");
    return { weight: Number(weight), layer: layer ?? "weights" };
  }

  // The weights as the studio tells them; those of a stroke that goes on are newer.
  show({ parts, source, painted_rigid: rigid }) {
    $("clear-weights").hidden = !parts.weights;
    $("clear-rigid").hidden = !rigid;
    $("brush").disabled = !this.app.state.can.export;
    const key = `${source?.hash} ${parts.weights} ${rigid}`;
    if (key === this.key) return;
    this.key = key;
    if (this.isOn && this.pointer === null) this.fetch();
  }

  async fetch() {
    const { source } = this.app.views;
    if (!source.shape) return;
    const { layer } = this.paint;
    const weights = await this.app.query(layer);
    if (!source.shape || layer !== this.paint.layer) return;
    this.weights = Float32Array.from(weights ?? new Array(source.shape.positions.length / 3).fill(layer === "rigid" ? 0 : 1));
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
    const more = { ...this.paint, strength: Number($("brush-strength").value), radius: Number($("brush-size").value), done };
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
