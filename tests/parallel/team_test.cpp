// SPDX-License-Identifier: MIT
#include "parallel/team.hpp"

#include <atomic>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "parallel/parallel_for.hpp"
#include "parallel/team_sort.hpp"

namespace flotilla {
namespace {

const int kTeams[] = {1, 2, 3, 4, 8, 16};

TEST(Team, LoopsDoEveryItemOnce) {
    for (const int threads : kTeams) {
        Team team({threads});
        EXPECT_EQ(team.size(), threads);
        for (const std::size_t n : {0u, 1u, 2u, 31u, 1000u})
            for (const std::size_t grain : {1u, 7u, 64u}) {
                std::vector<int> count(n, 0);
                team.for_each("test", n, grain, [&](std::size_t i, int thread) {
                    EXPECT_GE(thread, 0);
                    EXPECT_LT(thread, threads);
                    ++count[i];
                });
                EXPECT_EQ(count, std::vector<int>(n, 1));
            }
    }
}

TEST(Team, SeveralThreadsTakePart) {
    Team team({3});
    std::atomic<int> arrived = 0;
    // Each of three chunks waits for the others: only three threads can finish this.
    team.for_each("test", 3, 1, [&](std::size_t, int) {
        ++arrived;
        while (arrived < 3) std::this_thread::yield();
    });
    std::int64_t tasks = 0;
    for (const ThreadTimes& t : team.times()) {
        EXPECT_EQ(t.tasks, 1);
        tasks += t.tasks;
    }
    EXPECT_EQ(tasks, 3);
}

TEST(Team, OneThreadStaysOnTheCallersThreadAndInOrder) {
    Team team;
    const auto caller = std::this_thread::get_id();
    std::vector<std::size_t> seen;
    team.for_each("test", 20, 3, [&](std::size_t i, int) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        seen.push_back(i);
    });
    TaskOrder order;
    order.start(4);
    for (int i = 0; i < 20; ++i) order.add(i % 4, (i + 1) % 4);
    team.run("test", order, [&](std::size_t i, int) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        seen.push_back(i);
    });
    for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(seen[i], i % 20);
}

TEST(Team, ThrowsTheExceptionOfTheLowestTask) {
    for (const int threads : {1, 4}) {
        Team team({threads});
        TaskOrder order;
        order.start(1);
        for (int i = 0; i < 50; ++i) order.add(0, -1);
        for (int round = 0; round < 20; ++round) {
            const auto fail = [&](std::size_t i, int) {
                if (i >= 7) throw std::runtime_error(std::to_string(i));
            };
            EXPECT_THROW(team.for_each("test", 50, 1, fail), std::runtime_error);
            try {
                team.run("test", order, fail);
                FAIL();
            } catch (const std::runtime_error& e) {
                EXPECT_STREQ(e.what(), "7");
            }
        }
        // The team is as good as new.
        std::atomic<int> done = 0;
        team.run("test", order, [&](std::size_t, int) { ++done; });
        EXPECT_EQ(done, 50);
    }
}

struct Pair {
    std::int32_t a, b;
};

std::vector<Pair> random_pairs(std::size_t n, std::int32_t things, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Pair> out;
    while (out.size() < n) {
        const auto a = static_cast<std::int32_t>(random() % static_cast<unsigned>(things));
        const auto b = static_cast<std::int32_t>(random() % static_cast<unsigned>(things + 2)) - 2; // < 0: nothing
        if (a != b) out.push_back(random() % 2 == 0 ? Pair{a, b} : Pair{b, a});
    }
    return out;
}

/// What a task does to the numbers of its things depends on the order of all tasks before it.
void mix(std::vector<std::uint64_t>& value, const Pair& p, std::size_t task) {
    const auto get = [&](std::int32_t i) { return i >= 0 ? value[static_cast<std::size_t>(i)] : 17u; };
    const std::uint64_t mixed = (get(p.a) * 6364136223846793005u) ^ (get(p.b) + task * 1442695040888963407u);
    if (p.a >= 0) value[static_cast<std::size_t>(p.a)] = mixed ^ (mixed >> 29);
    if (p.b >= 0) value[static_cast<std::size_t>(p.b)] = mixed * 31 + 1;
}

