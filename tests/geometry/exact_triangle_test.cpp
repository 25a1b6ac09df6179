// SPDX-License-Identifier: MIT
#include "geometry/exact/triangle_triangle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "geometry/exact_pairs.hpp"

namespace flotilla::exact {
namespace {

using test::Corners;

constexpr Corners kUnit{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};

double above(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }

Corners moved(const Corners& t, const Vec3& by) { return {t[0] + by, t[1] + by, t[2] + by}; }

TEST(TrianglesIntersect, SeparatesByOneUlpOfHeight) {
    const Corners upright{Vec3{0.25, 0.25, 0}, Vec3{0.25, 0.25, 1}, Vec3{0.5, 0.25, 1}};
    const double least = std::numeric_limits<double>::denorm_min();
    EXPECT_TRUE(triangles_intersect(kUnit, upright));
    EXPECT_TRUE(triangles_intersect(kUnit, moved(upright, {0, 0, -least})));
    EXPECT_FALSE(triangles_intersect(kUnit, moved(upright, {0, 0, least})));
}

TEST(TrianglesIntersect, CoplanarTouchingCountsAndOneUlpApartDoesNot) {
    EXPECT_TRUE(triangles_intersect(kUnit, kUnit));
    EXPECT_TRUE(triangles_intersect(kUnit, moved(kUnit, {1, 0, 0})));
    EXPECT_FALSE(triangles_intersect(kUnit, moved(kUnit, {above(1), 0, 0})));
    EXPECT_TRUE(triangles_intersect(kUnit, {Vec3{1, 1, 0}, Vec3{0.5, 0.5, 0}, Vec3{1, 0.75, 0}}));
    EXPECT_FALSE(triangles_intersect(kUnit, {Vec3{1, 1, 0}, Vec3{0.5, above(0.5), 0}, Vec3{1, 0.75, 0}}));
    EXPECT_TRUE(triangles_intersect(kUnit, {Vec3{-9, -9, 0}, Vec3{30, -9, 0}, Vec3{-9, 30, 0}}));
    EXPECT_FALSE(triangles_intersect(kUnit, moved(kUnit, {0, 0, std::numeric_limits<double>::denorm_min()})));
}

TEST(TrianglesIntersect, LinkedTriangles) {
    const Corners through{Vec3{0.2, 0.2, -1}, Vec3{0.2, 0.2, 1}, Vec3{9, 9, 0}};
    const Corners beside{Vec3{-1, 0.5, -1}, Vec3{-1, 0.5, 1}, Vec3{-1e-300, 0.5, 0}};
    EXPECT_TRUE(triangles_intersect(kUnit, through));
    EXPECT_FALSE(triangles_intersect(kUnit, beside));
    EXPECT_TRUE(triangles_intersect(kUnit, moved(beside, {0.25, 0, 0})));
}

TEST(TrianglesIntersect, PointsAndSegments) {
    const auto point = [](const Vec3& p) { return Corners{p, p, p}; };
    EXPECT_TRUE(triangles_intersect(point({0.1, 0.2, 0.3}), point({0.1, 0.2, 0.3})));
    EXPECT_FALSE(triangles_intersect(point({0.1, 0.2, 0.3}), point({0.1, 0.2, above(0.3)})));
    EXPECT_TRUE(triangles_intersect(point({0.5, 0.5, 0}), kUnit));
    EXPECT_FALSE(triangles_intersect(point({0.5, above(0.5), 0}), kUnit));
    const Corners diagonal{Vec3{0, 0, 0}, Vec3{3, 3, 3}, Vec3{1, 1, 1}};
    EXPECT_TRUE(triangles_intersect(diagonal, point({2, 2, 2})));
    EXPECT_FALSE(triangles_intersect(diagonal, point({2, 2, above(2)})));
    EXPECT_FALSE(triangles_intersect(diagonal, point({above(3), above(3), above(3)})));
    EXPECT_TRUE(triangles_intersect(diagonal, moved(diagonal, {3, 3, 3})));
    EXPECT_FALSE(triangles_intersect(diagonal, moved(diagonal, {0, 0, 1})));
    EXPECT_TRUE(triangles_intersect(diagonal, {Vec3{0, 2, 1}, Vec3{4, 2, 3}, Vec3{2, 2, 2}}));
}

TEST(TrianglesIntersect, IsIndependentOfOrder) {
    test::Random r(21);
    for (const test::PairClass& pairs : test::kPairClasses)
        for (int i = 0; i < 300; ++i) {
            auto [a, b] = pairs.make(r);
            const bool expected = triangles_intersect(a, b);
            ASSERT_EQ(triangles_intersect_unboxed(a, b), expected) << pairs.name;
            for (int k = 0; k < 6; ++k) {
                std::swap(a[0], a[static_cast<std::size_t>(1 + k % 2)]);
                for (int l = 0; l < 6; ++l) {
                    std::swap(b[0], b[static_cast<std::size_t>(1 + l % 2)]);
                    ASSERT_EQ(triangles_intersect(a, b), expected) << pairs.name;
                    ASSERT_EQ(triangles_intersect(b, a), expected) << pairs.name;
                }
            }
        }
}

/// Two triangles meet exactly where an edge of one meets the other, or one edge of it is the whole of it: a second,
/// differently built decision of the same question.
TEST(TrianglesIntersect, AgreesWithItsEdges) {
    test::Random r(22);
    for (const test::PairClass& pairs : test::kPairClasses)
        for (int i = 0; i < 1000; ++i) {
            const auto [a, b] = pairs.make(r);
            bool edges = false;
            for (std::size_t k = 0; k < 3; ++k) {
                edges = edges || segment_intersects_triangle(a[k], a[(k + 1) % 3], b);
                edges = edges || segment_intersects_triangle(b[k], b[(k + 1) % 3], a);
            }
            ASSERT_EQ(triangles_intersect(a, b), edges) << pairs.name << " " << i;
        }
}

TEST(SegmentIntersectsTriangle, EqualsTheDegenerateTriangle) {
    test::Random r(23);
    for (const test::PairClass& pairs : test::kPairClasses)
        for (int i = 0; i < 1000; ++i) {
            const auto [a, b] = pairs.make(r);
            const bool expected = triangles_intersect({a[0], a[1], a[1]}, b);
            ASSERT_EQ(segment_intersects_triangle(a[0], a[1], b), expected) << pairs.name << " " << i;
            ASSERT_EQ(segment_intersects_triangle(a[1], a[0], b), expected) << pairs.name << " " << i;
            ASSERT_EQ(segment_intersects_triangle(a[2], a[2], b), triangles_intersect({a[2], a[2], a[2]}, b));
        }
}

TEST(BoxesDisjoint, TouchingBoxesAreNot) {
    EXPECT_FALSE(boxes_disjoint(kUnit, moved(kUnit, {1, 1, 0})));
    EXPECT_TRUE(boxes_disjoint(kUnit, moved(kUnit, {above(1), 0, 0})));
    EXPECT_TRUE(boxes_disjoint(moved(kUnit, {0, 0, 1e-300}), kUnit));
}

} // namespace
} // namespace flotilla::exact
