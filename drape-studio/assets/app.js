// The studio's page: what the server tells is shown, what the user does is asked of it.

import { Chart } from "./chart.js";
import { listen, showKeys } from "./keys.js";
import { Link, fetchShape } from "./link.js";
import { after, bestRotation, length, subtract } from "./maths.js";
import { FORMATS, Panels } from "./panels.js";
import { Renderer } from "./renderer.js";
import { Shape } from "./shapes.js";
import { Views } from "./views.js";

const $ = (id) => document.getElementById(id);
const STYLES = ["shaded", "wire", "points"];
const HEATS = { distance: [0, 0.01, "0", "1 % of the longest side"], stretch: [1, 2, "1", "2"], angle: [0, 30, "0°", "30°"], flipped: [0, 1, "as it should be", "flipped"] };
const COLOURS = {
  light: { back: [0.89, 0.905, 0.92], source: [0.93, 0.80, 0.58], target: [0.62, 0.70, 0.78], result: [0.93, 0.80, 0.58], line: [0.1, 0.12, 0.15] },
  dark: { back: [0.125, 0.145, 0.165], source: [0.88, 0.73, 0.50], target: [0.48, 0.57, 0.66], result: [0.88, 0.73, 0.50], line: [0.02, 0.03, 0.04] },
};
const PREFERENCES = "drape-studio";

