// A pointer for the keyboard: it is moved over the surface of the view that has the focus, and marks where it stands.

// Pixels that it moves with a key; with Shift a single one.
const STEP = 10;

export class Cursor {
  constructor(app) {
    this.app = app;
    [this.view, this.at] = [null, null];
    this.cross = Object.assign(document.createElement("div"), { className: "cross", hidden: true });
    for (const { element } of app.views.list) element.addEventListener("pointerdown", () => this.hide());
  }

  get isShown() {
    return this.view !== null;
  }

  // Shows itself in the middle of the view with the focus; where it is there already, marks the place under it.
  enter() {
    const { app } = this;
    const view = app.cameras.focused;
    if (!view.shape) return;
    if (this.view === view) {
      const { left, top } = view.element.getBoundingClientRect();
      app.place(view, view.ray({ clientX: left + this.at[0], clientY: top + this.at[1] }));
      return;
    }
    [this.view, this.at] = [view, [view.box.width / 2, view.box.height / 2]];
    view.element.append(this.cross);
    this.cross.hidden = false;
    this.move(0, 0);
  }

  move(dx, dy) {
    const { width, height } = this.view.box;
    const within = (x, most) => Math.max(0, Math.min(most, x));
    this.at = [within(this.at[0] + dx, width), within(this.at[1] + dy, height)];
    Object.assign(this.cross.style, { left: `${this.at[0]}px`, top: `${this.at[1]}px` });
  }

  // Takes an arrow key, if the cursor is there.
  takes([dx, dy], isFine) {
    if (this.view === null || this.view !== this.app.cameras.focused) return false;
    const step = isFine ? 1 : STEP;
    this.move(dx * step, dy * step);
    return true;
  }

  hide() {
    this.view = null;
    this.cross.hidden = true;
  }
}
