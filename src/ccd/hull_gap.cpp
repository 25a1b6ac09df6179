// SPDX-License-Identifier: MIT
#include "ccd/hull_gap.hpp"

#include <algorithm>

#include "geometry/rounding.hpp"

namespace flotilla {
namespace {

constexpr int kTrials = 5;
constexpr double kScaleRoom = 1 - kLengthRounding; // a unit vector's length is rounded by less

/// Hulls at one end.
struct Ends {
    const BodyMotion &a, &b;

    struct Look {
        double gap;
        Vec3 between; ///< from the point of a to that of b that are separated least
    };
    [[nodiscard]] Look look(const BodyPlacement& at_a, const BodyPlacement& at_b, const Vec3& d) const {
        const Support p = reach(a.shape->outline, transpose(*at_a.rotation) * d);
        const Support q = reach(b.shape->outline, transpose(*at_b.rotation) * -d);
        const double gap = dot(d, at_b.pose->origin - at_a.pose->origin) - q.reach - p.reach;
        return {gap, at_b.x[std::min(q.place, at_b.x.size() - 1)] - at_a.x[std::min(p.place, at_a.x.size() - 1)]};
    }
};

} // namespace

HullGap find_hull_gap(const BodyMotion& a, const BodyMotion& b, double wanted, Vec3& direction) {
    const SupportPoints &of_a = a.shape->outline, &of_b = b.shape->outline;
    if (of_a.fours.empty() || of_b.fours.empty()) return {};
    const Ends ends{a, b};
    const bool still = a.still() && b.still();
    const double error = of_a.error + of_b.error + place_rounding(std::max(a.max_abs(), b.max_abs()));
    Vec3 d = direction;
    if (d == Vec3{}) d = center(*b.at1.box) - center(*a.at1.box);
    HullGap best;
    for (int trial = 0; trial < kTrials; ++trial) {
        const double size = length(d);
        if (!(size > 0)) break;
        d = d / size;
        const auto at1 = ends.look(a.at1, b.at1, d);
        const auto at0 = still ? at1 : ends.look(a.at0, b.at0, d);
        const double start = kScaleRoom * (at0.gap - error), end = kScaleRoom * (at1.gap - error);
        if (trial == 0 || std::min(start, end) > std::min(best.start, best.end)) {
            best = {start, end};
            direction = d;
        }
        if (start > wanted && end > wanted) break;
        const Vec3& r = at0.gap < at1.gap ? at0.between : at1.between;
        const double along = dot(d, r), size_sq = length_sq(r);
        if (!(size_sq > 0)) break;
        d -= (2 * along / size_sq) * r;
    }
    return best;
}

} // namespace flotilla
