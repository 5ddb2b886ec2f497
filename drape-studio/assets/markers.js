// The markers of one view: a button per landmark, over the picture. It is a small dot; its number shows under the pointer.

import { markColour } from "./colours.js";

// How a landmark is called.
export const labelOf = ({ name, number }) => name || (number === null ? "landmark half made" : `landmark ${number}`);
// What a marker and a row of the list show.
export const digitsOf = ({ number }) => (number === null ? "·" : String(number));

export class Markers {
  constructor(view, layer) {
    Object.assign(this, { view, layer, entries: new Map() });
  }

  // Puts a marker at every landmark that is seen; what has not changed is not touched.
  show(landmarks, chosen) {
    const { view } = this;
    const project = view.projection();
    const seen = new Set();
    for (const landmark of landmarks) {
      const place = view.place(landmark);
      const at = place && project(place.point);
      if (!at) continue;
      seen.add(landmark.id);
      this.put(this.entries.get(landmark.id) ?? this.add(landmark.id), landmark, at, chosen);
    }
    for (const [id, { marker }] of this.entries) {
      if (!seen.has(id)) {
        marker.remove();
        this.entries.delete(id);
      }
    }
  }

  put(entry, landmark, at, chosen) {
    const { view } = this;
    const classes = [
      "marker",
      landmark.kind === "rigid" && "is-rigid",
      view.probes.hidden.has(landmark.id) && "is-behind",
      landmark.id === chosen && "is-chosen",
      !(landmark.source && landmark.target) && "is-half",
    ];
    const label = labelOf(landmark);
    const { marker } = entry;
    this.set(entry, "translate", `${at.x.toFixed(2)}px ${at.y.toFixed(2)}px`, (value) => (marker.style.translate = value));
    this.set(entry, "text", digitsOf(landmark), (value) => (marker.textContent = value));
    this.set(entry, "title", `${label}, ${landmark.kind}`, (value) => (marker.title = value));
    this.set(entry, "label", `${label} on the ${view.name}`, (value) => marker.setAttribute("aria-label", value));
    this.set(entry, "classes", classes.filter(Boolean).join(" "), (value) => (marker.className = value));
  }

  set(entry, what, value, write) {
    if (entry[what] === value) return;
    entry[what] = value;
    write(value);
  }

  add(id) {
    const marker = document.createElement("button");
    marker.dataset.id = id;
    marker.style.setProperty("--mark", markColour(id));
    marker.addEventListener("focus", () => this.view.app.choose(id));
    this.layer.append(marker);
    this.entries.set(id, { marker });
    return this.entries.get(id);
  }

  get(id) {
    return this.entries.get(id)?.marker;
  }
}
