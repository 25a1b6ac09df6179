// SPDX-License-Identifier: MIT
// The order of the tasks of a sweep is that of the plain loop, whoever finds it.
#include <gtest/gtest.h>

#include "base/random.hpp"
#include "pair/ordered_sweep.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kClusters = 3000, kPairs = 40000;

/// Pairs of clusters, some of infinite mass; `hubs` of them meet more pairs than there are colours.
void fill(std::uint64_t seed, std::int32_t hubs, SweepBuffers& buffers) {
    buffers.things.clear();
    buffers.open.clear();
    for (std::uint64_t i = 0; i < kPairs; ++i) {
        const auto draw = [&](std::uint64_t what, std::size_t n) {
            return static_cast<std::int32_t>(random_bits(seed, i, what) % n);
        };
        std::int32_t a = draw(0, kClusters), b = draw(1, kClusters);
        if (draw(2, 100) < 2) a = -1;
        if (hubs > 0 && draw(2, 100) >= 90) b = draw(3, static_cast<std::size_t>(hubs));
        buffers.things.push_back({a, b});
        buffers.open.push_back(draw(3, 1000) < 20 ? 1 : 0);
    }
}

struct Found {
    std::vector<std::array<std::int32_t, 2>> tasks;
    std::vector<Successors> successors;
    std::vector<std::uint8_t> waits;
    std::vector<std::int32_t> first;
    bool operator==(const Found&) const = default;
};

Found found_by(int threads, std::uint64_t seed, std::int32_t hubs, bool backwards, int rounds) {
    SweepBuffers buffers;
    fill(seed, hubs, buffers);
    const SweepPlan plan{order_by_color(kClusters, buffers), backwards, rounds};
    Team team(TeamOptions{.threads = threads});
    team.region([&] { order_tasks(plan, team, buffers); });
    Found out;
    for (const auto& t : buffers.tasks) out.tasks.push_back({t.place, t.round});
    const TaskOrder& order = buffers.order;
    out.successors.assign(order.successors().begin(), order.successors().end());
    out.waits.assign(order.waits().begin(), order.waits().end());
    out.first.assign(order.first().begin(), order.first().end());
    return out;
}

TEST(OrderOfTasks, IsThatOfThePlainLoopOnAnyNumberOfThreads) {
    std::uint64_t seed = 0;
    for (const std::int32_t hubs : {0, 5})
        for (const bool backwards : {false, true})
            for (const int rounds : {1, 3}) {
                const Found plain = found_by(1, ++seed, hubs, backwards, rounds);
                ASSERT_GT(plain.tasks.size(), kPairs / 2) << "closed pairs beside open ones are tasks";
                ASSERT_LT(plain.tasks.size(), kPairs * static_cast<std::size_t>(rounds)) << "some are none";
                for (const int threads : {2, 3, 7})
                    EXPECT_TRUE(found_by(threads, seed, hubs, backwards, rounds) == plain)
                        << threads << " threads, " << hubs << " hubs, " << rounds << " rounds, " << backwards;
            }
}

TEST(OrderOfTasks, ColorsThatAreFullAreAChain) {
    SweepBuffers buffers;
    fill(1, 5, buffers);
    (void)order_by_color(kClusters, buffers);
    EXPECT_LT(buffers.color_begin[kColors - 1], buffers.color_begin[kColors]);
}

} // namespace
} // namespace flotilla
