// Curves as landmarks: drawn place by place on source and target, shown as lines over both and over the result.

import { markColour } from "./colours.js";
import { weightField } from "./weights.js";

const $ = (id) => document.getElementById(id);
const SVG = "http://www.w3.org/2000/svg";
// Of the curve that is drawn, which has no number yet.
const DRAWN = "#e0457b";
// A line is a pale one below, so that it is seen on any colour, the line itself, and what of it is behind the shape.
const LAYERS = ["casing", "line", "behind"];
// Of a line at most this many points are probed.
const MOST_PROBED = 48;
// A line of few places runs straight between them: so far below the surface, in longest sides, it is still on it.
const BELOW = 0.025;

export const curveLabel = ({ name, number }) => name || (number === null ? "curve that waits" : `curve ${number}`);
// The shape on which a curve has no line yet; none where it has both.
export const waitsOn = ({ source, target }) => (target.length === 0 ? "target" : source.length === 0 ? "source" : null);

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

  // Curves that wait for a line on another scan come first.
  toggle() {
    if (this.isOn) return void this.cancel();
    const waiting = this.app.state.curves.find(waitsOn);
    if (waiting) return void this.takeUp(waiting);
    this.turn(true);
    this.app.words.note("Click along the line on the source, then on the target; Enter ends it, Ctrl Z takes the last place back, Esc gives it up");
  }

  takeUp(curve) {
    this.turn(true);
    this.app.edit("take_up_curve", { landmark: curve.id });
    this.app.words.note(`Click along “${curveLabel(curve)}” on the ${waitsOn(curve)}; Enter ends it, Esc leaves it for later`);
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
    const [label, missing] = [curveLabel(curve), waitsOn(curve)];
    row.curve = curve;
    row.number.textContent = missing ? "·" : String(curve.number);
    row.number.title = missing ? "A curve that waits" : curve.is_closed ? "Closed curve" : "Curve";
    if (missing) row.remove.before(row.draw);
    else row.draw.remove();
    row.draw.setAttribute("aria-label", `Draw ${label} on the ${missing}`);
    row.name.placeholder = missing ? `draw it on the ${missing}` : "curve";
    if (document.activeElement !== row.name) row.name.value = curve.name;
    row.name.setAttribute("aria-label", `Name of ${label}`);
    row.weight.show(curve.weight, label);
    row.remove.setAttribute("aria-label", `Delete ${label}`);
  }

  addRow(id) {
    const make = (tag, name, text) => Object.assign(document.createElement(tag), { className: name, textContent: text });
    const row = { item: make("li", "", ""), number: make("span", "number", ""), name: make("input", "", ""), weight: weightField(this.app, id), draw: make("button", "", "draw"), remove: make("button", "", "×") };
    Object.assign(row.name, { type: "text", maxLength: 80 });
    row.number.style.background = markColour(id);
    row.draw.addEventListener("click", () => this.takeUp(row.curve));
    row.name.addEventListener("change", () => this.app.edit("rename", { landmark: id, name: row.name.value }));
    row.name.addEventListener("keydown", (event) => event.key === "Enter" && row.name.blur());
    row.remove.addEventListener("click", () => this.app.edit("delete", { landmark: id }));
    row.item.append(row.number, row.name, row.weight.element, row.remove);
    $("curves").append(row.item);
    this.rows.set(id, row);
    return row;
  }

  // The lines that are shown, each with a key of its own.
  get lines() {
    const { curves = [], drawing } = this.app.state ?? {};
    const others = curves.filter((curve) => curve.id !== drawing?.of);
    const lines = others.map((curve) => ({ ...curve, key: curve.id, colour: markColour(curve.id), how: "" }));
    // With the mirror image that it will have.
    if (drawing?.twin) lines.push({ ...drawing.twin, key: "twin", colour: DRAWN, how: "is-drawn is-twin" });
    if (drawing) lines.push({ ...drawing, key: "drawn", colour: DRAWN, how: "is-drawn" });
    return lines;
  }

  // The lines of a view, as its camera has them: what is behind the shape is faint.
  draw(view) {
    const { lines } = this;
    while (view.lines.children.length > LAYERS.length * lines.length) view.lines.lastChild.remove();
    while (view.lines.children.length < LAYERS.length * lines.length) view.lines.append(document.createElementNS(SVG, "path"));
    const project = lines.length > 0 && view.projection();
    lines.forEach((line, row) => {
      const [before, behind] = ways(this.seen(view, line, project));
      LAYERS.forEach((layer, k) => {
        const element = view.lines.children[LAYERS.length * row + k];
        element.setAttribute("class", `${layer} ${line.how}`);
        element.setAttribute("d", layer === "behind" ? behind : before);
        element.style.stroke = layer === "casing" ? "" : line.colour;
      });
    });
  }

  // The points of a line in the frame of a view.
  points(view, line) {
    const isTarget = view.name === "target";
    const places = isTarget ? line.target.map((point) => ({ target: { point } })) : line.source.map((source) => ({ source }));
    if (line.is_closed && places.length > 0) places.push(places[0]);
    return places.map((place) => view.place(place)?.point).filter(Boolean);
  }

  // Where they are on the page, and whether something is before them.
  seen(view, line, project) {
    const points = this.points(view, line);
    const every = stride(points);
    const places = points.map((point, k) => ({ at: project(point), isBehind: view.probes.hidden.has(`${line.key} ${k - (k % every)}`) }));
    return places.filter(({ at }) => at);
  }

  // What has to be known of a view: points by their keys, of long lines not each.
  probed(view, nearer) {
    return this.lines.flatMap((line) => {
      const points = this.points(view, line);
      const every = stride(points);
      return points.map((point, k) => [`${line.key} ${k}`, { point, nearer: Math.max(nearer, BELOW) }]).filter((_, k) => k % every === 0);
    });
  }
}

const stride = (points) => Math.ceil(points.length / MOST_PROBED);

// The ways through the points that are seen and through those that are not: what ends behind something is behind it.
const ways = (places) => {
  const told = ({ at: { x, y } }) => `${x.toFixed(1)} ${y.toFixed(1)}`;
  const [out, last] = [["", ""], { kind: -1 }];
  // A single place is a dot.
  if (places.length === 1) places.push(places[0]);
  for (let k = 1; k < places.length; k++) {
    const [from, to] = [places[k - 1], places[k]];
    const kind = Number(from.isBehind || to.isBehind);
    out[kind] += `${kind === last.kind ? "" : `M${told(from)}`}L${told(to)}`;
    last.kind = kind;
  }
  return out;
};
