// SPDX-License-Identifier: MIT
// A camera that orbits a target with z up, and the few vectors and matrices that it takes (column-major, as WebGL has them).

const add = (a, b) => a.map((x, i) => x + b[i]);
const subtract = (a, b) => a.map((x, i) => x - b[i]);
const scale = (s, a) => a.map((x) => s * x);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => scale(1 / Math.hypot(...a), a);

function multiply(a, b) {
  const product = new Float32Array(16);
  for (let column = 0; column < 4; ++column)
    for (let row = 0; row < 4; ++row)
      for (let k = 0; k < 4; ++k) product[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return product;
}

function lookAt(eye, target) {
  const back = unit(subtract(eye, target));
  const right = unit(cross([0, 0, 1], back));
  const up = cross(back, right);
  return [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
}

function perspective(fieldOfView, aspect, near, far) {
  const f = 1 / Math.tan(fieldOfView / 2);
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0];
}

/** Of a cube of half width r about the target, seen from direction `from`. */
function orthographic(target, from, r) {
  const view = lookAt(add(target, scale(2 * r, from)), target);
  return multiply([1 / r, 0, 0, 0, 0, 1 / r, 0, 0, 0, 0, -1 / r, 0, 0, 0, -2, 1], view);
}

const FIELD_OF_VIEW = 0.6; // rad, vertical
const STEEPEST = 1.553; // rad; straight down "up" would be undefined

class Camera {
  /** focus: what is shown at first, a center and a radius (m). */
  constructor(focus) {
    this.focus = focus;
    this.reset();
  }

  reset() {
    this.target = [...this.focus.center];
    this.distance = (0.92 * this.focus.radius) / Math.sin(FIELD_OF_VIEW / 2);
    this.azimuth = -1.05;
    this.elevation = 0.5;
  }

  /** To another focus; what the user made of the view stays. */
  follow(focus) {
    const factor = focus.radius / this.focus.radius;
    this.target = add(focus.center, scale(factor, subtract(this.target, this.focus.center)));
    this.distance *= factor;
    this.focus = focus;
  }

  get direction() {
    const flat = Math.cos(this.elevation);
    return [flat * Math.cos(this.azimuth), flat * Math.sin(this.azimuth), Math.sin(this.elevation)];
  }
  get eye() { return add(this.target, scale(this.distance, this.direction)); }

  projection(aspect) {
    // A tall window sees the same width as a square one.
    const angle = aspect >= 1 ? FIELD_OF_VIEW : 2 * Math.atan(Math.tan(FIELD_OF_VIEW / 2) / aspect);
    const near = 0.01 * this.distance, far = this.distance + 40 * this.focus.radius;
    return multiply(perspective(angle, aspect, near, far), lookAt(this.eye, this.target));
  }

  orbit(dx, dy) {
    this.azimuth -= dx;
    this.elevation = Math.min(Math.max(this.elevation + dy, -STEEPEST), STEEPEST);
  }

  /** By parts of the window's height. */
  pan(dx, dy) {
    const right = unit(cross([0, 0, 1], this.direction));
    const up = cross(this.direction, right);
    const length = 2 * this.distance * Math.tan(FIELD_OF_VIEW / 2);
    this.target = add(this.target, add(scale(-dx * length, right), scale(dy * length, up)));
  }

  zoom(factor) {
    const r = this.focus.radius;
    this.distance = Math.min(Math.max(this.distance * factor, 1e-3 * r), 100 * r);
  }
}
