// SPDX-License-Identifier: MIT
#include "geometry/closest.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "base/rotation.hpp"
#include "geometry/ray.hpp"

namespace flotilla {
namespace {

using Tri = std::array<Vec3, 3>;

/// Least squared distance from v to the triangle by projecting onto a shrinking grid of barycentric coordinates: slow,
/// independent of the code under test, right to about 1e-12 of the size.
double sampled_distance_sq(const Vec3& v, const Tri& f) {
    double best = length_sq(v - f[0]), b1 = 0, b2 = 0;
    for (double step = 0.25; step > 1e-8; step *= 0.5) {
        const double c1 = b1, c2 = b2;
        for (int i = -4; i <= 4; ++i)
            for (int j = -4; j <= 4; ++j) {
                const double u = std::clamp(c1 + i * step, 0.0, 1.0), w = std::clamp(c2 + j * step, 0.0, 1.0 - u);
                const double d = length_sq(v - (f[0] + u * (f[1] - f[0]) + w * (f[2] - f[0])));
                if (d < best) best = d, b1 = u, b2 = w;
            }
    }
    return best;
}

Vec3 lattice_or_random(std::mt19937_64& rng, bool lattice) {
    if (lattice) {
        std::uniform_int_distribution<int> c(-1, 1);
        return {double(c(rng)), double(c(rng)), double(c(rng))};
    }
    std::uniform_real_distribution<double> c(-1, 1);
    return {c(rng), c(rng), c(rng)};
}

TEST(ClosestVertexTriangle, FindsFaceEdgeAndVertexRegions) {
    const Vec3 f0{0, 0, 0}, f1{1, 0, 0}, f2{0, 1, 0};
    EXPECT_DOUBLE_EQ(closest_vertex_triangle({0.25, 0.25, 2}, f0, f1, f2).distance_sq, 4);
    EXPECT_DOUBLE_EQ(closest_vertex_triangle({0.5, -3, 0}, f0, f1, f2).distance_sq, 9);
    EXPECT_DOUBLE_EQ(closest_vertex_triangle({-3, -4, 0}, f0, f1, f2).distance_sq, 25);
}

TEST(ClosestVertexTriangle, AgreesWithASearchOnRandomAndDegenerateTriangles) {
    std::mt19937_64 rng(11);
    for (int i = 0; i < 1500; ++i) {
        const bool lattice = i % 3 != 0; // many zero-area triangles and coplanar points
        const Tri f{lattice_or_random(rng, lattice), lattice_or_random(rng, lattice), lattice_or_random(rng, lattice)};
        const Vec3 v = lattice_or_random(rng, lattice);
        const auto c = closest_vertex_triangle(v, f[0], f[1], f[2]);
        ASSERT_NEAR(c.distance_sq, sampled_distance_sq(v, f), 1e-6) << i;
        ASSERT_LE(c.distance_sq, sampled_distance_sq(v, f) + 1e-14) << i;
        const auto& b = c.barycentric;
        ASSERT_GE(std::min({b[0], b[1], b[2]}), 0);
        ASSERT_NEAR(b[0] + b[1] + b[2], 1, 1e-12);
        ASSERT_NEAR(length(b[0] * f[0] + b[1] * f[1] + b[2] * f[2] - c.point), 0, 1e-12);
    }
}

TEST(ClosestVertexTriangle, SurvivesNeedlesAndPoints) {
    const Vec3 p{1, 2, 3};
    EXPECT_EQ(closest_vertex_triangle(p, p, p, p).distance_sq, 0);
    const auto c = closest_vertex_triangle({0.5, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0.5, 1e-300, 0});
    EXPECT_NEAR(c.distance_sq, 1, 1e-15);
}

TEST(ClosestEdgeEdge, AgreesWithTheVertexSegmentBoundAndPerpendicularFeet) {
    std::mt19937_64 rng(12);
    for (int i = 0; i < 20000; ++i) {
        const bool lattice = i % 2 == 0; // parallel, crossing and zero-length edges
        const Vec3 a0 = lattice_or_random(rng, lattice), a1 = lattice_or_random(rng, lattice);
        const Vec3 b0 = lattice_or_random(rng, lattice), b1 = lattice_or_random(rng, lattice);
        const auto c = closest_edge_edge(a0, a1, b0, b1);
        ASSERT_GE(c.s, 0);
        ASSERT_LE(c.s, 1);
        ASSERT_GE(c.t, 0);
        ASSERT_LE(c.t, 1);
        ASSERT_NEAR(length(a0 + c.s * (a1 - a0) - c.p), 0, 1e-15);
        ASSERT_NEAR(length(b0 + c.t * (b1 - b0) - c.q), 0, 1e-15);
        // Optimality (the problem is convex): no feasible change of s or t shortens the connection.
        const Vec3 r = c.p - c.q;
        const double ds = dot(r, a1 - a0), dt = -dot(r, b1 - b0);
        ASSERT_GE(c.s == 0 ? ds : c.s == 1 ? -ds : -std::abs(ds), -1e-9) << i;
        ASSERT_GE(c.t == 0 ? dt : c.t == 1 ? -dt : -std::abs(dt), -1e-9) << i;
    }
}

TEST(ClosestTriangleTriangle, IsZeroForCrossingAndNestedTriangles) {
    const Tri big{Vec3{-9, -9, 0}, Vec3{9, -9, 0}, Vec3{0, 9, 0}};
    EXPECT_EQ(closest_triangle_triangle(big, {Vec3{0, 0, -1}, Vec3{0.1, 0, 1}, Vec3{0, 0.1, 1}}).distance_sq, 0);
    EXPECT_EQ(closest_triangle_triangle(big, {Vec3{0, 0, 0}, Vec3{0.1, 0, 0}, Vec3{0, 0.1, 0}}).distance_sq, 0);
    const auto apart = closest_triangle_triangle(big, {Vec3{0, 0, 2}, Vec3{0.1, 0, 3}, Vec3{0, 0.1, 3}});
    EXPECT_DOUBLE_EQ(apart.distance_sq, 4);
}

// Triangles in planes that are one but for rounding, 50 mm apart: whether edges of one pass through the other is noise.
TEST(ClosestTriangleTriangle, IsTheDistanceWhereTrianglesLieInOnePlane) {
    std::mt19937_64 rng(7);
    std::uniform_real_distribution<double> uniform(-2, 2);
    for (int i = 0; i < 20000; ++i) {
        const Quat turn = rotation_from_vector({uniform(rng), uniform(rng), uniform(rng)});
        const auto at = [&](double x, double y, double z) { return rotate(turn, {x, y, z}); };
        const Tri a{at(0.15, 0.15, 0), at(0.03, 0.15, 0.2), at(0.03, -0.15, 0.2)},
            b{at(-1, 0.15, 0.25), at(1, 0.15, 0.29), at(1, 0.15, 0.25)};
        ASSERT_NEAR(std::sqrt(closest_triangle_triangle(a, b).distance_sq), 0.05, 1e-12) << i;
    }
}

TEST(ClosestTriangleTriangle, IsSymmetricAndNoLargerThanAnyVertexDistance) {
    std::mt19937_64 rng(13);
    for (int i = 0; i < 5000; ++i) {
        const bool lattice = i % 2 == 0;
        Tri a, b;
        for (auto* t : {&a, &b})
            for (auto& v : *t) v = lattice_or_random(rng, lattice);
        const double d = closest_triangle_triangle(a, b).distance_sq;
        ASSERT_NEAR(d, closest_triangle_triangle(b, a).distance_sq, 1e-14);
        for (const Vec3& v : a) ASSERT_LE(d, closest_vertex_triangle(v, b[0], b[1], b[2]).distance_sq);
    }
}

TEST(SegmentTriangle, CrossesInsideAndOnTheBoundaryOnly) {
    const Vec3 f0{0, 0, 0}, f1{1, 0, 0}, f2{0, 1, 0};
    EXPECT_DOUBLE_EQ(segment_triangle({0.2, 0.2, 1}, {0.2, 0.2, -3}, f0, f1, f2).value(), 0.25);
    EXPECT_TRUE(segment_triangle({0, 0.5, 1}, {0, 0.5, -1}, f0, f1, f2).has_value());
    EXPECT_FALSE(segment_triangle({0.6, 0.6, 1}, {0.6, 0.6, -1}, f0, f1, f2).has_value());
    EXPECT_FALSE(segment_triangle({0.2, 0.2, 1}, {0.2, 0.2, 0.1}, f0, f1, f2).has_value());
    EXPECT_FALSE(segment_triangle({-1, 0.2, 0}, {1, 0.2, 0}, f0, f1, f2).has_value());
    EXPECT_FALSE(segment_triangle({0, 0, 1}, {0, 0, -1}, f0, f0, f2).has_value());
}

TEST(SegmentTriangle, PiercesInsideOnly) {
    const Vec3 f0{0, 0, 0}, f1{1, 0, 0}, f2{0, 1, 0};
    EXPECT_TRUE(segment_pierces({0.2, 0.2, 1}, {0.2, 0.2, -3}, f0, f1, f2, 1e-6));
    EXPECT_TRUE(segment_pierces({0.2, 0.2, 1e-12}, {0.2, 0.2, -1e-12}, f0, f1, f2, 1e-6));
    EXPECT_FALSE(segment_pierces({0.6, 0.6, 1}, {0.6, 0.6, -1}, f0, f1, f2, 1e-6));
    EXPECT_FALSE(segment_pierces({0.2, 0.2, 1e-7}, {0.2, 0.2, -1}, f0, f1, f2, 1e-6));
    EXPECT_FALSE(segment_pierces({0.2, 0.2, 1}, {0.2, 0.2, -1e-7}, f0, f1, f2, 1e-6));
}

// The segment leaves a corner along the plane of a triangle that has the corner: its ends are on both sides of the
// plane by rounding.
TEST(SegmentTriangle, ASegmentInThePlaneOfATriangleThatItLeavesPiercesNothing) {
    std::mt19937_64 rng(3);
    std::uniform_real_distribution<double> uniform(-2, 2);
    for (int i = 0; i < 20000; ++i) {
        const Quat turn = rotation_from_vector({uniform(rng), uniform(rng), uniform(rng)});
        const auto at = [&](double x, double y) { return rotate(turn, {x, y, 0}) + Vec3{5, 3, -2}; };
        const Vec3 corner = at(0, 0), end = at(0, -1e-4), f0 = at(1, 1), f1 = at(-1, 1);
        const auto t = segment_triangle(corner, end, f0, f1, corner);
        ASSERT_FALSE(t && *t > 1e-6 && *t < 1 - 1e-6) << i << ": noise divided by noise";
        ASSERT_FALSE(segment_pierces(corner, end, f0, f1, corner, 1e-6)) << i;
    }
}

TEST(Closest, DirectionsOfPointsNearEachOtherAreTheFeatures) {
    // 40 m from the origin rounding moves the foot of the perpendicular by a good part of 1e-14 m, a hundred-thousandth
    // of the gap.
    const Quat turn = rotation_from_vector({0.3, 1.1, -0.7});
    const Vec3 f0 = rotate(turn, {40, -40, 7}), f1 = rotate(turn, {40, 40, 7}), f2 = rotate(turn, {-40, 40, 7});
    const Vec3 n = normalized(cross(f1 - f0, f2 - f0));
    for (const double gap : {1e-9, 1e-7, 1e-3}) {
        for (const double side : {-1.0, 1.0}) {
            const Vec3 v = rotate(turn, {13.7, 29.3, 7 + side * gap});
            const Vec3 d = v - closest_vertex_triangle(v, f0, f1, f2).point;
            const Vec3 direction = direction_between(d, 60, f1 - f0, f2 - f0);
            EXPECT_LT(length(direction - side * n), gap > 1e-4 ? 1e-9 : 1e-14) << gap;
        }
    }
    // Beside an edge by so little that the square of the distance is the same, the edge's point is taken; the direction
    // is the face's.
    for (const double beside : {6e-14, 1e-12, 1e-10}) {
        const Vec3 v{4 - beside, -0.5, 5e-5}, corners[] = {{-2, -1, 0}, {4, -1, 0}, {4, 1, 0}};
        const Vec3 d = v - closest_vertex_triangle(v, corners[0], corners[1], corners[2]).point;
        EXPECT_EQ(direction_between(d, 4, corners[1] - corners[0], corners[2] - corners[1]), (Vec3{0, 0, 1})) << beside;
    }
    // A point beside the face is not above it, and a face without area has no normal.
    EXPECT_EQ(direction_between({1e-9, 0, 0}, 60, {1, 0, 0}, {0, 1, 0}), (Vec3{1, 0, 0}));
    EXPECT_EQ(direction_between({0, 0, 1e-9}, 60, {1, 0, 0}, {2, 0, 0}), (Vec3{0, 0, 1}));
    EXPECT_EQ(direction_between({}, 60, {1, 0, 0}, {2, 0, 0}), Vec3{});
}

} // namespace
} // namespace flotilla
