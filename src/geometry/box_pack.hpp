// SPDX-License-Identifier: MIT
// A coarse box in registers, two of four floats: the reference that the wide pack must equal bit for bit. Everything
// has internal linkage (box_pack_avx2.hpp says why).
#pragma once

#include "geometry/coarse_box.hpp"

namespace flotilla {
namespace {

/// The six bounds, or six gaps or distances, of coarse boxes.
struct BoxPack {
    Float4 lower, neg_upper;

    static BoxPack load(const CoarseBox& box) { return {load4(box.lower), load4(box.neg_upper)}; }
    static BoxPack all(float x) { return {both4(x), both4(x)}; }
    /// The smallest box around two.
    friend BoxPack merged(BoxPack a, BoxPack b) {
        return {smaller(a.lower, b.lower), smaller(a.neg_upper, b.neg_upper)};
    }
    /// The box as the other one of a pair sees it: a + turned(b) are the six gaps of a and b.
    friend BoxPack turned(BoxPack a) { return {a.neg_upper, a.lower}; }
    friend BoxPack operator+(BoxPack a, BoxPack b) { return {a.lower + b.lower, a.neg_upper + b.neg_upper}; }
    friend BoxPack operator-(BoxPack a, BoxPack b) { return {a.lower - b.lower, a.neg_upper - b.neg_upper}; }
    friend BoxPack operator*(BoxPack a, BoxPack b) { return {a.lower * b.lower, a.neg_upper * b.neg_upper}; }
    /// Of all eight lanes; no NaN among them.
    friend float largest(BoxPack a) { return largest4(larger(a.lower, a.neg_upper)); }
    /// Whether any of the bounds is greater.
    friend bool any_greater(BoxPack a, BoxPack b) { return any((a.lower > b.lower) | (a.neg_upper > b.neg_upper)); }
    /// Whether one and the same bound is greater in both comparisons.
    friend bool any_greater_twice(BoxPack a, BoxPack b, BoxPack c, BoxPack d) {
        return any(((a.lower > b.lower) & (c.lower > d.lower)) |
                   ((a.neg_upper > b.neg_upper) & (c.neg_upper > d.neg_upper)));
    }
};

} // namespace
} // namespace flotilla
