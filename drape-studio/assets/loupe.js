// A loupe over a mark that is dragged: what is under the pointer, larger, and where the mark comes to lie.

import { markColour } from "./colours.js";
import { multiply } from "./maths.js";

// Pixels of the page along its side, how much larger things are in it, and how far above the pointer it stands.
const SIDE = 168;
const FACTOR = 4;
const ABOVE = 24;

export class Loupe {
  constructor(app) {
    this.app = app;
    [this.view, this.landmark, this.at] = [null, null, null];
    this.canvas = Object.assign(document.createElement("canvas"), { className: "loupe", hidden: true });
    this.canvas.setAttribute("aria-hidden", "true");
  }

  // Over the pointer of a view, which drags a mark.
  show(view, landmark, { clientX, clientY }) {
    const { left, top, width } = view.element.getBoundingClientRect();
    [this.view, this.landmark, this.at] = [view, landmark, { x: clientX - left, y: clientY - top }];
    const { x, y } = this.at;
    const above = y - SIDE - ABOVE;
    view.element.append(this.canvas);
    this.canvas.hidden = false;
    Object.assign(this.canvas.style, {
      width: `${SIDE}px`, height: `${SIDE}px`,
      left: `${Math.max(2, Math.min(width - SIDE - 2, x - SIDE / 2))}px`, top: `${above >= 2 ? above : y + ABOVE}px`,
    });
    this.app.painter.invalidate(view);
  }

  hide() {
    if (!this.view) return;
    this.canvas.hidden = true;
    this.app.painter.invalidate(this.view);
    this.view = null;
  }

  // Draws the view larger, takes the middle of that, and leaves the view to be drawn as it is.
  draw(painter) {
    const { view, at } = this;
    if (!view || !view.shape) return;
    const { box } = view;
    const { view: eye, both } = view.camera.matrices(box.width / box.height);
    const [x, y] = [(2 * at.x) / box.width - 1, 1 - (2 * at.y) / box.height];
    const nearer = [FACTOR, 0, 0, 0, 0, FACTOR, 0, 0, 0, 0, 1, 0, -FACTOR * x, -FACTOR * y, 0, 1];
    painter.renderer.aim(box, { view: eye, both: multiply(nearer, both) });
    painter.drawShape(view);
    this.take(painter);
    view.isStale = true;
  }

  take({ canvas, renderer: { ratio } }) {
    const { view, at } = this;
    const { left, top, width, height } = view.box;
    const side = Math.round(SIDE * ratio);
    if (this.canvas.width !== side) [this.canvas.width, this.canvas.height] = [side, side];
    const paper = this.canvas.getContext("2d");
    paper.drawImage(canvas, (left + width / 2) * ratio - side / 2, (top + height / 2) * ratio - side / 2, side, side, 0, 0, side, side);
    const landmark = this.app.landmarks.find((l) => l.id === this.landmark);
    const place = landmark && view.place(landmark);
    const seen = place && view.project(place.point);
    if (!seen) return;
    const there = [seen.x - at.x, seen.y - at.y].map((d) => side / 2 + d * FACTOR * ratio);
    this.mark(paper, there, 5 * ratio, markColour(landmark.id));
  }

  mark(paper, [x, y], radius, colour) {
    paper.beginPath();
    paper.arc(x, y, radius, 0, 2 * Math.PI);
    [paper.fillStyle, paper.strokeStyle, paper.lineWidth] = [colour, "#fff", radius / 2.5];
    paper.fill();
    paper.stroke();
  }
}
