// What buttons and keys of the page do, beside those of the panels.

import { listen, showKeys } from "./keys.js";
import { HEATS } from "./heats.js";
import { LOOKS, STYLES } from "./painter.js";

const $ = (id) => document.getElementById(id);
const next = (list, item) => list[(list.indexOf(item) + 1) % list.length];
const press = (id) => () => !$(id).disabled && !$(id).hidden && $(id).click();

const setStyle = (app, style) => {
  app.prefer({ style });
  document.querySelector(`input[name=style][value=${style}]`).checked = true;
};

const setLook = (app, look) => {
  app.prefer({ look });
  $("look").value = look;
};

// Yaw and pitch.
const QUARTER = Math.PI / 2;
const SIDES = { front: [0, 0], back: [2 * QUARTER, 0], right: [QUARTER, 0], left: [-QUARTER, 0], top: [0, QUARTER], bottom: [0, -QUARTER] };

const setFlat = (app, isFlat) => {
  $("flat").checked = isFlat;
  app.prefer({ flat: isFlat });
  app.cameras.setFlat(isFlat);
};

const setTheme = (app) => {
  app.prefer({ theme: app.theme === "dark" ? "light" : "dark" });
  app.dress();
};

const playOrPause = () => [$("pause"), $("resume"), $("drape")].find((b) => !b.hidden && !b.disabled)?.click();

const toggleOverlay = (app) => {
  $("opacity").value = Number($("opacity").value) > 0 ? 0 : 0.5;
  app.painter.invalidate(app.views.result);
};

const withChosen = (app, what, more = () => ({})) => {
  const landmark = app.chosenLandmark;
  if (landmark) app.edit(what, { landmark: landmark.id, ...more(landmark) });
};

const help = () => $("keys-dialog").showModal();

const controlButtons = (app) => {
  const on = (id, event, action) => $(id).addEventListener(event, action);
  const { cameras, stage } = app;
  on("theme", "click", () => setTheme(app));
  on("help", "click", help);
  on("home", "click", () => cameras.home());
  on("align", "click", () => cameras.align());
  on("zoom-in", "click", () => cameras.change((camera) => camera.zoom(0.8)));
  on("zoom-out", "click", () => cameras.change((camera) => camera.zoom(1.25)));
  on("heat", "change", () => stage.setHeat($("heat").value));
  on("opacity", "input", () => app.painter.invalidate(app.views.result));
  on("linked", "change", () => app.prefer({ linked: $("linked").checked }));
  $("linked").checked = app.preferences.linked;
  on("flat", "change", () => setFlat(app, $("flat").checked));
  setFlat(app, Boolean(app.preferences.flat));
  document.querySelectorAll("[data-look]").forEach((button) => button.addEventListener("click", () => cameras.look(...SIDES[button.dataset.look])));
  app.views.list.forEach((view) => view.large.addEventListener("click", () => cameras.enlarge(view)));
  $("look").value = app.preferences.look;
  on("look", "change", () => setLook(app, $("look").value));
  document.querySelectorAll("input[name=style]").forEach((input) => {
    input.checked = input.value === app.preferences.style;
    input.addEventListener("change", () => setStyle(app, input.value));
  });
};

// Arrows move the cursor of the keyboard where it is shown, else they turn.
const arrows = (app) => Object.fromEntries(Object.entries({ arrowleft: [-1, 0], arrowright: [1, 0], arrowup: [0, -1], arrowdown: [0, 1] }).flatMap(([key, [dx, dy]]) => {
  const act = (isFine) => () => app.cursor.takes([dx, dy], isFine) || app.cameras.change((c) => c.orbit(-12 * dx, -12 * dy));
  return [[key, act(false)], [`shift ${key}`, act(true)]];
}));

export const control = (app) => {
  controlButtons(app);
  showKeys($("keys"));
  const { cameras, stage } = app;
  const camera = (change) => () => cameras.change(change);
  const remove = () => withChosen(app, "delete");
  listen({
    d: press("drape"), " ": playOrPause, ".": press("step"), e: press("extend"),
    "ctrl z": press("undo"), "ctrl shift z": press("redo"), "ctrl y": press("redo"),
    delete: remove, backspace: remove,
    f2: () => app.panels.rename(app.chosen),
    r: () => withChosen(app, "kind", (l) => ({ kind: l.kind === "soft" ? "rigid" : "soft" })),
    m: () => $("mirror").click(), s: () => ($("snap").selectedIndex = ($("snap").selectedIndex + 1) % $("snap").length), escape: () => app.escape(), k: press("keep"),
    home: () => cameras.home(), f: () => cameras.frameChosen(), l: () => $("linked").click(), a: () => cameras.align(), u: () => cameras.toggleUp(),
    ...Object.fromEntries(Object.entries({ 1: "front", 2: "back", 3: "right", 4: "left", 7: "top", 8: "bottom" }).map(([key, side]) => [key, () => cameras.look(...SIDES[side])])),
    5: () => setFlat(app, !app.preferences.flat), b: press("brush"), g: () => app.state?.can.brush && app.sculpt.next(), x: () => cameras.enlarge(cameras.focused),
    enter: () => (!app.cursor.isShown && app.curves.end()) || app.cursor.enter(),
    c: press("curve"),
    ...arrows(app),
    "+": camera((c) => c.zoom(0.8)), "=": camera((c) => c.zoom(0.8)), "-": camera((c) => c.zoom(1.25)),
    v: () => setLook(app, next(LOOKS, app.preferences.look)),
    z: () => setStyle(app, next(STYLES, app.preferences.style)),
    h: () => stage.setHeat(next(["", ...Object.keys(HEATS).filter((name) => name !== "difference" || app.strip.shape)], stage.heat)),
    o: () => toggleOverlay(app), t: () => setTheme(app), "?": help,
  });
};
