// The three views: cameras, pointers, markers.

import { Camera } from "./camera.js";
import { Markers } from "./markers.js";
import { Probes } from "./probes.js";

// Pixels that a pointer may move and still be a click.
const CLICK = 5;

class View {
  constructor(app, name) {
    Object.assign(this, { app, name, camera: new Camera(), shape: null, isStale: true, isUnprobed: false, isResting: false, isCoarse: false });
    this.element = document.getElementById(`view-${name}`);
    this.element.innerHTML = '<div class="name"><b></b><span></span></div><div class="badge" hidden></div><div class="empty" hidden></div><div class="markers"></div><div class="busy" role="status"></div><button class="large">⤢</button>';
    [this.title, this.about] = this.element.querySelectorAll(".name b, .name span");
    this.badge = this.element.querySelector(".badge");
    this.empty = this.element.querySelector(".empty");
    this.large = this.element.querySelector(".large");
    [this.large.title, this.large.ariaLabel] = ["One view large, or all (X)", `The ${name} large, or all views`];
    this.busy = this.element.querySelector(".busy");
    this.markers = new Markers(this, this.element.querySelector(".markers"));
    this.probes = new Probes(app.painter.renderer);
    this.box = { left: 0, top: 0, width: 1, height: 1 };
    this.pointers = new Map();
    this.listen();
  }

  // Says what the view is waiting for; nothing where it is not.
  wait(text) {
    this.busy.textContent = text;
    this.element.setAttribute("aria-busy", String(Boolean(text)));
  }

  // A ray through a place of the page.
  ray({ clientX, clientY }) {
    const { left, top, width, height } = this.element.getBoundingClientRect();
    const [x, y] = [(2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height];
    return this.camera.ray(x, y, width / height, height);
  }

  // Where points are seen, in pixels of the view; none where they are behind the eye.
  projection() {
    const { width, height } = this.box;
    const m = this.camera.matrices(width / height).both;
    return ([x, y, z]) => {
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      if (w <= 0) return null;
      const [u, v] = [m[0] * x + m[4] * y + m[8] * z + m[12], m[1] * x + m[5] * y + m[9] * z + m[13]];
      return { x: (0.5 + (0.5 * u) / w) * width, y: (0.5 - (0.5 * v) / w) * height };
    };
  }

  project(point) {
    return this.projection()(point);
  }

  listen() {
    const { element } = this;
    element.addEventListener("pointerdown", (event) => this.press(event));
    element.addEventListener("pointermove", (event) => this.move(event));
    element.addEventListener("pointerup", (event) => this.release(event, true));
    element.addEventListener("pointercancel", (event) => this.release(event, false));
    element.addEventListener("contextmenu", (event) => event.preventDefault());
    element.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
  }

  press(event) {
    if (event.target.closest(".empty, .large") || !this.shape) return;
    const marker = event.target.closest(".marker");
    this.element.focus({ preventScroll: true });
    event.preventDefault();
    this.element.setPointerCapture(event.pointerId);
    const { clientX: x, clientY: y, button } = event;
    const landmark = marker && button === 0 ? Number(marker.dataset.id) : null;
    if (landmark !== null) this.app.choose(landmark);
    const tool = this.app.tools.find((tool) => landmark === null && tool.takes(this, event));
    if (tool) return void tool.begin(this, event);
    this.pointers.set(event.pointerId, { x, y, startX: x, startY: y, button, landmark, isClick: true });
    if (this.pointers.size > 1) this.pointers.forEach((p) => (p.isClick = false));
  }

  move(event) {
    const tool = this.toolAt(event);
    if (tool) return void tool.go(this, event);
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    const [dx, dy] = [event.clientX - pointer.x, event.clientY - pointer.y];
    if (Math.hypot(event.clientX - pointer.startX, event.clientY - pointer.startY) > CLICK) pointer.isClick = false;
    if (pointer.isClick) return;
    const before = this.pinch();
    [pointer.x, pointer.y] = [event.clientX, event.clientY];
    if (pointer.landmark !== null) {
      this.app.loupe.show(this, pointer.landmark, event);
      return void this.app.drag(this, pointer.landmark, this.ray(event), false);
    }
    this.element.classList.add("is-turning");
    const after = this.pinch();
    if (before && after) {
      this.app.cameras.move(this, (camera, view) => {
        camera.zoom(before.apart / Math.max(1, after.apart));
        camera.pan(after.x - before.x, after.y - before.y, view.box.width, view.box.height);
      });
    } else if (event.ctrlKey || event.metaKey) {
      this.app.cameras.move(this, (camera) => camera.zoom(Math.exp(dy * 0.008)));
    } else if (event.shiftKey || pointer.button === 2) {
      this.app.cameras.move(this, (camera, view) => camera.pan(dx, dy, view.box.width, view.box.height));
    } else {
      this.app.cameras.move(this, (camera) => camera.orbit(dx, dy));
    }
  }

  // The brush that a pointer leads.
  toolAt(event) {
    return this.app.tools.find((tool) => tool.isAt(event));
  }

  // The middle and the distance of two fingers.
  pinch() {
    const [a, b] = [...this.pointers.values()];
    return b ? { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) } : null;
  }