TEST(Team, OrderedTasksGiveTheBitsOfThePlainLoop) {
    for (const int threads : kTeams) {
        Team team({threads});
        TaskOrder order;
        for (unsigned seed = 0; seed < 12; ++seed) {
            const std::int32_t things = seed % 2 == 0 ? 5 : 300;
            const auto pairs = random_pairs(2000, things, seed);
            std::vector<std::uint64_t> expected(static_cast<std::size_t>(things), 1), value = expected;
            for (std::size_t i = 0; i < pairs.size(); ++i) mix(expected, pairs[i], i);
            order.start(static_cast<std::size_t>(things));
            for (const Pair& p : pairs) order.add(p.a, p.b);
            team.run("test", order, [&](std::size_t i, int) { mix(value, pairs[i], i); });
            EXPECT_EQ(value, expected) << threads << " threads, seed " << seed;
        }
    }
}

TEST(TaskOrder, ATaskThatSharesBothThingsIsWaitedForOnce) {
    TaskOrder order;
    order.start(3);
    order.add(0, 1);
    order.add(1, 0);
    order.add(2, -1);
    order.add(0, 2);
    EXPECT_EQ(std::vector<int>(order.waits().begin(), order.waits().end()), (std::vector<int>{0, 1, 0, 2}));
    EXPECT_EQ(std::set<std::int32_t>(order.successors()[0].begin(), order.successors()[0].end()),
              (std::set<std::int32_t>{-1, 1}));
    EXPECT_EQ(std::set<std::int32_t>(order.successors()[1].begin(), order.successors()[1].end()),
              (std::set<std::int32_t>{-1, 3}));
}

TEST(Team, BarriersKeepRoundsApart) {
    for (const int threads : {1, 2, 3, 8}) {
        Team team({threads});
        std::vector<int> round(static_cast<std::size_t>(threads), 0);
        std::atomic<int> wrong = 0;
        team.together(threads, [&](int thread, SpinBarrier& barrier) {
            for (int r = 1; r <= 200; ++r) {
                round[static_cast<std::size_t>(thread)] = r;
                barrier.wait();
                for (const int other : round) wrong += other != r ? 1 : 0;
                barrier.wait();
            }
        });
        EXPECT_EQ(wrong, 0);
    }
}

TEST(Team, PinningEndsWithTheTeam) {
    const int before = usable_cores();
    {
        Team team({2, true});
        EXPECT_EQ(usable_cores(), 1);
    }
    EXPECT_EQ(usable_cores(), before);
}

TEST(Team, SortsAsOneThreadDoes) {
    for (const int threads : {1, 2, 5}) {
        Team team({threads});
        std::mt19937_64 random(7);
        std::vector<std::uint64_t> buffer;
        for (const std::size_t n : {0u, 1u, 4096u, 4097u, 12289u, 100000u}) {
            std::vector<std::uint64_t> items(n);
            for (auto& x : items) x = random() % 5000;
            auto expected = items;
            std::sort(expected.begin(), expected.end());
            team_sort(team, items, buffer, std::less<>());
            EXPECT_EQ(items, expected);
        }
    }
}

TEST(Team, RecordsWhatItRan) {
    for (const int threads : {1, 2}) {
        Team team({threads});
        TaskRecorder recorder(threads);
        team.record_to(&recorder);
        team.for_each("loop", 10, 3, [](std::size_t, int) {});
        TaskOrder order;
        order.start(2);
        order.add(0, -1);
        order.add(0, 1);
        team.run("ordered", order, [](std::size_t, int) {});
        recorder.set_active(false);
        team.for_each("not recorded", 10, 3, [](std::size_t, int) {});
        const TaskRecord& record = recorder.record();
        ASSERT_EQ(record.regions.size(), 2u);
        EXPECT_STREQ(record.regions[0].name, "loop");
        EXPECT_EQ(record.regions[0].tasks, 4);
        EXPECT_EQ(record.regions[1].kind, RegionKind::ordered);
        ASSERT_EQ(record.links.size(), 2u);
        EXPECT_EQ(record.links[0][0], 1);
        std::size_t spans = 0;
        for (const auto& list : record.threads)
            for (const TaskSpan& s : list) {
                EXPECT_LE(s.begin, s.end);
                ++spans;
            }
        EXPECT_EQ(spans, 6u);
    }
}

} // namespace
} // namespace flotilla
