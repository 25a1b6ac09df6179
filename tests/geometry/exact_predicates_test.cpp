// SPDX-License-Identifier: MIT
// The predicates against rational arithmetic (GMP), which knows no rounding and no range.
#include "geometry/exact/predicates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>

#include <gmpxx.h>
#include <gtest/gtest.h>

#include "geometry/exact_pairs.hpp"

namespace flotilla::exact {
namespace {

using Rational = mpq_class;
using test::Random;

int rational_orient2d(const Point2& a, const Point2& b, const Point2& c) {
    const Rational ax(a.x), ay(a.y);
    const Rational det = (Rational(b.x) - ax) * (Rational(c.y) - ay) - (Rational(b.y) - ay) * (Rational(c.x) - ax);
    return sgn(det);
}

int rational_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Rational ax(a.x), ay(a.y), az(a.z);
    const Rational ux = Rational(b.x) - ax, uy = Rational(b.y) - ay, uz = Rational(b.z) - az;
    const Rational vx = Rational(c.x) - ax, vy = Rational(c.y) - ay, vz = Rational(c.z) - az;
    const Rational wx = Rational(d.x) - ax, wy = Rational(d.y) - ay, wz = Rational(d.z) - az;
    const Rational det = wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx);
    return sgn(det);
}

using Points = std::array<Vec3, 4>;

/// Both predicates, filtered and exact stage alone, against the rational sign; counts the signs of orient3d.
std::array<int, 3> check(int queries, std::uint64_t seed, const std::function<Points(Random&)>& make) {
    std::array<int, 3> count{};
    Random r(seed);
    for (int i = 0; i < queries && !testing::Test::HasFailure(); ++i) {
        const auto [a, b, c, d] = make(r);
        const int expected = rational_orient3d(a, b, c, d);
        EXPECT_EQ(orient3d(a, b, c, d), expected) << "query " << i;
        EXPECT_EQ(orient3d_exact(a, b, c, d), expected) << "query " << i;
        EXPECT_EQ(orient3d(a, c, b, d), -expected) << "query " << i;
        const Point2 p{a.x, a.y}, q{b.x, b.y}, s{c.x, c.y};
        const int expected2 = rational_orient2d(p, q, s);
        EXPECT_EQ(orient2d(p, q, s), expected2) << "query " << i;
        EXPECT_EQ(orient2d_exact(p, q, s), expected2) << "query " << i;
        ++count[static_cast<std::size_t>(expected + 1)];
    }
    return count;
}

Points random_points(Random& r) {
    const Vec3 a = r.point(), b = r.point(), c = r.point();
    return {a, b, c, r.point()};
}

Points lattice_points(Random& r) {
    const Vec3 a = r.lattice(2), b = r.lattice(2), c = r.lattice(2);
    return {a, b, c, r.lattice(2)};
}

/// Four corners of a lattice plane, moved to full mantissas and then by neighbouring doubles.
Points nearly_coplanar_points(Random& r) {
    const test::TrianglePair t = test::ulp_pair(r);
    return {t.a[0], t.a[1], t.a[2], t.b[static_cast<std::size_t>(r.below(3))]};
}

/// d is the rounded combination of a, b and c: as near to the plane as doubles get, at any orientation.
Points rounded_points(Random& r) {
    const Vec3 a = r.point(), b = r.point(), c = r.point();
    const double s = r.real(), t = r.real();
    return {a, b, c, a + s * (b - a) + t * (c - a)};
}

double any_double(Random& r, int low, int high) {
    if (r.below(8) == 0) return 0;
    return std::ldexp(r.real(), low + r.below(high - low + 1));
}

/// Coordinates of any exponent in [low, high]; every other query has d in the plane z = z(a) of the others.
template <int low, int high>
Points scaled_points(Random& r) {
    Points p;
    for (Vec3& v : p) {
        const double x = any_double(r, low, high), y = any_double(r, low, high);
        v = {x, y, any_double(r, low, high)};
    }
    if (r.below(2) == 0)
        for (Vec3& v : p) v.z = r.below(4) == 0 ? std::nextafter(p[0].z, 2 * p[0].z) : p[0].z;
    return p;
}

/// The least and the greatest doubles, zero, and their neighbours.
Points limit_points(Random& r) {
    using Limits = std::numeric_limits<double>;
    const std::array<double, 10> value{
        0.0,  Limits::max(), -Limits::max(), Limits::denorm_min(), Limits::min(), -Limits::denorm_min(), 1.0,
        -1.0, 0x1p-300,      0x1p336};
    Points p;
    const auto any = [&] { return value[static_cast<std::size_t>(r.below(10))]; };
    for (Vec3& v : p) {
        const double x = any(), y = any();
        v = {x, y, any()};
    }
    return p;
}

void expect_all_signs(const std::array<int, 3>& count, int least) {
    for (const int n : count) EXPECT_GE(n, least);
}

TEST(ExactPredicates, HaveTheDocumentedOrientation) {
    EXPECT_EQ(orient2d({0, 0}, {1, 0}, {0, 1}), 1);
    EXPECT_EQ(orient2d({0, 0}, {0, 1}, {1, 0}), -1);
    EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
    EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, -1}), -1);
    EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 0}), 0);
}

