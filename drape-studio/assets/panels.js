// Everything beside the views: files, landmarks, settings, the drape and its figures.

import { markColour } from "./colours.js";
import { digitsOf, labelOf } from "./markers.js";
import { weightField } from "./weights.js";

const $ = (id) => document.getElementById(id);
// Misses above this many hundredths of the longest side stand out.
const FAR = 2;

const COMMANDS = ["drape", "pause", "resume", "extend", "step", "stop", "reset"];

export class Panels {
  constructor(app) {
    this.app = app;
    this.rows = new Map();
    const on = (id, event, action) => $(id).addEventListener(event, action);
    for (const what of ["undo", "redo", "clear"]) on(what, "click", () => app.edit(what));
    for (const what of COMMANDS) on(what, "click", () => app.command(what));
    on("preset", "change", () => app.edit("preset", { name: $("preset").value }));
    on("seed", "change", () => app.edit("seed", { seed: Math.max(0, Math.min(4294967295, Math.round(Number($("seed").value) || 0))) }));
    for (const id of ["mirror", "mirror-source", "mirror-target"]) on(id, "change", () => this.mirror());
    on("settings", "click", () => this.editSettings());
    on("toml-apply", "click", async () => (await this.applySettings()) && $("settings-dialog").close());
    on("settings-save", "click", () => this.saveSettings());
    on("settings-forget", "click", () => this.app.edit("forget_settings", { name: $("settings-name").value.trim() }));
    document.addEventListener("click", (event) => {
      const own = event.target.closest(".menu");
      document.querySelectorAll(".menu").forEach((menu) => menu !== own && (menu.open = false));
      if (event.target.closest("#export-menu a")) $("export-menu").open = false;
    });
  }

  mirror() {
    const axes = $("mirror").checked ? [Number($("mirror-source").value), Number($("mirror-target").value)] : null;
    return this.app.edit("mirror", { axes });
  }

  editSettings() {
    $("toml").value = this.app.state.settings.toml;
    $("toml-error").textContent = "";
    $("settings-name").value = this.app.state.saved.present ?? "";
    $("settings-dialog").showModal();
    $("toml").setSelectionRange(0, 0);
    $("toml").scrollTop = 0;
  }

  // Whether the text was taken as settings.
  async applySettings() {
    return this.tryEdit({ do: "settings", toml: $("toml").value });
  }

  // The text as it stands, under a name.
  async saveSettings() {
    const name = $("settings-name").value.trim();
    if ((await this.applySettings()) && (await this.tryEdit({ do: "save_settings", name }))) $("settings-dialog").close();
  }

  async tryEdit(edit) {
    try {
      await this.app.link.ask("edit", edit);
      return true;
    } catch (error) {
      $("toml-error").textContent = error.message;
      return false;
    }
  }

