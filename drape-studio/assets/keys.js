// Keys, and the page that lists them.

const MOUSE = [
  ["Click", "mark a place"],
  ["Drag a marker", "move it along the surface"],
  ["Drag, or middle button", "turn"],
  ["Shift drag, or right button", "shift"],
  ["Wheel", "nearer to the pointer, farther"],
  ["Pinch, or Ctrl drag", "nearer, farther"],
  ["Two fingers on a trackpad", "turn; with Shift: shift"],
];

const KEYS = [
  ["Drape", [["D", "drape"], ["Space", "pause, resume"], [".", "one iteration"], ["E", "more iterations"], ["K", "keep the result"]]],
  ["Landmarks", [["Ctrl Z", "undo"], ["Ctrl Shift Z", "redo"], ["Delete", "delete the chosen one"], ["F2", "rename it"], ["R", "soft or rigid"], ["Enter", "a cross to move with the arrows; again: mark there; ends a curve"], ["C", "draw a curve"], ["M", "mirror on or off"], ["S", "snap: off, to a vertex, to the sharpest place"], ["B", "brush of weights on or off"], ["G", "next brush on the result: relax, pull, slide"], ["Esc", "give up the half pair, choose none"]]],
  ["Cameras", [["Home", "frame everything"], ["F", "frame the chosen landmark"], ["1 2 3 4", "from the front, behind, the right, the left"], ["7 8", "from above, below"], ["5", "with or without perspective"], ["X", "one view large, or all"], ["Arrows", "turn; move the cross"], ["+ −", "nearer, farther"], ["L", "together or each alone"], ["A", "turn the source as the result stands"], ["U", "y or z points up"]]],
  ["Shown", [["Z", "shaded, edges, points"], ["V", "as scanned, wrinkles, clay"], ["H", "next heat map"], ["O", "target over result"], ["T", "light or dark"], ["?", "this page"]]],
];

// Shows the list.
export const showKeys = (place) => {
  const table = (caption, rows) => {
    const keys = (text) => text.split(" ").map((key) => `<kbd>${key}</kbd>`).join(" ");
    const line = ([key, what]) => `<tr><th scope="row">${caption === "Mouse and trackpad" ? key : keys(key)}</th><td>${what}</td></tr>`;
    return `<table><caption>${caption}</caption><tbody>${rows.map(line).join("")}</tbody></table>`;
  };
  place.innerHTML = table("Mouse and trackpad", MOUSE) + KEYS.map(([caption, rows]) => table(caption, rows)).join("");
};

// Calls what belongs to a key, unless the user is typing.
export const listen = (actions) => {
  document.addEventListener("keydown", (event) => {
    const { target } = event;
    const isTyping = target.matches("input[type=text], input[type=number], textarea, select") || document.querySelector("dialog[open]");
    const name = (event.ctrlKey || event.metaKey ? "ctrl " : "") + (event.shiftKey && event.key.length > 1 ? "shift " : "") + event.key.toLowerCase();
    const isPressed = target.matches("button, summary, a, input") && [" ", "Enter"].includes(event.key);
    const isSlid = target.matches("input[type=range], input[type=radio]") && event.key.startsWith("Arrow");
    const action = actions[event.ctrlKey && event.shiftKey ? `ctrl shift ${event.key.toLowerCase()}` : name];
    if (!action || isTyping || isPressed || isSlid || event.altKey) return;
    event.preventDefault();
    action();
  });
};
