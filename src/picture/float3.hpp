// SPDX-License-Identifier: MIT
// Single-precision vectors of the renderer. Nothing here reaches the simulation.
#pragma once

#include <cmath>

#include "base/vec3.hpp"

namespace flotilla::picture {

struct Float3 {
    float x = 0, y = 0, z = 0;
};

constexpr Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Float3 operator-(Float3 a) { return {-a.x, -a.y, -a.z}; }
constexpr Float3 operator*(float s, Float3 a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr Float3 operator*(Float3 a, Float3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
constexpr Float3& operator+=(Float3& a, Float3 b) { return a = a + b; }
constexpr float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Float3 cross(Float3 a, Float3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(Float3 a) { return std::sqrt(dot(a, a)); }
inline Float3 normalized(Float3 a) {
    const float l = length(a);
    return l > 0 ? (1 / l) * a : Float3{0, 0, 1};
}
constexpr Float3 mix(Float3 a, Float3 b, float t) { return (1 - t) * a + t * b; }
inline Float3 to_float(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
inline float smoothstep(float low, float high, float x) {
    const float t = std::fmin(1.0F, std::fmax(0.0F, (x - low) / (high - low)));
    return t * t * (3 - 2 * t);
}

} // namespace flotilla::picture
