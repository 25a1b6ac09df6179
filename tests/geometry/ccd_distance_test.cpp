// SPDX-License-Identifier: MIT
// Bounds of the minimum distance against closed forms and against the same search in extended precision.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/ccd_distance.hpp"
#include "support/ccd_data.hpp"
#include "support/ccd_oracle.hpp"

namespace flotilla::test {
namespace {

TEST(SweepDistance, BoundsAPassingEdge) {
    // Edge a passes over the end of edge b at height 2 and one to the side of it at the nearest.
    const CcdQuery pass{{{{-5, -1, 2}, {-5, -9, 2}, {0, 0, 0}, {0, 1, 0}}},
                        {{{4, -1, 2}, {4, -9, 2}, {0, 0, 0}, {0, 1, 0}}}};
    const DistanceBounds r = sweep_distance(CcdKind::edge_edge, pass, {.tolerance = 1e-9});
    EXPECT_LE(r.lower, std::sqrt(5.0));
    EXPECT_GE(r.upper, std::sqrt(5.0));
    EXPECT_LE(r.upper - r.lower, 1e-9);
}

TEST(SweepDistance, StopsAsSoonAsAThresholdIsDecided) {
    const CcdQuery pass{{{{-5, 0, 2}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                        {{{5, 0, 2}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
    EXPECT_GT(sweep_distance(CcdKind::vertex_face, pass, {.above = 1}).lower, 1);
    EXPECT_LE(sweep_distance(CcdKind::vertex_face, pass, {.below = 3}).upper, 3);
    EXPECT_FALSE(exact_ccd(CcdKind::vertex_face, pass).hit);
}

class SweepDistanceData : public testing::TestWithParam<const char*> {};

TEST_P(SweepDistanceData, AgreesWithExtendedPrecision) {
    const auto rows = load_ccd_data(GetParam());
    if (!rows) GTEST_SKIP() << "no external test data: " << ccd_data_path(GetParam());
    int apart = 0;
    for (std::size_t i = 0; i < rows->size(); i += 10) {
        const CcdFileRow& row = (*rows)[i];
        const DistanceBounds r = sweep_distance(row.kind, row.query, {.tolerance = 1e-6, .budget = 20'000});
        const DistanceRange truth = min_distance(row.kind, row.query, {.tolerance = 1e-7L, .budget = 20'000});
        EXPECT_LE(r.lower, truth.upper) << GetParam() << " row " << i + 1;
        EXPECT_GE(r.upper, truth.lower) << GetParam() << " row " << i + 1;
        EXPECT_TRUE(!row.expected || truth.lower == 0) << GetParam() << " row " << i + 1;
        apart += truth.lower > 0 ? 1 : 0;
    }
    const bool all_apart = std::string(GetParam()).starts_with("nearmiss");
    EXPECT_TRUE(!all_apart || apart == static_cast<int>((rows->size() + 9) / 10));
}

INSTANTIATE_TEST_SUITE_P(Files, SweepDistanceData, testing::ValuesIn(kCcdDataFiles), [](const auto& file) {
    const std::string name = file.param;
    return name.substr(0, name.find('.'));
});

} // namespace
} // namespace flotilla::test
