// SPDX-License-Identifier: MIT
#include "io/step_csv.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

TEST(StepCsv, HeaderHasTheColumnsOfTheContractInOrder) {
    const std::string header = io::step_csv_header();
    EXPECT_TRUE(header.starts_with("step,time,total_ms,stage1_collisions_ms,"));
    EXPECT_NE(
        header.find("_ms,pairs,collisions,contacts,iterations,residual,merges,rung_changes,held,energy,momentum_x,"
                    "momentum_y,momentum_z,min_distance,state_hash,"),
        std::string::npos);
    StepReport row;
    row.state_hash = 0xabcu;
    const std::string text = io::step_csv_row(row);
    EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(text.begin(), text.end(), ','));
    EXPECT_NE(text.find(",,0000000000000abc,"), std::string::npos) << text;
}

TEST(StepCsv, RowsAfterAStepAndATornLineAreDropped) {
    std::string text = io::step_csv_header();
    StepReport row;
    for (row.step = 1; row.step <= 12; ++row.step) text += io::step_csv_row(row);
    const std::string kept = io::step_csv_until(text, 3);
    EXPECT_EQ(std::count(kept.begin(), kept.end(), '\n'), 4);
    const std::string torn = text.substr(0, text.size() - 5);
    EXPECT_EQ(io::step_csv_until(torn, 12), io::step_csv_until(text, 11));
}

} // namespace
} // namespace flotilla
