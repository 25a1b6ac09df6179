// SPDX-License-Identifier: MIT
// The cubic baseline: right on ordinary queries, and blind where its header says so.
#include <gtest/gtest.h>

#include "geometry/ccd_cubic.hpp"
#include "support/ccd_data.hpp"
#include "support/ccd_oracle.hpp"

namespace flotilla::test {
namespace {

const Vec3 kOrigin{}, kX{1, 0, 0}, kY{0, 1, 0};

CcdQuery vertex_over_still_face(const Vec3& from, const Vec3& to) {
    return {{{from, kOrigin, kX, kY}}, {{to, kOrigin, kX, kY}}};
}

TEST(CcdCubic, FindsTheCrossingTime) {
    const CcdResult r = ccd_cubic(CcdKind::vertex_face, vertex_over_still_face({0.25, 0.25, 1}, {0.25, 0.25, -2}));
    ASSERT_TRUE(r.hit);
    EXPECT_NEAR(r.toi, 1.0 / 3, 1e-15);
    EXPECT_FALSE(ccd_cubic(CcdKind::vertex_face, vertex_over_still_face({2, 2, 1}, {2, 2, -2})).hit);
}

TEST(CcdCubic, TakesTheEarliestOfSeveralRoots) {
    // The plane of the triangle tilts while the vertex falls: the cubic is (2 t - 1)^2 - 1/4, with roots 1/4 and 3/4.
    const CcdQuery twice{{{{0.25, 0, 0.75}, kOrigin, kX, kY}}, {{{0.25, 1, -3.25}, kOrigin, kX, {0, 1, -4}}}};
    const CcdResult r = ccd_cubic(CcdKind::vertex_face, twice);
    ASSERT_TRUE(r.hit);
    EXPECT_NEAR(r.toi, 0.25, 1e-15);
}

TEST(CcdCubic, LooksAtTheEndButNotAtTheStart) {
    const double near = 0.5e-4, far = 0.5;
    EXPECT_TRUE(ccd_cubic(CcdKind::vertex_face, vertex_over_still_face({0.25, 0.25, far}, {0.25, 0.25, near})).hit);
    EXPECT_FALSE(ccd_cubic(CcdKind::vertex_face, vertex_over_still_face({0.25, 0.25, near}, {0.25, 0.25, far})).hit);
}

TEST(CcdCubic, MissesContactInAlwaysCoplanarMotion) {
    const CcdQuery slide = vertex_over_still_face({-1, 0.25, 0}, {2, 0.25, 0});
    EXPECT_TRUE(exact_ccd(CcdKind::vertex_face, slide).hit);
    EXPECT_FALSE(ccd_cubic(CcdKind::vertex_face, slide).hit);
}

TEST(CcdCubic, FindsNearlyEveryContactOfSimulations) {
    for (const char* file : {"simulation_vf.bin", "simulation_ee.bin"}) {
        const auto rows = load_ccd_data(file);
        if (!rows) GTEST_SKIP() << "no external test data: " << ccd_data_path(file);
        std::size_t expected = 0, found = 0;
        for (const CcdFileRow& row : *rows) {
            if (!row.expected) continue;
            ++expected;
            found += ccd_cubic(row.kind, row.query).hit ? 1U : 0U;
        }
        EXPECT_GT(expected, 1000U);
        EXPECT_GE(static_cast<double>(found), 0.9 * static_cast<double>(expected)) << file;
    }
}

} // namespace
} // namespace flotilla::test
