// SPDX-License-Identifier: MIT
#include "report/step_columns.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "run_folder/step_csv.hpp"

namespace flotilla {
namespace {

TEST(StepColumns, ReadsWhatRunsWrite) {
    StepReport row;
    row.step = 1;
    row.time = 0.25;
    row.contacts = 7;
    row.state_hash = 0xabc;
    std::string csv = io::step_csv_header() + io::step_csv_row(row);
    row.step = 2;
    row.min_distance = 1e-3;
    csv += io::step_csv_row(row);
    const report::StepColumns table = report::read_step_columns(csv + "3,0.7"); // torn
    EXPECT_TRUE(table.problems.empty());
    EXPECT_EQ(table.rows(), 2u);
    EXPECT_EQ(table.column("step"), (std::vector<double>{1, 2}));
    EXPECT_EQ(table.column("contacts"), (std::vector<double>{7, 7}));
    EXPECT_TRUE(std::isnan(table.column("min_distance")[0])) << "unknown";
    EXPECT_EQ(table.column("min_distance")[1], 1e-3);
    EXPECT_EQ(table.last_state_hash, "0000000000000abc");
    EXPECT_TRUE(table.column("absent").empty());
}

TEST(StepColumns, NamesDamagedLinesAndKeepsTheOthers) {
    const report::StepColumns table = report::read_step_columns("step,time\n1,0.1\n2;0.2\n3,x\n4,0.4\n");
    EXPECT_EQ(table.column("step"), (std::vector<double>{1, 4}));
    ASSERT_EQ(table.problems.size(), 2u);
    EXPECT_NE(table.problems[0].find("line 3"), std::string::npos);
    EXPECT_EQ(report::read_step_columns("").problems.size(), 1u);
}

} // namespace
} // namespace flotilla
