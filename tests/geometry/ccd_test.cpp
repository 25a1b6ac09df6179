// SPDX-License-Identifier: MIT
#include "geometry/ccd.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

constexpr CcdKind kVf = CcdKind::vertex_face, kEe = CcdKind::edge_edge;

/// A vertex that falls from height h0 to h1 over the middle of a resting triangle.
CcdQuery falling_vertex(double h0, double h1) {
    const Vec3 f0{-1, -1, 0}, f1{1, -1, 0}, f2{0, 1, 0};
    return {{Vec3{0, 0, h0}, f0, f1, f2}, {Vec3{0, 0, h1}, f0, f1, f2}};
}

TEST(Ccd, ReportsAHitJustBeforeContact) {
    const CcdResult r = ccd(kVf, falling_vertex(1, -1), {.separation = 1e-3});
    EXPECT_TRUE(r.hit);
    EXPECT_LT(r.toi, 0.5);
    EXPECT_NEAR(r.toi, 0.5, 1e-3);
    EXPECT_NEAR(r.direction.z, 1, 1e-12);
}

TEST(Ccd, DecidesTheEndOfTheStepByTheSeparation) {
    EXPECT_FALSE(ccd(kVf, falling_vertex(1, 1.01e-3), {.separation = 1e-3}).hit);
    EXPECT_TRUE(ccd(kVf, falling_vertex(1, 1e-3), {.separation = 1e-3}).hit);
    EXPECT_TRUE(ccd(kVf, falling_vertex(1, 0), {.separation = 0}).hit);
    EXPECT_FALSE(ccd(kVf, falling_vertex(1, 1e-9), {.separation = 0}).hit);
}

TEST(Ccd, TouchingAtTheStartIsAHitAtZero) {
    const CcdResult r = ccd(kVf, falling_vertex(0, 1), {.separation = 0});
    EXPECT_TRUE(r.hit);
    EXPECT_EQ(r.toi, 0);
}

TEST(Ccd, SeesMotionInsideOnePlane) {
    // The coplanarity cubic vanishes identically: a vertex slides into a triangle's edge.
    const Vec3 f0{0, 0, 0}, f1{1, 0, 0}, f2{0, 1, 0};
    const CcdQuery q{{Vec3{-1, 0.2, 0}, f0, f1, f2}, {Vec3{1, 0.2, 0}, f0, f1, f2}};
    const CcdResult r = ccd(kVf, q, {.separation = 1e-6});
    EXPECT_TRUE(r.hit);
    EXPECT_NEAR(r.toi, 0.5, 1e-5);
}

TEST(Ccd, CrossingEdgesHitAndPassingEdgesDoNot) {
    const auto edges = [](double y) {
        return CcdQuery{{Vec3{-1, 0, 1}, Vec3{1, 0, 1}, Vec3{0, y - 1, 0}, Vec3{0, y + 1, 0}},
                        {Vec3{-1, 0, -1}, Vec3{1, 0, -1}, Vec3{0, y - 1, 0}, Vec3{0, y + 1, 0}}};
    };
    EXPECT_TRUE(ccd(kEe, edges(0.999), {}).hit);
    EXPECT_TRUE(ccd(kEe, edges(1), {}).hit);
    EXPECT_FALSE(ccd(kEe, edges(1.001), {}).hit);
}

TEST(Ccd, SeparatingFromCloserThanTheSeparationIsFreeOnlyWhenRelaxed) {
    EXPECT_TRUE(ccd(kVf, falling_vertex(1e-4, 1), {.separation = 1e-3}).hit);
    EXPECT_FALSE(ccd(kVf, falling_vertex(1e-4, 1), {1e-3, CcdStart::relaxed}).hit);
    // Sliding at constant distance passes, coming closer than 0.95 of it does not.
    EXPECT_FALSE(ccd(kVf, falling_vertex(1e-4, 1e-4), {1e-3, CcdStart::relaxed}).hit);
    EXPECT_FALSE(ccd(kVf, falling_vertex(1e-4, 0.96e-4), {1e-3, CcdStart::relaxed}).hit);
    EXPECT_TRUE(ccd(kVf, falling_vertex(1e-4, 0.94e-4), {1e-3, CcdStart::relaxed}).hit);
}

TEST(Ccd, BelowTheFloorOnlyOpeningMotionIsFree) {
    const double below = 8 * ccd_error(1);
    EXPECT_FALSE(ccd(kVf, falling_vertex(below, 1), {1e-3, CcdStart::relaxed}).hit);
    EXPECT_TRUE(ccd(kVf, falling_vertex(below, below), {1e-3, CcdStart::relaxed}).hit);
    EXPECT_TRUE(ccd(kVf, falling_vertex(0, 0), {1e-3, CcdStart::relaxed}).hit);
}

TEST(Ccd, ContactAtTheStartIsNeverTakenForOpeningMotion) {
    // A vertex on a face, up to rounding, that moves away: a computed gap below the error bound says nothing of its
    // sign.
    const Vec3 f0{0x1.56169994a6p-4, -0x1.66b36877102p-1, 0x1.e603840c16p-5};
    const Vec3 f1{-0x1.7318370bd3ep-1, -0x1.677f3f2c048p-2, 0x1.3638ef85398p-3};
    const Vec3 f2{0x1.908b11fa668p-1, -0x1.d21f8a98838p-1, 0x1.de4ad42f6dep-1};
    const Vec3 v0{0x1.37190248721p-1, -0x1.b744821026a8p-1, 0x1.6e502d33c2cp-1};
    const Vec3 v1{0x1.20c71988d72f9p-1, -0x1.2b13d6031991bp-1, 0x1.21dcdfd8b7edap-1};
    EXPECT_TRUE(ccd(kVf, {{v0, f0, f1, f2}, {v1, f0, f1, f2}}, {0, CcdStart::relaxed}).hit);
}

