// SPDX-License-Identifier: MIT
#include "parallel/compact.hpp"

#include <algorithm>
#include <atomic>
#include <functional>
#include <optional>
#include <span>
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

/// What to do with item i: drop all, keep all, every third, some at random, the first, a stretch, and several places
/// for one item.
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
    const auto resize = [&](std::size_t size) { kept.assign(size, -1); };
    compact({team, "test", grain, places}, n, count, resize, fill);
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
        compact({team, "test", 10, places}, 95, count, resize, fill);
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
        const auto resize = [&](std::size_t n) { size = n; };
        compact({team, "test", 16, places}, 0, never, resize, never);
        EXPECT_EQ(size, 0u);
    });
}

TEST(CompactIf, ReplacesTheRestOfAListByTheItemsThatAreKept) {
    for_teams([](Team* team) {
        std::vector<std::size_t> places;
        Ints out;
        const auto item = [](std::size_t i) { return static_cast<int>(2 * i); };
        for (const std::size_t n : kSizes)
            for (const Repeat& repeat : kRepeats)
                for (const std::size_t from : {0u, 3u}) {
                    const auto kept = [&](std::size_t i) { return repeat(i) > 0; };
                    Ints wanted(from, -7);
                    for (std::size_t i = 0; i < n; ++i)
                        if (kept(i)) wanted.push_back(item(i));
                    out.assign(from + 5, -7);
                    compact_if({team, "test", 16, places}, n, kept, out, from, item);
                    ASSERT_EQ(out, wanted) << n;
                }
    });
}

TEST(CompactIf, LooksAtEveryItemOnceAndFirst) {
    for_teams([](Team* team) {
        std::vector<std::size_t> places;
        Ints looks(1000, 0), out;
        const auto look = [&](std::size_t i) { return ++looks[i] == 1 && i % 2 == 0; };
        const auto kept = [&](std::size_t i) {
            EXPECT_EQ(looks, Ints(looks.size(), 1)) << "all were looked at";
            return i % 2 == 0;
        };
        const auto item = [](std::size_t i) { return static_cast<int>(i); };
        compact_if({team, "test", 16, places}, looks.size(), look, kept, out, 0, item);
        EXPECT_EQ(out, serial(looks.size(), [](std::size_t i) { return 1 - i % 2; }));
    });
}

TEST(GatherParts, PutsThemOneBehindTheOther) {
    for_teams([](Team* team) {
        std::vector<std::size_t> places;
        Ints out(5, -7);
        const auto put = [&](std::size_t place, const Ints& part) {
            std::copy(part.begin(), part.end(), out.begin() + static_cast<std::ptrdiff_t>(place));
        };
        for (const std::size_t n : kSizes)
            for (const Repeat& repeat : kRepeats) {
                std::vector<Ints> parts;
                for (std::size_t i = 0; i < n; ++i) parts.emplace_back(repeat(i), static_cast<int>(i));
                gather_parts({team, "test", 16, places}, std::span<const Ints>(parts), out, put);
                ASSERT_EQ(out, serial(n, repeat)) << n;
            }
    });
}

} // namespace
} // namespace flotilla
