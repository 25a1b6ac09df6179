// SPDX-License-Identifier: MIT
// The conservative CCD on every query of the external data, judged by the exact oracle: nothing missed, nothing late,
// and few false hits (at separation 1e-4 among the rows that really stay farther apart than 1.01e-4).
#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "support/ccd_data.hpp"
#include "support/ccd_oracle.hpp"

namespace flotilla::test {
namespace {

constexpr double kFarShare = 1.01; // of the separation: beyond it a hit is false
constexpr double kMaxFalseShare = 1e-3;

struct Tally {
    std::size_t contacts = 0, within = 0, far = 0; ///< rows that touch, come within the separation, stay far from it
    std::size_t missed = 0, late = 0, false_hits = 0;
};

void judge(const CcdFileRow& row, const CcdResult& result, double separation, Tally& tally) {
    if (const OracleToi truth = exact_ccd(row.kind, row.query); truth.hit) {
        ++tally.contacts;
        tally.missed += result.hit ? 0U : 1U;
        tally.late += is_late(row.kind, row.query, truth, result.hit ? result.toi : 1.0) ? 1U : 0U;
        return;
    }
    bool within = false, far = true;
    if (separation > 0) {
        const long double beyond = kFarShare * separation;
        const DistanceRange d = min_distance(
            row.kind, row.query, {.tolerance = 1e-9L, .above = beyond, .below = separation, .budget = 50'000});
        within = d.upper <= separation;
        far = d.lower > beyond;
    }
    tally.within += within ? 1U : 0U;
    tally.far += far ? 1U : 0U;
    tally.missed += within && !result.hit ? 1U : 0U;
    tally.false_hits += far && result.hit ? 1U : 0U;
}

Tally run(const std::vector<CcdFileRow>& rows, double separation) {
    Tally tally;
    for (const CcdKind kind : {CcdKind::vertex_face, CcdKind::edge_edge}) {
        std::vector<CcdFileRow> same_kind;
        std::vector<CcdQuery> queries;
        for (const CcdFileRow& row : rows)
            if (row.kind == kind) {
                same_kind.push_back(row);
                queries.push_back(row.query);
            }
        std::vector<CcdResult> results(queries.size());
        ccd_batch(kind, queries, {.separation = separation}, results, best_isa());
        for (std::size_t i = 0; i < queries.size(); ++i) judge(same_kind[i], results[i], separation, tally);
    }
    return tally;
}

class CcdData : public testing::TestWithParam<std::tuple<const char*, double>> {};

TEST_P(CcdData, MissesNothingAndIsNeverLate) {
    const auto [file, separation] = GetParam();
    const auto rows = load_ccd_data(file);
    if (!rows) GTEST_SKIP() << "no external test data: " << ccd_data_path(file);
    const Tally tally = run(*rows, separation);
    std::printf("%s at %g m: %zu rows, %zu touch, %zu within, %zu far; missed %zu, late %zu, false hits %zu\n", file,
                separation, rows->size(), tally.contacts, tally.within, tally.far, tally.missed, tally.late,
                tally.false_hits);
    EXPECT_EQ(tally.missed, 0U);
    EXPECT_EQ(tally.late, 0U);
    const bool near_misses = std::string(file).starts_with("nearmiss");
    EXPECT_EQ(tally.contacts == 0, near_misses) << "the file must be able to fail this test";
    if (separation > 0)
        EXPECT_LE(static_cast<double>(tally.false_hits), kMaxFalseShare * static_cast<double>(tally.far));
    else
        EXPECT_TRUE(!near_misses || tally.false_hits == 0);
}

INSTANTIATE_TEST_SUITE_P(Files, CcdData, testing::Combine(testing::ValuesIn(kCcdDataFiles), testing::Values(0.0, 1e-4)),
                         [](const auto& file) {
                             const std::string name = std::get<0>(file.param);
                             return name.substr(0, name.find('.')) +
                                    (std::get<1>(file.param) > 0 ? "_separated" : "_touching");
                         });

} // namespace
} // namespace flotilla::test
