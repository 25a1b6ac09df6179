// SPDX-License-Identifier: MIT
// Cubes that fall on their corners without rebound, friction and gravity, and what becomes of them: an exact sequence of
// hits, as the inertia of a cube is the same about all axes and its spin does not change between them.
#pragma once

#include "physics/problems/history.hpp"

namespace flotilla::physics {

inline constexpr int kFallingCubes = 100;
inline constexpr double kCubeFall = 3; ///< m/s

/// One of them, up to 0.125 m above a plate.
[[nodiscard]] SceneDescription falling_cube(const Start& start, int number);

/// Its velocity upwards after `duration` (s), m/s.
[[nodiscard]] double due_rise_of_cube(int number, double duration);

} // namespace flotilla::physics
