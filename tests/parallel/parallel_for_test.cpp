// SPDX-License-Identifier: MIT
#include "parallel/parallel_for.hpp"

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

TEST(ParallelFor, DoesEveryItemOnce) {
    for (const int threads : {0, 1, 2, 7}) {
        for (const std::size_t n : {0u, 1u, 2u, 1000u}) {
            std::vector<int> count(n, 0);
            parallel_for(n, threads, [&](std::size_t i) { ++count[i]; });
            EXPECT_EQ(count, std::vector<int>(n, 1));
        }
    }
}

TEST(ParallelFor, OneThreadStaysOnTheCallersThreadAndInOrder) {
    const auto caller = std::this_thread::get_id();
    std::vector<std::size_t> order;
    parallel_for(20, 1, [&](std::size_t i) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        order.push_back(i);
    });
    for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(order[i], i);
}

TEST(ParallelFor, ThrowsTheExceptionOfTheSmallestItem) {
    for (int round = 0; round < 20; ++round) {
        try {
            // Item 0 fails last of all, so that a later failure is there first.
            parallel_for(2, 2, [&](std::size_t i) {
                if (i == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
                throw std::runtime_error(std::to_string(i));
            });
            FAIL();
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "0");
        }
    }
}

TEST(ParallelFor, NestsAndTakesMoreThreadsThanCores) {
    std::vector<std::vector<int>> count(20, std::vector<int>(30, 0));
    parallel_for(20, 6, [&](std::size_t i) { parallel_for(30, 6, [&](std::size_t j) { ++count[i][j]; }); });
    EXPECT_EQ(count, std::vector<std::vector<int>>(20, std::vector<int>(30, 1)));
}

TEST(ParallelFor, TheEnvironmentSetsTheDefaultNumberOfThreads) {
    unsetenv("FLOTILLA_NUM_THREADS");
    const int openmp = default_threads(); // OMP_NUM_THREADS is read when the program begins
    EXPECT_GE(openmp, 1);
    setenv("FLOTILLA_NUM_THREADS", "5", 1);
    EXPECT_EQ(default_threads(), 5);
    setenv("FLOTILLA_NUM_THREADS", "none", 1);
    EXPECT_EQ(default_threads(), openmp);
    unsetenv("FLOTILLA_NUM_THREADS");
}

} // namespace
} // namespace flotilla
