// What the page says: titles, advice, complaints.

import { FORMATS } from "./files.js";

const $ = (id) => document.getElementById(id);
const KINDS = ["Preview: the source brought to its landmarks", "", "Preview: how the drape goes on"];
const BADGES = { running: "live", paused: "paused" };
const DISCARDS = {
  drape: "Another drape begins from the landmarks as they are. What this one came to goes to the kept results below the views, from where it can be brought back.",
  reset: "What it came to goes to the kept results below the views, from where it can be brought back. Landmarks and settings stay.",
};
// How long a complaint stays, in milliseconds.
const PATIENCE = 9000;

// The next thing to do.
const advice = ({ source, target, landmarks, run, can }) => {
  const waiting = landmarks.filter((l) => !l.source || !l.target);
  const half = waiting[0];
  if (!source && !target) return "Open or drop a source and a target to begin";
  if (!source) return "Now open or drop the source: the mesh to deform";
  if (!target) return "Now open or drop the target: the shape to drape over";
  if (waiting.length > 1) return `Now click ${half.name ? `“${half.name}”` : "the chosen landmark"} on the ${half.source ? "target" : "source"}: ${waiting.length} wait for their places`;
  if (half) return `Now click the same place on the ${half.source ? "target" : "source"}`;
  if (can.pause) return "Mark or drag landmarks at any time: they take effect at once";
  if (run.pending) return "Resume: the drape goes on with what you changed";
  if (landmarks.length === 0) return "Click a place on the source, then the same place on the target";
  if (can.extend) return "Add landmarks where the result is off and resume, let it go on, or export";
  if (landmarks.length < 5) return "Mark some more pairs of places, or drape";
  return can.drape ? "Drape, or mark more places" : "";
};

export class Words {
  constructor(app) {
    this.app = app;
    this.isSaying = false;
  }

  // Says what goes on, until nothing does.
  say(text) {
    $("hint").textContent = text;
    this.isSaying = Boolean(text);
    if (!text) this.advise();
  }

  complain(error) {
    this.isSaying = false;
    this.advise();
    this.note(error.message);
  }

  // Something the user should know, for a while.
  note(text) {
    const toast = $("toast");
    toast.textContent = text.charAt(0).toUpperCase() + text.slice(1);
    toast.hidden = false;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => (toast.hidden = true), PATIENCE);
  }

  advise() {
    const { state } = this.app;
    if (this.isSaying || !state) return;
    $("hint").textContent = $("hint").title = advice(state);
  }

  // Whether the user means a command that throws a result away.
  mayDiscard(what) {
    const dialog = $("discard-dialog");
    $("discard-text").textContent = DISCARDS[what];
    dialog.returnValue = "";
    dialog.showModal();
    return new Promise((decide) => {
      dialog.addEventListener("close", () => decide(dialog.returnValue === "discard"), { once: true });
    });
  }

  nameViews() {
    const { views, state, stage } = this.app;
    const { source, target, result } = views;
    const about = (s) => (s ? `${s.name} · ${s.n_vertices.toLocaleString("en")} ${s.kind === "cloud" ? "points" : "vertices"}` : "");
    const set = (view, title, text) => {
      view.title.textContent = title;
      view.about.textContent = text;
    };
    set(source, "Source", about(state?.source));
    set(target, "Target", about(state?.target));
    const { shown } = stage;
    const isShown = Boolean(result.shape && shown);
    set(result, "Result", isShown ? KINDS[shown.kind] || `After ${shown.iteration} iterations` : "");
    const badge = BADGES[state?.run.status] ?? "";
    [result.badge.textContent, result.badge.hidden] = [badge, !badge];
    this.invite(source, !state?.source, "The mesh you like", "Drop it here: its quads, UVs and groups survive.", "source");
    this.invite(target, !state?.target, "The shape you want", "Drop a mesh, a raw scan or a point cloud here.", "target");
    this.invite(result, !(state?.source && state?.target), "The result", "The source in the target's shape shows here, as soon as both are open.", null);
  }

  // What an empty view is for.
  invite(view, isEmpty, title, text, role) {
    if (view.empty.hidden === !isEmpty) return;
    view.empty.hidden = !isEmpty;
    view.empty.replaceChildren();
    if (!isEmpty) return;
    const make = (tag, content) => Object.assign(document.createElement(tag), { textContent: content });
    view.empty.append(make("b", title), make("span", text));
    if (role) {
      const button = make("button", "Choose a file…");
      button.className = "main";
      button.addEventListener("click", () => this.app.files.choose(role));
      view.empty.append(button, make("span", FORMATS.replaceAll(",", " ")));
    }
  }
}
