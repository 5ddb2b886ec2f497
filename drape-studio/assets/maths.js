// Vectors as arrays of three, matrices as sixteen numbers by columns.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
export const normalize = (a) => {
  const l = length(a);
  return l > 0 ? scale(a, 1 / l) : [0, 0, 0];
};

export const multiply = (a, b) => {
  const out = new Array(16);
  for (let c = 0; c < 4; c++) {
    for (let r = 0; r < 4; r++) {
      out[4 * c + r] = a[r] * b[4 * c] + a[4 + r] * b[4 * c + 1] + a[8 + r] * b[4 * c + 2] + a[12 + r] * b[4 * c + 3];
    }
  }
  return out;
};

// Rotations as nine numbers by rows.
export const IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1];
export const turn = (m, v) => [
  m[0] * v[0] + m[1] * v[1] + m[2] * v[2],
  m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
  m[6] * v[0] + m[7] * v[1] + m[8] * v[2],
];
export const turnBack = (m, v) => [
  m[0] * v[0] + m[3] * v[1] + m[6] * v[2],
  m[1] * v[0] + m[4] * v[1] + m[7] * v[2],
  m[2] * v[0] + m[5] * v[1] + m[8] * v[2],
];
export const after = (a, b) => {
  const out = [];
  for (let r = 0; r < 3; r++) {
    for (let c = 0; c < 3; c++) {
      out.push(a[3 * r] * b[c] + a[3 * r + 1] * b[3 + c] + a[3 * r + 2] * b[6 + c]);
    }
  }
  return out;
};
export const aboutX = (t) => [1, 0, 0, 0, Math.cos(t), -Math.sin(t), 0, Math.sin(t), Math.cos(t)];
export const aboutY = (t) => [Math.cos(t), 0, Math.sin(t), 0, 1, 0, -Math.sin(t), 0, Math.cos(t)];

// The rotation that brings points `from` nearest to points `to` (Horn 1987: the largest eigenvector of a 4×4 matrix).
export const bestRotation = (from, to) => {
  const mean = (points) => scale(points.reduce(add, [0, 0, 0]), 1 / points.length);
  const [cf, ct] = [mean(from), mean(to)];
  const s = [0, 0, 0, 0, 0, 0, 0, 0, 0];
  from.forEach((p, k) => {
    const [a, b] = [subtract(p, cf), subtract(to[k], ct)];
    for (let r = 0; r < 3; r++) for (let c = 0; c < 3; c++) s[3 * r + c] += a[r] * b[c];
  });
  const [xx, xy, xz, yx, yy, yz, zx, zy, zz] = s;
  const n = [
    [xx + yy + zz, yz - zy, zx - xz, xy - yx],
    [yz - zy, xx - yy - zz, xy + yx, zx + xz],
    [zx - xz, xy + yx, yy - xx - zz, yz + zy],
    [xy - yx, zx + xz, yz + zy, zz - xx - yy],
  ];
  // A shift makes the largest eigenvalue the one of largest magnitude.
  const shift = n.flat().reduce((sum, x) => sum + Math.abs(x), 0) || 1;
  let q = [1, 0.01, 0.02, 0.03];
  for (let k = 0; k < 300; k++) {
    q = n.map((row, r) => row.reduce((sum, x, c) => sum + x * q[c], shift * q[r]));
    const l = Math.hypot(...q);
    q = q.map((x) => x / l);
  }
  const [w, x, y, z] = q;
  return [
    w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y),
    2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x),
    2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z,
  ];
};