TEST(ExactPredicates, AgreeWithRationalsOnRandomPoints) {
    const auto count = check(4000, 1, random_points);
    EXPECT_GE(std::min(count[0], count[2]), 1000);
}
TEST(ExactPredicates, AgreeWithRationalsOnLattice) { expect_all_signs(check(6000, 2, lattice_points), 500); }
TEST(ExactPredicates, AgreeWithRationalsOneUlpFromCoplanar) {
    expect_all_signs(check(6000, 3, nearly_coplanar_points), 30);
}
TEST(ExactPredicates, AgreeWithRationalsOnRoundedCombinations) {
    const auto count = check(6000, 4, rounded_points);
    EXPECT_GE(std::min(count[0], count[2]), 1000);
}
TEST(ExactPredicates, AgreeWithRationalsOnMixedMagnitudes) {
    expect_all_signs(check(3000, 5, scaled_points<-30, 30>), 300);
}
TEST(ExactPredicates, AgreeWithRationalsAcrossTheRangeOfTheSums) {
    expect_all_signs(check(2000, 6, scaled_points<-300, 336>), 200);
}
TEST(ExactPredicates, AgreeWithRationalsOnHugeCoordinates) {
    expect_all_signs(check(1000, 7, scaled_points<300, 1023>), 100);
}
TEST(ExactPredicates, AgreeWithRationalsOnTinyCoordinates) {
    expect_all_signs(check(1000, 8, scaled_points<-1074, -290>), 100);
}
TEST(ExactPredicates, AgreeWithRationalsOnAllFiniteDoubles) {
    expect_all_signs(check(1000, 9, scaled_points<-1074, 1023>), 20);
    expect_all_signs(check(600, 10, limit_points), 3);
}

/// c is the rounded combination of a and b; magnitudes differ, so that the differences are rounded as well.
TEST(ExactPredicates, Orient2dAgreesWithRationalsNextToLines) {
    Random r(13);
    std::array<int, 3> count{};
    for (int i = 0; i < 20000; ++i) {
        const Point2 a{any_double(r, -20, 0), any_double(r, -20, 0)}, b{any_double(r, -20, 0), any_double(r, -20, 0)};
        const double t = r.real();
        const Point2 c{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
        const int expected = rational_orient2d(a, b, c);
        ASSERT_EQ(orient2d(a, b, c), expected) << "query " << i;
        ++count[static_cast<std::size_t>(expected + 1)];
    }
    expect_all_signs(count, 500);
}

/// In units of 2^-1075 the two products are 1 + 2^-54 + .. and 1 + 2^-53 + 2^-54 + .., but rounded differences make
/// them 1 + 2^-52 and 1, which round to 2^-1074 and 0: a filter without its underflow term gets this sign wrong.
TEST(ExactPredicates, Orient2dSurvivesUnderflowOfRoundedDifferences) {
    const Point2 a{-(0x1p-591 + 0x1p-598), -0x1p-591}, b{0x1p-538, 0x1p-538}, c{0x1p-537, 0x1p-537 - 0x1p-590};
    EXPECT_EQ((b.x - a.x) * (c.y - a.y), 0x1p-1074);
    EXPECT_EQ((b.y - a.y) * (c.x - a.x), 0);
    EXPECT_EQ(rational_orient2d(a, b, c), -1);
    EXPECT_EQ(orient2d(a, b, c), -1);
}

/// Scaling by a power of two changes no sign (and no bit of these mantissas): the integers must agree with the sums.
TEST(ExactPredicates, AgreeAcrossExactScaling) {
    Random r(11);
    for (int i = 0; i < 2000; ++i) {
        const Points p = i % 2 == 0 ? rounded_points(r) : lattice_points(r);
        Points tiny = p, huge = p;
        for (Vec3& v : tiny) v = 0x1p-900 * v;
        for (Vec3& v : huge) v = 0x1p900 * v;
        const int sign = orient3d(p[0], p[1], p[2], p[3]);
        ASSERT_EQ(orient3d(tiny[0], tiny[1], tiny[2], tiny[3]), sign);
        ASSERT_EQ(orient3d(huge[0], huge[1], huge[2], huge[3]), sign);
    }
}

TEST(ExactPredicates, PlaneSideEqualsOrient3d) {
    Random r(12);
    for (int i = 0; i < 5000; ++i) {
        const Points p = i % 2 == 0 ? nearly_coplanar_points(r) : lattice_points(r);
        ASSERT_EQ(OrientedPlane(p[0], p[1], p[2]).side(p[3]), orient3d(p[0], p[1], p[2], p[3]));
        ASSERT_EQ(orient3d(p[1], p[2], p[0], p[3]), orient3d(p[0], p[1], p[2], p[3]));
        ASSERT_EQ(orient3d(p[3], p[1], p[2], p[0]), -orient3d(p[0], p[1], p[2], p[3]));
    }
}

} // namespace
} // namespace flotilla::exact
