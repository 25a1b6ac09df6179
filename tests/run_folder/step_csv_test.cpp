// SPDX-License-Identifier: MIT
#include "run_folder/step_csv.hpp"

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

TEST(StepCsv, OtherColumnsAreNamed) {
    const std::string header = io::step_csv_header();
    EXPECT_EQ(io::step_csv_difference(header), "");
    EXPECT_EQ(io::step_csv_difference(header + io::step_csv_row({})), "");
    EXPECT_EQ(io::step_csv_difference(""), "");
    EXPECT_EQ(io::step_csv_difference("step,time\n1,0.5\n"), R"(it has no column "total_ms")");
    EXPECT_EQ(io::step_csv_difference("step,temps\n"), R"(it has column "temps" where "time" is expected)");
    EXPECT_EQ(io::step_csv_difference(header.substr(0, header.size() - 1) + ",more\n"),
              R"(column "more" is not known)");
    EXPECT_EQ(io::step_csv_difference("\n"), R"(it has column "" where "step" is expected)");
}

TEST(StepCsv, ATableHasEveryWholeRowAndItsFields) {
    std::string text = io::step_csv_header();
    StepReport row;
    for (row.step = 3; row.step <= 5; ++row.step) text += io::step_csv_row(row);
    const io::StepTable table = io::read_step_table(text.substr(0, text.size() - 5)); // the last line is torn
    ASSERT_EQ(table.rows.size(), 2u);
    EXPECT_EQ(table.rows[1].first, 4);
    EXPECT_EQ(io::step_csv_fields(table.rows[1].second).size(), table.columns.size());
    EXPECT_EQ(table.columns[2], "total_ms");
    EXPECT_EQ(io::step_csv_fields("a,,c"), (std::vector<std::string_view>{"a", "", "c"}));
    EXPECT_TRUE(io::read_step_table("").columns.empty());
}

} // namespace
} // namespace flotilla
