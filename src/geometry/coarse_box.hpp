// SPDX-License-Identifier: MIT
// Boxes in single precision, rounded outwards: half the memory of Box and a test of two moving ones in a dozen
// instructions. They only rule out; whatever they let through is decided in double precision.
//
// A box is stored as (lower, -upper). So the smallest box around two is one minimum, and the six gaps of two boxes are
// two sums: a.lower + b.neg_upper holds a.lower - b.upper along x, y and z.
//
// What rounding can do (e = 2^-24; all coordinates have magnitude at most M, see moving_box.hpp for the argument in
// double):
//  1. The stored bounds hold the points exactly: a coordinate's nearest float f is at most e |f| away, and both bounds
//     are moved out by 4 e |f|, two of which survive the rounding of that move.
//  2. A gap is the rounded sum of two stored bounds, so it exceeds the exact gap by at most 2 e M. CoarseReach adds 16
//     e M to the distance asked for: where gap > reach at both ends, the bodies stay farther apart than that distance.
//  3. The root of the line through gap - reach at both ends is found with a relative error of 4 e at most, and lies in
//     [0, 1]: kCoarseTimeSlack = 8 e covers it.
// Coordinates beyond the range of float give infinities, their differences NaN, and NaN means overlap.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/box.hpp"
#include "geometry/float4.hpp"

namespace flotilla {

struct alignas(32) CoarseBox {
    float lower[4] = {}; ///< x, y, z and 0, m
    float neg_upper[4] = {};
};

/// A box whose faces move linearly from t = 0 to t = 1.
struct MovingCoarseBox {
    CoarseBox at0, at1;
};

/// The smallest coarse box of a point.
inline CoarseBox coarse_box(const Vec3& p) {
    constexpr float kOut = 0x1p-22f, kTiny = 0x1p-126f;
    const Float4 f = narrow4(p.x, p.y, p.z, 0), room = both4(kOut) * magnitude(f) + both4_but_last(kTiny);
    CoarseBox box;
    store(box.lower, f - room);
    store(box.neg_upper, (both4(0) - f) - room);
    return box;
}

inline CoarseBox merged(const CoarseBox& a, const CoarseBox& b) {
    CoarseBox box;
    store(box.lower, smaller(load4(a.lower), load4(b.lower)));
    store(box.neg_upper, smaller(load4(a.neg_upper), load4(b.neg_upper)));
    return box;
}

/// The same box in double precision.
inline Box to_box(const CoarseBox& c) {
    return {{c.lower[0], c.lower[1], c.lower[2]}, {-c.neg_upper[0], -c.neg_upper[1], -c.neg_upper[2]}};
}

inline float extent_sum(const CoarseBox& c) {
    return -((c.lower[0] + c.neg_upper[0]) + (c.lower[1] + c.neg_upper[1]) + (c.lower[2] + c.neg_upper[2]));
}

/// A distance (m, >= 0) with room for the rounding of gaps of coordinates up to `max_abs` (m).
class CoarseReach {
  public:
    CoarseReach(double distance, double max_abs)
        : value_(static_cast<float>((distance + 0x1p-20 * max_abs) * (1 + 0x1p-20))) {}
    [[nodiscard]] float distance() const { return value_; } ///< with that room
    [[nodiscard]] Float4 value() const { return both4(value_); }

  private:
    float value_;
};

inline constexpr float kCoarseTimeSlack = 0x1p-21f;

/// Whether two boxes at rest come within the reach.
inline bool coarse_overlap(const CoarseBox& a, const CoarseBox& b, const CoarseReach& reach) {
    const Float4 r = reach.value();
    return !any((load4(a.lower) + load4(b.neg_upper) > r) | (load4(b.lower) + load4(a.neg_upper) > r));
}

/// Whether two moving boxes come within a distance that goes from `reach0` to `reach1`, linearly, at some t in [0,
/// t_max]. `entry_time` becomes a lower bound of the first, in [0, 1], if they do. `slack` is at least
/// kCoarseTimeSlack.
inline bool coarse_overlap(const MovingCoarseBox& a, const MovingCoarseBox& b, const CoarseReach& reach0,
                           const CoarseReach& reach1, float& entry_time, float t_max = 1,
                           float slack = kCoarseTimeSlack) {
    const Float4 r0 = reach0.value(), r1 = reach1.value(), zero = both4(0), one = both4(1);
    const Float4 below0 = load4(a.at0.lower) + load4(b.at0.neg_upper) - r0;
    const Float4 above0 = load4(b.at0.lower) + load4(a.at0.neg_upper) - r0;
    const Float4 below1 = load4(a.at1.lower) + load4(b.at1.neg_upper) - r1;
    const Float4 above1 = load4(b.at1.lower) + load4(a.at1.neg_upper) - r1;
    const Mask4 out_below0 = below0 > zero, out_above0 = above0 > zero;
    const Mask4 out_below1 = below1 > zero, out_above1 = above1 > zero;
    if (any((out_below0 & out_below1) | (out_above0 & out_above1))) return false; // apart along one axis all the time
    entry_time = 0;
    if (!any(out_below0 | out_above0)) return true; // near from the start
    const Float4 below = below0 / (below0 - below1), above = above0 / (above0 - above1);
    const Float4 enter = larger(select_or_zero(out_below0, below), larger(select_or_zero(out_above0, above), zero));
    const Float4 leave = smaller(select(out_below1, below, one), smaller(select(out_above1, above, one), one));
    const float first_time = largest3(enter) - slack, last_time = smallest3(leave) + slack;
    if ((first_time > last_time) | (first_time > t_max)) return false;
    entry_time = std::max(first_time, 0.0f);
    return true;
}

} // namespace flotilla
