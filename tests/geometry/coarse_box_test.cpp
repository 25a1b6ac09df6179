// SPDX-License-Identifier: MIT
// Single-precision boxes never rule out what double precision lets through.
#include "geometry/coarse_box.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "geometry/moving_box.hpp"

namespace flotilla {
namespace {

double uniform(std::int64_t n, std::int64_t k) { return 2 * unit_interval(random_bits(n, k)) - 1; }
Vec3 point(std::int64_t n, std::int64_t k) { return {uniform(n, 3 * k), uniform(n, 3 * k + 1), uniform(n, 3 * k + 2)}; }

/// A box around two points in both precisions.
struct Both {
    Box box;
    CoarseBox coarse;
    Both(const Vec3& p, const Vec3& q)
        : box(extended(extended({}, p), q)), coarse(merged(coarse_box(p), coarse_box(q))) {}
};

TEST(CoarseBox, HoldsItsPoints) {
    for (std::int64_t n = 0; n < 20000; ++n) {
        const Vec3 p = std::ldexp(1.0, static_cast<int>(n % 60) - 40) * point(n, 0);
        const Box box = to_box(coarse_box(p));
        EXPECT_TRUE(box.lower.x <= p.x && p.x <= box.upper.x);
        EXPECT_TRUE(box.lower.y <= p.y && p.y <= box.upper.y);
        EXPECT_TRUE(box.lower.z <= p.z && p.z <= box.upper.z);
        EXPECT_LE(max_component(extent(box)), 0x1p-20 * max_component(abs(p)) + 1e-37);
    }
}

TEST(CoarseBox, OverlapsWhereTheDoubleBoxesDo) {
    int overlaps = 0, misses = 0, near_misses = 0;
    for (std::int64_t n = 0; n < 200000; ++n) {
        const double offset = n % 3 == 0 ? 0 : n % 3 == 1 ? 20 : 1e5, spread = n % 5 == 0 ? 0.02 : 1;
        const Vec3 center = offset * point(n, 20);
        const auto at = [&](std::int64_t k) { return center + spread * point(n, k); };
        const Both a0(at(0), at(1)), a1(at(2), at(3)), b0(at(4), at(5)), b1(at(6), at(7));
        const double reach = n % 2 == 0 ? 2e-4 : 0.05, t_max = n % 4 == 0 ? 0.5 : 1;
        const CoarseReach coarse_reach(reach, offset + 2);
        double entry = 0;
        float coarse_entry = 0;
        const bool meet = moving_boxes_overlap(a0.box, a1.box, b0.box, b1.box, reach, entry, t_max);
        const MovingCoarseBox a{a0.coarse, a1.coarse}, b{b0.coarse, b1.coarse};
        const bool coarse = coarse_overlap(a, b, coarse_reach, coarse_reach, coarse_entry, static_cast<float>(t_max));
        if (meet) {
            ASSERT_TRUE(coarse);
            EXPECT_LE(double{coarse_entry}, entry + 1e-15);
        }
        EXPECT_TRUE(coarse_overlap(a0.coarse, b0.coarse, coarse_reach) || !boxes_overlap(a0.box, b0.box, reach));
        ++(meet ? overlaps : misses);
        near_misses += !meet && coarse ? 1 : 0;
    }
    EXPECT_GE(overlaps, 20000);
    EXPECT_GE(misses, 20000);
    EXPECT_LE(near_misses, misses / 5); // it also rules out: far from the origin a float ends at centimetres
}

TEST(CoarseBox, InfiniteCoordinatesOverlap) {
    const CoarseBox far = coarse_box({1e300, 0, 0}), near = coarse_box({0, 0, 0});
    const CoarseReach reach(1e-3, 1e300);
    float entry = 0;
    EXPECT_TRUE(coarse_overlap(far, near, reach));
    EXPECT_TRUE(coarse_overlap({far, near}, {near, far}, reach, reach, entry));
}

} // namespace
} // namespace flotilla
