// Kept results: a strip of pictures with figures; one of them can be laid beside the present one, or brought back.

import { Shape } from "./shapes.js";

const $ = (id) => document.getElementById(id);
const make = (tag, more) => Object.assign(document.createElement(tag), more);

export class Strip {
  constructor(app) {
    this.app = app;
    this.rows = new Map();
    // The result that the present one is compared with, and its shape.
    [this.compared, this.shape] = [null, null];
    $("keep").addEventListener("click", () => this.keep());
    $("bring-back").addEventListener("click", () => this.bringBack());
    $("wipe").addEventListener("input", () => this.wipe());
    this.line = make("div", { className: "wipe-line", hidden: true });
    app.views.result.element.append(this.line);
  }

  // How much of the view, from the left, shows the kept result.
  get share() {
    return this.shape ? Number($("wipe").value) : 0;
  }

  // The strip as the studio tells it.
  show({ kept, run }) {
    const hasResult = ["running", "paused", "stopped", "finished"].includes(run.status) && run.iteration > 0;
    $("strip").hidden = kept.length === 0 && !hasResult;
    $("keep").disabled = !hasResult;
    const ids = new Set(kept.map((k) => k.id));
    for (const [id, row] of this.rows) {
      if (!ids.has(id)) {
        row.item.remove();
        this.rows.delete(id);
      }
    }
    for (const result of kept) this.showRow(this.rows.get(result.id) ?? this.addRow(result.id), result);
    const compared = kept.find((k) => k.id === this.compared);
    if (this.compared !== null && !compared?.is_present) this.compare(null);
    $("bring-back").disabled = !compared;
  }

  showRow(row, { id, target, iteration, figures, is_present: isPresent }) {
    const q = figures ? `Q ${figures.q.toFixed(3)}` : "judging…";
    const faults = figures ? (figures.flipped ?? 0) + figures.crossings : 0;
    row.quality.textContent = faults > 0 ? `${q} · ${faults} faults` : q;
    row.about.textContent = `${target} · ${iteration.toLocaleString("en")}`;
    row.button.disabled = !isPresent;
    row.button.title = isPresent ? `Compare with the result after ${iteration} iterations` : `Of ${target}, which is not open now`;
    row.button.setAttribute("aria-label", `${row.button.title}; ${row.quality.textContent}`);
    row.button.setAttribute("aria-pressed", String(id === this.compared));
    if (figures && !row.picture.src) row.picture.src = `kept/${id}/picture`;
  }

  addRow(id) {
    const row = {
      item: make("li"),
      button: make("button", { className: "kept" }),
      picture: make("img", { alt: "", width: 56, height: 56 }),
      quality: make("b"),
      about: make("span", { className: "soft" }),
      remove: make("button", { className: "remove", textContent: "×", title: "Take it out of the strip; undo brings it back" }),
    };
    row.remove.setAttribute("aria-label", "Take this result out of the strip");
    const text = make("span", { className: "text" });
    text.append(row.quality, row.about);
    row.button.append(row.picture, text);
    row.button.addEventListener("click", () => this.compare(this.compared === id ? null : id));
    row.remove.addEventListener("click", () => this.app.edit("dismiss", { result: id }));
    row.item.append(row.button, row.remove);
    $("kept").append(row.item);
    this.rows.set(id, row);
    return row;
  }

  async keep() {
    await this.app.ask("kept", { do: "keep" });
  }

  async bringBack() {
    if (this.compared === null) return;
    const result = this.compared;
    this.compare(null);
    await this.app.ask("kept", { do: "bring_back", result });
  }

  // Lays a kept result beside the present one; none ends it.
  async compare(id) {
    const { app } = this;
    this.compared = id;
    this.drop();
    if (id !== null) {
      const answer = await fetch(`kept/${id}/positions`);
      if (this.compared !== id) return;
      if (answer.ok) this.load(new Float32Array(await answer.arrayBuffer()));
      else app.words.complain(new Error("this result cannot be loaded"));
    }
    $("compare").hidden = !this.shape;
    document.querySelector("#heat [value=difference]").hidden = !this.shape;
    if (this.shape) $("wipe").value = 0.5;
    else if (app.stage.heat === "difference") app.stage.setHeat("");
    this.show(app.state);
    this.wipe();
  }

  load(positions) {
    const { source } = this.app.views;
    if (!source.shape || positions.length !== source.shape.positions.length) return;
    const { triangles, edges, paint } = source.shape;
    this.shape = new Shape(this.app.painter.renderer.gl, { positions, triangles, edges, normals: null });
    this.shape.wear(paint);
  }

  drop() {
    this.shape?.free();
    this.shape = null;
  }

  wipe() {
    const { painter, views, stage } = this.app;
    this.line.hidden = this.share <= 0 || this.share >= 1;
    this.line.style.left = `${100 * this.share}%`;
    if (stage.heat === "difference") stage.showDifference();
    painter.invalidate(views.result);
  }

  // How far every vertex of a shape is from where it is in the kept result.
  differences(positions) {
    if (!this.shape) return null;
    const [a, b] = [positions, this.shape.positions];
    return Float32Array.from({ length: a.length / 3 }, (_, v) => Math.hypot(a[3 * v] - b[3 * v], a[3 * v + 1] - b[3 * v + 1], a[3 * v + 2] - b[3 * v + 2]));
  }
}
