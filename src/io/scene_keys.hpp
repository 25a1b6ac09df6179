// SPDX-License-Identifier: MIT
// The keys of a scene file beside those of `settings`. scene.schema.json lists the same; a test compares them.
#pragma once

#include <array>
#include <string_view>

namespace flotilla::io {

using std::string_view_literals::operator""sv;

inline constexpr std::array kSceneKeys{"flotilla_scene"sv, "gravity"sv, "settings"sv,
                                       "shapes"sv,         "bodies"sv,  "ignore"sv};
inline constexpr std::array kShapeKeys{
    "name"sv, "mesh"sv,    "scale"sv,          "vertices"sv, "triangles"sv, "density"sv,     "surface_density"sv,
    "mass"sv, "inertia"sv, "center_of_mass"sv, "segments"sv, "points"sv,    "line_density"sv};
inline constexpr std::array kBodyKeys{
    "name"sv,   "shape"sv, "type"sv,   "position"sv,  "rotation"sv,    "velocity"sv,         "friction"sv,
    "locked"sv, "force"sv, "torque"sv, "keyframes"sv, "restitution"sv, "angular_velocity"sv, "group"sv};
/// Axes that `locked` may name: of translation, then of rotation.
inline constexpr std::array kLockedAxes{"x"sv, "y"sv, "z"sv, "rx"sv, "ry"sv, "rz"sv};
inline constexpr std::array kIgnoreKeys{"groups"sv, "bodies"sv};
inline constexpr std::array kKeyframeKeys{"time"sv, "position"sv, "rotation"sv};

} // namespace flotilla::io
