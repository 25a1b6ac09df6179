// SPDX-License-Identifier: MIT
// Owners by recursive bisection.
#include "parallel/division.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

/// One rank alone, to whom nobody else says anything.
class Alone : public Ranks {
  public:
    Alone() : Ranks(0, 1) {}
    std::unique_ptr<RankExchange> prepare(std::span<const RankMessage>, std::span<const RankMessage>) override {
        return nullptr;
    }
    void gather(std::span<const std::byte> own, std::span<const std::size_t>, std::span<std::byte> all) override {
        std::copy(own.begin(), own.end(), all.begin());
    }
};

std::vector<double> weights_of(std::span<const std::int32_t> part, std::span<const double> weights, int parts) {
    std::vector<double> sums(static_cast<std::size_t>(parts));
    for (std::size_t i = 0; i < part.size(); ++i) sums[static_cast<std::size_t>(part[i])] += weights[i];
    return sums;
}

TEST(Bisection, PartsWeighAboutTheSame) {
    std::vector<Vec3> points;
    std::vector<double> weights;
    for (int i = 0; i < 1000; ++i) {
        points.push_back({std::cos(1.7 * i) * i, std::sin(2.3 * i), 0.01 * i});
        weights.push_back(1 + (i * 37) % 11);
    }
    const double all = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (const int parts : {1, 2, 3, 7, 16}) {
        const std::vector<double> sums = weights_of(bisect(points, weights, parts), weights, parts);
        for (const double sum : sums) EXPECT_NEAR(sum, all / parts, 12 * std::log2(parts + 1)) << parts;
    }
}

TEST(Bisection, CutsAlongTheLongestSide) {
    const std::vector<Vec3> points{{0, 0, 9}, {0, 1, 1}, {1, 0, 0}, {1, 1, 8}};
    EXPECT_EQ(bisect(points, std::vector<double>(4, 1.0), 2), (std::vector<std::int32_t>{1, 0, 0, 1}));
}

TEST(Bisection, EqualPlacesAreCutByNumber) {
    EXPECT_EQ(bisect(std::vector<Vec3>(4), std::vector<double>(4, 1.0), 2), (std::vector<std::int32_t>{0, 0, 1, 1}));
    EXPECT_EQ(bisect(std::vector<Vec3>(1), std::vector<double>(1, 1.0), 4).size(), 1U);
    EXPECT_TRUE(bisect({}, {}, 3).empty());
}

TEST(Division, APairIsOwnedByOneOfItsMovableBodies) {
    EXPECT_EQ(Division::payer(3, -1), 3);
    EXPECT_EQ(Division::payer(-1, 5), 5);
    EXPECT_EQ(Division::payer(-1, -1), -1);
    EXPECT_EQ(Division::payer(2, 4), 2);
    EXPECT_EQ(Division::payer(2, 5), 5);
}

TEST(Division, OneRankOwnsAll) {
    Alone rank;
    Division division(rank);
    EXPECT_EQ(division.owner(7), 0) << "before the first step";
    const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    const std::vector<std::int32_t> active{0, 2};
    division.begin_step(positions, active);
    division.add_cost(2, 1000);
    division.begin_step(positions, active);
    EXPECT_TRUE(division.owns(0, 2));
    EXPECT_DOUBLE_EQ(division.imbalance(), 1);
}

} // namespace
} // namespace flotilla
