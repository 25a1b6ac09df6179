// SPDX-License-Identifier: MIT
// The animation in WebGL2: one instanced draw call per group of bodies of one shape. All frames lie in one buffer on the
// graphics card; showing another one moves two offsets.

const SHADOW_PIXELS = 2048;
const SUN = unit([0.45, -0.35, 1]);
const FIXED_TINT = [158, 164, 172];
// Muted colours that stay apart from each other and from the grey of static bodies.
const TINTS = [[201, 75, 60], [226, 138, 60], [236, 190, 84], [126, 165, 82], [58, 141, 118], [63, 142, 178],
  [54, 97, 158], [123, 94, 158], [190, 98, 134], [229, 221, 203], [156, 106, 72], [98, 178, 190]];

/** Spreads neighbouring numbers over the colours. */
function tintOf(index) {
  let h = Math.imul(index + 1, 2654435769) >>> 0;
  h = Math.imul(h ^ (h >>> 15), 2246822519) >>> 0;
  h ^= h >>> 13;
  const shade = 0.9 + 0.2 * ((h >>> 16) & 255) / 255;
  return TINTS[(h >>> 0) % TINTS.length].map((c) => Math.min(255, Math.round(shade * c)));
}

const quantile = (sorted, q) => sorted[Math.round(q * (sorted.length - 1))] ?? 0;

/** A box as center and radius of a sphere about it (m). */
function sphereOf(low, high) {
  return { center: scale(0.5, add(low, high)), radius: Math.max(0.5 * Math.hypot(...subtract(high, low)), 1e-6) };
}

/** Whether a body in the page's order is in a frame. */
function isThere(data, poses, frame, body) {
  const at = WORDS * (frame * data.bodies.count + body);
  return poses[at + 4] !== 0 || poses[at + 5] !== 0 || poses[at + 6] !== 0 || poses[at + 7] !== 0;
}

/**
 * What to look at in every frame (m): the box of most moving bodies, low and high. Not of all: one that flew off must not
 * shrink the others to a dot. Of a sample of them, because thousands of bodies and frames would take seconds.
 */
function movingBoxes(data, boxes, poses, radii) {
  const moving = data.groups.filter((g) => !g.fixed);
  const bodies = moving.flatMap((g) => Array.from({ length: g.count }, (_, i) => g.first + i));
  const sample = bodies.filter((_, i) => i % Math.ceil(bodies.length / 400) === 0);
  const margin = Math.max(0, ...moving.map((g) => radii[g.shape]));
  return data.track.frames.map((_, frame) => {
    const there = sample.filter((body) => isThere(data, poses, frame, body));
    const ends = [0, 1, 2].map((axis) => {
      const values = Float32Array.from(there.length > 0 ? there : sample, (body) => boxes[6 * body + axis] +
        (boxes[6 * body + 3 + axis] * poses[WORDS * (frame * data.bodies.count + body) + axis]) / 65535).sort();
      return [quantile(values, 0.01) - margin, quantile(values, 0.99) + margin];
    });
    return { low: ends.map((e) => e[0]), high: ends.map((e) => e[1]) };
  });
}

/** Adds the fixed bodies that are no larger than what moves: containers, not the ground. */
function withContainers(moving, data, boxes, radii) {
  const smallest = Math.min(...moving.map(({ low, high }) => sphereOf(low, high).radius));
  const none = data.groups.every((g) => g.fixed);
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const group of data.groups.filter((g) => g.fixed && (none || radii[g.shape] < 2.5 * smallest)))
    for (let i = group.first; i < group.first + group.count; ++i)
      for (let axis = 0; axis < 3; ++axis) {
        const reach = 0.5 * radii[group.shape]; // of a sphere the box' corners are empty
        low[axis] = Math.min(low[axis], boxes[6 * i + axis] - reach);
        high[axis] = Math.max(high[axis], boxes[6 * i + axis] + boxes[6 * i + 3 + axis] + reach);
      }
  return moving.map((box) => none ? { low, high } : {
    low: box.low.map((x, i) => Math.min(x, low[i])), high: box.high.map((x, i) => Math.max(x, high[i])) });
}

/** Spheres of the boxes, averaged over about a second, so that a camera that follows them moves gently. */
function smoothFocus(boxes, times) {
  const spheres = boxes.map(({ low, high }) => sphereOf(low, high));
  return spheres.map((_, k) => {
    let center = [0, 0, 0], radius = 0, weight = 0;
    for (let j = k; j >= 0 && times[k] - times[j] < 0.8; --j) accumulate(j);
    for (let j = k + 1; j < times.length && times[j] - times[k] < 0.8; ++j) accumulate(j);
    return { center: scale(1 / weight, center), radius: radius / weight };

    function accumulate(j) {
      const w = 0.8 - Math.abs(times[j] - times[k]);
      center = add(center, scale(w, spheres[j].center));
      radius += w * spheres[j].radius;
      weight += w;
    }
  });
}

