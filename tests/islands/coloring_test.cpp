// SPDX-License-Identifier: MIT
#include "islands/coloring.hpp"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

std::vector<BodyPair> random_pairs(int num_bodies, int num_pairs, std::span<const std::uint8_t> movable,
                                   unsigned seed) {
    std::mt19937_64 rng(seed);
    std::uniform_int_distribution<std::int32_t> body(0, num_bodies - 1);
    std::set<BodyPair> pairs;
    while (static_cast<int>(pairs.size()) < num_pairs) {
        const std::int32_t i = body(rng), j = body(rng);
        if (i == j || !(movable[static_cast<std::size_t>(i)] || movable[static_cast<std::size_t>(j)])) continue;
        pairs.insert({std::min(i, j), std::max(i, j)});
    }
    return {pairs.begin(), pairs.end()};
}

struct Colored {
    int num_colors = 0;
    std::vector<std::int32_t> color;
};

Colored color(const std::vector<BodyPair>& pairs, const std::vector<std::uint8_t>& movable) {
    ColoringScratch scratch;
    Colored c{0, std::vector<std::int32_t>(pairs.size())};
    c.num_colors = color_pairs(pairs, movable, scratch, c.color);
    return c;
}

void expect_valid(const std::vector<BodyPair>& pairs, const std::vector<std::uint8_t>& movable, const Colored& c) {
    std::set<std::pair<std::int32_t, std::int32_t>> taken; // (body, colour)
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        ASSERT_LT(c.color[k], c.num_colors);
        for (const std::int32_t body : {pairs[k].a, pairs[k].b})
            if (movable[static_cast<std::size_t>(body)]) {
                ASSERT_TRUE(taken.insert({body, c.color[k]}).second) << "body " << body << ", colour " << c.color[k];
            }
    }
}

TEST(Coloring, NoColorHoldsAMovableBodyTwice) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        std::vector<std::uint8_t> movable(60, 1);
        for (std::size_t i = 0; i < seed % 5; ++i) movable[i] = 0;
        const auto pairs = random_pairs(60, 40 + 60 * static_cast<int>(seed), movable, seed);
        expect_valid(pairs, movable, color(pairs, movable));
    }
}

TEST(Coloring, AStackNeedsTwoColorsAndAFloorNone) {
    std::vector<BodyPair> pairs;
    for (std::int32_t i = 0; i < 10; ++i) pairs.push_back({i, i + 1});
    std::vector<std::uint8_t> movable(11, 1);
    movable[0] = 0;
    EXPECT_EQ(color(pairs, movable).num_colors, 2);

    pairs.clear();
    for (std::int32_t i = 1; i <= 200; ++i) pairs.push_back({0, i}); // side by side on one floor
    movable.assign(201, 1);
    movable[0] = 0;
    EXPECT_EQ(color(pairs, movable).num_colors, 1);
}

TEST(Coloring, ABodyWithMoreNeighboursThanTheMaskStaysValid) {
    std::vector<BodyPair> pairs;
    for (std::int32_t i = 1; i <= 150; ++i) pairs.push_back({0, i});
    for (std::int32_t i = 1; i < 150; ++i) pairs.push_back({i, i + 1});
    for (std::int32_t hub = 60; hub < 65; ++hub)
        for (std::int32_t i = hub + 2; i <= 150; ++i) pairs.push_back({hub, i});
    const std::vector<std::uint8_t> movable(151, 1);
    const Colored c = color(pairs, movable);
    expect_valid(pairs, movable, c);
    EXPECT_GE(c.num_colors, 150);
}

TEST(Coloring, ColorsOfAnIslandIgnoreOtherIslands) {
    const std::vector<std::uint8_t> movable(100, 1);
    std::vector<BodyPair> both, low;
    for (const BodyPair& p : random_pairs(100, 600, movable, 7)) {
        if ((p.a < 50) == (p.b < 50)) both.push_back(p);
        if (p.b < 50) low.push_back(p);
    }
    const Colored all = color(both, movable), alone = color(low, movable);
    std::vector<std::int32_t> low_colors;
    for (std::size_t i = 0; i < both.size(); ++i)
        if (both[i].b < 50) low_colors.push_back(all.color[i]);
    EXPECT_EQ(low_colors, alone.color);
}

} // namespace
} // namespace flotilla
