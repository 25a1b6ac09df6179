// SPDX-License-Identifier: MIT
#include "parallel/compact.hpp"

#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

using Ints = std::vector<int>;
using Repeat = std::function<std::size_t(std::size_t)>; ///< how often an item is wanted

const int kTeams[] = {1, 2, 3, 8};
const std::size_t kSizes[] = {0, 1, 2, 63, 64, 65, 1000, 20000};
const std::size_t kGrains[] = {1, 7, 64, 100000};

std::size_t mixed(std::size_t i) { return (i * 2654435761u) >> 7; }

/// What to do with item i: drop all, keep all, every third, some at random, the first, a stretch, and several places for one item.
const std::vector<Repeat> kRepeats = {
    [](std::size_t) { return 0u; },
    [](std::size_t) { return 1u; },
    [](std::size_t i) { return i % 3 == 0 ? 1u : 0u; },
    [](std::size_t i) { return mixed(i) % 2; },
    [](std::size_t i) { return i == 0 ? 1u : 0u; },
    [](std::size_t i) { return i >= 500 && i < 700 ? 1u : 0u; },
    [](std::size_t i) { return mixed(i) % 4; },
};

Ints serial(std::size_t n, const Repeat& repeat) {
    Ints kept;
    for (std::size_t i = 0; i < n; ++i) kept.insert(kept.end(), repeat(i), static_cast<int>(i));
    return kept;
}

Ints compacted(Team* team, std::size_t n, std::size_t grain, std::vector<std::size_t>& places, const Repeat& repeat) {
    Ints kept;
    const auto count = [&](std::size_t begin, std::size_t end) {
        std::size_t sum = 0;
        for (std::size_t i = begin; i < end; ++i) sum += repeat(i);
        return sum;
    };
    const auto fill = [&](std::size_t begin, std::size_t end, std::size_t place) {
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t k = repeat(i); k > 0; --k) kept[place++] = static_cast<int>(i);
    };
    compact(
        team, "test", n, grain, places, count, [&](std::size_t size) { kept.assign(size, -1); }, fill);
    return kept;
}

/// Calls check(team) with each of the teams and with none.
template <class Check>
void for_teams(Check&& check) {
    check(nullptr);
    for (const int threads : kTeams) {
        SCOPED_TRACE(threads);
        Team team({threads});
        check(&team);
    }
}

TEST(Compact, GivesTheListOfThePlainLoop) {
    for_teams([](Team* team) {
        std::vector<std::size_t> places; // the same for all: what one call leaves must not matter to the next
        for (const std::size_t n : kSizes)
            for (const std::size_t grain : kGrains)
                for (const Repeat& repeat : kRepeats)
                    ASSERT_EQ(compacted(team, n, grain, places, repeat), serial(n, repeat)) << n << " by " << grain;
    });
}

TEST(Compact, MakesRoomOnceBetweenTheTwoPasses) {
    for_teams([](Team* team) {
        std::atomic<int> counted = 0, filled = 0;
        std::vector<std::size_t> places, sizes;
        const auto count = [&](std::size_t begin, std::size_t end) {
            EXPECT_LT(begin, end);
            ++counted;
            return end - begin;
        };
        const auto resize = [&](std::size_t size) {
            EXPECT_EQ(counted, 10);
            EXPECT_EQ(filled, 0);
            sizes.push_back(size);
        };
        const auto fill = [&](std::size_t begin, std::size_t, std::size_t place) {
            EXPECT_EQ(place, begin);
            ++filled;
        };
        compact(team, "test", 95, 10, places, count, resize, fill);
        EXPECT_EQ(filled, 10);
        EXPECT_EQ(sizes, (std::vector<std::size_t>{95}));
    });
}

TEST(Compact, AnEmptyListIsMadeEmpty) {
    for_teams([](Team* team) {
        std::optional<std::size_t> size;
        std::vector<std::size_t> places{7, 7, 7};
        const auto never = [](std::size_t, std::size_t, auto...) -> std::size_t {
            ADD_FAILURE();
            return 0;
        };
        compact(
            team, "test", 0, 16, places, never, [&](std::size_t n) { size = n; }, never);
        EXPECT_EQ(size, 0u);
    });
}

} // namespace
} // namespace flotilla
