// The cameras of the three views, which move together or each alone.

import { after, bestRotation } from "./maths.js";

// What a view shows around the chosen landmark, in longest sides.
const AROUND = 0.12;

export class Cameras {
  constructor(app) {
    this.app = app;
  }

  // Moves the camera of a view, and the others with it.
  move(view, change) {
    const { views, preferences, painter } = this.app;
    const moved = preferences.linked ? views.list : [view];
    moved.forEach((other) => change(other.camera, other));
    painter.invalidate(...moved);
  }

  // Moves the camera of the view that the user works in.
  change(change) {
    this.move(this.focused, change);
  }

  get focused() {
    const { list, result } = this.app.views;
    return list.find((view) => view.element.contains(document.activeElement)) ?? result;
  }

  look(yaw, pitch) {
    this.change((camera) => camera.look(yaw, pitch));
  }

  // Target and result lie in one frame and are seen from one place.
  frame(view) {
    if (!view.shape) return;
    const { target } = this.app.views;
    const { shape } = view.name === "result" && target.shape ? target : view;
    const { width, height } = view.box;
    view.camera.fit(shape.bounds.centre, shape.sample(3000), width / height);
  }

  frameAll() {
    this.app.views.list.forEach((view) => this.frame(view));
    this.app.painter.invalidate();
  }

  home() {
    this.app.views.list.forEach((view) => view.camera.home());
    this.frameAll();
  }

  frameChosen() {
    const landmark = this.app.chosenLandmark;
    if (!landmark) return;
    for (const view of this.app.views.list) {
      const place = view.place(landmark);
      if (place) view.camera.frame(place.point, AROUND);
    }
    this.app.painter.invalidate();
  }

  // Turns the source's view so that it stands as its result does.
  align() {
    const { source, target, result } = this.app.views;
    if (!source.shape || !result.shape) return;
    const rotation = bestRotation(source.shape.sample(800), result.shape.sample(800));
    source.camera.base = after(target.camera.base, rotation);
    source.camera.look(target.camera.yaw, target.camera.pitch);
    this.frame(source);
    this.app.painter.invalidate();
  }

  // With or without perspective, in all views.
  setFlat(isFlat) {
    this.app.views.list.forEach(({ camera }) => (camera.isFlat = isFlat));
    this.app.painter.invalidate();
  }

  // One view in the place of all, or all again.
  enlarge(view) {
    const main = document.querySelector("main");
    const isLarge = view.element.classList.contains("is-large");
    this.app.views.list.forEach((other) => other.element.classList.toggle("is-large", other === view && !isLarge));
    main.classList.toggle("is-single", !isLarge);
    this.app.resized();
  }

  toggleUp() {
    const { views, painter } = this.app;
    const next = this.focused.camera.up === "y" ? "z" : "y";
    const turned = this.focused.name === "source" ? [views.source] : [views.target, views.result];
    turned.forEach((view) => view.camera.setUp(next));
    painter.invalidate();
  }
}
