// Files on their way in: chosen, dropped, waiting.

import { openFile, openKnown } from "./link.js";

const $ = (id) => document.getElementById(id);
const LANDMARKS = /\.(json|txt|pp|csv)$/i;
const BESIDE = /\.(mtl|png|jpe?g|webp|bmp|bin)$/i;
export const FORMATS = ".obj,.ply,.off,.stl,.gltf,.glb,.xyz,.gz";
const SIDES = ["source", "target"];

// Whether a file is a session: it has a check sum, which landmarks have not.
const isSession = async (file) => {
  const text = /\.json$/i.test(file.name) ? await file.text() : "";
  return text.includes('"check_sum"') && text.includes('"document"');
};

export class Files {
  constructor(app) {
    this.app = app;
    this.opening = Promise.resolve();
    // The sides that have been opened; the studio tells of them a moment later.
    this.opened = new Set();
    for (const role of [...SIDES, "landmarks"]) $(`open-${role}`).addEventListener("click", () => this.choose(role));
    this.listenToDrops();
  }

  // A file dialog; tests put files into the same input.
  choose(role) {
    const input = $("file");
    input.accept = role === "landmarks" ? ".json,.txt,.pp,.csv" : `${FORMATS},.mtl,.png,.jpg,.jpeg,.webp,.json`;
    input.multiple = role !== "landmarks";
    input.value = "";
    input.onchange = () => input.files.length && this.take([...input.files], role === "landmarks" ? null : role);
    input.click();
  }

  // Files are opened one after the other, in the order in which they came. A role may depend on what came before.
  open(role, file) {
    return this.next(() => this.openNow(typeof role === "function" ? role() : role, file.name, (as) => openFile(as, file)));
  }

  // A target that waits, or a session that was set aside.
  openKnown(what, name) {
    return this.next(() => this.openNow(what, name, (as) => openKnown(as, name)));
  }

  next(step) {
    this.opening = this.opening.then(step);
    return this.opening;
  }

  async openNow(role, name, send) {
    const { words, views } = this.app;
    const view = views.list.find((v) => v.name === role) ?? (role === "next" ? views.target : null);
    words.say(SIDES.includes(role) ? `Opening ${name} as ${role}…` : `Opening ${name}…`);
    view?.wait(`Opening ${name}…`);
    try {
      await send(role);
      this.opened.add(role);
      words.say("");
    } catch (error) {
      words.complain(error);
    }
    if (view?.shape) view.wait("");
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
      const view = viewOf(event)?.dataset.name;
      this.take([...(event.dataTransfer?.files ?? [])], SIDES.includes(view) ? view : null);
    });
  }

  // One shape goes where it is dropped, of two the first is the source, of more on the target all wait in order;
  // pictures come before the shapes that show them, landmarks after those that they mark.
  async take(files, side) {
    const sessions = [];
    for (const file of files) if (await isSession(file)) sessions.push(file);
    const others = files.filter((file) => !sessions.includes(file));
    const beside = others.filter((file) => BESIDE.test(file.name));
    const landmarks = others.filter((file) => LANDMARKS.test(file.name));
    const shapes = others.filter((file) => !BESIDE.test(file.name) && !LANDMARKS.test(file.name));
    const isQueue = side === "target" && Boolean(this.app.state?.source) && shapes.length > 1;
    if (sessions.length > 1 || landmarks.length > 1 || (shapes.length > 2 && !isQueue)) {
      this.app.words.complain(new Error("drop a source, a target and one file of landmarks at most; several targets on the target's view"));
      return;
    }
    // What is free is known once the files that came before are open.
    const free = () => (this.app.state?.source || this.opened.has("source") ? "target" : "source");
    const roles = isQueue ? shapes.map((_, k) => (k === 0 ? "target" : "queue")) : shapes.length === 2 ? SIDES : [side ?? free];
    for (const file of beside) for (const role of this.sidesOf(roles, shapes.length)) await this.open(`beside-${role}`, file);
    for (const file of sessions) await this.open("session", file);
    for (const [k, file] of shapes.entries()) await this.open(roles[k], file);
    for (const file of landmarks) await this.open("landmarks", file);
    if (beside.length > 0 && shapes.length === 0) this.app.words.note("Pictures are shown with their mesh: drop it together with them");
  }

  // The sides whose folder gets what lies beside a mesh.
  sidesOf(roles, nShapes) {
    const named = roles.slice(0, nShapes).map((role) => (typeof role === "function" ? role() : role));
    const sides = SIDES.filter((side) => named.includes(side));
    return sides.length > 0 ? sides : SIDES;
  }
}

// The scans that wait and those whose session was set aside.
export const showScans = (app, { queue, aside }) => {
  $("scans-menu").hidden = queue.length + aside.length === 0;
  $("scans").textContent = queue.length > 0 ? `Scans (${queue.length} wait) ▾` : "Scans ▾";
  const item = (text, title, act) => {
    const [row, button] = ["li", "button"].map((tag) => document.createElement(tag));
    Object.assign(button, { textContent: text, title });
    button.addEventListener("click", () => {
      $("scans-menu").open = false;
      act();
    });
    row.append(button);
    return row;
  };
  $("scans-list").replaceChildren(
    ...queue.slice(0, 1).map((name) => item(`Next: ${name}`, "Landmarks stay and wait for their places on it", () => app.files.openKnown("next", name))),
    ...queue.slice(1).map((name) => Object.assign(document.createElement("li"), { textContent: `then ${name}`, className: "soft" })),
    ...aside.map((name) => item(`Back to ${name.replace(/-[0-9a-f]{6}$/, "")}`, "Its session, as it was left", () => app.files.openKnown("aside", name))),
  );
};