class App {
  constructor() {
    this.canvas = $("canvas");
    this.preferences = { style: "wire", theme: null, linked: true, ...this.stored() };
    this.renderer = new Renderer(this.canvas);
    this.views = new Views(this);
    this.panels = new Panels(this);
    this.chart = new Chart($("chart"));
    this.state = null;
    this.progress = null;
    this.figures = null;
    this.frame = null;
    this.chosen = null;
    this.heat = "";
    this.heatWanted = false;
    this.hashes = {};
    this.loads = {};
    this.dragging = null;
    this.dress();
    this.control();
    new ResizeObserver(() => this.resized()).observe(document.querySelector("main"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.dress());
    this.link = new Link({
      told: (message) => this.hear(message),
      frames: (bytes) => this.receive(bytes),
      online: (isOnline) => this.setOnline(isOnline),
    });
  }

  stored() {
    try {
      return JSON.parse(localStorage.getItem(PREFERENCES) ?? "{}");
    } catch {
      return {};
    }
  }

  prefer(more) {
    Object.assign(this.preferences, more);
    localStorage.setItem(PREFERENCES, JSON.stringify(this.preferences));
    this.invalidate();
  }

  get theme() {
    return this.preferences.theme ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
  }

  dress() {
    document.documentElement.dataset.theme = this.theme;
    this.chart?.draw();
    this.invalidate();
  }

  // --- what the server tells ---

  setOnline(isOnline) {
    $("offline").hidden = isOnline;
    if (isOnline) this.link.ask("curves").then((curves) => this.chart.replace(curves), () => {});
  }

  hear(message) {
    if (message.type === "state") this.setState(message);
    if (message.type === "progress") this.setProgress(message);
    if (message.type === "figures") this.setFigures(message);
    if (message.type === "error") this.complain(new Error(message.error));
  }

  setState(state) {
    const before = this.state;
    this.state = state;
    if (before && before.run.number !== state.run.number) this.chart.clear();
    if (state.run.status === "none") this.progress = null;
    for (const side of ["source", "target"]) this.load(side, state[side]);
    this.nameViews();
    this.panels.show(state);
    this.panels.showProgress(this.progress, state.run);
    if (!state.landmarks.some((l) => l.id === this.chosen)) this.chosen = null;
    this.advise();
    this.refresh();
  }

  setProgress(progress) {
    this.progress = progress;
    if (progress.loss !== null) this.chart.add("loss", progress.iteration - 1, progress.loss);
    if (this.state) this.panels.showProgress(progress, this.state.run);
    this.chart.draw();
  }

  setFigures(figures) {
    this.figures = figures;
    this.panels.showFigures(figures);
    this.chart.add("Q", figures.iteration, figures.q);
    this.chart.draw();
  }

  // Loads a shape if it is another than the one shown.
  async load(side, about) {
    const hash = about ? about.hash : null;
    if (this.hashes[side] === hash) return;
    this.hashes[side] = hash;
    const view = this.views.of(side);
    const isNew = { source: ["source", "result"], target: ["target", "result"] }[side];
    isNew.forEach((name) => this.drop(this.views.of(name)));
    this.figures = null;
    this.panels.showFigures(null);
    if (!hash) return;
    try {
      const buffers = await fetchShape(side, hash);
      if (this.hashes[side] !== hash) return;
      view.shape = new Shape(this.renderer.gl, buffers);
      view.camera.home();
      this.frameView(view);
      if (side === "source") this.colourParts();
      this.takeFrame();
      this.invalidate();
    } catch (error) {
      this.hashes[side] = undefined;
      this.complain(error);
    }
  }

  drop(view) {
    view.shape?.free();
    view.shape = null;
    this.invalidate(view);
  }

  // A shape of the result: four numbers (1, serial, kind, iteration), then positions. Or a heat map: (2, serial,
  // kind, whether by triangle), then values.
  receive(bytes) {
    const [what, serial, kind, more] = new Uint32Array(bytes, 0, 4);
    const numbers = new Float32Array(bytes, 16);
    if (what === 1) {
      this.frame = { serial, kind, iteration: more, positions: numbers };
      this.takeFrame();
      requestAnimationFrame(() => this.link.tell({ ready: serial }));
    } else if (this.views.result.shape && this.heat) {
      this.heatWanted = false;
      this.views.result.shape.colour(numbers, more === 1);
      this.heatSerial = serial;
      this.askHeat();
    }
    this.nameViews();
    this.invalidate(this.views.result);
  }

  // Puts the newest positions into the result's view.
  takeFrame() {
    const { source, target, result } = this.views;
    if (!this.frame || !source.shape || !target.shape) return;
    if (this.frame.positions.length !== source.shape.positions.length) return;
    if (!result.shape) {
      result.shape = new Shape(this.renderer.gl, { positions: this.frame.positions, triangles: source.shape.triangles, edges: source.shape.edges, normals: null });
      result.camera.look(target.camera.yaw, target.camera.pitch);
      this.frameView(result);
      if (this.state.landmarks.filter((l) => l.source && l.target).length >= 4) this.align();
    } else {
      result.shape.move(this.frame.positions);
    }
    this.askHeat();
  }

  askHeat() {
    if (!this.heat || this.heatWanted || this.heatSerial === this.frame?.serial) return;
    this.heatWanted = true;
    this.link.tell({ heat: this.heat });
  }

  // --- what the user does ---

  async ask(what, more) {
    try {
      return await this.link.ask(what, more);
    } catch (error) {
      this.complain(error);
      return null;
    }
  }

  async place(view, ray) {
    if (!this.state) return;
    const answer = await this.ask("place", { side: view.side, ray });
    if (answer) this.choose(answer.landmark);
    else this.choose(null);
  }

  // Rays of a drag go one after the other; those that come meanwhile are passed over, but the last.
  async drag(view, landmark, ray, done) {
    if (this.dragging) {
      this.dragging.next = [view, landmark, ray, done || this.dragging.next?.[3]];
      return;
    }
    this.dragging = { next: null };
    await this.ask("drag", { landmark, side: view.side, ray, done });
    const { next } = this.dragging;
    this.dragging = null;
    if (next) this.drag(...next);
  }

  choose(id) {
    this.chosen = id;
    this.refresh();
  }

  // Moves the camera of a view, and the others with it.
  moveCameras(view, change) {
    const moved = this.preferences.linked ? this.views.list : [view];
    moved.forEach((other) => change(other.camera, other));
    this.invalidate(...moved);
  }

  // Target and result lie in one frame and are seen from one place.
  frameView(view) {
    if (!view.shape) return;
    const { shape } = view.side === "result" && this.views.target.shape ? this.views.target : view;
    const { clientWidth, clientHeight } = view.element;
    view.camera.fit(shape.bounds.centre, shape.sample(3000), clientWidth / clientHeight);
  }

  home() {
    this.views.list.forEach((view) => view.camera.home());
    this.frameAll();
  }

  frameAll() {
    this.views.list.forEach((view) => this.frameView(view));
    this.invalidate();
  }

  look(yaw, pitch) {
    this.moveCameras(this.focused, (camera) => camera.look(yaw, pitch));
  }

  get focused() {
    return this.views.list.find((view) => view.element === document.activeElement || view.element.contains(document.activeElement)) ?? this.views.result;
  }

  frameChosen() {
    const landmark = this.state?.landmarks.find((l) => l.id === this.chosen);
    if (!landmark) return;
    for (const view of this.views.list) {
      const place = view.place(landmark);
      if (place) view.camera.frame(place.point, 0.12);
    }
    this.invalidate();
  }

  // Turns the source's view so that it stands as its result does.
  align() {
    const { source, target, result } = this.views;
    if (!source.shape || !result.shape) return;
    const rotation = bestRotation(source.shape.sample(800), result.shape.sample(800));
    source.camera.base = after(target.camera.base, rotation);
    source.camera.look(target.camera.yaw, target.camera.pitch);
    this.frameView(source);
    this.invalidate();
  }

  toggleUp() {
    const next = this.focused.camera.up === "y" ? "z" : "y";
    const views = this.focused.side === "source" ? [this.views.source] : [this.views.target, this.views.result];
    views.forEach((view) => view.camera.setUp(next));
    this.invalidate();
  }

  // How each part of the source is draped.
  setParts(ways) {
    const key = JSON.stringify(ways);
    if (this.waysKey === key) return;
    [this.waysKey, this.ways] = [key, ways];
    this.colourParts();
  }

  pointOut(name) {
    this.pointedOut = name;
    this.colourParts();
  }

  // Parts that are not draped like the rest, and the one that is pointed out, have a colour in the source's view.
  async colourParts() {
    const { shape } = this.views.source;
    if (!shape) return;
    const shown = Object.entries(this.ways ?? {}).filter(([name, way]) => way !== "draped" || name === this.pointedOut);
    const hash = this.hashes.source;
    this.partFaces = this.partFaces?.hash === hash ? this.partFaces : { hash, of: new Map() };
    for (const [name] of shown) {
      if (!this.partFaces.of.has(name)) this.partFaces.of.set(name, (await this.ask("part_faces", { name })) ?? []);
    }
    if (this.hashes.source !== hash) return;
    const values = new Float32Array(shape.triangles.length / 3).fill(-1);
    for (const [name, way] of shown) {
      const value = name === this.pointedOut ? 1 : way === "free" ? 0.25 : 0.75;
      for (const [from, to] of this.partFaces.of.get(name) ?? []) values.fill(value, from, to);
    }
    shape.colour(shown.length > 0 ? values : null, true);
    this.invalidate(this.views.source);
  }

  setHeat(heat) {
    this.heat = heat;
    this.heatSerial = null;
    this.heatWanted = false;
    $("heat").value = heat;
    $("legend").hidden = !heat;
    if (heat) [, , $("legend-low").textContent, $("legend-high").textContent] = HEATS[heat];
    else this.views.result.shape?.colour(null, false);
    this.askHeat();
    this.invalidate();
  }

  setStyle(style) {
    this.prefer({ style });
    document.querySelector(`input[name=style][value=${style}]`).checked = true;
  }

  setTheme() {
    this.prefer({ theme: this.theme === "dark" ? "light" : "dark" });
    this.dress();
  }

  playOrPause() {
    const status = this.state?.run.status;
    const button = [$("pause"), $("resume"), $("drape")].find((b) => !b.hidden && !b.disabled);
    if (status && button) button.click();
  }

  withChosen(what, more = () => ({})) {
    const landmark = this.state?.landmarks.find((l) => l.id === this.chosen);
    if (landmark) this.ask(what, { landmark: landmark.id, ...more(landmark) });
  }

  control() {
    const on = (id, event, action) => $(id).addEventListener(event, action);
    on("theme", "click", () => this.setTheme());
    on("help", "click", () => this.help());
    on("home", "click", () => this.home());
    on("align", "click", () => this.align());
    on("zoom-in", "click", () => this.moveCameras(this.focused, (camera) => camera.zoom(0.8)));
    on("zoom-out", "click", () => this.moveCameras(this.focused, (camera) => camera.zoom(1.25)));
    on("heat", "change", () => this.setHeat($("heat").value));
    on("opacity", "input", () => this.invalidate(this.views.result));
    on("linked", "change", () => this.prefer({ linked: $("linked").checked }));
    $("linked").checked = this.preferences.linked;
    document.querySelectorAll("input[name=style]").forEach((input) => {
      input.checked = input.value === this.preferences.style;
      input.addEventListener("change", () => this.setStyle(input.value));
    });
    showKeys($("keys"));
    const camera = (change) => () => this.moveCameras(this.focused, change);
    const next = (list, item) => list[(list.indexOf(item) + 1) % list.length];
    const press = (id) => () => !$(id).disabled && !$(id).hidden && $(id).click();
    listen({
      d: press("drape"), " ": () => this.playOrPause(), ".": press("step"),
      "ctrl z": press("undo"), "ctrl shift z": press("redo"), "ctrl y": press("redo"),
      delete: () => this.withChosen("delete"), backspace: () => this.withChosen("delete"),
      f2: () => this.panels.rename(this.chosen),
      r: () => this.withChosen("kind", (l) => ({ kind: l.kind === "soft" ? "rigid" : "soft" })),
      m: () => $("mirror").click(), escape: () => this.choose(null),
      home: () => this.home(), f: () => this.frameChosen(), l: () => $("linked").click(), a: () => this.align(), u: () => this.toggleUp(),
      1: () => this.look(0, 0), 3: () => this.look(Math.PI / 2, 0), 7: () => this.look(0, Math.PI / 2),
      arrowleft: camera((c) => c.orbit(12, 0)), arrowright: camera((c) => c.orbit(-12, 0)),
      arrowup: camera((c) => c.orbit(0, 12)), arrowdown: camera((c) => c.orbit(0, -12)),
      "+": camera((c) => c.zoom(0.8)), "=": camera((c) => c.zoom(0.8)), "-": camera((c) => c.zoom(1.25)),
      z: () => this.setStyle(next(STYLES, this.preferences.style)),
      h: () => this.setHeat(next(["", ...Object.keys(HEATS)], this.heat)),
      o: () => { $("opacity").value = Number($("opacity").value) > 0 ? 0 : 0.5; this.invalidate(); },
      t: () => this.setTheme(), "?": () => this.help(),
    });
  }

  help() {
    $("keys-dialog").showModal();
  }

  // --- what is seen ---

  say(text) {
    $("hint").textContent = text;
    this.isSaying = Boolean(text);
    if (!text) this.advise();
  }

  complain(error) {
    this.isSaying = false;
    this.advise();
    const toast = $("toast");
    toast.textContent = error.message.charAt(0).toUpperCase() + error.message.slice(1);
    toast.hidden = false;
    clearTimeout(this.toastTimer);
    this.toastTimer = setTimeout(() => (toast.hidden = true), 9000);
  }

  // The next thing to do.
  advise() {
    if (this.isSaying || !this.state) return;
    const { source, target, landmarks, run } = this.state;
    const half = landmarks.find((l) => !l.source || !l.target);
    const text =
      !source && !target ? "Open or drop a source and a target to begin"
      : !source ? "Now open or drop the source: the mesh to deform"
      : !target ? "Now open or drop the target: the shape to drape over"
      : half ? `Now click the same place on the ${half.source ? "target" : "source"}`
      : run.status === "running" ? "Mark or drag landmarks at any time: they take effect at once"
      : run.pending ? "Resume: the drape goes on with the landmarks as they are now"
      : landmarks.length === 0 ? "Click a place on the source, then the same place on the target"
      : run.status === "finished" ? "Add landmarks where the result is off and resume, or export"
      : landmarks.length < 5 ? "Mark some more pairs of places, or drape"
      : run.status === "none" ? "Drape, or mark more places" : "";
    $("hint").textContent = text;
  }

  nameViews() {
    const { source, target, result } = this.views;
    const about = (s) => (s ? `${s.name} · ${s.n_vertices.toLocaleString("en")} ${s.kind === "cloud" ? "points" : "vertices"}` : "");
    const set = (view, title, text) => {
      view.title.textContent = title;
      view.about.textContent = text;
    };
    set(source, "Source", about(this.state?.source));
    set(target, "Target", about(this.state?.target));
    const kinds = ["Preview: the source brought to its landmarks", "", "Preview: how the drape goes on"];
    const isShown = Boolean(result.shape && this.frame);
    set(result, "Result", isShown ? kinds[this.frame.kind] || `After ${this.frame.iteration} iterations` : "");
    const status = this.state?.run.status;
    result.badge.hidden = !["running", "paused"].includes(status);
    result.badge.textContent = status === "running" ? "live" : "paused";
    this.fillEmpty();
  }

  fillEmpty() {
    const invite = (view, isEmpty, title, text, role) => {
      if (view.empty.hidden === !isEmpty) return;
      view.empty.hidden = !isEmpty;
      view.empty.replaceChildren();
      if (!isEmpty) return;
      const make = (tag, content) => Object.assign(document.createElement(tag), { textContent: content });
      view.empty.append(make("b", title), make("span", text));
      if (role) {
        const button = make("button", "Choose a file…");
        button.className = "main";
        button.addEventListener("click", () => this.panels.chooseFile(role));
        view.empty.append(button, make("span", FORMATS.replaceAll(",", " ")));
      }
    };
    const { source, target, result } = this.views;
    invite(source, !this.state?.source, "The mesh you like", "Drop it here: its quads, UVs and groups survive.", "source");
    invite(target, !this.state?.target, "The shape you want", "Drop a mesh, a raw scan or a point cloud here.", "target");
    invite(result, !(this.state?.source && this.state?.target), "The result", "The source in the target's shape will show here, from the first landmark on.", null);
  }

  resized() {
    this.chart.draw();
    this.invalidate();
  }

  // These views are to be drawn again; all where none is named.
  invalidate(...views) {
    const stale = views.length > 0 ? views : (this.views?.list ?? []);
    stale.forEach((view) => (view.isStale = true));
    this.refresh();
  }

  // Markers are to be put where they belong.
  refresh() {
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.draw();
    });
  }

  draw() {
    if (!this.views) return;
    const isResized = this.renderer.begin();
    for (const view of this.views.list) {
      if (view.isStale || isResized) this.drawView(view);
      view.isStale = false;
    }
    this.showMarkers();
  }

  drawView(view) {
    const { renderer } = this;
    const { style } = this.preferences;
    const { box } = view;
    const colours = COLOURS[this.theme];
    renderer.part(box, view.camera.matrices(box.width / box.height), colours.back);
    if (!view.shape) return;
    const isResult = view.side === "result";
    const range = isResult ? (this.heat ? HEATS[this.heat] : null) : [0, 1];
    renderer.draw(view.shape, { style, colour: colours[view.side], line: colours.line, range });
    const opacity = Number($("opacity").value);
    if (isResult && opacity > 0 && this.views.target.shape) {
      renderer.draw(this.views.target.shape, { style: "shaded", colour: colours.target, alpha: opacity });
    }
  }

  showMarkers() {
    const landmarks = this.state?.landmarks ?? [];
    this.views.list.forEach((view) => view.showMarkers(landmarks, this.chosen));
    this.panels.showMisses(this.misses(landmarks), this.chosen);
  }

  // How far each landmark of the shown result is from its place, in longest sides of the target's box.
  misses(landmarks) {
    const { result } = this.views;
    const entries = landmarks.filter((l) => l.source && l.target && result.shape);
    return new Map(entries.map((l) => [l.id, length(subtract(result.place(l).point, l.target.point))]));
  }

  // Where a point of a view is on the page: for tests.
  onPage(side, point) {
    const view = this.views.of(side);
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

