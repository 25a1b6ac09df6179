// SPDX-License-Identifier: MIT
// The oracle against published answers: every row of the external data, whose labels come from another exact program.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>

#include "support/ccd_data.hpp"
#include "support/ccd_oracle.hpp"

namespace flotilla::test {
namespace {

CcdQuery still(const std::array<Vec3, 4>& x) { return {x, x}; }

TEST(CcdOracle, FindsCrossingTimeOfVertexThroughFace) {
    CcdQuery q{{{{0.25, 0.25, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
               {{{0.25, 0.25, -2}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
    const OracleToi r = exact_ccd(CcdKind::vertex_face, q);
    ASSERT_TRUE(r.hit);
    EXPECT_LE(r.lower, mpq_class(1, 3));
    EXPECT_GE(r.upper, mpq_class(1, 3));
    EXPECT_LE(mpq_class(r.upper - r.lower), mpq_class(1, mpz_class(1) << 80));
}

TEST(CcdOracle, SeesTouchingAtStartAndEnd) {
    const std::array<Vec3, 4> above{{{0, 0, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const std::array<Vec3, 4> on_corner{{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const OracleToi end = exact_ccd(CcdKind::vertex_face, {above, on_corner});
    ASSERT_TRUE(end.hit);
    EXPECT_EQ(end.lower, 1);
    const OracleToi start = exact_ccd(CcdKind::vertex_face, {on_corner, above});
    ASSERT_TRUE(start.hit);
    EXPECT_EQ(start.upper, 0);
}

TEST(CcdOracle, DecidesStillAndDegenerateFeatures) {
    const Vec3 o{}, x{1, 0, 0}, y{0, 1, 0}, m{0.5, 0, 0}, beside{0.5, 5e-324, 0}, beyond{2, 0, 0};
    const auto vf = CcdKind::vertex_face, ee = CcdKind::edge_edge;
    EXPECT_TRUE(exact_ccd(vf, still({m, o, x, y})).hit);
    EXPECT_TRUE(exact_ccd(vf, still({m, o, x, x})).hit) << "zero-area face, vertex on it";
    EXPECT_FALSE(exact_ccd(vf, still({beside, o, x, beyond})).hit) << "off a collinear face by one denormal";
    EXPECT_TRUE(exact_ccd(vf, still({o, o, o, o})).hit);
    EXPECT_FALSE(exact_ccd(vf, still({m, o, o, o})).hit);
    EXPECT_TRUE(exact_ccd(ee, still({o, x, m, beyond})).hit) << "collinear, overlapping";
    EXPECT_FALSE(exact_ccd(ee, still({o, m, x, beyond})).hit) << "collinear, apart";
    EXPECT_TRUE(exact_ccd(ee, still({o, m, m, beyond})).hit) << "collinear, sharing an end";
    EXPECT_TRUE(exact_ccd(ee, still({m, m, o, x})).hit) << "zero-length edge on the other";
    EXPECT_FALSE(exact_ccd(ee, still({y, y, o, x})).hit);
}

TEST(CcdOracle, SolvesAlwaysCoplanarMotion) {
    // A vertex slides in the plane of a still triangle and enters it through the edge x = 0 at t = 1/3.
    const CcdQuery enter{{{{-1, 0.25, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                         {{{2, 0.25, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
    const OracleToi r = exact_ccd(CcdKind::vertex_face, enter);
    ASSERT_TRUE(r.hit);
    EXPECT_NEAR(r.lower.get_d(), 1.0 / 3, 1e-16);
    CcdQuery pass = enter;
    pass.x0[0].y = pass.x1[0].y = 1.0000000000000002;
    EXPECT_FALSE(exact_ccd(CcdKind::vertex_face, pass).hit);
    pass.x0[0].y = pass.x1[0].y = 1;
    EXPECT_TRUE(exact_ccd(CcdKind::vertex_face, pass).hit) << "grazes the corner (0, 1)";
    // Two edges on the same line, approaching end to end.
    const CcdQuery rail{{{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {4, 0, 0}}}, {{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0, 0}}}};
    const OracleToi meet = exact_ccd(CcdKind::edge_edge, rail);
    ASSERT_TRUE(meet.hit);
    EXPECT_NEAR(meet.lower.get_d(), 2.0 / 3, 1e-16);
}

/// The plane of the triangle tilts while the vertex falls: the signed volume is (n t - 1)^2 + lift, which grazes zero
/// at t = 1/n.
CcdQuery grazing(double n, double lift) {
    const Vec3 o{}, x{1, 0, 0};
    return {{{{0.25, 0, 1 + lift}, o, x, {0, 1, 0}}}, {{{0.25, 1, 1 - 2 * n + lift}, o, x, {0, 1, -n * n}}}};
}

TEST(CcdOracle, TellsGrazingFromMissingByTheLastBit) {
    for (const double n : {2.0, 3.0}) {
        const OracleToi graze = exact_ccd(CcdKind::vertex_face, grazing(n, 0));
        ASSERT_TRUE(graze.hit);
        EXPECT_LE(graze.lower, mpq_class(1, static_cast<unsigned>(n)));
        EXPECT_GE(graze.upper, mpq_class(1, static_cast<unsigned>(n)));
        EXPECT_FALSE(exact_ccd(CcdKind::vertex_face, grazing(n, 0x1p-50)).hit);
        EXPECT_TRUE(exact_ccd(CcdKind::vertex_face, grazing(n, -0x1p-50)).hit);
    }
}

TEST(CcdOracle, DecidesContactOnTheBoundaryAtAnIrregularTime) {
    // The vertex crosses the plane z = 0 and the line of the edge y = 0 at t = 1/3, no dyadic number: signs at that
    // time are decided by common factors alone. One unit in the last place of one coordinate ends it.
    CcdQuery q{{{{0.5, -1, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0.5, 2, -2}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
    EXPECT_TRUE(exact_ccd(CcdKind::vertex_face, q).hit);
    q.x1[0].y = std::nextafter(2.0, 0.0);
    EXPECT_FALSE(exact_ccd(CcdKind::vertex_face, q).hit);
}

TEST(CcdOracle, ComparesReportedTimesExactly) {
    const CcdQuery half{{{{0.25, 0.25, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                        {{{0.25, 0.25, -1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
    const OracleToi truth = exact_ccd(CcdKind::vertex_face, half, 8);
    EXPECT_FALSE(is_late(CcdKind::vertex_face, half, truth, 0.5));
    EXPECT_TRUE(is_late(CcdKind::vertex_face, half, truth, std::nextafter(0.5, 1.0)));
    CcdQuery third = half;
    third.x1[0].z = -2;
    const OracleToi coarse = exact_ccd(CcdKind::vertex_face, third, 8);
    EXPECT_FALSE(is_late(CcdKind::vertex_face, third, coarse, 1.0 / 3)); // the double is below 1/3
    EXPECT_TRUE(is_late(CcdKind::vertex_face, third, coarse, std::nextafter(1.0 / 3, 1.0)));
}

TEST(CcdOracle, BoundsMinimumDistance) {
    const CcdQuery pass{{{{-1, 0, 2}, {-1, 1, 2}, {0, 0, 0}, {0, 1, 0}}},
                        {{{1, 0, 2}, {1, 1, 2}, {0, 0, 0}, {0, 1, 0}}}};
    const DistanceRange r = min_distance(CcdKind::edge_edge, pass);
    EXPECT_LE(r.lower, 2.0L);
    EXPECT_GE(r.upper, 2.0L);
    EXPECT_LE(r.upper - r.lower, 1e-9L);
}

/// Every row of a data file: the answer, and the time to the rounding of its decimal form.
class CcdOracleData : public testing::TestWithParam<const char*> {};

TEST_P(CcdOracleData, AgreesWithEveryPublishedLabel) {
    const auto rows = load_ccd_data(GetParam());
    if (!rows) GTEST_SKIP() << "no external test data: " << ccd_data_path(GetParam());
    const auto start = std::chrono::steady_clock::now();
    int disagreements = 0, hits = 0, timed = 0;
    for (std::size_t i = 0; i < rows->size(); ++i) {
        const CcdFileRow& row = (*rows)[i];
        const OracleToi truth = exact_ccd(row.kind, row.query);
        hits += truth.hit ? 1 : 0;
        bool agrees = truth.hit == row.expected;
        if (agrees && row.toi) {
            ++timed;
            // The published time is the exact one, known to 2^-80, rounded down to double.
            const mpq_class slack(1, mpz_class(1) << 78);
            const mpq_class next(std::nextafter(*row.toi, 2.0));
            agrees = mpq_class(*row.toi) <= truth.upper + slack && next >= truth.lower - slack;
        }
        if (!agrees && ++disagreements < 10) ADD_FAILURE() << GetParam() << " row " << i + 1;
    }
    EXPECT_EQ(disagreements, 0);
    const std::chrono::duration<double, std::micro> spent = std::chrono::steady_clock::now() - start;
    std::printf("%s: %zu rows, %d hits, %d times compared, %.1f us per query\n", GetParam(), rows->size(), hits, timed,
                spent.count() / static_cast<double>(rows->size()));
}

TEST_P(CcdOracleData, FilterChangesNothing) {
    const auto rows = load_ccd_data(GetParam());
    if (!rows) GTEST_SKIP() << "no external test data: " << ccd_data_path(GetParam());
    for (std::size_t i = 0; i < rows->size(); i += 3) {
        const CcdFileRow& row = (*rows)[i];
        EXPECT_EQ(exact_ccd(row.kind, row.query, 10, OracleFilter::on).hit,
                  exact_ccd(row.kind, row.query, 10, OracleFilter::off).hit)
            << GetParam() << " row " << i + 1;
    }
}

INSTANTIATE_TEST_SUITE_P(Files, CcdOracleData, testing::ValuesIn(kCcdDataFiles), [](const auto& file) {
    const std::string name = file.param;
    return name.substr(0, name.find('.'));
});

} // namespace
} // namespace flotilla::test
