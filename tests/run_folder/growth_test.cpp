// SPDX-License-Identifier: MIT
#include "run_folder/growth.hpp"

#include <new>
#include <vector>

#include <gtest/gtest.h>

namespace flotilla::io {
namespace {

TEST(Growth, IsTakenBackUnlessAllGrew) {
    std::vector<int> steps{1, 2};
    std::vector<double> times{0.1, 0.2}, places;
    const auto append = [&](bool refuse) {
        Growth growth(std::tie(steps, times, places));
        steps.push_back(3);
        places.insert(places.end(), {1, 2, 3});
        if (refuse) throw std::bad_alloc();
        times.push_back(0.3);
        growth.keep();
    };
    EXPECT_THROW(append(true), std::bad_alloc);
    EXPECT_EQ(steps, (std::vector<int>{1, 2}));
    EXPECT_EQ(times, (std::vector<double>{0.1, 0.2}));
    EXPECT_TRUE(places.empty());
    append(false);
    EXPECT_EQ(steps.size(), 3u);
    EXPECT_EQ(times.size(), 3u);
    EXPECT_EQ(places.size(), 3u);
}

} // namespace
} // namespace flotilla::io