TEST(Ccd, UndefinedInputIsAHit) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    for (double bad : {nan, inf, -inf, 1e200}) {
        for (CcdKind kind : {kVf, kEe})
            for (std::size_t point = 0; point < 4; ++point)
                for (CcdStart start : {CcdStart::strict, CcdStart::relaxed}) {
                    CcdQuery q = falling_vertex(2, 1);
                    q.x1[point].y = bad;
                    EXPECT_TRUE(ccd(kind, q, {0, start}).hit);
                    q = falling_vertex(2, 1);
                    q.x0[point].z = bad;
                    EXPECT_TRUE(ccd(kind, q, {0, start}).hit);
                }
    }
    EXPECT_TRUE(ccd(kVf, CcdQuery{}, {}).hit);
}

TEST(Ccd, DistanceFromTheOriginDoesNotMatter) {
    for (double shift : {0.0, 1e3, 1e6, 0x1p40}) {
        CcdQuery q = falling_vertex(1, 0x1p-10);
        for (auto* x : {&q.x0, &q.x1})
            for (Vec3& p : *x) p += Vec3{shift, -shift, 0};
        EXPECT_FALSE(ccd(kVf, q, {.separation = 0x1p-11}).hit) << shift;
    }
}

TEST(Ccd, LongEdgesPassEachOtherANanometreApart) {
    // The diagonal of a box's side falls past the diagonal of a plate of 80 m, whose direction rounding turns by more
    // than the gap.
    const Vec3 a0{-0.49999999999999806, 0.49999999999999994, -9.7640624999999979}, a1{0.5, 0.5, -8.7640624999999979};
    const Vec3 b0{-0.50000000100000885, -2, 40}, b1{-0.50000000099999109, 2, -40}, way{0, 0, -0.5614583};
    const CcdQuery q{{a0, a1, b0, b1}, {a0 + way, a1 + way, b0, b1}};
    EXPECT_FALSE(ccd(kEe, q, {.separation = 2e-11, .start = CcdStart::relaxed}).hit);
    const CcdQuery through{{a0, a1, b0, b1}, {a0 + way + Vec3{-2.5e-9, 0, 0}, a1 + way, b0, b1}};
    EXPECT_TRUE(ccd(kEe, through, {.separation = 2e-11, .start = CcdStart::relaxed}).hit);
}

TEST(Ccd, TheWitnessOfAOneStepMissCertifiesIt) {
    std::mt19937_64 rng(5);
    std::normal_distribution<double> n;
    int tried = 0;
    for (int i = 0; i < 3000; ++i) {
        CcdQuery q;
        for (auto& p : q.x0) p = {n(rng), n(rng), n(rng)};
        for (std::size_t k = 0; k < 4; ++k) q.x1[k] = q.x0[k] + 0.1 * Vec3{n(rng), n(rng), n(rng)};
        const CcdKind kind = i % 2 ? kVf : kEe;
        const CcdResult r = ccd(kind, q, {.separation = 1e-3});
        if (r.hit || r.iterations != 1) continue;
        ++tried;
        // Normalising the direction costs a few ulp, hence the slightly smaller separation.
        EXPECT_TRUE(certified_along(kind, q, r.direction, 0.999e-3));
        EXPECT_FALSE(certified_along(kind, q, -r.direction, 1e-3));
    }
    EXPECT_GT(tried, 1000);
}

bool same_bits(const CcdResult& a, const CcdResult& b) {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    return a.hit == b.hit && a.iterations == b.iterations && bits(a.toi) == bits(b.toi) &&
           bits(a.direction.x) == bits(b.direction.x) && bits(a.direction.y) == bits(b.direction.y) &&
           bits(a.direction.z) == bits(b.direction.z);
}

TEST(CcdBatch, EqualsTheScalarCodeForEveryLengthAndWidth) {
    std::mt19937_64 rng(6);
    std::normal_distribution<double> n;
    for (std::size_t count : {0u, 1u, 3u, 4u, 5u, 9u, 255u, 256u, 257u, 1000u}) {
        std::vector<CcdQuery> queries(count);
        for (auto& q : queries) {
            for (auto* x : {&q.x0, &q.x1})
                for (Vec3& p : *x) p = {n(rng), n(rng), 0.2 * n(rng)};
        }
        for (CcdKind kind : {kVf, kEe})
            for (CcdStart start : {CcdStart::strict, CcdStart::relaxed})
                for (Isa isa : {Isa::scalar, Isa::avx2, Isa::avx512}) {
                    if (isa > best_isa()) continue;
                    const CcdOptions options{1e-3, start};
                    std::vector<CcdResult> results(count);
                    ccd_batch(kind, queries, options, results, isa);
                    for (std::size_t i = 0; i < count; ++i)
                        ASSERT_TRUE(same_bits(results[i], ccd(kind, queries[i], options)));
                }
    }
}

} // namespace
} // namespace flotilla