  release(event, isMeant) {
    const tool = this.toolAt(event);
    if (tool) return void tool.end(this, isMeant ? event : null);
    const pointer = this.pointers.get(event.pointerId);
    this.pointers.delete(event.pointerId);
    this.element.classList.remove("is-turning");
    if (!pointer) return;
    if (pointer.landmark !== null && !pointer.isClick) {
      this.app.loupe.hide();
      this.app.drag(this, pointer.landmark, isMeant ? this.ray(event) : null, true);
    } else if (pointer.isClick && isMeant && pointer.button === 0 && pointer.landmark === null) {
      this.app.place(this, this.ray(event));
    }
  }

  // A wheel zooms; two fingers on a trackpad turn; a pinch zooms.
  wheel(event) {
    if (!this.shape) return;
    event.preventDefault();
    const isWheel = event.deltaMode !== 0 || (event.deltaX === 0 && Math.abs(event.deltaY) >= 50);
    const { width, height } = this.box;
    if (event.ctrlKey || isWheel) {
      const speed = event.deltaMode === 1 ? 0.05 : event.ctrlKey ? 0.01 : 0.0015;
      const { left, top } = this.element.getBoundingClientRect();
      const at = [(2 * (event.clientX - left)) / width - 1, 1 - (2 * (event.clientY - top)) / height];
      this.app.cameras.move(this, (camera, view) => camera.zoomAt(Math.exp(event.deltaY * speed), at, view.box.width / view.box.height));
    } else if (event.shiftKey) {
      this.app.cameras.move(this, (camera) => camera.pan(-event.deltaX, -event.deltaY, width, height));
    } else {
      this.app.cameras.move(this, (camera) => camera.orbit(-event.deltaX * 0.6, -event.deltaY * 0.6));
    }
  }

  // The place of a landmark in this view and the normal there; none where it has none.
  place(landmark) {
    if (!this.shape) return null;
    if (this.name === "target") return landmark.target;
    return landmark.source && landmark.source.vertices.every((v) => 3 * v < this.shape.positions.length) ? this.shape.place(landmark.source) : null;
  }

  // Asks which landmarks and points of curves are hidden by what was drawn.
  probe(landmarks, nearer) {
    const places = landmarks.map((l) => [l.id, { point: this.place(l)?.point, nearer }]).filter(([, { point }]) => point);
    this.probes.ask(new Map([...places, ...this.app.curves.probed(this, nearer)]), this.camera.eye);
  }

  // Another graphics card, or the same one without what it had.
  restore(renderer) {
    this.shape?.upload(renderer.gl);
    // The result has the paint of the source.
    if (this.name !== "result") this.shape?.paint?.upload(renderer.gl);
    this.probes = new Probes(renderer);
  }
}

export class Views {
  constructor(app) {
    this.list = ["source", "target", "result"].map((name) => new View(app, name));
    [this.source, this.target, this.result] = this.list;
    this.size = { width: 1, height: 1 };
  }

  // Reads where the views are on the page: once whenever that changes, for it makes the browser lay the page out.
  measure() {
    const outer = this.list[0].app.painter.canvas.getBoundingClientRect();
    this.size = { width: outer.width, height: outer.height };
    for (const view of this.list) {
      const { left, top, width, height } = view.element.getBoundingClientRect();
      view.box = { left: left - outer.left, top: top - outer.top, width: Math.max(1, width), height: Math.max(1, height) };
    }
  }

  of(name) {
    return this.list.find((view) => view.name === name);
  }
}

