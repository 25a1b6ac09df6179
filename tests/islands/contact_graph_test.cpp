// SPDX-License-Identifier: MIT
#include "islands/contact_graph.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

TEST(Islands, PilesOnOneFloorAreApartAndNumberedByLowestBody) {
    // Body 2 is the floor; 0-4 and 1-3-5 are piles, 6 lies alone, 7 has no contact.
    const std::vector<BodyPair> pairs{{0, 2}, {0, 4}, {1, 2}, {1, 5}, {2, 6}, {3, 5}};
    const std::vector<std::uint8_t> movable{1, 1, 0, 1, 1, 1, 1, 1};
    ContactGraphScratch scratch;
    std::vector<std::int32_t> island(pairs.size());
    EXPECT_EQ(find_islands(pairs, movable, scratch, island), 3);
    EXPECT_EQ(island, (std::vector<std::int32_t>{0, 0, 1, 1, 2, 1}));
}

// The lowest body of every pair's component, by relabelling until nothing changes.
std::vector<std::int32_t> lowest_bodies(const std::vector<BodyPair>& pairs, const std::vector<std::uint8_t>& movable) {
    std::vector<std::int32_t> label(movable.size());
    std::iota(label.begin(), label.end(), 0);
    const auto of = [&](std::int32_t i) -> std::int32_t& { return label[static_cast<std::size_t>(i)]; };
    const auto moves = [&](std::int32_t i) { return movable[static_cast<std::size_t>(i)] != 0; };
    for (bool changed = true; changed;) {
        changed = false;
        for (const BodyPair& p : pairs) {
            if (!moves(p.a) || !moves(p.b) || of(p.a) == of(p.b)) continue;
            of(p.a) = of(p.b) = std::min(of(p.a), of(p.b));
            changed = true;
        }
    }
    std::vector<std::int32_t> lowest;
    for (const BodyPair& p : pairs) lowest.push_back(of(moves(p.a) ? p.a : p.b));
    return lowest;
}

TEST(Islands, AgreeWithRelabellingUntilNothingChanges) {
    std::mt19937_64 rng(3);
    for (int round = 0; round < 30; ++round) {
        std::vector<std::uint8_t> movable(40, 1);
        movable[0] = movable[17] = 0;
        std::vector<BodyPair> pairs;
        for (std::int32_t a = 0; a < 40; ++a)
            for (std::int32_t b = a + 1; b < 40; ++b)
                if (rng() % 30 == 0 && !(a == 0 && b == 17)) pairs.push_back({a, b});
        ContactGraphScratch scratch;
        std::vector<std::int32_t> island(pairs.size());
        const int num_islands = find_islands(pairs, movable, scratch, island);

        const std::vector<std::int32_t> lowest = lowest_bodies(pairs, movable);
        const std::set<std::int32_t> sorted(lowest.begin(), lowest.end());
        EXPECT_EQ(num_islands, static_cast<int>(sorted.size()));
        for (std::size_t k = 0; k < pairs.size(); ++k) EXPECT_EQ(*std::next(sorted.begin(), island[k]), lowest[k]);
    }
}

TEST(Levels, AreTheFewestContactsToTheGround) {
    // 0 is the ground: 1 and 2 stand on it, 3 on both, 4 on 3; 5-6 fly together.
    const std::vector<BodyPair> pairs{{0, 1}, {0, 2}, {1, 3}, {2, 3}, {3, 4}, {5, 6}};
    const std::vector<std::uint8_t> movable{0, 1, 1, 1, 1, 1, 1};
    ContactGraphScratch scratch;
    std::vector<std::int32_t> level(7);
    contact_levels(pairs, movable, scratch, level);
    EXPECT_EQ(level, (std::vector<std::int32_t>{0, 1, 1, 2, 3, -1, -1}));
}

} // namespace
} // namespace flotilla
