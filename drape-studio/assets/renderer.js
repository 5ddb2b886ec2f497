// Draws shapes into parts of one canvas.

import { within } from "./detail.js";
import { RAMP } from "./heats.js";

const VERTEX = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float value;
layout(location = 3) in vec3 painted;
layout(location = 4) in vec2 uv;
uniform mat4 view, both;
uniform float pointSize;
out vec3 vNormal, vPlace;
out float vValue;
out vec3 vPainted;
out vec2 vUv;
void main() {
  gl_Position = both * vec4(position, 1.0);
  vPlace = (view * vec4(position, 1.0)).xyz;
  vNormal = mat3(view) * normal;
  vValue = value;
  vPainted = painted;
  vUv = uv;
  gl_PointSize = pointSize;
}`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec3 vNormal, vPlace;
in float vValue;
in vec3 vPainted;
in vec2 vUv;
uniform sampler2D picture;
uniform int paint; // 0 none, 1 colours of vertices, 2 a picture
uniform bool isMatcap;
uniform vec4 colour;
uniform vec3 ramp[6];
uniform vec2 range;
uniform bool isGrey; // What has no value is grey
uniform int mode; // 0 shaded, 1 plain, 2 heat, 3 points
out vec4 fragment;
void main() {
  if (mode == 1) { fragment = colour; return; }
  if (mode == 3) {
    vec2 d = gl_PointCoord - 0.5;
    if (dot(d, d) > 0.25) discard;
  }
  vec3 n = vNormal;
  float l = length(n);
  n = l > 1e-20 ? n / l : (mode == 3 ? vec3(0, 0, 1) : normalize(cross(dFdx(vPlace), dFdy(vPlace))));
  bool away = dot(n, -vPlace) < 0.0;
  if (away) n = -n;
  vec3 base = colour.rgb;
  if (mode == 2 && vValue > -1e-6) {
    float t = clamp((vValue - range.x) / (range.y - range.x), 0.0, 1.0) * 5.0;
    int k = min(int(t), 4);
    base = mix(ramp[k], ramp[k + 1], t - float(k));
  } else if (mode == 2 && isGrey) {
    base = vec3(0.62);
  }
  if (away && mode == 0 && !gl_FrontFacing) base = mix(base, vec3(0.45, 0.36, 0.34), 0.55);
  bool isPainted = paint > 0 && mode != 2;
  if (isPainted) base = paint == 1 ? vPainted : texture(picture, vUv).rgb;
  if (isMatcap && mode == 0) {
    // The curvature of the surface, in one over the longest side: what is hollow is darker, what bulges brighter.
    float reach = max(1e-6, 0.5 * (length(dFdx(vPlace)) + length(dFdy(vPlace))));
    float bulge = (dFdx(n.x) + dFdy(n.y)) / reach;
    float tone = 0.22 + 0.62 * smoothstep(-0.5, 1.0, 0.45 * n.x + 0.75 * n.y + 0.5 * n.z) + 0.25 * pow(1.0 - abs(n.z), 3.0);
    fragment = vec4(mix(vec3(0.72), base, 0.35) * clamp(tone * (1.0 + clamp(0.006 * bulge, -0.45, 0.35)), 0.0, 1.4), colour.a);
    return;
  }
  vec3 key = normalize(vec3(0.35, 0.6, 0.8));
  float light = 0.34 + 0.52 * max(dot(n, key), 0.0) + 0.16 * (0.5 + 0.5 * n.y);
  // What was scanned has the light of its room in it.
  if (isPainted) light = mix(light, 1.0, 0.65);
  vec3 half_ = normalize(key + normalize(-vPlace));
  float shine = mode == 2 || isPainted ? 0.0 : 0.10 * pow(max(dot(n, half_), 0.0), 32.0);
  fragment = vec4(base * light + shine, colour.a);
}`;

const compile = (gl) => {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  return program;
};

