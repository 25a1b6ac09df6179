// SPDX-License-Identifier: MIT
// Flight and impacts.
#pragma once

#include "physics/problems/history.hpp"

namespace flotilla::physics {

/// A spinning box that is thrown up.
[[nodiscard]] SceneDescription projectile(const Start& start);
/// m, the largest distance of its centre of mass from the parabola.
[[nodiscard]] double off_parabola(const History& history);

inline constexpr double kDrop = 5;
/// A body on a single point, kDrop above a plate, each rise of which is e^2 of that before.
[[nodiscard]] SceneDescription bouncing(const Start& start, double e);
/// s, when it has bounced for ever.
[[nodiscard]] double due_end_of_bouncing(double e);
struct Bounces {
    std::vector<double> heights;
    double end_of_bouncing = 0; ///< s, since when it stays within a rest distance of the plate
};
[[nodiscard]] Bounces bounces(const History& history);

/// A crate that falls flat from 1 m.
[[nodiscard]] SceneDescription flat_crate(const Start& start, double e);

/// A bar of 1 m along x that falls flat by `drop` m across the top of a fixed rail, its centre `aside` m beside that.
[[nodiscard]] SceneDescription bar_over_rail(const Start& start, double drop, double aside, double friction, double e);
/// A plate that falls flat by `drop` m on a fixed block smaller than it.
[[nodiscard]] SceneDescription plate_over_block(const Start& start, double drop, double e);

/// Boxes that fall flat on a plate, `gap` m between them, edge above edge.
[[nodiscard]] SceneDescription flat_boxes(const Start& start, int count, double gap, double e);

inline constexpr int kThrownBoxes = 24;
/// The i-th of these boxes, thrown without gravity obliquely at a plate, flat or turned, on `cells` by `cells` cells.
[[nodiscard]] SceneDescription thrown_box(const Start& start, int i, int cells, double e);

inline constexpr int kCradleBodies = 5;
inline constexpr double kCradleSpeed = 2;
/// Equal bodies in a row, met one after the other: the last one leaves with ((1 + e) / 2)^(N - 1) of the first one's
/// speed.
[[nodiscard]] SceneDescription cradle(const Start& start, double e);
[[nodiscard]] double due_cradle_speed(double e);

} // namespace flotilla::physics