  // The presets of the program, then what was saved.
  showPresets({ presets, saved, settings }) {
    const key = JSON.stringify([presets, saved.names]);
    if (this.presetsKey !== key) {
      this.presetsKey = key;
      const group = (label, names) => {
        const element = Object.assign(document.createElement("optgroup"), { label });
        element.append(...names.map((name) => new Option(name, name)));
        return element;
      };
      const groups = saved.names.length > 0 ? [group("Presets", presets), group("Saved", saved.names)] : presets.map((name) => new Option(name, name));
      $("preset").replaceChildren(...groups);
    }
    $("preset").value = saved.present ?? settings.preset;
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
    this.showPresets(state);
    const isPainted = Boolean(state.parts.weights) && !state.parts.weights.startsWith("property:");
    $("export-weights").parentElement.hidden = !isPainted;
    $("export-rigid").parentElement.hidden = !state.painted_rigid;
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
      const label = labelOf(landmark);
      row.number.textContent = digitsOf(landmark);
      row.number.setAttribute("aria-label", `Choose ${label}`);
      if (document.activeElement !== row.name) row.name.value = landmark.name;
      row.name.placeholder = !landmark.target ? "mark it on the target" : !landmark.source ? "mark it on the source" : "name";
      row.name.title = landmark.name;
      row.name.setAttribute("aria-label", `Name of ${label}`);
      row.kind.textContent = landmark.kind;
      row.kind.setAttribute("aria-label", `${label} is ${landmark.kind}; change`);
      row.kind.dataset.kind = landmark.kind;
      row.weight.show(landmark.weight, label);
      row.remove.setAttribute("aria-label", `Delete ${label}`);
      if (list.children[k] !== row.item) list.insertBefore(row.item, list.children[k] ?? null);
    });
  }

  addRow(id) {
    const make = (tag, name, text) => Object.assign(document.createElement(tag), { className: name, textContent: text });
    const row = { item: make("li", "", ""), number: make("button", "number", ""), name: make("input", "", ""), miss: make("span", "miss", ""), weight: weightField(this.app, id), kind: make("button", "", ""), remove: make("button", "", "×") };
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
    row.item.append(row.number, row.name, row.miss, row.weight.element, row.kind, row.remove);
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

  // Those of other landmarks than the present ones are grey until the new ones come.
  showFigures(f, { run, marks }) {
    const isOld = Boolean(f) && f.marks !== marks && run.status !== "running";
    $("figures").classList.toggle("is-old", isOld);
    $("figures").title = isOld ? "Of the landmarks before; those of the present ones are on the way" : "";
    const entries = f ? figuresOf(f) : [];
    $("figures").replaceChildren(...entries.map(([name, value, title, kind = ""]) => {
      const item = document.createElement("div");
      [item.title, item.className] = [title, kind];
      item.append(Object.assign(document.createElement("dt"), { textContent: name }), Object.assign(document.createElement("dd"), { textContent: value }));
      return item;
    }));
  }
}

// What the footer says of a shape: name, value, what it means, and whether it is bad or for information only.
const figuresOf = (f) => {
  const isDraped = f.iteration !== null;
  const percent = (x, digits) => `${(100 * x).toFixed(digits)} %`;
  const isPartial = f.source_left_out + f.target_left_out > 0.005;
  const over = isPartial ? ", over what has a counterpart" : "";
  const bad = (n) => (isDraped && n > 0 ? "is-bad" : "");
  const entries = [
    ["Q", f.q.toFixed(3), `Fit and distortion together: 1 is perfect${over}`],
    ["Hausdorff", percent(f.hausdorff, 2), `Largest distance, both ways, of the target's longest side${over}`],
    ["mean distance", percent(f.mean_distance, 3), `Mean distances of both ways, added${over}`],
    ["Dirichlet", f.dirichlet.toFixed(3), "Stretch: 1 is none"],
    ["angles", `${f.angle_deviation.toFixed(1)}°`, "Mean change of the corner angles"],
    ["flipped", f.flipped ?? "unknown", "Triangles that face against the target", bad(f.flipped)],
    ["crossing", f.crossings, "Pairs of triangles that pass through each other and did not at rest", bad(f.crossings)],
    ["folds", f.folds, "Edges folded over", bad(f.folds)],
    ["skinny", f.skinny, "Triangles of quality below 0.1"],
    ["landmarks", percent(f.landmark_rms, 2), "Root mean square of what the landmarks are off"],
  ];
  if (!isPartial) return entries;
  const shares = [["source", f.source_left_out], ["target", f.target_left_out]].filter(([, share]) => share > 0.005);
  const about = shares.map(([shape, share]) => `${percent(share, 0)} of the ${shape}`).join(", ");
  return [...entries, ["left out", about, `Has no counterpart and is not counted; with it, the Hausdorff distance is ${percent(f.hausdorff_of_all, 1)}`, "is-soft"]];
};

const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1) + (/[.!?]$/.test(text) ? "" : ".");

const time = (seconds) => {
  const s = Math.ceil(seconds);
  return s < 100 ? `${s} s` : `${Math.floor(s / 60)} min ${s % 60} s`;
};
