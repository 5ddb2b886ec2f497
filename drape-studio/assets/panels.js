// Everything beside the views: files, landmarks, settings, the drape and its figures.

import { openFile } from "./link.js";
import { markColour } from "./views.js";

const $ = (id) => document.getElementById(id);
// Misses above this many hundredths of the longest side stand out.
const FAR = 2;

const COMMANDS = ["drape", "pause", "resume", "extend", "step", "stop", "reset"];
const LANDMARKS = /\.(json|txt|pp|csv)$/i;
export const FORMATS = ".obj,.ply,.off,.stl,.gltf,.glb,.xyz,.gz";

export class Panels {
  constructor(app) {
    this.app = app;
    this.rows = new Map();
    const on = (id, event, action) => $(id).addEventListener(event, action);
    on("open-source", "click", () => this.chooseFile("source"));
    on("open-target", "click", () => this.chooseFile("target"));
    on("open-landmarks", "click", () => this.chooseFile("landmarks"));
    for (const what of ["undo", "redo", "clear"]) on(what, "click", () => app.edit(what));
    for (const what of COMMANDS) on(what, "click", () => app.command(what));
    on("preset", "change", () => app.edit("preset", { name: $("preset").value }));
    on("seed", "change", () => app.edit("seed", { seed: Math.max(0, Math.min(4294967295, Math.round(Number($("seed").value) || 0))) }));
    for (const id of ["mirror", "mirror-source", "mirror-target"]) on(id, "change", () => this.mirror());
    on("settings", "click", () => this.editSettings());
    on("toml-apply", "click", () => this.applySettings());
    document.addEventListener("click", (event) => {
      if (!event.target.closest("#export-menu summary")) $("export-menu").open = false;
    });
    this.listenToDrops();
  }

  // A file dialog; tests put files into the same input.
  chooseFile(role) {
    const input = $("file");
    input.accept = role === "landmarks" ? ".json,.txt,.pp,.csv" : FORMATS;
    input.value = "";
    input.onchange = () => input.files.length && this.open(role, input.files[0]);
    input.click();
  }

  async open(role, file) {
    this.app.words.say(`Opening ${file.name} as ${role}…`);
    try {
      await openFile(role, file);
      this.app.words.say("");
    } catch (error) {
      this.app.words.complain(error);
    }
  }

