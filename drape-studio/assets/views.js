// The three views: cameras, pointers, markers.

import { Camera } from "./camera.js";
import { Probes } from "./probes.js";
import { dot, subtract } from "./maths.js";

// Pixels that a pointer may move and still be a click.
const CLICK = 5;

export const markColour = (id) => `hsl(${(id * 137.508) % 360} 62% 40%)`;

class View {
  constructor(app, name) {
    Object.assign(this, { app, name, camera: new Camera(), shape: null, isStale: true, isUnprobed: false });
    this.element = document.getElementById(`view-${name}`);
    this.element.innerHTML = '<div class="name"><b></b><span></span></div><div class="badge" hidden></div><div class="empty" hidden></div><div class="markers"></div>';
    [this.title, this.about] = this.element.querySelectorAll(".name b, .name span");
    this.badge = this.element.querySelector(".badge");
    this.empty = this.element.querySelector(".empty");
    this.markerLayer = this.element.querySelector(".markers");
    this.markers = new Map();
    this.probes = new Probes(app.painter.renderer);
    this.turnedAway = new Set();
    this.pointers = new Map();
    this.listen();
  }

  get box() {
    const [outer, own] = [this.app.painter.canvas.getBoundingClientRect(), this.element.getBoundingClientRect()];
    return { left: own.left - outer.left, top: own.top - outer.top, width: own.width, height: own.height };
  }

  // A ray through a place of the page.
  ray({ clientX, clientY }) {
    const { left, top, width, height } = this.element.getBoundingClientRect();
    const [x, y] = [(2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height];
    return this.camera.ray(x, y, width / height, height);
  }

  // Where a point is seen, in pixels of the view.
  project(point) {
    const { clientWidth: width, clientHeight: height } = this.element;
    const m = this.camera.matrices(width / height).both;
    const clip = [0, 1, 3].map((r) => m[r] * point[0] + m[4 + r] * point[1] + m[8 + r] * point[2] + m[12 + r]);
    return clip[2] > 0 ? { x: (0.5 + 0.5 * (clip[0] / clip[2])) * width, y: (0.5 - 0.5 * (clip[1] / clip[2])) * height } : null;
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
    if (event.target.closest(".empty") || !this.shape) return;
    const marker = event.target.closest(".marker");
    this.element.focus({ preventScroll: true });
    event.preventDefault();
    this.element.setPointerCapture(event.pointerId);
    const { clientX: x, clientY: y, button } = event;
    const landmark = marker && button === 0 ? Number(marker.dataset.id) : null;
    if (landmark !== null) this.app.choose(landmark);
    this.pointers.set(event.pointerId, { x, y, startX: x, startY: y, button, landmark, isClick: true });
    if (this.pointers.size > 1) this.pointers.forEach((p) => (p.isClick = false));
  }

  move(event) {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    const [dx, dy] = [event.clientX - pointer.x, event.clientY - pointer.y];
    if (Math.hypot(event.clientX - pointer.startX, event.clientY - pointer.startY) > CLICK) pointer.isClick = false;
    if (pointer.isClick) return;
    const before = this.pinch();
    [pointer.x, pointer.y] = [event.clientX, event.clientY];
    if (pointer.landmark !== null) return void this.app.drag(this, pointer.landmark, this.ray(event), false);
    this.element.classList.add("is-turning");
    const after = this.pinch();
    if (before && after) {
      this.app.cameras.move(this, (camera, view) => {
        camera.zoom(before.apart / Math.max(1, after.apart));
        camera.pan(after.x - before.x, after.y - before.y, view.element.clientWidth, view.element.clientHeight);
      });
    } else if (event.ctrlKey || event.metaKey) {
      this.app.cameras.move(this, (camera) => camera.zoom(Math.exp(dy * 0.008)));
    } else if (event.shiftKey || pointer.button === 2) {
      this.app.cameras.move(this, (camera, view) => camera.pan(dx, dy, view.element.clientWidth, view.element.clientHeight));
    } else {
      this.app.cameras.move(this, (camera) => camera.orbit(dx, dy));
    }
  }

  // The middle and the distance of two fingers.
  pinch() {
    const [a, b] = [...this.pointers.values()];
    return b ? { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) } : null;
  }

  release(event, isMeant) {
    const pointer = this.pointers.get(event.pointerId);
    this.pointers.delete(event.pointerId);
    this.element.classList.remove("is-turning");
    if (!pointer) return;
    if (pointer.landmark !== null && !pointer.isClick) {
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
    const { clientWidth: width, clientHeight: height } = this.element;
    if (event.ctrlKey || isWheel) {
      const speed = event.deltaMode === 1 ? 0.05 : event.ctrlKey ? 0.01 : 0.0015;
      this.app.cameras.move(this, (camera) => camera.zoom(Math.exp(event.deltaY * speed)));
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

  // Asks which landmarks are hidden; where nothing but points is drawn, the normal tells which look away.
  probe(landmarks, isPointed) {
    const places = new Map(landmarks.map((l) => [l.id, this.place(l)]).filter(([, place]) => place));
    const { eye } = this.camera;
    const isAway = ({ point, normal }) => dot(normal, subtract(eye, point)) < 0;
    const isSparse = isPointed || this.shape?.isCloud;
    this.turnedAway = new Set([...places].filter(([, place]) => isSparse && isAway(place)).map(([id]) => id));
    this.probes.ask(new Map([...places].map(([id, place]) => [id, place.point])), eye);
  }

  showMarkers(landmarks, chosen) {
    const seen = new Set();
    landmarks.forEach((landmark, k) => {
      const place = this.place(landmark);
      const at = place && this.project(place.point);
      if (!at) return;
      seen.add(landmark.id);
      const marker = this.markers.get(landmark.id) ?? this.addMarker(landmark.id);
      const label = landmark.name || `landmark ${k + 1}`;
      marker.style.translate = `${at.x}px ${at.y}px`;
      marker.textContent = k + 1;
      marker.title = `${label}, ${landmark.kind}`;
      marker.setAttribute("aria-label", `${label} on the ${this.name}`);
      marker.classList.toggle("is-rigid", landmark.kind === "rigid");
      marker.classList.toggle("is-behind", this.probes.hidden.has(landmark.id) || this.turnedAway.has(landmark.id));
      marker.classList.toggle("is-chosen", landmark.id === chosen);
      marker.classList.toggle("is-half", !landmark.source || !landmark.target);
    });
    for (const [id, marker] of this.markers) {
      if (!seen.has(id)) {
        marker.remove();
        this.markers.delete(id);
      }
    }
  }

  addMarker(id) {
    const marker = document.createElement("button");
    marker.className = "marker";
    marker.dataset.id = id;
    marker.style.background = markColour(id);
    marker.addEventListener("focus", () => this.app.choose(id));
    this.markerLayer.append(marker);
    this.markers.set(id, marker);
    return marker;
  }
}

export class Views {
  constructor(app) {
    this.list = ["source", "target", "result"].map((name) => new View(app, name));
    [this.source, this.target, this.result] = this.list;
  }

  of(name) {
    return this.list.find((view) => view.name === name);
  }
}

