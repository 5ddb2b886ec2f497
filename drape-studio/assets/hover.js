// What is under the pointer while it only looks: the value of the colours.

export class Hover {
  constructor(app) {
    this.app = app;
    this.isAsking = false;
    const { element } = app.views.result;
    element.addEventListener("pointermove", (event) => event.buttons === 0 && this.move(event));
    element.addEventListener("pointerleave", () => app.legend.tell(null));
  }

  // One question at a time; places that the pointer only passed are not asked for.
  async move(event) {
    const { app } = this;
    const { result } = app.views;
    if (this.isAsking || !app.stage.heat || !result.shape?.values) return;
    this.isAsking = true;
    try {
      const hit = await app.link.ask("query", { do: "pick", shape: "result", ray: result.ray(event) });
      app.legend.tell(hit ? result.shape.valueAt(hit.source) : null);
    } catch {
      app.legend.tell(null);
    }
    this.isAsking = false;
  }
}
