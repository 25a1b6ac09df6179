// SPDX-License-Identifier: MIT
#include "geometry/moving_box.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include <gmpxx.h>
#include <gtest/gtest.h>

namespace flotilla {
namespace {

struct Query {
    Box a0, a1, b0, b1;
    double inflation;
};

/// The first t in [0, 1] at which the boxes are within `inflation` along all axes, in exact rational arithmetic.
std::optional<mpq_class> exact_entry(const Query& q, const mpq_class& inflation) {
    mpq_class enter = 0, leave = 1;
    for (int axis = 0; axis < 3; ++axis)
        for (const bool a_above : {true, false}) {
            const auto gap = [&](const Box& a, const Box& b) -> mpq_class {
                const Box &high = a_above ? a : b, &low = a_above ? b : a;
                return mpq_class(component(high.lower, axis)) - mpq_class(component(low.upper, axis)) - inflation;
            };
            const mpq_class g0 = gap(q.a0, q.b0), g1 = gap(q.a1, q.b1);
            if (g0 > 0 && g1 > 0) return std::nullopt;
            if (g0 > 0) enter = std::max(enter, mpq_class(g0 / (g0 - g1)));
            if (g1 > 0) leave = std::min(leave, mpq_class(g0 / (g0 - g1)));
        }
    return enter <= leave ? std::optional(enter) : std::nullopt;
}

/// Random boxes of one of several kinds: anywhere, on a coarse grid (exact touching, equal times), far from the origin,
/// an ulp or two from the grid, flat.
class Generator {
  public:
    explicit Generator(std::uint64_t seed) : rng_(seed) {}
    Query operator()() {
        kind_ = static_cast<int>(rng_() % 5);
        offset_ = kind_ == 2 ? std::ldexp(1.0, static_cast<int>(rng_() % 24)) : 0.0;
        Query q{box(), box(), box(), box(), 0};
        constexpr std::array kInflations{0.0, 1e-4, 0.01, 0.25, 1.0};
        q.inflation = kInflations[rng_() % kInflations.size()];
        return q;
    }

