// SPDX-License-Identifier: MIT
// Boxes that move: bounds at t = 0 and at t = 1, everything between them linear.
//
// Let every point of a body move on a segment x(t) = (1 - t) x0 + t x1, and let the boxes hold all points at t = 0 and at
// t = 1. Then the box with faces interpolated in the same way holds them at every t between, for a minimum over points of
// linear functions is at least the line between the two end minima. Two bodies whose boxes fall together at 30 m/s sweep
// far but hardly move relative to each other: moving boxes see that, swept boxes do not.
//
// Along each axis and each way round the gap between two moving boxes is linear in t,
//   G_k(t) = (1 - t) G_k(0) + t G_k(1),   k = 1..6,   such as a.lower.x - b.upper.x,
// and they are within `inflation` of each other along all axes at t exactly where G_k(t) <= inflation for all six k.
//
// What rounding can do (u = 2^-53; underflow is exact in sums). All six coordinates have magnitude at most M.
//  1. Gap: d = fl(a - b) differs from G by at most u |G| <= 2 u M.
//  2. OutwardInflation r >= inflation + 2 u M, so d - r <= G - inflation; g = fl(d - r) has the sign of d - r and is within
//     a factor 1 +- u of it. Hence g > 0 at both ends proves that the gap stays above the inflation: a miss.
//  3. The line through (0, d0 - r) and (1, d1 - r) lies below G_k(t) - inflation, so its root lies before the true entry
//     (after the true exit). fl(g0 / (g0 - g1)), with g0 and g1 of opposite sign, is within a factor (1 + u)^4/(1 - u)^2 of that
//     root, that is within 7 u of it as it is at most 1; kTimeSlack = 8 u covers it in both directions.
// A NaN anywhere makes comparisons false, and false means overlap.
#pragma once

#include <algorithm>

#include "geometry/box.hpp"
#include "geometry/double2.hpp"

namespace flotilla {

/// An inflation with room for the rounding of the moving-box test: made once per pair of bodies, used for all their boxes.
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

/// The six gaps of two boxes at one time, less the inflation.
struct Gaps {
    Double2 lower_upper, upper_lower, z;
};

inline Gaps gaps(const Box& a, const Box& b, Double2 inflation) {
    return {load2(&a.lower.x) - load2(&b.upper.x) - inflation, load2(&b.lower.x) - load2(&a.upper.x) - inflation,
            pair2(a.lower.z, b.lower.z) - pair2(b.upper.z, a.upper.z) - inflation};
}

} // namespace moving_box_detail

/// Whether the boxes a (a0 at t = 0, a1 at t = 1) and b come within the inflation of each other at some t in [0, t_max].
/// Conservative for all points inside that move linearly: false is a proof. `entry_time` becomes a lower bound of the first
/// such time, in [0, 1]; it is set only where the result is true.
inline bool moving_boxes_overlap(const Box& a0, const Box& a1, const Box& b0, const Box& b1, OutwardInflation inflation,
                                 double& entry_time, double t_max = 1) {
    const Double2 r = both(inflation.value()), zero = both(0), one = both(1);
    const auto g0 = moving_box_detail::gaps(a0, b0, r), g1 = moving_box_detail::gaps(a1, b1, r);
    const Mask2 p0 = g0.lower_upper > zero, q0 = g0.upper_lower > zero, z0 = g0.z > zero;
    const Mask2 p1 = g1.lower_upper > zero, q1 = g1.upper_lower > zero, z1 = g1.z > zero;
    if (any((p0 & p1) | (q0 & q1) | (z0 & z1))) return false; // apart along one axis all the time
    entry_time = 0;
    if (!any(p0 | q0 | z0)) return true; // near from the start
    const Double2 tp = g0.lower_upper / (g0.lower_upper - g1.lower_upper);
    const Double2 tq = g0.upper_lower / (g0.upper_lower - g1.upper_lower);
    const Double2 tz = g0.z / (g0.z - g1.z);
    // The running value stands second: larger() and smaller() drop a NaN in the first.
    Double2 enter = larger(select_or_zero(p0, tp), zero);
    enter = larger(select_or_zero(q0, tq), enter);
    enter = larger(select_or_zero(z0, tz), enter);
    Double2 leave = smaller(select(p1, tp, one), one);
    leave = smaller(select(q1, tq, one), leave);
    leave = smaller(select(z1, tz, one), leave);
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
