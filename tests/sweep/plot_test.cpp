// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "sweep/plot.hpp"

namespace flotilla::test {
namespace {

using namespace sweep;

std::size_t count(const std::string& text, const std::string& word) {
    std::size_t n = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
    return n;
}

TEST(SweepPlot, TicksAreRoundAndInside) {
    EXPECT_EQ(log_ticks(0.9, 6), (std::vector<double>{1, 2, 5}));
    EXPECT_EQ(log_ticks(0.5, 2000), (std::vector<double>{1, 10, 100, 1000}));
    EXPECT_LE(log_ticks(1e-12, 1).size(), 8u);
    EXPECT_GE(log_ticks(1e-12, 1).size(), 4u);
}

TEST(SweepPlot, DrawsEveryPointOnceAndInside) {
    Plot plot;
    plot.points = {{1, 1e-3, 1e-4, "a<b", "x & y", 0, true, true, false},
                   {10, 0, 0, "zero", "", 1, false, false, false},
                   {100, 1e-5, 0, "c", "", 2, true, false, true}};
    plot.reference_x = 1000;
    const std::string text = svg(plot);
    EXPECT_EQ(count(text, "<circle"), 4u) << "one is ringed";
    EXPECT_EQ(count(text, "var(--card)"), 1u) << "one is hollow";
    EXPECT_EQ(count(text, "class=\"front\""), 1u);
    EXPECT_EQ(count(text, "cost of the reference"), 1u);
    EXPECT_NE(text.find("a&lt;b"), std::string::npos);
    EXPECT_NE(text.find("x &amp; y"), std::string::npos);
    EXPECT_EQ(text.find("nan"), std::string::npos);
    EXPECT_EQ(text.find("inf"), std::string::npos);
}

TEST(SweepPlot, LabelsDoNotHideEachOther) {
    Plot plot;
    for (int k = 0; k < 40; ++k) plot.points.push_back({1, 1, 0, "the same place", "", 0, false, false, false});
    const std::size_t labels = count(svg(plot), "class=\"label\"");
    EXPECT_GE(labels, 1u);
    EXPECT_LE(labels, 6u);
}

} // namespace
} // namespace flotilla::test