/** Between two frames. */
function between(a, b, part) {
  return { center: add(scale(1 - part, a.center), scale(part, b.center)), radius: (1 - part) * a.radius + part * b.radius };
}

/** True where the processor draws: smooth edges and shadows would multiply the time there. */
function drawnByProcessor() {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return false;
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const renderer = gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer);
}

function openContext(canvas) {
  const slow = drawnByProcessor();
  const gl = canvas.getContext("webgl2", { alpha: true, antialias: !slow, powerPreference: "high-performance" });
  if (!gl) throw new Error("This browser offers no WebGL2, so the animation cannot be shown.");
  return { gl, slow };
}

class Viewer {
  constructor(canvas, data, poses, player) {
    const { gl, slow } = openContext(canvas);
    Object.assign(this, { canvas, gl, data, player, words: poses });
    this.bodies = data.bodies.count;
    this.options = { colour: "body", fixed: "cut", shadows: !slow, follow: true };
    this.detail = 1; // of the resolution; below 1 where a full one cannot keep up
    this.picked = -1;
    this.framesDrawn = 0;
    this.stale = true;
    const boxes = floatsOf(data.track.boxes);
    const shapes = data.shapes.map((s) => ({ vertices: floatsOf(s.vertices), triangles: indicesOf(s.triangles) }));
    const radii = shapes.map(({ vertices }) => radiusOf(vertices));
    const moving = movingBoxes(data, boxes, poses, radii);
    this.moving = moving.map(({ low, high }) => sphereOf(low, high));
    this.views = smoothFocus(withContainers(moving, data, boxes, radii), data.track.times);
    this.camera = new Camera(this.views[0]);
    this.boxes = boxes;
    this.speedTop = topOfColours(poses, data) || 1;
    this.makePrograms();
    this.makeBuffers(shapes, boxes, poses);
    this.makeShadowMap();
  }

  makePrograms() {
    const make = (fragment) => new Program(this.gl, PLACE_SHADER, fragment);
    this.programs = { shade: make(SHADE_SHADER), depth: make(DEPTH_SHADER), pick: make(PICK_SHADER) };
  }

  makeBuffers(shapes, boxes, poses) {
    const gl = this.gl;
    this.poses = this.upload(gl.ARRAY_BUFFER, poses);
    const boxBuffer = this.upload(gl.ARRAY_BUFFER, boxes);
    const tintBuffer = this.upload(gl.ARRAY_BUFFER, this.tints());
    this.groups = this.data.groups.filter((g) => shapes[g.shape].triangles.length > 0).map((group) => {
      const vao = gl.createVertexArray();
      gl.bindVertexArray(vao);
      this.upload(gl.ARRAY_BUFFER, shapes[group.shape].vertices);
      this.attribute(0, 3, gl.FLOAT, false, 12, 0, 0);
      this.upload(gl.ELEMENT_ARRAY_BUFFER, shapes[group.shape].triangles);
      gl.bindBuffer(gl.ARRAY_BUFFER, boxBuffer);
      this.attribute(5, 3, gl.FLOAT, false, 24, 24 * group.first, 1);
      this.attribute(6, 3, gl.FLOAT, false, 24, 24 * group.first + 12, 1);
      gl.bindBuffer(gl.ARRAY_BUFFER, tintBuffer);
      this.attribute(7, 4, gl.UNSIGNED_BYTE, true, 4, 4 * group.first, 1);
      gl.bindVertexArray(null); // later bindings must not change it
      return { ...group, vao, corners: shapes[group.shape].triangles.length };
    });
  }

  upload(target, values) {
    const buffer = this.gl.createBuffer();
    this.gl.bindBuffer(target, buffer);
    this.gl.bufferData(target, values, this.gl.STATIC_DRAW);
    return buffer;
  }

  attribute(location, size, type, normalised, stride, offset, divisor) {
    this.gl.enableVertexAttribArray(location);
    this.gl.vertexAttribPointer(location, size, type, normalised, stride, offset);
    this.gl.vertexAttribDivisor(location, divisor);
  }

  tints() {
    const tints = new Uint8Array(4 * this.bodies).fill(255);
    for (const group of this.data.groups)
      for (let i = group.first; i < group.first + group.count; ++i)
        tints.set(group.fixed ? FIXED_TINT : tintOf(this.data.bodies.indices[i]), 4 * i);
    return tints;
  }

