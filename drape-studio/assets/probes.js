// Which points of a view are hidden by what was drawn there: the graphics card counts what it would draw of each.

const PIXELS = 4;

export class Probes {
  constructor(renderer) {
    this.renderer = renderer;
    this.buffer = renderer.gl.createBuffer();
    this.free = [];
    this.asked = new Map();
    this.hidden = new Set();
  }

  // Asks for points by their keys; the view must be aimed at. Each is sought so much nearer to the eye, in longest sides,
  // that its own surface does not hide it.
  ask(points, eye) {
    const { gl } = this.renderer;
    this.asked.forEach((query) => this.free.push(query));
    this.asked.clear();
    // What is no longer there is not hidden.
    for (const id of this.hidden) if (!points.has(id)) this.hidden.delete(id);
    if (points.size === 0) return;
    const places = [...points.values()].flatMap(({ point: p, nearer }) => {
      const way = eye.map((c, k) => c - p[k]);
      const share = Math.min(0.5, nearer / Math.max(1e-9, Math.hypot(...way)));
      return p.map((c, k) => c + share * way[k]);
    });
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(places), gl.STREAM_DRAW);
    this.renderer.probe(this.buffer, PIXELS, () => {
      [...points.keys()].forEach((id, k) => {
        const query = this.free.pop() ?? gl.createQuery();
        gl.beginQuery(gl.ANY_SAMPLES_PASSED, query);
        gl.drawArrays(gl.POINTS, k, 1);
        gl.endQuery(gl.ANY_SAMPLES_PASSED);
        this.asked.set(id, query);
      });
    });
  }

  // Takes answers that have come; whether some are still to come.
  collect() {
    const { gl } = this.renderer;
    for (const [id, query] of this.asked) {
      if (!gl.getQueryParameter(query, gl.QUERY_RESULT_AVAILABLE)) return true;
      if (gl.getQueryParameter(query, gl.QUERY_RESULT)) this.hidden.delete(id);
      else this.hidden.add(id);
      this.free.push(query);
      this.asked.delete(id);
    }
    return false;
  }
}
