// What a scan was painted with: colours of its vertices, or pictures on its triangles.

// Fetches what a shape has; none where it has nothing.
export const fetchPaint = async (name, hash, { colors, pictures }) => {
  if (!colors && pictures.length === 0) return null;
  const bytes = async (what) => {
    const answer = await fetch(`looks/${name}/${what}?${hash}`);
    if (!answer.ok) throw new Error(`the looks of the ${name} cannot be loaded`);
    return answer;
  };
  const painted = [];
  for (const [row, ranges] of pictures.entries()) {
    const blob = await (await bytes(row)).blob();
    // A picture that this browser cannot read is left out.
    const bitmap = await createImageBitmap(blob, { imageOrientation: "flipY" }).catch(() => null);
    if (bitmap) painted.push({ ranges, bitmap });
  }
  return {
    colors: colors ? new Uint8Array(await (await bytes("colors")).arrayBuffer()) : null,
    uvs: painted.length > 0 ? new Float32Array(await (await bytes("uvs")).arrayBuffer()) : null,
    pictures: painted,
  };
};

// Paint on a graphics card; shapes of one source share it.
export class Paint {
  constructor(gl, { colors, uvs, pictures }, nTriangles) {
    Object.assign(this, { colors, uvs, pictures });
    this.bare = complement(pictures.flatMap(({ ranges }) => ranges), nTriangles);
    this.upload(gl);
  }

  upload(gl) {
    this.gl = gl;
    this.buffers = { colors: this.buffer(this.colors), uvs: this.buffer(this.uvs) };
    this.pictures.forEach((picture) => (picture.texture = this.texture(picture.bitmap)));
  }

  buffer(data) {
    const { gl } = this;
    if (!data) return null;
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    return buffer;
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
