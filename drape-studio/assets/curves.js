// Curves as landmarks: drawn place by place on source and target, shown as lines over both and over the result.

import { markColour } from "./colours.js";
import { weightField } from "./weights.js";

const $ = (id) => document.getElementById(id);
const SVG = "http://www.w3.org/2000/svg";
// Of the curve that is drawn, which has no number yet.
const DRAWN = "#e0457b";

export const curveLabel = ({ name, number }) => name || `curve ${number}`;

export class Curves {
  constructor(app) {
    this.app = app;
    [this.isOn, this.rows] = [false, new Map()];
    $("curve").addEventListener("click", () => this.toggle());
    for (const view of app.views.list) {
      view.lines = document.createElementNS(SVG, "svg");
      view.lines.setAttribute("class", "curves");
      view.lines.setAttribute("aria-hidden", "true");
      view.element.querySelector(".markers").before(view.lines);
    }
  }

  toggle() {
    if (this.isOn) return void this.cancel();
    this.turn(true);
    this.app.words.note("Click along the line on the source, then on the target; Enter ends it, Esc gives it up");
  }

  turn(isOn) {
    this.isOn = isOn;
    $("curve").setAttribute("aria-pressed", String(isOn));
  }

  // One more place of the curve that is drawn.
  async add(view, ray) {
    const { words } = this.app;
    try {
      const numbers = await this.app.link.ask("edit", { do: "draw", shape: view.name, ray });
      if (!numbers) return void words.note("The click missed: nothing is there");
      const [source, target] = numbers;
      words.note(`Curve: ${source} places on the source, ${target} on the target; Enter ends it`);
    } catch (error) {
      words.complain(error);
    }
  }

  // Takes the curve; whether one was drawn at all.
  end() {
    if (!this.isOn) return false;
    this.finish();
    return true;
  }

  async finish() {
    try {
      await this.app.link.ask("edit", { do: "end_curve" });
      this.turn(false);
      this.app.words.note("The curve is among the landmarks; undo takes it back");
    } catch (error) {
      this.app.words.complain(error);
    }
  }

  // Gives the curve up; whether one was drawn at all.
  cancel() {
    if (!this.isOn) return false;
    this.turn(false);
    this.app.edit("cancel_curve");
    return true;
  }

  // The list below the landmarks, and the lines.
  show({ curves, drawing, can }) {
    $("curve").disabled = !can.export;
    if (drawing && !this.isOn) this.turn(true);
    const list = $("curves");
    list.hidden = curves.length === 0;
    const ids = new Set(curves.map((curve) => curve.id));
    for (const [id, row] of this.rows) {
      if (ids.has(id)) continue;
      row.item.remove();
      this.rows.delete(id);
    }
    for (const curve of curves) this.fill(this.rows.get(curve.id) ?? this.addRow(curve.id), curve);
  }

  fill(row, curve) {
    const label = curveLabel(curve);
    row.number.textContent = String(curve.number);
    row.number.title = curve.is_closed ? "Closed curve" : "Curve";
    if (document.activeElement !== row.name) row.name.value = curve.name;
    row.name.setAttribute("aria-label", `Name of ${label}`);
    row.weight.show(curve.weight, label);
    row.remove.setAttribute("aria-label", `Delete ${label}`);
  }

  addRow(id) {
    const make = (tag, name, text) => Object.assign(document.createElement(tag), { className: name, textContent: text });
    const row = { item: make("li", "", ""), number: make("span", "number", ""), name: make("input", "", ""), weight: weightField(this.app, id), remove: make("button", "", "×") };
    Object.assign(row.name, { type: "text", maxLength: 80, placeholder: "curve" });
    row.number.style.background = markColour(id);
    row.name.addEventListener("change", () => this.app.edit("rename", { landmark: id, name: row.name.value }));
    row.name.addEventListener("keydown", (event) => event.key === "Enter" && row.name.blur());
    row.remove.addEventListener("click", () => this.app.edit("delete", { landmark: id }));
    row.item.append(row.number, row.name, row.weight.element, row.remove);
    $("curves").append(row.item);
    this.rows.set(id, row);
    return row;
  }

  // The lines of a view, as its camera has them.
  draw(view) {
    const { curves = [], drawing } = this.app.state ?? {};
    const lines = curves.map((curve) => ({ ...curve, colour: markColour(curve.id) }));
    if (drawing) lines.push({ ...drawing, colour: DRAWN, isDrawn: true });
    while (view.lines.children.length > 2 * lines.length) view.lines.lastChild.remove();
    while (view.lines.children.length < 2 * lines.length) view.lines.append(document.createElementNS(SVG, "polyline"));
    const project = lines.length > 0 && view.projection();
    lines.forEach((line, k) => {
      const points = this.points(view, line, project);
      // A pale line below, so that it is seen on any colour.
      [["casing", ""], ["line", line.colour]].forEach(([name, stroke], layer) => {
        const element = view.lines.children[2 * k + layer];
        element.setAttribute("class", line.isDrawn ? `${name} is-drawn` : name);
        element.setAttribute("points", points);
        element.style.stroke = stroke;
      });
    });
  }

  points(view, line, project) {
    const isTarget = view.name === "target";
    const places = isTarget ? line.target.map((point) => ({ target: { point } })) : line.source.map((source) => ({ source }));
    if (line.is_closed && places.length > 0) places.push(places[0]);
    const seen = places.map((place) => view.place(place)?.point).filter(Boolean).map(project).filter(Boolean);
    return seen.map(({ x, y }) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ");
  }
}
