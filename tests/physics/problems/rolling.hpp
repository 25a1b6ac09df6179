// SPDX-License-Identifier: MIT
// What rolls: on the level, down a slope, and from sliding to rolling.
#pragma once

#include "physics/problems/history.hpp"

namespace flotilla::physics {

inline constexpr double kRollerRadius = 0.5; // m

/// What rolls about the y axis. `inertia` is that about this axis over m r^2.
struct Roller {
    const char* name;
    TriangleMesh (*mesh)();
    bool solid, round; ///< closed; a ball
    double inertia;
    double sides; ///< around
};

template <int sides>
TriangleMesh cylinder_mesh() {
    return make_cylinder(kRollerRadius, 0.6, sides);
}
inline TriangleMesh tube_mesh() { return make_tube(kRollerRadius, 0.6, 512); }
inline TriangleMesh ball_mesh() { return make_sphere(kRollerRadius, 5); }
inline TriangleMesh coarse_ball_mesh() { return make_sphere(kRollerRadius, 3); }

inline constexpr Roller kCylinder{"Cylinder512", cylinder_mesh<512>, true, false, 1.0 / 2, 512};
inline constexpr Roller kTube{"Tube512", tube_mesh, false, false, 1, 512};
// A ball of 20 4^n triangles has about 5 2^n sides around.
inline constexpr Roller kBall{"Ball20480", ball_mesh, true, true, 2.0 / 5, 160};
inline constexpr Roller kHollowBall{"HollowBall20480", ball_mesh, false, true, 2.0 / 3, 160};
inline constexpr Roller kCoarseBall{"Ball1280", coarse_ball_mesh, true, true, 2.0 / 5, 40};

/// How a roller is let go.
struct Release {
    double slope = 0, friction = 0.5, speed = 0, spin = 0; ///< radians; m/s down the slope; rad/s
};
/// It rests on a side of its own (a vertex, for a ball) at the place where the slope's normal meets it, and rolls
/// towards +x.
[[nodiscard]] SceneDescription rolling_scene(const Start& start, const Roller& roller, const Release& release);

/// A polygon of n sides that rolls with pure impacts on its next corner loses (2 pi / n)^2 / 2 of its speed times 1 /
/// (1 + inertia) each side: over an angle a it keeps exp(-pi a / n / (1 + inertia)), 99 % of a cylinder of 512 sides.
[[nodiscard]] double kept_by_facets(const Roller& roller, double angle);

/// How far, in sides, a regular prism of n sides rolls that stands on a corner and turns about it at `spin` (rad/s).
/// Each landing is a plastic impact, which keeps the angular momentum about the corner that lands; on the way up to a
/// corner and down from it the energy stays.
[[nodiscard]] double sides_of_prism(int sides, double spin);

/// Of a round body that rolls down: speed over that due, at the end.
[[nodiscard]] double rolled_share(const History& history, const Roller& roller, double slope);

inline constexpr double kRollingSpeed = 2, kRollingFriction = 0.1;
/// Friction mu g brakes the sliding until the point of contact rests.
struct SlideToRoll {
    double time = 0, speed = 0; ///< s, m/s: when it first rolled
};
[[nodiscard]] SlideToRoll due_to_roll(const Roller& roller);
[[nodiscard]] SlideToRoll slide_to_roll(const History& history);

/// A body needs friction of inertia / (1 + inertia) tan to roll: with `share` of it, slip over speed.
[[nodiscard]] double least_rolling_friction(const Roller& roller, double slope);
[[nodiscard]] double slip(const History& history, double slope);
[[nodiscard]] double due_slip(const Roller& roller, double slope, double share);

} // namespace flotilla::physics
