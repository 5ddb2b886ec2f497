// Quality over the iterations: Q, and the mean distance on a logarithmic scale. The loss is not drawn: it rises whenever
// weights change, and says nothing of the result.

export class Chart {
  constructor(canvas) {
    this.canvas = canvas;
    this.curves = new Map();
  }

  clear() {
    this.curves.clear();
    this.draw();
  }

  // Curves as the studio sends them: [{ name, points: [[iteration, value]] }].
  replace(curves) {
    this.curves = new Map(curves.map(({ name, points }) => [name, points]));
    this.draw();
  }

  add(name, iteration, value) {
    if (value === null || value === undefined || iteration === null) return;
    const points = this.curves.get(name) ?? [];
    if (points.length > 0 && iteration <= points.at(-1)[0]) return;
    points.push([iteration, value]);
    this.curves.set(name, points);
  }

  draw() {
    const { canvas } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(name).trim();
    const fontSize = parseFloat(style.fontSize) * 0.78;
    pen.font = `${fontSize}px system-ui, sans-serif`;
    const [left, right, top, bottom] = [6, width - 6, fontSize + 6, height - 6];
    pen.strokeStyle = colour("--line");
    pen.strokeRect(left - 0.5, top - 0.5, right - left + 1, bottom - top + 1);

    const [q, distances] = [this.curves.get("Q") ?? [], this.curves.get("mean distance") ?? []];
    const end = Math.max(1, ...[q, distances].map((points) => points.at(-1)?.[0] ?? 0));
    const x = (iteration) => left + ((right - left) * iteration) / end;
    const line = (points, y, ink, thickness) => {
      if (points.length === 0) return;
      pen.strokeStyle = ink;
      pen.lineWidth = thickness;
      pen.beginPath();
      points.forEach(([iteration, value], k) => (k ? pen.lineTo(x(iteration), y(value)) : pen.moveTo(x(iteration), y(value))));
      pen.stroke();
    };
    const low = (value) => Math.log(Math.max(value, 1e-9));
    const logs = distances.map(([, value]) => low(value));
    const [least, most] = [Math.min(...logs), Math.max(...logs)];
    const span = Math.max(most - least, 1e-6);
    const tall = bottom - top - 4;
    line(distances, (value) => bottom - 2 - (tall * (low(value) - least)) / span, colour("--soft"), 1.5);
    line(q, (value) => bottom - 2 - tall * value, colour("--accent"), 2.5);

    pen.textBaseline = "alphabetic";
    pen.fillStyle = colour("--soft");
    const far = distances.length ? `mean distance ${(100 * distances.at(-1)[1]).toPrecision(2)} %` : "mean distance";
    pen.fillText(far, left, top - 5);
    pen.textAlign = "right";
    pen.fillStyle = colour("--accent");
    const good = q.length ? `Q ${q.at(-1)[1].toFixed(3)}` : "Q";
    pen.fillText(good, right, top - 5);
    pen.textAlign = "left";
    canvas.setAttribute("aria-label", q.length ? `After ${q.at(-1)[0]} iterations: ${good}, ${far}` : "Quality over the iterations: no drape yet");
  }
}