  makeShadowMap() {
    const gl = this.gl;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW_PIXELS, SHADOW_PIXELS);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    this.shadowTarget = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowTarget);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** The place in time, and what follows from it. */
  update() {
    const { frame, part } = this.place = this.player.place();
    const at = (spheres) => between(spheres[frame], spheres[part > 0 ? frame + 1 : frame], part);
    this.focus = at(this.moving);
    if (this.options.follow) this.camera.follow(at(this.views));
    this.shadowProjection = orthographic(this.focus.center, SUN, this.focus.radius);
    this.shadowTexel = (2 * this.focus.radius) / SHADOW_PIXELS;
  }

  /** Draws where something changed since the last time. */
  draw() {
    this.fitToWindow();
    if (!this.stale) return;
    this.stale = false;
    this.framesDrawn += 1;
    this.update();
    const gl = this.gl;
    gl.enable(gl.DEPTH_TEST);
    if (this.options.shadows) this.drawShadows();
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0, 0, 0, 0); // the page's own background shows
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.drawBodies();
  }

  fitToWindow() {
    const ratio = this.detail * Math.min(devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (this.canvas.width === width && this.canvas.height === height) return;
    this.canvas.width = width;
    this.canvas.height = height;
    this.stale = true;
  }

  get projection() { return this.camera.projection(this.canvas.width / this.canvas.height); }

  drawShadows() {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowTarget);
    gl.viewport(0, 0, SHADOW_PIXELS, SHADOW_PIXELS);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    const program = this.programs.depth.use();
    this.setPlace(program, this.shadowProjection);
    // A container would put into shade what it is cut open for.
    for (const group of this.groups) if (!group.fixed) this.drawGroup(program, group);
  }

  drawBodies() {
    const gl = this.gl, program = this.programs.shade.use(), fixed = this.options.fixed;
    this.setPlace(program, this.projection);
    gl.uniform3fv(program.at.eye, this.camera.eye);
    gl.uniform3fv(program.at.sun, SUN);
    gl.uniform3fv(program.at.focus, this.focus.center);
    gl.uniformMatrix4fv(program.at.shadowProjection, false, this.shadowProjection);
    gl.uniform1f(program.at.shadowTexel, this.options.shadows ? this.shadowTexel : 0);
    this.drawLayer(program, 0, (g) => !g.fixed || fixed === "solid");
    if (fixed === "cut") this.drawLayer(program, 1, (g) => g.fixed);
    if (fixed === "cut" || fixed === "glass") this.drawGlass(program, fixed === "cut" ? 2 : 3);
  }

  drawGlass(program, layer) {
    const gl = this.gl;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    this.drawLayer(program, layer, (g) => g.fixed);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  drawLayer(program, layer, wanted) {
    this.gl.uniform1i(program.at.layer, layer);
    for (const group of this.groups) if (wanted(group)) this.drawGroup(program, group);
  }

  setPlace(program, projection) {
    const gl = this.gl;
    gl.uniformMatrix4fv(program.at.projection, false, projection);
    gl.uniform1f(program.at.part, this.place.part);
    gl.uniform1i(program.at.pickedBody, this.picked);
  }

  drawGroup(program, group) {
    const gl = this.gl, { frame, part } = this.place;
    const next = part > 0 ? frame + 1 : frame;
    gl.bindVertexArray(group.vao);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.poses);
    for (const [location, k] of [[1, frame], [3, next]]) {
      const offset = POSE_BYTES * (k * this.bodies + group.first);
      this.attribute(location, 4, gl.UNSIGNED_SHORT, true, POSE_BYTES, offset, 1);
      this.attribute(location + 1, 4, gl.SHORT, true, POSE_BYTES, offset + 8, 1);
    }
    gl.uniform1i(program.at.firstBody, group.first);
    const bySpeed = this.options.colour === "speed" && !group.fixed;
    gl.uniform1f(program.at.speedScale, bySpeed ? this.data.track.top_speed / this.speedTop : 0);
    gl.drawElementsInstanced(gl.TRIANGLES, group.corners, gl.UNSIGNED_INT, 0, group.count);
    gl.bindVertexArray(null);
  }

  /** The middle of a body in the page's order, at the frame shown (m, about the origin of the page). */
  middleOf(body) {
    const at = WORDS * (this.player.place().frame * this.bodies + body);
    return [0, 1, 2].map((k) => this.boxes[6 * body + k] + (this.boxes[6 * body + 3 + k] * this.words[at + k]) / 65535);
  }

  /** Whether a body in the page's order is in the frame shown. */
  isThere(body) { return isThere(this.data, this.words, this.player.place().frame, body); }

  /** m/s, of a body in the page's order, at the frame shown. */
  speedOf(body) {
    const word = this.words[WORDS * (this.player.place().frame * this.bodies + body) + 3];
    return (word / 65535) ** 2 * this.data.track.top_speed;
  }

  /** The body at a point of the canvas (CSS pixels), as a place in the page's order; -1: none. Static bodies are air. */
  bodyAt(x, y) {
    const gl = this.gl, ratio = this.canvas.width / this.canvas.clientWidth;
    const px = Math.floor(x * ratio), py = this.canvas.height - 1 - Math.floor(y * ratio);
    const target = this.pickTarget ??= new PickTarget(gl);
    target.bind(this.canvas.width, this.canvas.height);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(px, py, 1, 1); // one pixel is all that is asked for
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const program = this.programs.pick.use();
    this.setPlace(program, this.projection);
    for (const group of this.groups) if (!group.fixed) this.drawGroup(program, group);
    const pixel = new Uint8Array(4);
    gl.readPixels(px, py, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.disable(gl.SCISSOR_TEST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return pixel[0] + 256 * pixel[1] + 65536 * pixel[2] - 1;
  }
}

/** A linked program with the places of its uniforms in `at`. */
class Program {
  constructor(gl, vertex, fragment) {
    this.gl = gl;
    this.handle = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(this.handle, shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    }
    gl.linkProgram(this.handle);
    if (!gl.getProgramParameter(this.handle, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(this.handle));
    this.at = {};
    for (let i = 0; i < gl.getProgramParameter(this.handle, gl.ACTIVE_UNIFORMS); ++i) {
      const { name } = gl.getActiveUniform(this.handle, i);
      this.at[name] = gl.getUniformLocation(this.handle, name);
    }
  }

  use() {
    this.gl.useProgram(this.handle);
    return this;
  }
}

/** Where body numbers are drawn: without antialiasing, which would mix them. */
class PickTarget {
  constructor(gl) {
    this.gl = gl;
    this.framebuffer = gl.createFramebuffer();
    this.colour = gl.createRenderbuffer();
    this.depth = gl.createRenderbuffer();
  }

  bind(width, height) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    for (const [buffer, format, attachment] of [[this.colour, gl.RGBA8, gl.COLOR_ATTACHMENT0],
      [this.depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, buffer);
    }
    gl.viewport(0, 0, width, height);
  }
}

function radiusOf(vertices) {
  let largest = 0;
  for (let i = 0; i < vertices.length; i += 3)
    largest = Math.max(largest, Math.hypot(vertices[i], vertices[i + 1], vertices[i + 2]));
  return largest;
}

/** The speed that 99 of 100 sampled poses of moving bodies stay below (m/s): one fast body must not make all others blue. */
function topOfColours(poses, data) {
  const moving = data.groups.filter((g) => !g.fixed).reduce((sum, g) => sum + g.count, 0); // dynamic ones come first
  const speeds = [];
  const count = moving * data.track.frames.length, step = Math.max(1, Math.floor(count / 50000));
  for (let k = 0; k < count; k += step) {
    const frame = Math.floor(k / moving), pose = frame * data.bodies.count + (k % moving);
    if (isThere(data, poses, frame, k % moving)) speeds.push((poses[WORDS * pose + 3] / 65535) ** 2 * data.track.top_speed);
  }
  speeds.sort((a, b) => a - b);
  return speeds[Math.floor(0.99 * speeds.length)] ?? 0;
}

/** Mouse, touch and pen: orbit, pan, zoom; a press that does not move picks. */
function attachPointers(viewer, onPick) {
  const { canvas, camera } = viewer;
  const pointers = new Map();
  let moved = 0;
  const changed = () => { viewer.stale = true; };

  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    if (pointers.size === 0) moved = 0;
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const now = [event.clientX, event.clientY];
    const dx = now[0] - last[0], dy = now[1] - last[1], height = canvas.clientHeight;
    moved += Math.abs(dx) + Math.abs(dy);
    const other = [...pointers.entries()].find(([id]) => id !== event.pointerId)?.[1];
    if (other) { // two fingers: their middle pans, their distance zooms
      camera.pan(dx / 2 / height, dy / 2 / height);
      camera.zoom(Math.hypot(last[0] - other[0], last[1] - other[1]) /
        Math.max(Math.hypot(now[0] - other[0], now[1] - other[1]), 1));
    } else if (event.shiftKey || event.buttons & 6) {
      camera.pan(dx / height, dy / height);
    } else {
      camera.orbit((3.5 * dx) / height, (3.5 * dy) / height);
    }
    pointers.set(event.pointerId, now);
    changed();
  });
  const release = (event) => {
    if (!pointers.delete(event.pointerId)) return;
    if (event.type === "pointerup" && event.button === 0 && moved < 4) onPick(event.offsetX, event.offsetY);
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    camera.zoom(Math.exp(0.0013 * event.deltaY * (event.deltaMode === 1 ? 30 : 1)));
    changed();
  }, { passive: false });
  canvas.addEventListener("dblclick", () => { camera.reset(); changed(); });
}
