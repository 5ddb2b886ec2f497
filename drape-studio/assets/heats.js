// Colour maps of the result: what each shows, its range and its legend.

const $ = (id) => document.getElementById(id);

// From low to high: the colours of the report.
export const STOPS = ["#291c5c", "#2e4d94", "#1c829c", "#40b37a", "#a8d44f", "#fce85c"];
export const RAMP = STOPS.flatMap((hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255));

// The range of each map at first, in its own units, and how a value is told.
export const HEATS = {
  distance: { range: [0, 0.01], unit: "", isLength: true },
  stretch: { range: [1, 2], unit: "" },
  angle: { range: [0, 30], unit: "°" },
  flipped: { range: [0, 1], unit: "" },
  difference: { range: [0, 0.01], unit: "", isLength: true, isOfPage: true },
};

// A number with three digits that count.
const told = (value) => (value === 0 ? "0" : String(Number(value.toPrecision(3))));

export class Legend {
  constructor(app) {
    this.app = app;
    this.ranges = Object.fromEntries(Object.entries(HEATS).map(([name, { range }]) => [name, [...range]]));
    for (const [k, id] of ["legend-low", "legend-high"].entries()) {
      $(id).addEventListener("change", () => this.edit(k, Number($(id).value)));
    }
  }

  // Lengths of the page are in longest sides of the target; people have the units of the scene.
  get scale() {
    return HEATS[this.app.stage.heat]?.isLength ? (this.app.state?.target?.side ?? 1) : 1;
  }

  get range() {
    return this.ranges[this.app.stage.heat] ?? null;
  }

  edit(end, value) {
    const range = [...this.range];
    range[end] = value / this.scale;
    // A range that is none is not taken.
    if (Number.isFinite(value) && range[0] < range[1]) this.ranges[this.app.stage.heat] = range;
    this.show();
    this.app.painter.invalidate(this.app.views.result);
  }

  show() {
    const { heat } = this.app.stage;
    $("legend").hidden = !heat;
    if (!heat) return;
    const about = HEATS[heat];
    for (const [k, id] of ["legend-low", "legend-high"].entries()) {
      $(id).value = told(this.range[k] * this.scale);
      $(id).hidden = heat === "flipped";
    }
    $("legend-unit").textContent = about.isLength ? "in units of the scene" : heat === "flipped" ? "dark: as it should be, bright: flipped" : heat === "angle" ? "degrees" : "1 is none";
    this.tell(null);
  }

  // The value under the pointer; none where there is none.
  tell(value) {
    const { heat } = this.app.stage;
    if (!heat) return;
    const about = HEATS[heat];
    const text = value === null || value === undefined ? "" : value < 0 ? "left out: no counterpart" : `${told(value * this.scale)}${about.unit}${about.isLength ? ` · ${(100 * value).toPrecision(2)} %` : ""}`;
    $("legend-value").textContent = text;
  }
}
