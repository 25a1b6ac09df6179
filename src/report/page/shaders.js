// SPDX-License-Identifier: MIT
// The shaders. A body's pose comes as normalised 16-bit attributes of two frames, straight from the decoded stream, so that
// the script does no work per body.

const PLACE_SHADER = `#version 300 es
precision highp float;
layout(location = 0) in vec3 vertex;   // m, about the middle of the shape
layout(location = 1) in vec4 place0;   // part of the body's box; w: sqrt(speed / top speed)
layout(location = 2) in vec4 turn0;    // quaternion x y z w; zero: the body is not there
layout(location = 3) in vec4 place1;   // the same in the next frame
layout(location = 4) in vec4 turn1;
layout(location = 5) in vec3 low;      // the body's box, m, about the origin of the page
layout(location = 6) in vec3 extent;
layout(location = 7) in vec4 tint;     // sRGB
uniform mat4 projection;
uniform float part;                    // of the way from one frame to the next
uniform int firstBody, pickedBody;
uniform float speedScale;              // top speed / upper end of the colours; 0: colour by body
out vec3 world;
out vec3 albedo;                       // linear
flat out int body;

vec3 rotate(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
vec3 linear(vec3 c) { return pow(c, vec3(2.2)); }

vec3 ramp(float t) { // as in the legend; t is a root, so that slow motion in a pile shows beside free fall
  vec3 c[5] = vec3[5](vec3(43, 63, 140), vec3(47, 127, 184), vec3(73, 179, 138), vec3(227, 198, 74), vec3(217, 72, 43));
  float x = 4.0 * clamp(t, 0.0, 1.0);
  int i = min(int(x), 3);
  return mix(c[i], c[i + 1], x - float(i)) / 255.0;
}

void main() {
  body = firstBody + gl_InstanceID;
  if (turn0 == vec4(0.0)) { // every vertex at one point out of sight
    world = albedo = vec3(0.0);
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  bool stays = turn1 != vec4(0.0);
  vec4 next = dot(turn0, turn1) < 0.0 ? -turn1 : turn1;
  vec4 turn = normalize(stays ? mix(turn0, next, part) : turn0);
  vec4 place = stays ? mix(place0, place1, part) : place0;
  world = low + extent * place.xyz + rotate(turn, vertex);
  albedo = linear(speedScale > 0.0 ? ramp(place.w * sqrt(speedScale)) : tint.rgb);
  if (body == pickedBody) albedo = vec3(1.0, 0.95, 0.7);
  gl_Position = projection * vec4(world, 1.0);
}`;

// Normals are those of the triangles, from derivatives: meshes stay indexed, and both sides are lit alike.
const SHADE_SHADER = `#version 300 es
precision highp float;
precision highp sampler2DShadow;
in vec3 world;
in vec3 albedo;
uniform vec3 eye, sun, focus;
uniform mat4 shadowProjection;
uniform sampler2DShadow shadowMap;
uniform float shadowTexel;             // m; 0: no shadows
uniform int layer;                     // 0 all; 1 inner faces only; 2 outer faces, as glass; 3 all, as glass
out vec4 colour;

float lit(vec3 normal) {
  if (shadowTexel == 0.0) return 1.0;
  vec3 at = (shadowProjection * vec4(world + 1.5 * shadowTexel * normal, 1.0)).xyz * 0.5 + 0.5;
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
  vec2 pixel = 1.0 / vec2(textureSize(shadowMap, 0));
  float sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec2 shift = vec2(i % 2, i / 2) * 1.6 - 0.8;
    sum += texture(shadowMap, vec3(at.xy + shift * pixel, at.z - 0.0008));
  }
  return sum / 4.0;
}

void main() {
  vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
  vec3 toEye = normalize(eye - world);
  if (dot(normal, toEye) < 0.0) normal = -normal;
  // A face of a container is an inner one where the visible side looks towards the bodies.
  bool inner = dot(normal, focus - world) > 0.0;
  if (layer == 1 && !inner || layer == 2 && inner) discard;
  if (layer >= 2) {
    float rim = pow(1.0 - abs(dot(normal, toEye)), 3.0);
    colour = vec4(0.55, 0.62, 0.7, 1.0) * (0.10 + 0.35 * rim); // premultiplied
    return;
  }
  vec3 own = gl_FrontFacing ? albedo : 0.8 * albedo; // tells the two sides of a thin shell apart
  float direct = max(dot(normal, sun), 0.0) * lit(normal);
  vec3 sky = mix(vec3(0.22, 0.21, 0.21), vec3(0.46, 0.52, 0.62), 0.5 + 0.5 * normal.z);
  float fill = 0.12 * max(dot(normal, toEye), 0.0);
  vec3 light = own * (sky + fill + vec3(1.02, 0.97, 0.88) * direct);
  // Eight bits show steps on large even faces; noise of one step hides them.
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
  colour = vec4(pow(light, vec3(1.0 / 2.2)) + noise / 255.0, 1.0);
}`;

const DEPTH_SHADER = `#version 300 es
precision highp float;
void main() {}`;

/** Writes the number of the body instead of a colour; zero is the background. */
const PICK_SHADER = `#version 300 es
precision highp float;
flat in int body;
out vec4 colour;
void main() {
  int id = body + 1;
  colour = vec4(id & 255, (id >> 8) & 255, (id >> 16) & 255, 255) / 255.0;
}`;
