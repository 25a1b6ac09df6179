// SPDX-License-Identifier: MIT
// Checks of a scene description: names, references, ranges, rotations, keyframes, and whether the masses exist.
// Limits are wide enough for any sensible scene in SI units and narrow enough that nothing later overflows or
// underflows.
#pragma once

#include <string>
#include <vector>

#include <flotilla/scene.hpp>

#include "base/error_list.hpp"

namespace flotilla {

/// m and m/s. Rounding of world coordinates grows with the distance from the origin: at 10^9 m a double resolves 10^-7
/// m.
inline constexpr double kMaxCoordinate = 1e9;
inline constexpr double kMaxAngularVelocity = 1e6; ///< rad/s
inline constexpr double kMaxGravity = 1e6;         ///< m/s^2
inline constexpr double kMinScale = 1e-9, kMaxScale = 1e9;
/// kg, kg/m^2 or kg/m^3 of a shape. The product of the extremes with kMaxCoordinate^5 stays far inside double's range.
inline constexpr double kMinMassValue = 1e-12, kMaxMassValue = 1e15;
inline constexpr double kMaxFriction = 1e3;
inline constexpr double kMaxForce = 1e15;           ///< N and N m
inline constexpr double kMaxTime = 1e9;             ///< s, of keyframes
inline constexpr double kRotationTolerance = 1e-6;  ///< how far |q| may be from 1
inline constexpr std::size_t kMaxNameLength = 1000; ///< bytes

/// Adds every problem of `scene` to `errors`, at JSON pointers ("/bodies/3/rotation"). What depends on a value that
/// already has an error there is not checked. Rotations within tolerance are normalised, and a kinematic body takes the
/// pose of its first keyframe.
void check_description(SceneDescription& scene, ErrorList& errors);

/// Of one body; of its shape `scene` tells the name and whether it has a mass.
void check_body(BodyDescription& body, const SceneDescription& scene, const std::string& path, ErrorList& errors);

/// Of a dynamic body: beyond the limits of gravity and of angular velocities, what its loads add in a step has no
/// meaning. kg; kg m^2, the least of its axes that have any; s.
void check_loads(const BodyDescription& body, double mass, double least_inertia, double time_step,
                 const std::string& path, ErrorList& errors);
/// Of a body whose shape lies on the direction `line` (MassProperties::line): what of its turns may be locked.
void check_line(const BodyDescription& body, const Vec3& line, const std::string& path, ErrorList& errors);
/// Adds to `errors` what no name may be: empty, long, with control characters.
void check_name(const std::string& name, const std::string& path, ErrorList& errors);

/// Of a body that came without one, by its place and how many were there before.
[[nodiscard]] std::string default_body_name(std::size_t place, std::uint32_t generation);

/// Of a shape that came without one: the first of "shape0", "shape1", ... from the list's length on that none has.
[[nodiscard]] std::string default_shape_name(const std::vector<ShapeDescription>& shapes);

/// "/shapes/3", "/bodies/7".
[[nodiscard]] std::string element_path(const char* list, std::size_t index);

} // namespace flotilla
