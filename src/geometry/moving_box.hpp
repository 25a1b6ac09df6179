// SPDX-License-Identifier: MIT
// Boxes that move: bounds at t = 0 and at t = 1, everything between them linear.
//
// Let every point of a body move on a segment x(t) = (1 - t) x0 + t x1, and let the boxes hold all points at t = 0 and
// at t = 1. Then the box with faces interpolated in the same way holds them at every t between, for a minimum over
// points of linear functions is at least the line between the two end minima. Two bodies whose boxes fall together at
// 30 m/s sweep far but hardly move relative to each other: moving boxes see that, swept boxes do not.
//
// Along each axis and each way round the gap between two moving boxes is linear in t,
//   G_k(t) = (1 - t) G_k(0) + t G_k(1),   k = 1..6,   such as a.lower.x - b.upper.x,
// and they are within `inflation` of each other along all axes at t exactly where G_k(t) <= inflation for all six k.
//
// What rounding can do (u = 2^-53; underflow is exact in sums). All six coordinates have magnitude at most M.
//  1. Gap: d = fl(a - b) differs from G by at most u |G| <= 2 u M.
//  2. OutwardInflation r >= inflation + 2 u M, so d - r <= G - inflation: where d > r at both ends, the gap stays
//     above the inflation. A miss.
//  3. The line through (0, d0 - r) and (1, d1 - r) lies below G_k(t) - inflation, so its root (d0 - r) / (d0 - d1)
//     lies before the true entry (d0 > r >= d1) or after the true exit (d0 <= r < d1). Three roundings put the
//     computed root within a factor (1 + u)^2 / (1 - u) of it, that is within 4 u as it is at most 1; kTimeSlack = 8 u
//     covers that either way.
// A NaN anywhere makes comparisons false, and false means overlap. Coordinates beyond 2^1000 are outside this argument.
#pragma once

#include <algorithm>

#include "geometry/box.hpp"
#include "geometry/double2.hpp"

namespace flotilla {

/// An inflation with room for the rounding of the moving-box test: made once per pair of bodies, used for all their
/// boxes.
class OutwardInflation {
  public:
    /// `inflation` (m, >= 0) is the separation to be covered, `max_abs` (m) bounds the magnitude of all coordinates.
    OutwardInflation(double inflation, double max_abs)
        // 4 u M instead of 2 u M, and a factor 1 + 4 u, pay for the rounding of this line.
        : value_((inflation + 0x1p-51 * max_abs) * (1 + 0x1p-51)) {}
    [[nodiscard]] double value() const { return value_; }

  private:
    double value_;
};

/// See 3. above.
inline constexpr double kTimeSlack = 0x1p-50;

namespace moving_box_detail {

/// The gaps of two boxes at one time.
struct Gaps {
    Double2 below; ///< a.lower - b.upper along x and y
    Double2 above; ///< b.lower - a.upper along x and y
    Double2 z;     ///< both along z
};

inline Gaps gaps(const Box& a, const Box& b) {
    return {load2(&a.lower.x) - load2(&b.upper.x), load2(&b.lower.x) - load2(&a.upper.x),
            pair2(a.lower.z, b.lower.z) - pair2(b.upper.z, a.upper.z)};
}

} // namespace moving_box_detail

/// Whether the boxes a (a0 at t = 0, a1 at t = 1) and b come within the inflation of each other at some t in [0,
/// t_max], t_max >= 0. Conservative for all points inside that move linearly: false is a proof. `entry_time` becomes a
/// lower bound of the first such time, in [0, 1]; it means nothing where the result is false.
inline bool moving_boxes_overlap(const Box& a0, const Box& a1, const Box& b0, const Box& b1, OutwardInflation inflation,
                                 double& entry_time, double t_max = 1) {
    const Double2 r = both(inflation.value()), zero = both(0), one = both(1);
    const auto d0 = moving_box_detail::gaps(a0, b0), d1 = moving_box_detail::gaps(a1, b1);
    const Mask2 below0 = d0.below > r, above0 = d0.above > r, z0 = d0.z > r;
    const Mask2 below1 = d1.below > r, above1 = d1.above > r, z1 = d1.z > r;
    if (any((below0 & below1) | (above0 & above1) | (z0 & z1))) return false; // apart along one axis all the time
    entry_time = 0;
    if (!any(below0 | above0 | z0)) return true; // near from the start
    const Double2 below = (d0.below - r) / (d0.below - d1.below);
    const Double2 above = (d0.above - r) / (d0.above - d1.above);
    const Double2 z = (d0.z - r) / (d0.z - d1.z);
    // The running value stands second: larger() and smaller() drop a NaN in the first.
    Double2 enter = larger(select_or_zero(below0, below), zero);
    enter = larger(select_or_zero(above0, above), enter);
    enter = larger(select_or_zero(z0, z), enter);
    Double2 leave = smaller(select(below1, below, one), one);
    leave = smaller(select(above1, above, one), leave);
    leave = smaller(select(z1, z, one), leave);
    const double first_time = std::max(first(enter), second(enter)) - kTimeSlack;
    const double last_time = std::min(first(leave), second(leave)) + kTimeSlack;
    if ((first_time > last_time) | (first_time > t_max)) return false;
    entry_time = std::max(first_time, 0.0);
    return true;
}

/// The same for two boxes on their own: finds the room for rounding itself.
inline bool moving_boxes_overlap(const Box& a0, const Box& a1, const Box& b0, const Box& b1, double inflation,
                                 double& entry_time, double t_max = 1) {
    const double max_abs = std::max(std::max(max_abs_coordinate(a0), max_abs_coordinate(a1)),
                                    std::max(max_abs_coordinate(b0), max_abs_coordinate(b1)));
    return moving_boxes_overlap(a0, a1, b0, b1, OutwardInflation(inflation, max_abs), entry_time, t_max);
}

} // namespace flotilla