export class Renderer {
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true, powerPreference: "high-performance" });
    if (!this.gl) throw new Error("this browser shows no WebGL 2");
    this.program = compile(this.gl);
    const names = ["view", "both", "pointSize", "colour", "ramp", "range", "mode", "isGrey", "picture", "paint", "isMatcap"];
    this.at = Object.fromEntries(names.map((name) => [name, this.gl.getUniformLocation(this.program, name)]));
  }

  // Fits the canvas to its size on the page; whether everything has to be drawn again.
  begin(size) {
    const { gl, canvas } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(size.width * ratio), Math.round(size.height * ratio)];
    const isResized = canvas.width !== width || canvas.height !== height;
    if (isResized) [canvas.width, canvas.height] = [width, height];
    this.ratio = ratio;
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.SCISSOR_TEST);
    gl.useProgram(this.program);
    gl.uniform3fv(this.at.ramp, RAMP);
    gl.uniform1i(this.at.picture, 0);
    return isResized;
  }

  // Draws into a part of the canvas from now on, in pixels of the page from the canvas's corner.
  aim(box, matrices) {
    const { gl, canvas } = this;
    const { ratio } = this;
    // Neighbours share the pixel between them: edges are rounded, not widths.
    const [left, right] = [box.left, box.left + box.width].map((x) => Math.round(x * ratio));
    const [top, bottom] = [box.top, box.top + box.height].map((y) => Math.round(y * ratio));
    const rect = [left, canvas.height - bottom, right - left, bottom - top];
    gl.viewport(...rect);
    gl.scissor(...rect);
    gl.uniformMatrix4fv(this.at.view, false, matrices.view);
    gl.uniformMatrix4fv(this.at.both, false, matrices.both);
  }

  clear(background) {
    const { gl } = this;
    gl.clearColor(...background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  // Closes the gaps between points, for what lies behind them: nothing is seen of this.
  close(shape, pixels) {
    const { gl, at } = this;
    this.points(shape);
    gl.uniform1f(at.pointSize, Math.max(2, Math.min(64, pixels * this.ratio)));
    gl.colorMask(false, false, false, false);
    gl.drawArrays(gl.POINTS, 0, shape.positions.length / 3);
    gl.colorMask(true, true, true, true);
  }

  // Lets points be counted that are not hidden, changing nothing.
  probe(buffer, pixels, draw) {
    const { gl, at } = this;
    this.attribute(0, buffer, 3);
    this.attribute(1, null);
    this.attribute(2, null);
    gl.uniform1i(at.mode, 1);
    gl.uniform1f(at.pointSize, pixels * this.ratio);
    gl.colorMask(false, false, false, false);
    gl.depthMask(false);
    draw();
    gl.depthMask(true);
    gl.colorMask(true, true, true, true);
  }

  // Draws ranges of coloured triangles over everything else.
  through(shape, ranges, range) {
    const { gl } = this;
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.heat(shape, range);
    for (const [from, to] of ranges) gl.drawArrays(gl.TRIANGLES, 3 * from, 3 * (to - from));
  }

  attribute(location, buffer, size) {
    const { gl } = this;
    if (!buffer) {
      gl.disableVertexAttribArray(location);
      gl.vertexAttrib1f(location, 0);
      return;
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, 0, 0);
  }

  // What a shape is painted with: 0 nothing, 1 the colours of its vertices, 2 a picture.
  brush(kind, paint) {
    const { gl, at } = this;
    this.attribute(3, null);
    this.attribute(4, kind === 2 ? paint.buffers.uvs : null, 2);
    if (kind === 1) {
      gl.bindBuffer(gl.ARRAY_BUFFER, paint.buffers.colors);
      gl.enableVertexAttribArray(3);
      gl.vertexAttribPointer(3, 4, gl.UNSIGNED_BYTE, true, 0, 0);
    }
    gl.uniform1i(at.paint, kind);
  }

  colour([r, g, b], alpha) {
    this.gl.uniform4f(this.at.colour, r, g, b, alpha);
  }

  // style: shaded, wire (shaded with edges), points; `ink` is how strong the edges are; coarse: with fewer triangles.
  draw(shape, { style, look = "clay", colour, line, ink = 0, alpha = 1, range = null, isGrey = false, isCoarse = false }) {
    const { gl } = this;
    if (alpha <= 0) return;
    const isBlended = alpha < 1;
    if (isBlended) {
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    }
    this.colour(colour, alpha);
    gl.uniform1i(this.at.isMatcap, look === "matcap");
    const paint = look === "scan" && !isBlended ? shape.paint : null;
    if (shape.isCloud || style === "points") this.points(shape, paint);
    else if (paint?.places && !(shape.values && range)) this.pictured(shape, paint, isCoarse);
    else this.surface(shape, { isBlended, range, isGrey, paint, isCoarse });
    this.brush(0);
    if (style === "wire" && !shape.isCloud && ink > 0) this.lines(shape, line, ink);
    gl.disable(gl.BLEND);
  }

  points(shape, paint = null) {
    const { gl, at } = this;
    this.brush(paint?.colors ? 1 : 0, paint);
    this.attribute(0, shape.buffers.positions, 3);
    this.attribute(1, shape.buffers.normals, 3);
    this.attribute(2, null);
    gl.uniform1i(at.mode, 3);
    gl.uniform1f(at.pointSize, Math.max(2, 3 * this.ratio));
    gl.drawArrays(gl.POINTS, 0, shape.positions.length / 3);
  }

  // Triangles with pictures, and those without one.
  pictured(shape, paint, isCoarse) {
    const { gl } = this;
    this.plain(shape);
    const coarse = isCoarse ? paint.coarse(shape) : null;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, coarse?.buffer ?? paint.buffers.corners ?? shape.buffers.triangles);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    const kept = (range) => (coarse ? within(coarse.rows, range) : range);
    const all = (ranges) => ranges.map(kept).forEach(([from, to]) => gl.drawElements(gl.TRIANGLES, 3 * (to - from), gl.UNSIGNED_INT, 12 * from));
    this.brush(0);
    all(paint.bare);
    this.brush(2, paint);
    for (const { ranges, texture } of paint.pictures) {
      gl.bindTexture(gl.TEXTURE_2D, texture);
      all(ranges);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  // Draws into the left share of a view from now on, over what is there.
  cut(share) {
    const { gl } = this;
    const [x, y, width, height] = gl.getParameter(gl.SCISSOR_BOX);
    gl.scissor(x, y, Math.round(width * share), height);
  }

  surface(shape, { isBlended, range, isGrey, paint, isCoarse }) {
    const { gl } = this;
    this.brush(paint?.colors && !(shape.values && range) ? 1 : 0, paint);
    const isHeat = shape.values && range;
    const isSpread = isHeat && shape.perTriangle;
    if (isHeat) this.heat(shape, range, isGrey);
    else this.plain(shape);
    const coarse = isCoarse && !isSpread ? shape.coarse() : null;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, coarse?.buffer ?? shape.buffers.triangles);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    const n = (coarse?.corners ?? shape.triangles).length;
    const draw = () => (isSpread ? gl.drawArrays(gl.TRIANGLES, 0, n) : gl.drawElements(gl.TRIANGLES, n, gl.UNSIGNED_INT, 0));
    if (isBlended) {
      // Only the nearest layer is seen through.
      gl.colorMask(false, false, false, false);
      draw();
      gl.colorMask(true, true, true, true);
    }
    draw();
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  plain(shape) {
    this.attribute(0, shape.buffers.positions, 3);
    this.attribute(1, shape.buffers.normals, 3);
    this.attribute(2, null);
    this.gl.uniform1i(this.at.mode, 0);
  }

  // Values between two ends as colours; those below 0 have none.
  heat(shape, range, isGrey = false) {
    const { perTriangle, buffers } = shape;
    if (perTriangle) shape.spread();
    this.attribute(0, perTriangle ? buffers.spread : buffers.positions, 3);
    this.attribute(1, perTriangle ? buffers.spreadNormals : buffers.normals, 3);
    this.attribute(2, buffers.values, 1);
    this.gl.uniform2f(this.at.range, ...range);
    this.gl.uniform1i(this.at.isGrey, isGrey);
    this.gl.uniform1i(this.at.mode, 2);
  }

  lines(shape, line, alpha) {
    const { gl, at } = this;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    this.attribute(0, shape.buffers.positions, 3);
    this.attribute(1, null);
    this.attribute(2, null);
    this.colour(line, alpha);
    gl.uniform1i(at.mode, 1);
    if (!shape.hasEdges) shape.indexEdges();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, shape.buffers.edges);
    gl.drawElements(gl.LINES, shape.edges.length, gl.UNSIGNED_INT, 0);
  }
}
