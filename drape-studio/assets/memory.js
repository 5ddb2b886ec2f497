// What a tab remembers when it is loaded again: cameras, colours, what is laid over what.

const KEY = "drape-studio-views";

const read = () => {
  try {
    return JSON.parse(sessionStorage.getItem(KEY) ?? "{}");
  } catch {
    return {};
  }
};

export class Memory {
  constructor(app) {
    this.app = app;
    this.before = read();
    // A page that is left, or put into the background of a phone, may not come back by itself.
    addEventListener("pagehide", () => this.write());
    document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && this.write());
  }

  write() {
    const { views, stage, painter } = this.app;
    // A view that shows nothing yet is remembered as it was before.
    const cameras = Object.fromEntries(views.list.map((view) => [
      view.name,
      view.shape ? { hash: this.hash(view), pose: view.camera.pose } : (this.before.cameras?.[view.name] ?? null),
    ]));
    const kept = { cameras, heat: stage.heat === "difference" ? "" : stage.heat, overlay: painter.overlay };
    sessionStorage.setItem(KEY, JSON.stringify(kept));
  }

  // What a view shows: the result stands for both shapes.
  hash({ name }) {
    const { source, target } = this.app.stage.hashes;
    return { source, target, result: `${source} ${target}` }[name];
  }

  // Looks at a shape as before, if it is the same; whether it is.
  look(view) {
    const kept = this.before.cameras?.[view.name];
    if (!kept || kept.hash !== this.hash(view)) return false;
    delete this.before.cameras[view.name];
    view.camera.pose = kept.pose;
    return true;
  }
}
