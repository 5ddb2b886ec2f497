// What a landmark or a curve counts beside the others: a number in its row.

const MOST = 100;

export const weightField = (app, id) => {
  const element = Object.assign(document.createElement("input"), { type: "number", className: "weight", min: 0, max: MOST, step: 0.1, title: "Weight: what it counts beside the others; 0 leaves it out" });
  element.addEventListener("change", () => {
    const weight = Math.max(0, Math.min(MOST, Number(element.value)));
    if (element.value !== "" && Number.isFinite(weight)) app.edit("weight", { landmark: id, weight });
  });
  element.addEventListener("keydown", (event) => event.key === "Enter" && element.blur());
  const show = (weight, label) => {
    if (document.activeElement !== element) element.value = String(weight);
    element.classList.toggle("is-one", weight === 1);
    element.setAttribute("aria-label", `Weight of ${label}`);
  };
  return { element, show };
};
