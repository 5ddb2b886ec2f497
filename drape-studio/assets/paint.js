// What a scan was painted with: colours of its vertices, or pictures on its triangles.

import { coarsen } from "./detail.js";

const NONE = new Uint32Array(0);
// The lowest row comes first, as coordinates on pictures have it; colours are taken as they are.
const PLAIN = { imageOrientation: "flipY", premultiplyAlpha: "none", colorSpaceConversion: "none" };

// Fetches what a shape has; none where it has nothing.
export const fetchPaint = async (name, hash, { colors, pictures, copies }) => {
  if (!colors && pictures.length === 0) return null;
  const answer = async (what) => {
    const found = await fetch(`looks/${name}/${what}?${hash}`);
    if (!found.ok) throw new Error(`the looks of the ${name} cannot be loaded`);
    return found;
  };
  const numbers = async (Type, what, isThere) => (isThere ? new Type(await (await answer(what)).arrayBuffer()) : null);
  // A picture that this browser cannot read is left out.
  const picture = async (ranges, row) => {
    const blob = await (await answer(row)).blob();
    const bitmap = await createImageBitmap(blob, PLAIN).catch(() => null);
    return { ranges, bitmap };
  };
  const isPictured = pictures.length > 0;
  const isSeamed = isPictured && copies > 0;
  const [painted, ...rest] = await Promise.all([
    Promise.all(pictures.map(picture)),
    numbers(Uint8Array, "colors", colors),
    numbers(Float32Array, "uvs", isPictured),
    numbers(Uint32Array, "copies", isSeamed),
    numbers(Uint32Array, "corners", isSeamed),
  ]);
  const shown = painted.filter(({ bitmap }) => bitmap);
  return { pictures: shown, colors: rest[0], places: shown.length > 0 ? { uvs: rest[1], copies: rest[2] ?? NONE, corners: rest[3] } : null };
};

// Paint on a graphics card; shapes of one source share it. Where there are pictures, vertices on a seam are drawn
// several times: `copies` are the vertices that follow those of the shape, `corners` is what the triangles have then.
export class Paint {
  constructor(gl, { colors, places, pictures }, nTriangles) {
    Object.assign(this, { colors, places, pictures });
    this.bare = complement(pictures.flatMap(({ ranges }) => ranges), nTriangles);
    this.upload(gl);
  }

  get copies() {
    return this.places?.copies ?? NONE;
  }

  upload(gl) {
    [this.gl, this.fewer] = [gl, null];
    const { uvs, corners } = this.places ?? {};
    this.buffers = { colors: this.buffer(gl.ARRAY_BUFFER, this.colors), uvs: this.buffer(gl.ARRAY_BUFFER, uvs), corners: this.buffer(gl.ELEMENT_ARRAY_BUFFER, corners) };
    this.pictures.forEach((picture) => (picture.texture = this.texture(picture.bitmap)));
  }

  buffer(kind, data) {
    const { gl } = this;
    if (!data) return null;
    const buffer = gl.createBuffer();
    gl.bindBuffer(kind, buffer);
    gl.bufferData(kind, data, gl.STATIC_DRAW);
    return buffer;
  }

  // Fewer triangles of the shape that was painted first, which has the same corners as all that share this.
  coarse(shape) {
    if (!this.fewer) {
      this.fewer = coarsen(shape, this.places);
      this.buffers.coarse = this.fewer.buffer = this.buffer(this.gl.ELEMENT_ARRAY_BUFFER, this.fewer.corners);
    }
    return this.fewer;
  }

  texture(bitmap) {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    gl.generateMipmap(gl.TEXTURE_2D);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    const sharp = gl.getExtension("EXT_texture_filter_anisotropic");
    if (sharp) gl.texParameterf(gl.TEXTURE_2D, sharp.TEXTURE_MAX_ANISOTROPY_EXT, 4);
    return texture;
  }

  free() {
    Object.values(this.buffers).forEach((buffer) => buffer && this.gl.deleteBuffer(buffer));
    this.pictures.forEach(({ texture, bitmap }) => {
      this.gl.deleteTexture(texture);
      bitmap.close();
    });
  }
}

// The rows that are in no range.
const complement = (ranges, n) => {
  const out = [];
  let at = 0;
  for (const [from, to] of [...ranges].sort((a, b) => a[0] - b[0])) {
    if (from > at) out.push([at, from]);
    at = Math.max(at, to);
  }
  if (at < n) out.push([at, n]);
  return out;
};
