// SPDX-License-Identifier: MIT
#include "base/search.hpp"

#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

TEST(LowerBoundNear, IsTheLowerBoundFromAnyGuess) {
    for (int size = 0; size <= 40; ++size) {
        std::vector<int> items;
        for (int i = 0; i < size; ++i) items.push_back(2 * (i / 3)); // each value three times, odd ones missing
        for (int value = -1; value <= 2 * size / 3 + 2; ++value)
            for (std::size_t guess = 0; guess <= items.size() + 2; ++guess) {
                const auto expected =
                    static_cast<std::size_t>(std::lower_bound(items.begin(), items.end(), value) - items.begin());
                EXPECT_EQ(lower_bound_near(std::span<const int>(items), guess, value, std::less<>{}), expected)
                    << size << ' ' << value << ' ' << guess;
            }
    }
}

TEST(LowerBoundNear, ANearGuessTakesFewComparisons) {
    std::vector<int> items;
    for (int i = 0; i < 100000; ++i) items.push_back(i);
    int comparisons = 0;
    const auto less = [&](int a, int b) {
        ++comparisons;
        return a < b;
    };
    for (const std::size_t guess : {49997u, 50000u, 50003u}) {
        comparisons = 0;
        EXPECT_EQ(lower_bound_near(std::span<const int>(items), guess, 50000, less), 50000u);
        EXPECT_LE(comparisons, 6) << guess;
    }
}

} // namespace
} // namespace flotilla
