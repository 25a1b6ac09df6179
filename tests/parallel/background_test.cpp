// SPDX-License-Identifier: MIT
#include "parallel/background.hpp"

#include <atomic>
#include <cfenv>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "parallel/in_order.hpp"
#include "parallel/parallel_for.hpp"

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

/// Whoever does coarse work rounds to nearest, also where a thread of TBB, or the caller, does otherwise.
TEST(CoarseWork, HasTheDefaultFloatingPointEnvironment) {
    std::atomic<int> others = 0;
    const auto look = [&](std::size_t) { others += std::fegetround() != FE_TONEAREST ? 1 : 0; };
    std::fesetround(FE_UPWARD);
    parallel_for(200, 3, look);
    run_ordered_stages(50, 3, 8, {look, look, look});
    {
        Background jobs(4);
        for (int i = 0; i < 50; ++i) jobs.add([&] { look(0); });
    }
    const int caller = std::fegetround();
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(caller, FE_UPWARD);
    EXPECT_EQ(others, 0);
}

TEST(InOrder, KeepsTheOrder) {
    for (const int threads : {1, 2, 5})
        for (const std::size_t n : {0u, 1u, 3u, 200u}) {
            std::vector<std::size_t> used;
            in_order(
                n, threads, [](std::size_t i) { return i; }, [](std::size_t i) { return i * i; },
                [&](std::size_t square, std::size_t i) {
                    EXPECT_EQ(square, i * i);
                    used.push_back(i);
                });
            ASSERT_EQ(used.size(), n);
            for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(used[i], i);
        }
}

TEST(InOrder, ThrowsAsAPlainLoopWould) {
    for (const int threads : {1, 2, 5})
        for (const int stage : {0, 1, 2}) {
            std::size_t used = 0;
            const auto fail = [&](int here, std::size_t i) {
                if (here == stage && i >= 40) throw std::runtime_error(std::to_string(i));
                return i;
            };
            try {
                in_order(
                    100, threads, [&](std::size_t i) { return fail(0, i); }, [&](std::size_t i) { return fail(1, i); },
                    [&](std::size_t, std::size_t i) { fail(2, i), ++used; });
                FAIL();
            } catch (const std::runtime_error& e) {
                EXPECT_STREQ(e.what(), "40");
            }
            EXPECT_EQ(used, 40u);
        }
}

} // namespace
} // namespace flotilla
