// Brushes on the result: relaxed, pulled to the target, slid along it. The drape goes on from there.

import { Ring } from "./ring.js";

const $ = (id) => document.getElementById(id);
const BRUSHES = ["relax", "pull", "slide"];

export class Sculpt {
  constructor(app) {
    this.app = app;
    [this.brush, this.pointer, this.asked, this.isAsking] = [null, null, Promise.resolve(), false];
    this.ring = new Ring();
    for (const brush of BRUSHES) $(`sculpt-${brush}`).addEventListener("click", () => this.choose(this.brush === brush ? null : brush));
    const { result } = app.views;
    result.element.addEventListener("pointermove", (event) => this.follow(event));
    result.element.addEventListener("pointerleave", () => this.ring.hide());
  }

  // Takes a brush in hand, or none.
  choose(brush) {
    this.brush = brush;
    if (brush && this.app.brush.isOn) this.app.brush.toggle();
    $("sculpt-controls").hidden = !brush;
    if (!brush) this.ring.hide();
    this.show(this.app.state);
  }

  // The next brush, and after the last none.
  next() {
    this.choose(BRUSHES[BRUSHES.indexOf(this.brush) + 1] ?? null);
  }

  // There is something to brush where a drape stands still; a brush in hand can be put down at any time.
  show(state) {
    $("sculpt-section").hidden = !state || state.run.status === "none";
    for (const brush of BRUSHES) {
      const button = $(`sculpt-${brush}`);
      button.setAttribute("aria-pressed", String(this.brush === brush));
      button.disabled = !state?.can.brush && this.brush !== brush;
    }
  }

  // Whether a press brushes: the first button alone, on the result.
  takes(view, event) {
    return this.brush !== null && view.name === "result" && event.button === 0 && !event.shiftKey && !event.ctrlKey && !event.metaKey;
  }

  isAt(event) {
    return this.pointer === event.pointerId;
  }

  begin(view, event) {
    this.pointer = event.pointerId;
    this.dab(view.ray(event), false);
  }

  // Places that come while one is brushed are passed over.
  go(view, event) {
    if (!this.isAsking) this.dab(view.ray(event), false);
  }

  async end(view, event) {
    this.pointer = null;
    await this.asked;
    await this.dab(event && view.ray(event), true);
  }

  dab(ray, done) {
    this.isAsking = true;
    const more = { brush: this.brush ?? BRUSHES[0], radius: Number($("sculpt-size").value), strength: Number($("sculpt-strength").value) };
    this.asked = this.app.edit("brush", { ray, done, ...more }).then(() => (this.isAsking = false));
    return this.asked;
  }

  follow(event) {
    const { result } = this.app.views;
    if (this.brush && result.shape) this.ring.follow(result, event, Number($("sculpt-size").value));
    else this.ring.hide();
  }
}
