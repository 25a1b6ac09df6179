// SPDX-License-Identifier: MIT
// A slice of the matrix of extremes: every value alone, and every 40th of the pairs.
#include <gtest/gtest.h>

#include <map>

#include "extremes/check.hpp"

namespace flotilla::extremes {
namespace {

TEST(Extremes, EveryPromiseIsKeptOrTheSceneIsRefused) {
    std::map<Verdict, int> count;
    std::size_t n = 0;
    for (const Cell& cell : all_cells()) {
        if (cell.extremes.size() > 1 && n++ % 40 != 0) continue;
        const Outcome out = run_cell(cell, 4);
        ++count[out.verdict];
        EXPECT_NE(out.verdict, Verdict::broken) << cell.name() << ": " << out.message;
        EXPECT_EQ(out.verdict == Verdict::refused, !out.message.empty()) << cell.name();
        EXPECT_LT(out.slowest_step, 2) << cell.name();
    }
    EXPECT_GT(count[Verdict::pass], 100);
    EXPECT_GT(count[Verdict::refused], 1);
}

TEST(Extremes, TheMatrixHasTwoThousandCells) { EXPECT_GE(all_cells().size(), 2000u); }

} // namespace
} // namespace flotilla::extremes
