// A ring as large as a brush, around the pointer.

export class Ring {
  constructor() {
    this.element = Object.assign(document.createElement("div"), { className: "brush-ring", hidden: true });
  }

  // Around the pointer of a view; the radius is in the units of its camera.
  follow(view, event, radius) {
    const { left, top } = view.element.getBoundingClientRect();
    const size = 2 * view.camera.pixels(radius, view.box.width, view.box.height);
    view.element.append(this.element);
    this.element.hidden = false;
    Object.assign(this.element.style, { left: `${event.clientX - left}px`, top: `${event.clientY - top}px`, width: `${size}px`, height: `${size}px` });
  }

  hide() {
    this.element.hidden = true;
  }
}
