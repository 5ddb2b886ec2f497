// A camera on a turntable around a shape whose longest side is 1.

import { IDENTITY, aboutX, aboutY, add, after, multiply, normalize, scale, subtract, turn, turnBack } from "./maths.js";

const FIELD = (30 * Math.PI) / 180;
// How much of a view a shape fills.
const FILLED = 0.8;
const HOME = { yaw: 0.6, pitch: 0.25, distance: 2.6, centre: [0, 0, 0] };
// Which axis of the shape points up: rotations that bring it to the camera's y.
const UPS = { y: IDENTITY, z: [1, 0, 0, 0, 0, 1, 0, -1, 0] };

// Of half the angle from top to bottom; the narrower side of a view sees the same field.
const tangent = (aspect) => Math.tan(FIELD / 2) / Math.min(1, aspect);

export class Camera {
  constructor() {
    this.up = "y";
    this.base = UPS.y;
    this.isFlat = false;
    this.home();
  }

  home() {
    Object.assign(this, HOME, { centre: [...HOME.centre] });
  }

  // All that tells how it looks, to come back to.
  get pose() {
    const { yaw, pitch, distance, centre, up, base, isFlat } = this;
    return { yaw, pitch, distance, centre, up, base, isFlat };
  }

  set pose(pose) {
    Object.assign(this, pose);
  }

  setUp(axis) {
    this.up = axis;
    this.base = UPS[axis];
  }

  look(yaw, pitch) {
    [this.yaw, this.pitch] = [yaw, pitch];
  }

  // The rotation from the shape to the camera.
  get rotation() {
    return after(aboutX(this.pitch), after(aboutY(-this.yaw), this.base));
  }

  orbit(dx, dy) {
    this.yaw -= dx * 0.01;
    this.pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.pitch + dy * 0.01));
  }

  // By pixels of a view of some width and height.
  pan(dx, dy, width, height) {
    const unit = (2 * this.distance * tangent(width / height)) / height;
    this.centre = subtract(this.centre, turnBack(this.rotation, [dx * unit, -dy * unit, 0]));
  }

  // How many pixels a length has in the middle of a view.
  pixels(length, width, height) {
    return (length * height) / (2 * this.distance * tangent(width / height));
  }

  zoom(factor) {
    this.distance = Math.max(0.02, Math.min(40, this.distance * factor));
  }

  // Comes nearer to what is seen at a place of the view, each of x and y from −1 to 1, which stays where it is.
  zoomAt(factor, [x, y], aspect) {
    const before = this.distance;
    this.zoom(factor);
    const moved = (before - this.distance) * tangent(aspect);
    this.centre = add(this.centre, turnBack(this.rotation, [x * moved * aspect, y * moved, 0]));
  }

  // Looks at a ball.
  frame(centre, radius) {
    this.centre = centre;
    this.distance = Math.max(0.05, radius / Math.sin(FIELD / 2));
  }

  // Looks at points from where it is, so near that they just fit.
  fit(centre, points, aspect) {
    this.centre = centre;
    const [m, t] = [this.rotation, tangent(aspect) * FILLED];
    const needed = points.map((p) => {
      const [x, y, z] = turn(m, subtract(p, centre));
      return (this.isFlat ? 0 : z) + Math.max(Math.abs(x) / (t * aspect), Math.abs(y) / t);
    });
    this.distance = Math.max(0.05, ...needed);
  }

  matrices(aspect) {
    const m = this.rotation;
    const t = scale(turn(m, this.centre), -1);
    const view = [m[0], m[3], m[6], 0, m[1], m[4], m[7], 0, m[2], m[5], m[8], 0, t[0], t[1], t[2] - this.distance, 1];
    const near = Math.max(0.005, this.distance * 0.02);
    const far = this.distance + 6;
    const f = 1 / tangent(aspect);
    const [s, depth] = [f / this.distance, far + 6];
    // Without perspective, what lies behind the eye is seen as well.
    const projection = this.isFlat ? [
      s / aspect, 0, 0, 0, 0, s, 0, 0,
      0, 0, -1 / depth, 0, 0, 0, 0, 1,
    ] : [
      f / aspect, 0, 0, 0, 0, f, 0, 0,
      0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0,
    ];
    return { view, projection, both: multiply(projection, view) };
  }

  get eye() {
    return add(this.centre, turnBack(this.rotation, [0, 0, this.distance]));
  }

  // From the eye through a point of the view, each of x and y from −1 to 1.
  ray(x, y, aspect, height) {
    const t = tangent(aspect);
    const spread = (8 * t) / height;
    if (this.isFlat) {
      const beside = scale([x * t * aspect, y * t, 0], this.distance);
      const back = [beside[0], beside[1], this.distance + 3];
      return { origin: add(this.centre, turnBack(this.rotation, back)), direction: turnBack(this.rotation, [0, 0, -1]), spread };
    }
    const direction = normalize(turnBack(this.rotation, [x * t * aspect, y * t, -1]));
    return { origin: this.eye, direction, spread };
  }
}