  private:
    double coordinate() {
        const double x = std::uniform_real_distribution<double>(-2, 2)(rng_);
        if (kind_ == 0 || kind_ == 4) return x;
        if (kind_ == 1) return std::round(4 * x) / 4;
        if (kind_ == 2) return offset_ + x;
        double y = std::round(4 * x) / 4;
        for (std::uint64_t steps = rng_() % 3; steps > 0; --steps)
            y = std::nextafter(y, rng_() % 2 == 0 ? 10.0 : -10.0);
        return y;
    }
    Box box() {
        const Vec3 p{coordinate(), coordinate(), coordinate()}, q{coordinate(), coordinate(), coordinate()};
        Box b = box_of(p, q, p);
        if (kind_ == 4) b.upper.z = b.lower.z;
        return b;
    }
    std::mt19937_64 rng_;
    int kind_ = 0;
    double offset_ = 0;
};

TEST(MovingBox, NeverMissesAnExactOverlapAndIsTight) {
    Generator next(1);
    int overlaps = 0, misses = 0, moving_entries = 0;
    for (int i = 0; i < 60000; ++i) {
        const Query q = next();
        double entry = -1;
        const bool overlap = moving_boxes_overlap(q.a0, q.a1, q.b0, q.b1, q.inflation, entry);
        const auto exact = exact_entry(q, q.inflation);
        if (exact) {
            ASSERT_TRUE(overlap) << i;
            ASSERT_LE(mpq_class(entry), *exact) << i;
            ASSERT_GE(entry, 0);
            ++overlaps;
            moving_entries += entry > 0;
        } else if (!overlap) {
            ++misses;
        } else {
            // A false overlap may only come from the room made for rounding.
            ASSERT_TRUE(exact_entry(q, mpq_class(q.inflation) + mpq_class(1e-6))) << i;
        }
    }
    EXPECT_GT(overlaps, 10000);
    EXPECT_GT(misses, 10000);
    EXPECT_GT(moving_entries, 1000);
}

TEST(MovingBox, EntryTimeIsCloseToTheExactOne) {
    Generator next(2);
    for (int i = 0; i < 20000; ++i) {
        const Query q = next();
        double entry = -1;
        const auto exact = exact_entry(q, q.inflation);
        if (!exact || !moving_boxes_overlap(q.a0, q.a1, q.b0, q.b1, q.inflation, entry)) continue;
        // The allowance grows where the relative motion is slow: measure it by what 1e-7 m more inflation does.
        const auto wider = exact_entry(q, mpq_class(q.inflation) + mpq_class(1e-7));
        ASSERT_GE(entry + 1e-14, wider->get_d()) << i;
    }
}

TEST(MovingBox, PrunesByTheEarliestHitSoFar) {
    // Unit cubes 10 apart, b comes 20 closer: they meet at t = (10 - 1) / 20.
    const Box a{{0, 0, 0}, {1, 1, 1}}, b0{{10, 0, 0}, {11, 1, 1}}, b1{{-10, 0, 0}, {-9, 1, 1}};
    double entry = -1;
    EXPECT_TRUE(moving_boxes_overlap(a, a, b0, b1, 0.0, entry));
    EXPECT_NEAR(entry, 0.45, 1e-14);
    EXPECT_LE(entry, 0.45);
    EXPECT_TRUE(moving_boxes_overlap(a, a, b0, b1, 0.0, entry, 0.45));
    EXPECT_FALSE(moving_boxes_overlap(a, a, b0, b1, 0.0, entry, 0.4499));
    EXPECT_TRUE(moving_boxes_overlap(a, a, b0, b1, 1.0, entry));
    EXPECT_NEAR(entry, 0.40, 1e-14);
}

TEST(MovingBox, TouchingAtOneInstantCounts) {
    // The corners pass each other at t = 1/2, where they touch exactly.
    const Box a{{0, 0, 0}, {1, 1, 1}};
    const Box b0{{2, 0, 0}, {3, 1, 1}}, b1{{0, 2, 0}, {1, 3, 1}};
    double entry = -1;
    EXPECT_TRUE(moving_boxes_overlap(a, a, b0, b1, 0.0, entry));
    EXPECT_NEAR(entry, 0.5, 1e-14);
    const Box c0{{2 + 1e-9, 0, 0}, {3, 1, 1}}, c1{{0 + 1e-9, 2, 0}, {1, 3, 1}};
    EXPECT_FALSE(moving_boxes_overlap(a, a, c0, c1, 0.0, entry));
}

TEST(MovingBox, FallingTogetherIsAMissWhereSweptBoxesOverlap) {
    const Box a0{{0, 0, 30}, {1, 1, 31}}, a1{{0, 0, 0}, {1, 1, 1}};
    const Box b0{{0, 0, 32}, {1, 1, 33}}, b1{{0, 0, 2}, {1, 1, 3}};
    double entry = -1;
    EXPECT_TRUE(boxes_overlap(merged(a0, a1), merged(b0, b1), 0));
    EXPECT_FALSE(moving_boxes_overlap(a0, a1, b0, b1, 0.5, entry));
}

TEST(MovingBox, NotANumberCountsAsOverlap) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Box a{{0, 0, 0}, {1, 1, 1}};
    // Apart along x alone, where one of the two faces is lost.
    const Box apart{{5, 0, 0}, {6, 1, 1}}, all_lost{{nan, nan, nan}, {nan, nan, nan}};
    double entry = -1;
    for (const Box& bad : {Box{{nan, 0, 0}, {6, 1, 1}}, all_lost}) {
        entry = -1;
        EXPECT_TRUE(moving_boxes_overlap(a, a, bad, bad, 0.0, entry));
        EXPECT_EQ(entry, 0);
        EXPECT_TRUE(moving_boxes_overlap(a, a, apart, bad, 0.0, entry));
        EXPECT_TRUE(moving_boxes_overlap(a, a, bad, apart, 0.0, entry));
        EXPECT_EQ(entry, 0);
        EXPECT_TRUE(boxes_overlap(a, bad, 0));
    }
    EXPECT_TRUE(moving_boxes_overlap(a, a, apart, apart, nan, entry));
    EXPECT_FALSE(moving_boxes_overlap(a, a, apart, apart, 0.0, entry));
}

TEST(Box, EmptyIsNeutralAndMergingIsExact) {
    const Box a{{-1, 2, 0.1}, {3, 4, 0.5}};
    EXPECT_EQ(merged(Box{}, a), a);
    EXPECT_EQ(merged(a, Box{}), a);
    EXPECT_EQ(extended(a, {5, 3, 0}), (Box{{-1, 2, 0}, {5, 4, 0.5}}));
    EXPECT_EQ(max_abs_coordinate(Box{{-7, 0, 0}, {3, 4, 5}}), 7);
}

} // namespace
} // namespace flotilla
