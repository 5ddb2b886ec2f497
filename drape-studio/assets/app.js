// The studio's page: what the server tells is shown, what the user does is asked of it.

import { Brush } from "./brush.js";
import { Cameras } from "./cameras.js";
import { Chart } from "./chart.js";
import { control } from "./commands.js";
import { Curves } from "./curves.js";
import { Legend } from "./heats.js";
import { Cursor } from "./cursor.js";
import { Files, showScans } from "./files.js";
import { Hover } from "./hover.js";
import { Link } from "./link.js";
import { Loupe } from "./loupe.js";
import { Memory } from "./memory.js";
import { Painter } from "./painter.js";
import { Panels } from "./panels.js";
import { Parts } from "./parts.js";
import { Sculpt } from "./sculpt.js";
import { Strip } from "./strip.js";
import { Stage } from "./stage.js";
import { Views } from "./views.js";
import { Words } from "./words.js";

const $ = (id) => document.getElementById(id);
const PREFERENCES = "drape-studio";

const stored = () => {
  try {
    return JSON.parse(localStorage.getItem(PREFERENCES) ?? "{}");
  } catch {
    return {};
  }
};

class App {
  constructor() {
    this.preferences = { style: "wire", look: "scan", theme: null, linked: true, ...stored() };
    [this.state, this.progress, this.figures, this.chosen, this.dragging] = [null, null, null, null, null];
    this.painter = new Painter(this, $("canvas"));
    this.views = new Views(this);
    this.cameras = new Cameras(this);
    this.stage = new Stage(this);
    this.memory = new Memory(this);
    this.legend = new Legend(this);
    this.hover = new Hover(this);
    this.parts = new Parts(this);
    this.files = new Files(this);
    this.panels = new Panels(this);
    this.strip = new Strip(this);
    this.brush = new Brush(this);
    this.curves = new Curves(this);
    this.sculpt = new Sculpt(this);
    this.tools = [this.brush, this.sculpt];
    this.cursor = new Cursor(this);
    this.loupe = new Loupe(this);
    this.words = new Words(this);
    this.chart = new Chart($("chart"));
    this.dress();
    control(this);
    const observer = new ResizeObserver(() => this.resized());
    [document.querySelector("main"), ...this.views.list.map((view) => view.element)].forEach((element) => observer.observe(element));
    this.stage.remember(this.memory.before);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.dress());
    this.link = new Link({
      told: (message) => this.hear(message),
      shapes: (bytes) => this.stage.receive(bytes),
      online: (isOnline) => this.setOnline(isOnline),
    });
  }

  prefer(more) {
    Object.assign(this.preferences, more);
    localStorage.setItem(PREFERENCES, JSON.stringify(this.preferences));
    this.painter.invalidate();
  }

  get theme() {
    return this.preferences.theme ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
  }

  dress() {
    document.documentElement.dataset.theme = this.theme;
    this.resized();
  }

  resized() {
    this.views.measure();
    this.chart.draw();
    this.painter.invalidate();
  }

  get landmarks() {
    return this.state?.landmarks ?? [];
  }

  // The shape that the result's view was last sent.
  get shown() {
    return this.stage.shown;
  }

  // --- what the server tells ---

  setOnline(isOnline) {
    $("offline").hidden = isOnline;
    if (isOnline) this.fetchCurves();
  }

  fetchCurves() {
    this.link.ask("query", { do: "curves" }).then((curves) => this.chart.replace(curves), () => {});
  }

  hear(message) {
    if (message.type === "state") this.setState(message);
    if (message.type === "progress") this.setProgress(message);
    if (message.type === "figures") this.setFigures(message);
    if (message.type === "error") this.words.complain(new Error(message.error));
  }

  setState(state) {
    const before = this.state?.run;
    this.state = state;
    if (before && before.number !== state.run.number) this.chart.clear();
    // A drape that was taken up again has a past.
    if (before?.status === "starting" && state.run.status !== "starting") this.fetchCurves();
    if (state.run.status === "none") this.progress = null;
    for (const name of ["source", "target"]) this.stage.load(name, state[name]);
    this.words.nameViews();
    this.panels.show(state);
    this.parts.show(state);
    this.strip.show(state);
    this.brush.show(state);
    this.curves.show(state);
    this.sculpt.show(state);
    showScans(this, state.scans);
    this.panels.showProgress(this.progress, state);
    this.panels.showFigures(this.figures, state);
    this.chooseNext();
    this.words.advise();
    this.legend.show();
    this.painter.moved();
  }

  setProgress(progress) {
    this.progress = progress;
    if (progress.loss !== null) this.chart.add("loss", progress.iteration - 1, progress.loss);
    if (this.state) this.panels.showProgress(progress, this.state);
    this.chart.draw();
  }

  setFigures(figures) {
    this.figures = figures;
    if (this.state) this.panels.showFigures(figures, this.state);
    if (!figures) return;
    this.chart.add("Q", figures.iteration, figures.q);
    this.chart.add("mean distance", figures.iteration, figures.mean_distance);
    this.chart.draw();
  }

  // --- what the user does ---

  // Asks without changing anything.
  query(what, more) {
    return this.ask("query", { do: what, ...more });
  }

  // Changes landmarks, parts or settings.
  edit(what, more) {
    return this.ask("edit", { do: what, ...more });
  }

  // Drives the drape; where that throws a result away, only if the user means it.
  async command(what) {
    if (this.state?.discards.includes(what) && !(await this.words.mayDiscard(what))) return;
    await this.ask("command", what);
  }

  async ask(kind, request) {
    try {
      return await this.link.ask(kind, request);
    } catch (error) {
      this.words.complain(error);
      return null;
    }
  }

  async place(view, ray) {
    if (!this.state) return;
    if (this.curves.isOn) return void this.curves.add(view, ray);
    try {
      const answer = await this.link.ask("edit", { do: "place", shape: view.name, ray, snap: this.snap });
      if (!answer) this.words.note("The click missed: nothing is there");
      this.choose(answer ? answer.landmark : null);
      this.chooseNext();
    } catch (error) {
      this.words.complain(error);
    }
  }

  // Of landmarks that wait for their places on another scan, the first is chosen, so that it is seen which one is meant.
  chooseNext() {
    const waiting = this.landmarks.filter((l) => !l.source || !l.target);
    if (!this.chosenLandmark) this.chosen = null;
    if (waiting.length > 1) this.choose(waiting[0].id);
  }

  // Puts the cross or the brush down; gives up the pair that is half made; else nothing is chosen any more.
  escape() {
    if (this.cursor.isShown) return void this.cursor.hide();
    if (this.curves.cancel()) return;
    if (this.sculpt.brush) return void this.sculpt.choose(null);
    const waiting = this.landmarks.filter((l) => !l.source || !l.target);
    if (waiting.length === 1) {
      this.edit("delete", { landmark: waiting[0].id });
      this.words.note("The half pair is gone; undo brings it back");
    }
    this.choose(null);
  }

  // What places that are marked snap to; null where they stay as they are.
  get snap() {
    return $("snap").value || null;
  }

  // Rays of a drag go one after the other; those that come meanwhile are passed over, but the last.
  async drag(view, landmark, ray, done) {
    if (this.dragging) {
      this.dragging.next = [view, landmark, ray, done || this.dragging.next?.[3] === true];
      return;
    }
    this.dragging = { next: null };
    await this.edit("drag", { landmark, shape: view.name, ray, done, snap: this.snap });
    const { next } = this.dragging;
    this.dragging = null;
    if (next) this.drag(...next);
  }

  choose(id) {
    this.chosen = id;
    this.painter.refresh();
  }

  get chosenLandmark() {
    return this.landmarks.find((l) => l.id === this.chosen);
  }

  // Where a point of a view is on the page: for tests.
  onPage(name, point) {
    const view = this.views.of(name);
    const at = view.project(point);
    const { left, top } = view.element.getBoundingClientRect();
    return at && { x: left + at.x, y: top + at.y };
  }
}

try {
  window.studio = new App();
} catch (error) {
  document.body.textContent = `The studio cannot start: ${error.message}.`;
}
