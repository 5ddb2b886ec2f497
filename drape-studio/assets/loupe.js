// A loupe over a mark that is dragged: what is under the pointer, larger, and where the mark comes to lie.

import { markColour } from "./colours.js";
import { multiply } from "./maths.js";

// Its side in heights of the page's letters, how much larger things are in it, and how far above the pointer it stands.
const SIDE = 12;
const FACTOR = 4;
const ABOVE = 1.7;

const letter = () => parseFloat(getComputedStyle(document.documentElement).fontSize);

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
    const size = letter();
    this.side = SIDE * size;
    const above = y - this.side - ABOVE * size;
    view.element.append(this.canvas);
    this.canvas.hidden = false;
    Object.assign(this.canvas.style, {
      width: `${this.side}px`, height: `${this.side}px`,
      left: `${Math.max(2, Math.min(width - this.side - 2, x - this.side / 2))}px`, top: `${above >= 2 ? above : y + ABOVE * size}px`,
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
    const side = Math.round(this.side * ratio);
    if (this.canvas.width !== side) [this.canvas.width, this.canvas.height] = [side, side];
    const paper = this.canvas.getContext("2d");
    paper.drawImage(canvas, (left + width / 2) * ratio - side / 2, (top + height / 2) * ratio - side / 2, side, side, 0, 0, side, side);
    const landmark = this.app.landmarks.find((l) => l.id === this.landmark);
    const place = landmark && view.place(landmark);
    const seen = place && view.project(place.point);
    if (!seen) return;
    const there = [seen.x - at.x, seen.y - at.y].map((d) => side / 2 + d * FACTOR * ratio);
    this.mark(paper, there, 0.03 * side, markColour(landmark.id));
  }

  mark(paper, [x, y], radius, colour) {
    paper.beginPath();
    paper.arc(x, y, radius, 0, 2 * Math.PI);
    [paper.fillStyle, paper.strokeStyle, paper.lineWidth] = [colour, "#fff", radius / 2.5];
    paper.fill();
    paper.stroke();
  }
}
