// SPDX-License-Identifier: MIT
#include "parallel/background.hpp"

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

TEST(Background, DoesAllJobsInOrder) {
    for (int round = 0; round < 50; ++round) {
        std::vector<int> done;
        {
            Background jobs(4);
            for (int i = 0; i < 100; ++i) jobs.add([&done, i] { done.push_back(i); });
            if (round % 2 == 0) jobs.finish();
        }
        ASSERT_EQ(done.size(), 100u);
        for (int i = 0; i < 100; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
    }
}

TEST(Background, LetsTheCallerGoOn) {
    Background jobs(100);
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 20; ++i) jobs.add([] { std::this_thread::sleep_for(std::chrono::milliseconds(10)); });
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(150));
    jobs.finish();
    EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(200));
}

TEST(Background, NothingIsDoneAfterAJobThatThrew) {
    int done = 0;
    Background jobs(3);
    const auto add_all = [&] {
        for (int i = 0; i < 50; ++i)
            jobs.add([&done, i] {
                if (i == 5) throw std::runtime_error("planted");
                ++done;
            });
        jobs.finish();
    };
    EXPECT_THROW(add_all(), std::runtime_error);
    EXPECT_EQ(done, 5);
    EXPECT_THROW(jobs.add([&done] { ++done; }), std::runtime_error);
    EXPECT_THROW(jobs.finish(), std::runtime_error);
    EXPECT_EQ(done, 5);
}

} // namespace
} // namespace flotilla
