// SPDX-License-Identifier: MIT
// What slides: on slopes, thrown on the level.
#pragma once

#include "physics/problems/history.hpp"

namespace flotilla::physics {

/// A flat body on a slope that falls towards `heading`, at its rest distance, turned with the slope.
struct Slope {
    double angle = 0, heading = 0; ///< radians
    [[nodiscard]] Quat tilt() const {
        return rotation_from_vector({0, 0, heading}) * rotation_from_vector({0, angle, 0});
    }
    [[nodiscard]] Vec3 down() const { return rotate(tilt(), {1, 0, 0}); }
    [[nodiscard]] Vec3 aside() const { return rotate(tilt(), {0, 1, 0}); }
    /// m/s^2, of a body that slides.
    [[nodiscard]] double rate(double friction) const;
};

[[nodiscard]] SceneDescription on_slope(const Start& start, const Slope& slope, double friction, TriangleMesh mesh,
                                        double half_height, double mass = 5);
[[nodiscard]] SceneDescription block_on_slope(const Start& start, const Slope& slope, double friction);

/// What was gained between 0.5 s and 1.5 s.
struct Sliding {
    double share;  ///< of the due rate
    double turned; ///< radians, away from the slope's fall
};
[[nodiscard]] Sliding sliding(const History& history, const Slope& slope, double friction);
/// m, of the first body along the slope.
[[nodiscard]] double way_down(const History& history, const Slope& slope);

inline constexpr double kThrownSpeed = 5, kThrownFriction = 0.3;
[[nodiscard]] SceneDescription thrown_block(const Start& start, double heading);
struct Thrown {
    double share;  ///< of the due way
    double turned; ///< radians
};
[[nodiscard]] Thrown thrown(const History& history, double heading);

/// A spinning disc-like box that also slides: friction of its corners turns with it, its path stays straight by
/// symmetry.
[[nodiscard]] SceneDescription spinning_block(const Start& start);

} // namespace flotilla::physics
