// Shapes of very many triangles are drawn with fewer of them while something changes, where all take long: without a
// graphics card a scan of a million would stand still. What rests is drawn with all.

// Triangles of which a shape has more than this many are many.
const MANY = 200_000;
// Vertices in one cell are drawn as one: cells per longest side, and per side of a picture, so that seams stay seams.
const CELLS = 110;
const PICTURE_CELLS = 24;
// What is drawn within this time, in milliseconds, is drawn with all triangles at any time.
const QUICK = 60;
// Something rests when it was left alone for as long as all its triangles take, within these bounds.
const REST = [200, 4000];

// The triangles whose corners are in three cells, each corner the first vertex of its cell, and their rows in order.
// `places` are those of a picture: `uvs` of vertices and `copies` of vertices, `corners` instead of the triangles.
export const coarsen = ({ positions, triangles }, { uvs, copies, corners } = { uvs: null, copies: [], corners: null }) => {
  const n = positions.length / 3;
  const firsts = new Map();
  const first = new Uint32Array(n + copies.length);
  const cell = (at) => 512 + Math.floor(CELLS * positions[at]);
  const pictureCell = (at) => 32 + (Math.floor(PICTURE_CELLS * uvs[at]) % 32);
  for (let v = 0; v < first.length; v++) {
    const at = 3 * (v < n ? v : copies[v - n]);
    let key = (cell(at) * 1024 + cell(at + 1)) * 1024 + cell(at + 2);
    if (uvs) key = (key * 64 + pictureCell(2 * v)) * 64 + pictureCell(2 * v + 1);
    const known = firsts.get(key);
    if (known === undefined) firsts.set(key, v);
    first[v] = known ?? v;
  }
  const all = corners ?? triangles;
  const [kept, rows] = [[], []];
  for (let t = 0; t < all.length; t += 3) {
    const [a, b, c] = [first[all[t]], first[all[t + 1]], first[all[t + 2]]];
    if (a === b || b === c || c === a) continue;
    kept.push(a, b, c);
    rows.push(t / 3);
  }
  return { corners: Uint32Array.from(kept), rows: Uint32Array.from(rows) };
};

// Where in the rows that were kept a range of rows lies.
export const within = (rows, [from, to]) => {
  const below = (row) => {
    let [low, high] = [0, rows.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (rows[middle] < row) low = middle + 1;
      else high = middle;
    }
    return low;
  };
  return [below(from), below(to)];
};

// When what is drawn with all its triangles.
export class Detail {
  constructor(painter) {
    // Milliseconds that all triangles took; unknown at first.
    [this.painter, this.cost, this.timer] = [painter, Infinity, null];
  }

  // Whether a view is drawn with fewer triangles now.
  isCoarse({ shape, isResting }) {
    return !isResting && this.cost > QUICK && !shape.isCloud && shape.triangles.length > 3 * MANY;
  }

  // After views were drawn: those that were drawn with fewer triangles are drawn again when they rest.
  drawn(views) {
    if (views.some((view) => view.isResting && view.shape?.triangles.length > 3 * MANY)) this.measure();
    const coarse = views.filter((view) => view.isCoarse);
    if (coarse.length === 0) return;
    clearTimeout(this.timer);
    const [least, most] = REST;
    this.timer = setTimeout(() => this.finish(), Math.max(least, Math.min(most, this.cost)));
  }

  finish() {
    const coarse = this.painter.app.views.list.filter((view) => view.isCoarse);
    this.painter.invalidate(...coarse);
    coarse.forEach((view) => (view.isResting = true));
  }

  // How long the graphics card takes for what it was last told.
  measure() {
    const { gl } = this.painter.renderer;
    const began = performance.now();
    const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    const look = () => {
      if (!gl.isContextLost() && gl.getSyncParameter(sync, gl.SYNC_STATUS) !== gl.SIGNALED) return void setTimeout(look, 10);
      this.cost = performance.now() - began;
      gl.deleteSync(sync);
    };
    gl.flush();
    setTimeout(look);
  }
}