  listenToDrops() {
    const viewOf = (event) => event.target.closest?.(".view");
    const clear = () => document.querySelectorAll(".view").forEach((view) => view.classList.remove("is-target-of-drop"));
    document.addEventListener("dragover", (event) => {
      event.preventDefault();
      clear();
      viewOf(event)?.classList.add("is-target-of-drop");
    });
    document.addEventListener("dragleave", (event) => event.relatedTarget === null && clear());
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      clear();
      this.openDropped([...(event.dataTransfer?.files ?? [])], viewOf(event)?.dataset.name);
    });
  }

  // One shape goes where it is dropped, of two the first is the source; landmarks come after the shapes that they mark.
  async openDropped(files, view) {
    const shapes = files.filter((file) => !LANDMARKS.test(file.name));
    const landmarks = files.filter((file) => LANDMARKS.test(file.name));
    if (shapes.length > 2 || landmarks.length > 1) {
      this.app.words.complain(new Error("drop a source, a target and one file of landmarks at most"));
      return;
    }
    const free = this.app.state?.source ? "target" : "source";
    const roles = shapes.length === 2 ? ["source", "target"] : [["source", "target"].includes(view) ? view : free];
    for (const [k, file] of shapes.entries()) await this.open(roles[k], file);
    for (const file of landmarks) await this.open("landmarks", file);
  }

  mirror() {
    const axes = $("mirror").checked ? [Number($("mirror-source").value), Number($("mirror-target").value)] : null;
    return this.app.edit("mirror", { axes });
  }

  editSettings() {
    $("toml").value = this.app.state.settings.toml;
    $("toml-error").textContent = "";
    $("settings-dialog").showModal();
  }

  async applySettings() {
    try {
      await this.app.link.ask("edit", { do: "settings", toml: $("toml").value });
      $("settings-dialog").close();
    } catch (error) {
      $("toml-error").textContent = error.message;
    }
  }

  // The state as the studio tells it.
  show(state) {
    const { can, run, settings, landmarks } = state;
    for (const what of ["undo", "redo", "clear", "drape"]) $(what).disabled = !can[what];
    for (const what of COMMANDS) $(what).hidden = !can[what];
    // Before there is anything to drape, the button says what is to come.
    $("drape").hidden = !can.drape && (can.pause || can.resume);
    $("drape").textContent = run.status === "none" ? "Drape" : "Drape again";
    $("drape").classList.toggle("main", !can.resume);
    $("resume").textContent = !run.pending ? "Resume" : run.pending_parts ? "Resume with the changes" : "Resume with the new landmarks";
    $("extend").textContent = `${run.n_more} more iterations`;
    $("open-landmarks").disabled = !can.open_landmarks;
    for (const what of ["result", "warp", "landmarks", "report"]) {
      const link = $(`export-${what}`);
      link.setAttribute("aria-disabled", String(!can.export));
      link.tabIndex = can.export ? 0 : -1;
    }
    if ($("preset").options.length !== state.presets.length) {
      $("preset").replaceChildren(...state.presets.map((name) => new Option(name, name)));
    }
    $("preset").value = settings.preset;
    if (document.activeElement !== $("seed")) $("seed").value = settings.seed;
    $("mirror").checked = Boolean(state.mirror);
    const axes = state.mirror ?? [state.source?.symmetry ?? 0, state.target?.symmetry ?? 0];
    [$("mirror-source").value, $("mirror-target").value] = axes;
    $("n-landmarks").textContent = landmarks.length || "";
    const notes = [state.notice, state.preview_error, ...state.warnings].filter(Boolean);
    $("warnings").replaceChildren(...notes.map((text) => {
      const item = document.createElement("li");
      item.textContent = sentence(text);
      return item;
    }));
    this.showLandmarks(landmarks);
  }

  showLandmarks(landmarks) {
    const list = $("landmarks");
    if (landmarks.length === 0) {
      this.rows.clear();
      const none = document.createElement("li");
      none.className = "none";
      none.textContent = "None yet. Mark the ends of whatever sticks out: ears, tails, fingers. Five is few, fifteen to thirty is comfortable.";
      list.replaceChildren(none);
      return;
    }
    list.querySelector(".none")?.remove();
    const ids = new Set(landmarks.map((l) => l.id));
    for (const [id, row] of this.rows) {
      if (!ids.has(id)) {
        row.item.remove();
        this.rows.delete(id);
      }
    }
    landmarks.forEach((landmark, k) => {
      const row = this.rows.get(landmark.id) ?? this.addRow(landmark.id);
      const label = landmark.name || `landmark ${k + 1}`;
      row.number.textContent = k + 1;
      row.number.setAttribute("aria-label", `Choose ${label}`);
      if (document.activeElement !== row.name) row.name.value = landmark.name;
      row.name.placeholder = !landmark.target ? "mark it on the target" : !landmark.source ? "mark it on the source" : `landmark ${k + 1}`;
      row.name.setAttribute("aria-label", `Name of landmark ${k + 1}`);
      row.kind.textContent = landmark.kind;
      row.kind.setAttribute("aria-label", `${label} is ${landmark.kind}; change`);
      row.kind.dataset.kind = landmark.kind;
      row.remove.setAttribute("aria-label", `Delete ${label}`);
      if (list.children[k] !== row.item) list.insertBefore(row.item, list.children[k] ?? null);
    });
  }

  addRow(id) {
    const make = (tag, name, text) => Object.assign(document.createElement(tag), { className: name, textContent: text });
    const row = { item: make("li", "", ""), number: make("button", "number", ""), name: make("input", "", ""), miss: make("span", "miss", ""), kind: make("button", "", ""), remove: make("button", "", "×") };
    row.name.type = "text";
    row.name.maxLength = 80;
    row.miss.title = "How far it is off, in hundredths of the target's longest side";
    row.kind.title = "Soft landmarks stretch what is around them, rigid ones turn it as one";
    row.number.style.background = markColour(id);
    row.number.addEventListener("click", () => this.app.choose(id));
    row.name.addEventListener("focus", () => this.app.choose(id));
    row.name.addEventListener("change", () => this.app.edit("rename", { landmark: id, name: row.name.value }));
    row.name.addEventListener("keydown", (event) => event.key === "Enter" && row.name.blur());
    row.kind.addEventListener("click", () => this.app.edit("kind", { landmark: id, kind: row.kind.dataset.kind === "soft" ? "rigid" : "soft" }));
    row.remove.addEventListener("click", () => this.app.edit("delete", { landmark: id }));
    row.item.append(row.number, row.name, row.miss, row.kind, row.remove);
    this.rows.set(id, row);
    return row;
  }

  // How far each landmark is off, and which one is chosen.
  showMisses(misses, chosen) {
    for (const [id, row] of this.rows) {
      const miss = misses.get(id);
      row.miss.textContent = miss === undefined ? "" : `${(100 * miss).toFixed(2)}`;
      row.miss.classList.toggle("is-far", 100 * (miss ?? 0) > FAR);
      row.item.classList.toggle("is-chosen", id === chosen);
    }
  }

  rename(id) {
    this.rows.get(id)?.name.select();
  }

  showProgress(progress, { run, can }) {
    const { iteration = 0, n_iterations: n = 0, seconds_left: left = 0 } = progress ?? {};
    $("progress").value = n > 0 ? iteration / n : 0;
    const words = { none: "No drape yet", starting: "Deforming the source…", running: "Draping", paused: "Paused", stopped: "Stopped", finished: "Done", failed: "Failed" };
    const parts = [words[run.status]];
    if (run.status !== "none" && n > 0) parts.push(`iteration ${iteration} of ${n}`);
    if (can.pause && left > 0) parts.push(`${time(left)} left`);
    if (run.pending && can.resume) parts.push(run.pending_landmarks ? "landmarks changed" : "parts changed");
    $("status").textContent = $("status").title = run.error ? sentence(run.error) : parts.join(" · ");
    $("status").classList.toggle("is-bad", Boolean(run.error));
  }

  showFigures(f) {
    const entries = f ? [
      ["Q", f.q.toFixed(3), "Fit and distortion together: 1 is perfect"],
      ["Hausdorff", `${(100 * f.hausdorff).toFixed(2)} %`, "Largest distance, both ways, of the target's longest side"],
      ["mean distance", `${(100 * f.mean_distance).toFixed(3)} %`, "Mean distances of both ways, added"],
      ["Dirichlet", f.dirichlet.toFixed(3), "Stretch: 1 is none"],
      ["angles", `${f.angle_deviation.toFixed(1)}°`, "Mean change of the corner angles"],
      ["folds", f.folds, "Edges folded over"],
      ["skinny", f.skinny, "Triangles of quality below 0.1"],
      ["crossings", f.crossings, "Pairs of triangles that run through each other and did not in the source"],
      ["landmarks", `${(100 * f.landmark_rms).toFixed(2)} %`, "Root mean square of what the landmarks are off"],
    ] : [];
    $("figures").replaceChildren(...entries.map(([name, value, title]) => {
      const item = document.createElement("div");
      item.title = title;
      item.append(Object.assign(document.createElement("dt"), { textContent: name }), Object.assign(document.createElement("dd"), { textContent: value }));
      return item;
    }));
  }
}

const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1) + (/[.!?]$/.test(text) ? "" : ".");

const time = (seconds) => {
  const s = Math.ceil(seconds);
  return s < 100 ? `${s} s` : `${Math.floor(s / 60)} min ${s % 60} s`;
};
