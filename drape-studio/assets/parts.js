// Parts of the source: groups, objects, materials, inner pieces; how each is draped.

const $ = (id) => document.getElementById(id);
const WAYS = ["draped", "free", "rigid"];
const TITLE = "Free parts attract nothing and are carried along, rigid ones move as one body";

export class Parts {
  constructor(app) {
    this.app = app;
    this.rows = new Map();
    this.ways = {};
    this.pointedOut = null;
    this.triangles = { hash: null, of: new Map() };
  }

  // The parts as the studio tells them.
  show({ source, parts, inner }) {
    const names = source?.parts ?? [];
    $("parts-section").hidden = !source;
    $("parts").hidden = names.length === 0;
    $("inner-section").hidden = inner.length === 0;
    const key = JSON.stringify([names, inner]);
    if (this.key !== key) {
      this.key = key;
      this.rows = new Map(names.map((name) => [name, this.addRow(name, name, name)]));
      inner.forEach((part) => this.rows.set(part.name, this.addInner(part)));
      const items = (some) => some.map((name) => this.rows.get(name).item);
      $("parts").replaceChildren(...items(names));
      $("inner").replaceChildren(...items(inner.map((part) => part.name)));
    }
    const asked = (name) => WAYS.find((way) => parts[way]?.includes(name));
    const unasked = new Map(inner.map((part) => [part.name, part.unasked]));
    const ways = Object.fromEntries([...this.rows.keys()].map((name) => [name, asked(name) ?? unasked.get(name) ?? "draped"]));
    for (const [name, row] of this.rows) this.showRow(row, ways[name], Boolean(asked(name)));
    if (JSON.stringify(ways) !== JSON.stringify(this.ways)) {
      this.ways = ways;
      this.colour();
    }
  }

  showRow({ select, button, proposed, unasked }, way, isAsked) {
    select.value = way;
    if (!button) return;
    button.hidden = way === proposed;
    for (const option of select.options) option.textContent = !isAsked && option.value === unasked ? `${unasked} (auto)` : option.value;
  }

  addRow(name, text, title) {
    const [item, label, select] = ["li", "span", "select"].map((tag) => document.createElement(tag));
    [label.textContent, label.title] = [text, title];
    for (const way of WAYS) select.append(new Option(way, way));
    select.setAttribute("aria-label", `How ${name} is draped`);
    select.title = TITLE;
    select.addEventListener("change", () => this.treat(name, select.value));
    for (const event of ["pointerenter", "focusin"]) item.addEventListener(event, () => this.pointOut(name));
    for (const event of ["pointerleave", "focusout"]) item.addEventListener(event, () => this.pointOut(null));
    item.append(label, select);
    return { item, select };
  }

  // An inner piece has a button for what is proposed.
  addInner({ name, label, about, proposed, unasked }) {
    const row = this.addRow(name, label, about);
    const button = document.createElement("button");
    button.textContent = `Make ${proposed}`;
    button.setAttribute("aria-label", `Make ${name} ${proposed}`);
    button.addEventListener("click", () => this.treat(name, proposed));
    row.select.before(button);
    return { ...row, button, proposed, unasked };
  }

  async treat(name, treatment) {
    await this.app.edit("part", { name, treatment });
    // Where it was refused, what holds is shown again.
    this.show(this.app.state);
  }

  // The triangles of the part that is pointed out, which is seen through others.
  get pointedRanges() {
    return this.triangles.of.get(this.pointedOut) ?? [];
  }

  pointOut(name) {
    this.pointedOut = name;
    this.colour();
  }

  // Parts that are not draped like the rest, and the one that is pointed out, have a colour in the source's view.
  async colour() {
    const { views, stage, painter, brush } = this.app;
    // Weights that are painted have the colours then.
    if (!views.source.shape || brush.isOn) return;
    const shown = Object.entries(this.ways).filter(([name, way]) => way !== "draped" || name === this.pointedOut);
    const hash = stage.hashes.source;
    if (this.triangles.hash !== hash) this.triangles = { hash, of: new Map() };
    for (const [name] of shown) {
      if (!this.triangles.of.has(name)) this.triangles.of.set(name, (await this.app.query("part_triangles", { name })) ?? []);
    }
    const { shape } = views.source;
    if (stage.hashes.source !== hash || !shape) return;
    const values = new Float32Array(shape.triangles.length / 3).fill(-1);
    for (const [name, way] of shown) {
      const value = name === this.pointedOut ? 1 : way === "free" ? 0.25 : 0.75;
      for (const [from, to] of this.triangles.of.get(name) ?? []) values.fill(value, from, to);
    }
    shape.colour(shown.length > 0 ? values : null, true);
    painter.invalidate(views.source);
  }
}
