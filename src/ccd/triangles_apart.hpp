// SPDX-License-Identifier: MIT
// Pairs of triangles that a direction keeps apart, for one traversal of two bodies.
//
// In a shell that another turns in, boxes of its large triangles meet those of nearly all of the other's, and each pair
// of triangles has up to fifteen pairs of features. The normal of one of the two keeps most of them apart, and often
// that of the pair before does. As with leaves (leaf_pairs.hpp, which has the rounding), what is apart along a fixed
// direction at both ends is so in between.
#pragma once

#include <algorithm>

#include "base/index.hpp"
#include "ccd/leaf_pairs.hpp"

namespace flotilla {

class TrianglesApart {
  public:
    /// Farther apart than `clear`, m.
    TrianglesApart(const BodyMotion& a, const BodyMotion& b, double clear)
        : a_(a), b_(b), least_(clear / kLengthRoom + kGapRounding * std::max(a.max_abs(), b.max_abs())) {}

    /// Whether a direction that is tried proves it of triangle i of a and triangle j of b.
    [[nodiscard]] bool operator()(std::int32_t i, std::int32_t j) {
        const Triangle &p = a_.shape->mesh.triangles[at(i)], &q = b_.shape->mesh.triangles[at(j)];
        if (last_ != Vec3{} && apart_along(last_, p, q)) return true;
        for (const Vec3& n : {normal(b_, q), normal(a_, p)}) {
            if (n == Vec3{} || !apart_along(n, p, q)) continue;
            last_ = n;
            return true;
        }
        return false;
    }

  private:
    struct Range {
        double low, high;
    };
    static Range range(const Vec3& d, std::span<const Vec3> x, const Triangle& t) {
        const double u = dot(d, x[at(t[0])]), v = dot(d, x[at(t[1])]), w = dot(d, x[at(t[2])]);
        return {std::min({u, v, w}), std::max({u, v, w})};
    }

    /// The same way round at both ends.
    [[nodiscard]] bool apart_along(const Vec3& d, const Triangle& p, const Triangle& q) const {
        const Range a0 = range(d, a_.at0.x, p), b0 = range(d, b_.at0.x, q);
        const bool a_first = b0.low - a0.high > least_, b_first = a0.low - b0.high > least_;
        if (!a_first && !b_first) return false;
        const Range a1 = range(d, a_.at1.x, p), b1 = range(d, b_.at1.x, q);
        return a_first ? b1.low - a1.high > least_ : a1.low - b1.high > least_;
    }

    /// Between those of a triangle at both ends, of unit length, its components floats; zero where there is none.
    static Vec3 normal(const BodyMotion& body, const Triangle& t) {
        const auto at_end = [&](std::span<const Vec3> x) {
            return cross(x[at(t[1])] - x[at(t[0])], x[at(t[2])] - x[at(t[0])]);
        };
        const Vec3 n = at_end(body.at0.x) + at_end(body.at1.x);
        const double size = length(n);
        if (!(size > 0)) return {};
        return {static_cast<float>(n.x / size), static_cast<float>(n.y / size), static_cast<float>(n.z / size)};
    }

    const BodyMotion &a_, &b_;
    double least_;
    Vec3 last_; ///< the direction that kept a pair apart
};

} // namespace flotilla
