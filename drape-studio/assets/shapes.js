// Shapes on the graphics card.

import { coarsen } from "./detail.js";

// Sums of the area vectors of the triangles around each vertex.
const vertexNormals = (positions, triangles, out) => {
  out.fill(0);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    out[a] += x; out[a + 1] += y; out[a + 2] += z;
    out[b] += x; out[b + 1] += y; out[b + 2] += z;
    out[c] += x; out[c + 1] += y; out[c + 2] += z;
  }
  return out;
};

// The mean length of some edges, spread over all.
const meanLength = (positions, edges) => {
  const stride = 2 * Math.max(1, Math.floor(edges.length / 4000));
  let [sum, n] = [0, 0];
  for (let k = 0; k < edges.length; k += stride) {
    const [a, b] = [3 * edges[k], 3 * edges[k + 1]];
    sum += Math.hypot(positions[a] - positions[b], positions[a + 1] - positions[b + 1], positions[a + 2] - positions[b + 2]);
    n++;
  }
  return sum / Math.max(1, n);
};

// About how far apart the points of a cloud are: as if they lay evenly over the surface of their box.
const meanSpacing = (positions) => {
  const [low, high] = extent(positions);
  const [x, y, z] = low.map((l, c) => high[c] - l);
  return Math.sqrt((2 * (x * y + y * z + z * x)) / Math.max(1, positions.length / 3));
};

// The lowest and the highest coordinates.
const extent = (positions) => {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let k = 0; k < positions.length; k++) {
    low[k % 3] = Math.min(low[k % 3], positions[k]);
    high[k % 3] = Math.max(high[k % 3], positions[k]);
  }
  return [low, high];
};

// Rows of three numbers, and some of them again.
const withCopies = (rows, copies) => {
  if (copies.length === 0) return rows;
  const all = new Float32Array(rows.length + 3 * copies.length);
  all.set(rows);
  copies.forEach((v, k) => all.set(rows.subarray(3 * v, 3 * v + 3), rows.length + 3 * k));
  return all;
};

const BUFFERS = ["positions", "normals", "values", "triangles", "edges", "spread", "spreadNormals"];

export class Shape {
  constructor(gl, { positions, triangles, edges, normals }) {
    this.isCloud = triangles.length === 0;
    [this.triangles, this.edges, this.positions] = [triangles, edges, positions];
    this.values = null;
    this.perTriangle = false;
    this.paint = null;
    this.givenNormals = normals;
    this.meanEdge = this.isCloud ? meanSpacing(positions) : meanLength(positions, edges);
    this.normals = normals ?? new Float32Array(positions.length);
    this.upload(gl);
  }

  // Brings everything to a graphics card, which may be another or have lost what it had.
  upload(gl) {
    this.gl = gl;
    this.buffers = Object.fromEntries(BUFFERS.map((name) => [name, gl.createBuffer()]));
    [this.fewer, this.hasEdges] = [null, false];
    this.index("triangles", this.triangles);
    this.move(this.positions);
    this.colour(this.values, this.perTriangle);
  }

  index(name, rows) {
    const { gl } = this;
    gl.bindVertexArray(null);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers[name]);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, rows, gl.STATIC_DRAW);
  }

  // Edges are brought when they are first seen: of a large scan they never are.
  indexEdges() {
    this.index("edges", this.edges);
    this.hasEdges = true;
  }

  // Fewer triangles, made when they are first needed.
  coarse() {
    if (!this.fewer) {
      this.fewer = coarsen(this);
      this.buffers.coarse = this.fewer.buffer = this.gl.createBuffer();
      this.index("coarse", this.fewer.corners);
    }
    return this.fewer;
  }

  fill(name, data) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name]);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
  }

  // Puts the vertices elsewhere.
  move(positions) {
    this.positions = positions;
    if (!this.givenNormals) vertexNormals(positions, this.triangles, this.normals);
    this.fillVertices();
    this.isSpread = false;
  }

  // Vertices on the seams of a picture are there several times.
  wear(paint) {
    this.paint = paint;
    if (paint?.copies.length > 0) this.fillVertices();
  }

  fillVertices() {
    const copies = this.paint?.copies ?? [];
    this.fill("positions", withCopies(this.positions, copies));
    this.fill("normals", withCopies(this.normals, copies));
  }

  // Values to colour by: one per vertex, or one per triangle; none for the plain colour.
  colour(values, perTriangle) {
    [this.values, this.perTriangle] = [values, perTriangle];
    if (!values) return;
    const { length } = this.triangles;
    this.fill("values", perTriangle ? Float32Array.from({ length }, (_, k) => values[Math.floor(k / 3)]) : values);
  }

  // Where every triangle has a colour of its own, it has corners of its own.
  spread() {
    if (this.isSpread) return;
    const n = this.triangles.length;
    const [p, m] = [new Float32Array(3 * n), new Float32Array(3 * n)];
    for (let k = 0; k < n; k++) {
      const from = 3 * this.triangles[k];
      for (let c = 0; c < 3; c++) {
        p[3 * k + c] = this.positions[from + c];
        m[3 * k + c] = this.normals[from + c];
      }
    }
    this.fill("spread", p);
    this.fill("spreadNormals", m);
    this.isSpread = true;
  }

  // The value at a place; none where there are no values.
  valueAt({ vertices, weights }) {
    if (!this.values) return null;
    if (this.perTriangle) return this.values[this.triangleOf(vertices)] ?? null;
    const parts = vertices.map((v, k) => this.values[v] * weights[k]);
    return vertices.some((v) => this.values[v] < 0) ? -1 : parts.reduce((sum, x) => sum + x, 0);
  }

  // The row of the triangle with some corners; the list is made when it is first needed.
  triangleOf(corners) {
    const key = (three) => [...three].sort((a, b) => a - b).join(" ");
    if (!this.rowOf) {
      const rows = this.triangles.length / 3;
      this.rowOf = new Map(Array.from({ length: rows }, (_, k) => [key(this.triangles.subarray(3 * k, 3 * k + 3)), k]));
    }
    return this.rowOf.get(key(corners));
  }

  point(v) {
    return [this.positions[3 * v], this.positions[3 * v + 1], this.positions[3 * v + 2]];
  }

  // A weighted mean of vertices, and the normal there.
  place({ vertices, weights }) {
    const [point, normal] = [[0, 0, 0], [0, 0, 0]];
    vertices.forEach((v, k) => {
      for (let c = 0; c < 3; c++) {
        point[c] += weights[k] * this.positions[3 * v + c];
        normal[c] += weights[k] * this.normals[3 * v + c];
      }
    });
    return { point, normal };
  }

  // The middle of the box and the distance of its corners.
  get bounds() {
    const [low, high] = extent(this.positions);
    const centre = low.map((x, c) => (x + high[c]) / 2);
    return { centre, radius: Math.hypot(...low.map((x, c) => (high[c] - x) / 2)) };
  }

  // Some points, spread over all.
  sample(n) {
    const all = this.positions.length / 3;
    const stride = Math.max(1, Math.floor(all / n));
    return Array.from({ length: Math.ceil(all / stride) }, (_, k) => this.point(k * stride));
  }

  free() {
    Object.values(this.buffers).forEach((buffer) => this.gl.deleteBuffer(buffer));
  }
}
