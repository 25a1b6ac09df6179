// SPDX-License-Identifier: MIT
// When two swept bodies are a candidate pair.
#pragma once

#include "state/candidate_pairs.hpp"

namespace flotilla {

/// With room for rounding: boxes that come within the sum of their reaches of each other overlap when inflated.
inline Box inflated(const Box& box, double by) {
    constexpr double kRounding = 0x1p-50;
    const double room = by + kRounding * (by + max_abs_coordinate(box));
    const Vec3 r{room, room, room};
    return {box.lower - r, box.upper + r};
}
inline Box inflated(const SweptBody& b) { return inflated(b.box, b.reach); }

/// `wakes`: see PairSearch.
inline bool may_pair(const SweptBody& a, const SweptBody& b, bool wakes) {
    const auto reach = [&](const SweptBody& x) { return wakes ? x.reach + x.waking_reach : x.reach; };
    const auto movable = [&](const SweptBody& x) { return x.movable || (wakes && x.waking_reach > 0); };
    return (movable(a) || movable(b)) && boxes_overlap(a.box, b.box, reach(a) + reach(b));
}

} // namespace flotilla
