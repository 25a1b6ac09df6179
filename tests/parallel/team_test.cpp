// SPDX-License-Identifier: MIT
#include "parallel/team.hpp"

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

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
    Team team({.threads = 3, .crowds = true});
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

TEST(Team, BusyIsTheTimeInTasks) {
    using Clock = std::chrono::steady_clock;
    const auto ms_since = [](Clock::time_point begin) {
        return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    };
    Team team;
    const Clock::time_point begin = Clock::now();
    for (int loop = 0; loop < 10; ++loop)
        team.for_each("test", 2, 1, [&](std::size_t, int) {
            const Clock::time_point start = Clock::now();
            while (ms_since(start) < 1) {
            }
        });
    const double least = 20, most = ms_since(begin);
    EXPECT_GE(team.times()[0].busy_ms, 0.99 * least);
    EXPECT_LE(team.times()[0].busy_ms, 1.01 * most);
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
            const auto expect_seven = [](auto&& run) {
                try {
                    run();
                    FAIL();
                } catch (const std::runtime_error& e) {
                    EXPECT_STREQ(e.what(), "7");
                }
            };
            expect_seven([&] { team.for_each("test", 50, 1, fail); });
            expect_seven([&] { team.run("test", order, fail); });
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

TEST(Team, PhasesBeginWhenTheOneBeforeIsDone) {
    for (const int threads : {1, 2, 3, 8})
        for (const bool crowds : {false, true}) {
            Team team({.threads = threads, .crowds = crowds});
            std::vector<std::size_t> done(static_cast<std::size_t>(threads), 0); // phases of each share
            std::atomic<int> wrong = 0;
            const auto work = [&](std::size_t phase, int share) {
                if (phase % 2 == 0)
                    wrong += ++done[static_cast<std::size_t>(share)] != phase / 2 + 1 ? 1 : 0;
                else
                    for (const std::size_t other : done) wrong += other != phase / 2 + 1 ? 1 : 0;
            };
            const auto sections = [&] {
                for (int round = 0; round < 50; ++round) {
                    done.assign(done.size(), 0);
                    team.phases(threads, 200, work);
                    EXPECT_EQ(done, std::vector<std::size_t>(done.size(), 100));
                }
            };
            team.region(sections);
            EXPECT_EQ(wrong, 0);
        }
}

/// Shares in a row, each the neighbour of the next, with work in some phases of a chain between two phases of all.
struct ChainOfShares {
    int shares;
    std::size_t length;
    std::vector<std::uint8_t> works; ///< by share and phase of the chain
    std::vector<std::uint64_t> near;
    std::vector<std::int32_t> next;

    ChainOfShares(int of_shares, std::size_t of_length, std::uint64_t seed) : shares(of_shares), length(of_length) {
        std::mt19937_64 random(seed);
        const auto n = static_cast<std::size_t>(shares), words = PhaseChain::words(shares);
        near.assign(n * words, 0);
        works.assign(n * length, 1);
        next.assign(n * length, 0);
        for (std::size_t k = 0; k < n; ++k) {
            if (k > 0) near[k * words + (k - 1) / 64] |= std::uint64_t{1} << (k - 1) % 64;
            if (k + 1 < n) near[k * words + (k + 1) / 64] |= std::uint64_t{1} << (k + 1) % 64;
            for (std::size_t p = 1; p < length; ++p) works[k * length + p] = random() % 3 != 0 ? 1 : 0;
            auto to = static_cast<std::int32_t>(length);
            for (std::size_t p = length; p-- > 0;) {
                next[k * length + p] = to;
                if (works[k * length + p] != 0) to = static_cast<std::int32_t>(p);
            }
        }
    }
    [[nodiscard]] PhaseChain chain() const { return {1, 1 + length, near, next}; }
};

/// What was done in one section, checked as it is done.
class ChainWatch {
  public:
    explicit ChainWatch(const ChainOfShares& chain) : chain_(chain), done_(chain.works.size(), 0) {}

    void work(std::size_t phase, int share) {
        const auto n = static_cast<std::size_t>(chain_.shares), k = static_cast<std::size_t>(share);
        if (phase == 0) return;
        if (phase > chain_.length) {
            if (done_ != chain_.works) ++wrong;
            return;
        }
        const std::size_t p = phase - 1;
        for (std::size_t j = k > 0 ? k - 1 : 0; j < std::min(k + 2, n); ++j)
            for (std::size_t q = 0; q < p; ++q)
                if (done_[j * chain_.length + q] != chain_.works[j * chain_.length + q]) ++wrong;
        if (++done_[k * chain_.length + p] != 1 || chain_.works[k * chain_.length + p] == 0) ++wrong;
    }
    std::atomic<int> wrong = 0;

  private:
    const ChainOfShares& chain_;
    std::vector<std::uint8_t> done_; ///< as ChainOfShares::works
};

TEST(Team, InAChainSharesWaitForTheirNeighboursAlone) {
    for (const int threads : {2, 3, 8, 70})
        for (const bool crowds : {false, true}) {
            if (crowds && threads > 8) continue;
            Team team({.threads = threads, .crowds = crowds});
            team.region([&] {
                for (std::uint64_t round = 0; round < 200; ++round) {
                    const ChainOfShares shares(threads, 1 + round % 20, round);
                    const PhaseChain chain = shares.chain();
                    ChainWatch watch(shares);
                    team.phases(
                        threads, shares.length + 2, [&](std::size_t p, int share) { watch.work(p, share); }, &chain);
                    ASSERT_EQ(watch.wrong, 0) << threads << " threads, round " << round;
                }
            });
        }
}

// The first share is held up in the first phase: far from it others go on to the last.
TEST(Team, InAChainAShareThatIsLateHoldsUpItsNeighboursAlone) {
    Team team({.threads = 2, .crowds = true});
    const std::vector<std::uint64_t> near{0, 0}; // no neighbours
    const std::vector<std::int32_t> next{1, 2, 3, 1, 2, 3};
    const PhaseChain chain{0, 3, near, next};
    std::atomic<bool> released = false;
    std::atomic<int> done = 0;
    const auto work = [&](std::size_t phase, int share) {
        if (share == 0 && phase == 0)
            while (!released) std::this_thread::yield();
        if (share == 1 && phase == 2) released = true;
        ++done;
    };
    bool alone = false;
    team.region([&] {
        alone = team.alone(); // the system gave no second thread
        if (!alone) team.phases(2, 3, work, &chain);
    });
    if (alone) GTEST_SKIP() << "needs two threads";
    EXPECT_EQ(done, 6);
}

TEST(Team, SectionsOfAllKindsAndWidthsFollowOneAnother) {
    for (const int threads : {2, 3, 8}) {
        Team team({.threads = threads, .crowds = true});
        TaskOrder order;
        order.start(3);
        for (int i = 0; i < 20; ++i) order.add(i % 3, (i + 1) % 3);
        std::atomic<int> count = 0;
        const auto add = [&](std::size_t, int) { ++count; };
        int expected = 0;
        team.region([&] {
            for (int round = 0; round < 2000; ++round) {
                const auto n = static_cast<std::size_t>(round % 7);
                team.for_each("loop", n, 1, add);
                const int shares = 1 + round % threads;
                if (n >= 3 && round % 2 == 0) {
                    const ChainOfShares row(shares, n - 2, static_cast<std::uint64_t>(round));
                    const PhaseChain chain = row.chain();
                    team.phases(shares, n, add, &chain);
                    expected += 2 * shares + static_cast<int>(std::ranges::count(row.works, 1));
                } else {
                    team.phases(shares, n, add);
                    expected += static_cast<int>(n) * shares;
                }
                expected += static_cast<int>(n);
                if (round % 5 == 0) team.run("ordered", order, add), expected += 20;
                ASSERT_EQ(count, expected);
            }
        });
    }
}

TEST(Team, ASectionDoesNotWaitForThreadsThatDoNotCome) {
    Team team({.threads = 4, .crowds = true});
    team.region([&] {
        std::atomic<bool> release = false;
        std::atomic<int> held = 0;
        // A thread of the team is held up in a task; the others do the rest meanwhile, whosever share it was.
        const auto caller = std::this_thread::get_id();
        std::atomic<int> done = 0;
        team.for_each("held", 40, 1, [&](std::size_t, int) {
            if (std::this_thread::get_id() != caller && held.fetch_add(1) == 0)
                while (!release) std::this_thread::yield();
            if (++done == 39) release = true;
            if (std::this_thread::get_id() == caller) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        });
        EXPECT_EQ(done, 40);
    });
    // After dismiss() there are no helpers at all.
    team.region([&] {
        team.dismiss();
        EXPECT_TRUE(team.alone());
        std::vector<int> count(3, 0);
        team.phases(3, 5, [&](std::size_t, int share) { ++count[static_cast<std::size_t>(share)]; });
        EXPECT_EQ(count, std::vector<int>(3, 5));
    });
}

TEST(Team, HelpersRoundAsTheCallerDoes) {
    Team team({.threads = 3, .crowds = true});
    std::vector<int> mode(3, -1);
    const auto note = [&](std::size_t i, int) { mode[i] = std::fegetround(); };
    for (const int direction : {FE_UPWARD, FE_TONEAREST}) {
        std::fesetround(direction);
        team.for_each("test", 3, 1, note);
        std::fesetround(FE_TONEAREST);
        EXPECT_EQ(mode, std::vector<int>(3, direction));
    }
}

TEST(Team, AnExceptionLeavesTheRegion) {
    Team team({2});
    EXPECT_THROW(team.region([] { throw std::runtime_error("planted"); }), std::runtime_error);
    int done = 0;
    team.region([&] { ++done; });
    EXPECT_EQ(done, 1);
}

/// Two teams of one process, each called by a thread of its own.
TEST(Team, TwoTeamsSideBySide) {
    const auto work = [] {
        Team team({.threads = 2, .yields = true});
        for (int region = 0; region < 50; ++region)
            team.region([&] {
                std::vector<int> count(100, 0);
                for (int i = 0; i < 20; ++i) team.for_each("test", 100, 3, [&](std::size_t k, int) { ++count[k]; });
                EXPECT_EQ(count, std::vector<int>(100, 20));
            });
    };
    std::thread other(work);
    work();
    other.join();
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

TEST(Team, MergesAsTheStandardLibraryDoes) {
    using Item = std::pair<int, std::size_t>; // and where it was
    const auto less = [](const Item& x, const Item& y) { return x.first < y.first; };
    std::mt19937 rng(6);
    std::vector<Item> merged;
    for (const int threads : {1, 2, 8}) {
        Team team({threads});
        for (const std::size_t n : {0u, 1u, 2u, 255u, 1000u, 20000u})
            for (const std::size_t middle : {std::size_t{0}, n / 3, n}) {
                std::vector<Item> items(n);
                for (std::size_t i = 0; i < n; ++i) items[i] = {static_cast<int>(rng() % 500), i};
                const auto split = items.begin() + static_cast<std::ptrdiff_t>(middle);
                std::stable_sort(items.begin(), split, less);
                std::stable_sort(split, items.end(), less);
                team_merge(team, items, middle, merged, less);
                std::inplace_merge(items.begin(), split, items.end(), less);
                EXPECT_EQ(merged, items) << threads << ' ' << n << ' ' << middle;
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
