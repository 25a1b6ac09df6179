// SPDX-License-Identifier: MIT
// Schedules of small task graphs against times computed by hand.
#include "trace/schedule.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "parallel/sweep_width.hpp"
#include "parallel/task_order.hpp"
#include "trace/measure_costs.hpp"
#include "trace/merge_records.hpp"

namespace flotilla {
namespace {

const CostModel kFree({{2, 0, 0, 0}});

struct Graph {
    std::vector<std::int64_t> durations;
    TaskOrder order;

    explicit Graph(std::size_t things = 0) { order.start(things); }
    void add(std::int64_t duration, std::int32_t a, std::int32_t b = -1) {
        order.add(a, b);
        durations.push_back(duration);
    }
    [[nodiscard]] RegionTasks region() const { return {RegionKind::ordered, durations, order.successors(), {}}; }
};

double time_of(const RegionTasks& region, int cores, const CostModel& costs = kFree) {
    ScheduleScratch scratch;
    return region_time(region, cores, costs, scratch);
}

TEST(Schedule, AChainTakesItsWorkOnAnyNumberOfCores) {
    Graph g(1);
    for (const std::int64_t d : {10, 20, 30}) g.add(d, 0);
    EXPECT_EQ(region_work(g.region()), 60);
    EXPECT_EQ(region_critical_path(g.region()), 60);
    const CostModel costs({{2, 100, 7, 5}, {3, 110, 8, 6}});
    EXPECT_EQ(time_of(g.region(), 1, costs), 60);
    EXPECT_EQ(time_of(g.region(), 2, costs), 160) << "stays on its core: forked, never handed over";
    EXPECT_EQ(time_of(g.region(), 64, costs), 170) << "as many threads as tasks";
}

TEST(Schedule, IndependentTasksShareTheCores) {
    Graph g(4);
    for (int i = 0; i < 4; ++i) g.add(10, i);
    EXPECT_EQ(region_critical_path(g.region()), 10);
    EXPECT_EQ(time_of(g.region(), 2), 20);
    EXPECT_EQ(time_of(g.region(), 3), 20);
    EXPECT_EQ(time_of(g.region(), 4), 10);
    EXPECT_EQ(time_of(g.region(), 4, CostModel({{2, 50, 7, 5}})), 110)
        << "twice the fork of two; no hand-over at the start";
}

TEST(Schedule, TheLowestTaskGoesFirst) {
    Graph g(3);
    for (const std::int64_t d : {2, 2, 4}) g.add(d, static_cast<std::int32_t>(g.durations.size()));
    EXPECT_EQ(time_of(g.region(), 2), 6) << "the longest first would take 4";
}

TEST(Schedule, AForkAndAJoinPayForTheHandOver) {
    Graph g(2);
    g.add(10, 0, 1);
    g.add(20, 0);
    g.add(20, 1);
    g.add(10, 0, 1);
    EXPECT_EQ(region_critical_path(g.region()), 40);
    EXPECT_EQ(time_of(g.region(), 2), 40);
    // 0: 0-10, 1: 10-30 there, 2: 15-35 on the other core, which then goes on with 3: 35-45.
    EXPECT_EQ(time_of(g.region(), 2, CostModel({{2, 0, 0, 5}})), 45);
    EXPECT_EQ(time_of(g.region(), 1, CostModel({{2, 0, 0, 5}})), 60);
}

TEST(Schedule, TwoChainsMeetInATaskThatUsesBoth) {
    Graph g(2);
    g.add(10, 0);   // 0-10 on a
    g.add(4, 1);    // 0-4 on b
    g.add(5, 0, 1); // 10-15 on a: 0 was the last that it waited for
    g.add(7, 0);    // 15-22 on a
    g.add(7, 1);    // 18-25 on b: handed over
    EXPECT_EQ(region_work(g.region()), 33);
    EXPECT_EQ(region_critical_path(g.region()), 22);
    EXPECT_EQ(time_of(g.region(), 2), 22);
    EXPECT_EQ(time_of(g.region(), 2, CostModel({{2, 0, 0, 3}})), 25);
}

TEST(Schedule, ATaskThatHadToWaitForACoreMayBeHandedOverToo) {
    Graph g(3);
    g.add(10, 0, 1); // 0-10 on a
    g.add(30, 2);    // 0-30 on b
    g.add(40, 0);    // 10-50 on a
    g.add(10, 1);    // ready at 10, 30+h .. 40+h on b
    EXPECT_EQ(time_of(g.region(), 2, CostModel({{2, 0, 0, 15}})), 55);
}

TEST(Schedule, ALoopFillsTheCoresInListOrder) {
    const std::vector<std::int64_t> durations{5, 1, 1, 1, 1, 1};
    const RegionTasks loop{RegionKind::loop, durations, {}, {}};
    EXPECT_EQ(region_work(loop), 10);
    EXPECT_EQ(region_critical_path(loop), 5);
    EXPECT_EQ(time_of(loop, 1), 10);
    EXPECT_EQ(time_of(loop, 2), 5);
    EXPECT_EQ(time_of(loop, 100, CostModel({{2, 10, 0, 0}, {6, 30, 0, 0}})), 35) << "six threads for six chunks";
    const std::vector<std::int64_t> late{1, 1, 1, 1, 1, 5};
    EXPECT_EQ(time_of({RegionKind::loop, late, {}, {}}, 2), 7);
}

TEST(Schedule, SweepsTakeRoundsAndBarriers) {
    // 100 ns for each visit of a task.
    const std::vector<GroupSpan> groups{{0, 16, 10, 0, 16'000}, {0, 8, 10, 10, 8'000}};
    const RegionTasks sweeps{RegionKind::sweeps, {}, {}, groups};
    EXPECT_EQ(sweeps.num_tasks(), 240);
    EXPECT_EQ(region_work(sweeps), 24'000);
    EXPECT_EQ(region_critical_path(sweeps), 2'000);
    const CostModel costs({{2, 500, 20, 5}, {3, 700, 40, 5}});
    EXPECT_EQ(time_of(sweeps, 1, costs), 24'000);
    EXPECT_EQ(time_of(sweeps, 2, costs), 500 + 10 * (800 + 5) + 10 * (400 + 20));
    EXPECT_EQ(time_of(sweeps, 3, costs), 700 + 10 * (600 + 5) + 10 * (300 + 40));
    EXPECT_EQ(time_of(sweeps, 256, costs), time_of(sweeps, 12, costs)) << "12 tasks in the average group";
    RegionTasks told = sweeps;
    told.most_threads = 2;
    EXPECT_EQ(time_of(told, 256, costs), time_of(sweeps, 2, costs));
    EXPECT_EQ(sweep_width(24, 2, 256), 12);
    EXPECT_EQ(sweep_width(16, 2, 256), 8);
    EXPECT_EQ(sweep_width(15, 2, 256), 1);
    EXPECT_EQ(sweep_width(24, 2, 5), 5);
    EXPECT_EQ(sweep_width(3, 2, 256), 1);
    EXPECT_EQ(sweep_width(0, 0, 4), 1);
}

TEST(Schedule, StaysWithinGrahamsBounds) {
    std::mt19937 random(11);
    for (int round = 0; round < 30; ++round) {
        const int things = round % 2 == 0 ? 8 : 200;
        Graph g(static_cast<std::size_t>(things));
        for (int i = 0; i < 1000; ++i) {
            const auto a = static_cast<std::int32_t>(random() % static_cast<unsigned>(things));
            const auto b = static_cast<std::int32_t>(random() % static_cast<unsigned>(things));
            g.add(1 + static_cast<std::int64_t>(random() % 100), a, a == b ? -1 : b);
        }
        const double work = region_work(g.region()), path = region_critical_path(g.region());
        EXPECT_EQ(time_of(g.region(), 1), work);
        EXPECT_EQ(time_of(g.region(), 1000), path);
        for (const int cores : {2, 3, 8, 64}) {
            const double time = time_of(g.region(), cores);
            EXPECT_GE(time, std::max(work / cores, path));
            EXPECT_LE(time, work / cores + path);
        }
    }
}

TEST(CostModel, InterpolatesAndGrowsByTheLawChosen) {
    const std::vector<ThreadCosts> measured{{4, 300, 80, 50}, {2, 100, 40, 30}};
    const CostModel costs(measured);
    EXPECT_EQ(costs.at(1).fork_join, 0);
    EXPECT_EQ(costs.at(2).fork_join, 100);
    EXPECT_EQ(costs.at(3).fork_join, 200);
    EXPECT_EQ(costs.at(3).barrier, 60);
    EXPECT_EQ(costs.at(4).hand_over, 50);
    EXPECT_EQ(costs.at(256).fork_join, 1200);
    EXPECT_EQ(costs.at(256).barrier, 320);
    EXPECT_EQ(costs.at(256).hand_over, 50);
    EXPECT_EQ(CostModel(measured, CostModel::Growth::linear).at(8).fork_join, 600);
    EXPECT_FALSE(costs.assumed());
    EXPECT_TRUE(CostModel({}).assumed());
    EXPECT_EQ(CostModel({}).at(2).barrier, kAssumedCosts.barrier);
}

TEST(CostModel, CostsCanBeMeasured) {
    EXPECT_TRUE(measure_costs(1).empty());
    const auto costs = measure_costs(2);
    ASSERT_EQ(costs.size(), 1u);
    EXPECT_EQ(costs[0].threads, 2);
    for (const ThreadCosts& c : costs) {
        EXPECT_GT(c.fork_join, 0);
        EXPECT_GT(c.barrier, 0);
        EXPECT_GE(c.hand_over, 0);
    }
}

/// Two steps of 1000 ns: 100 ns, a phase of 400 ns with an ordered region of 300 ns in it, a loop of 200 ns, 300 ns.
TaskRecord two_steps() {
    TaskRecord record;
    record.threads.resize(1);
    for (std::int32_t step = 0; step < 2; ++step) {
        const std::int64_t t = 2000 * step;
        const auto ordered = static_cast<std::int32_t>(record.regions.size());
        record.regions.push_back({"pairs", RegionKind::ordered, 3, t + 150, t + 450, 3 * step, step});
        record.links.insert(record.links.end(), {Successors{1, 2}, Successors{-1, -1}, Successors{-1, -1}});
        for (std::int32_t i = 0; i < 3; ++i)
            record.threads[0].push_back({t + 150 + 100 * i, t + 250 + 100 * i, ordered, i});
        record.regions.push_back({"bounds", RegionKind::loop, 2, t + 500, t + 700, 0, step});
        for (std::int32_t i = 0; i < 2; ++i)
            record.threads[0].push_back({t + 500 + 100 * i, t + 600 + 100 * i, ordered + 1, i});
        record.phases.push_back({"collisions", t + 100, t + 500, step});
        record.phases.push_back({"step", t, t + 1000, step});
    }
    return record;
}

TEST(Schedule, PhasesAddSerialTimeAndRegions) {
    const TaskRecord record = two_steps();
    const Schedule s = make_schedule(record, CostModel({{2, 10, 0, 5}}), {1, 2, 4});
    ASSERT_EQ(s.rows.size(), 5u);
    using Kind = ScheduleRow::Kind;
    const auto expect = [](const ScheduleRow& row, const char* name, Kind kind, int depth, double wall, double serial,
                           double work, double path) {
        EXPECT_EQ(row.name, name);
        EXPECT_EQ(row.kind, kind) << name;
        EXPECT_EQ(row.depth, depth) << name;
        EXPECT_EQ(row.count, 2) << name;
        EXPECT_EQ(row.wall, wall) << name;
        EXPECT_EQ(row.serial, serial) << name;
        EXPECT_EQ(row.work, work) << name;
        EXPECT_EQ(row.critical_path, path) << name;
    };
    expect(s.rows[0], "step", Kind::phase, 0, 2000, 1000, 2000, 1600);
    expect(s.rows[1], "collisions", Kind::phase, 1, 800, 200, 800, 600);
    expect(s.rows[2], "pairs", Kind::ordered, 2, 600, 0, 600, 400);
    expect(s.rows[3], "bounds", Kind::loop, 1, 400, 0, 400, 200);
    expect(s.rows[4], "rest", Kind::rest, 1, 800, 800, 800, 800);
    EXPECT_EQ(s.rows[0].regions, 4);
    EXPECT_EQ(s.rows[0].tasks, 10);
    EXPECT_EQ(s.rows[2].time, (std::vector<double>{600, 2 * (10 + 205), 2 * (10 * std::log2(3.0) + 205)}));
    EXPECT_EQ(s.rows[3].time, (std::vector<double>{400, 220, 220}));
    EXPECT_EQ(s.total.work, 2000);
    EXPECT_EQ(s.total.wall, 2000);
    EXPECT_EQ(s.total.time[1], 1000 + 430 + 220);
    EXPECT_DOUBLE_EQ(s.total.speedup(1), 2000.0 / 1650);
    EXPECT_DOUBLE_EQ(s.total.parallelism(), 2000.0 / 1600);
    EXPECT_EQ(s.tasks_time, 1000);
}

TEST(Schedule, WhatSweepsSpendOutsideTheirGroupsIsSerial) {
    TaskRecord record;
    record.threads.resize(1);
    record.regions.push_back({"sweeps", RegionKind::sweeps, 2, 100, 1100, 0, 0});
    record.groups.push_back({.tasks = 8, .visits = 10, .busy = 500});
    record.groups.push_back({.tasks = 8, .visits = 10, .busy = 300});
    record.phases.push_back({"step", 0, 1200, 0});
    const Schedule s = make_schedule(record, kFree, {1, 2});
    EXPECT_EQ(s.total.serial, 400);
    EXPECT_EQ(s.total.work, 1200);
    EXPECT_EQ(s.total.critical_path, 400 + 100);
    EXPECT_EQ(s.total.time[1], 400 + 400);
    // A loop between its sweeps counts for itself.
    record.regions.push_back({"loop", RegionKind::loop, 2, 600, 700, 0, 0});
    record.threads[0] = {{600, 650, 1, 0}, {650, 700, 1, 1}};
    const Schedule with_loop = make_schedule(record, kFree, {1, 2});
    EXPECT_EQ(with_loop.total.serial, 300);
    EXPECT_EQ(with_loop.total.work, 1200);
    EXPECT_EQ(with_loop.total.time[1], 300 + 400 + 50);
    record.regions.pop_back();
    record.threads[0].clear();
    // With more threads, busy times overlap, and the region's own time says nothing.
    record.threads.resize(2);
    EXPECT_EQ(make_schedule(record, kFree, {1, 2}).total.serial, 200);
}

TEST(MergeRecords, KeepsTheShortestTimesOfEverything) {
    // One was interrupted in a task, the other in a serial stretch and in another task.
    TaskRecord a = two_steps(), b = two_steps();
    const auto delay = [](TaskRecord& r, std::int64_t after, std::int64_t by) {
        const auto shift = [&](std::int64_t& t) { t += t > after ? by : 0; };
        for (RegionRecord& x : r.regions) shift(x.begin), shift(x.end);
        for (TaskSpan& x : r.threads[0]) shift(x.begin), shift(x.end);
        for (PhaseSpan& x : r.phases) shift(x.begin), shift(x.end);
    };
    delay(a, 300, 5000); // in task 1 of "pairs" of the first step
    delay(b, 2050, 700); // before "collisions" of the second
    delay(b, 2, 300);
    delay(b, 590 + 300, 40); // in a task of "bounds"
    const Schedule expected = make_schedule(two_steps(), kFree, {1, 2});
    EXPECT_GT(make_schedule(a, kFree, {1, 2}).total.work, 6999);
    ASSERT_TRUE(keep_shortest(a, b));
    const Schedule merged = make_schedule(a, kFree, {1, 2});
    ASSERT_EQ(merged.rows.size(), expected.rows.size());
    for (std::size_t i = 0; i < merged.rows.size(); ++i) {
        EXPECT_EQ(merged.rows[i].name, expected.rows[i].name);
        EXPECT_EQ(merged.rows[i].depth, expected.rows[i].depth);
        EXPECT_EQ(merged.rows[i].count, expected.rows[i].count);
        EXPECT_EQ(merged.rows[i].wall, expected.rows[i].wall);
        EXPECT_EQ(merged.rows[i].serial, expected.rows[i].serial);
        EXPECT_EQ(merged.rows[i].critical_path, expected.rows[i].critical_path);
        EXPECT_EQ(merged.rows[i].time, expected.rows[i].time);
    }
    ASSERT_TRUE(keep_shortest(a, two_steps()));
    EXPECT_EQ(make_schedule(a, kFree, {1, 2}).total.time, expected.total.time);
}

TEST(MergeRecords, RefusesOtherGraphs) {
    const auto refused = [](auto change) {
        TaskRecord a = two_steps(), b = two_steps();
        change(b);
        return !keep_shortest(a, b) && make_schedule(a, kFree, {1}).total.work == 2000;
    };
    EXPECT_FALSE(refused([](TaskRecord&) {}));
    EXPECT_TRUE(refused([](TaskRecord& r) { r.links[0] = {1, -1}; }));
    EXPECT_TRUE(refused([](TaskRecord& r) { r.regions[1].name = "other"; }));
    EXPECT_TRUE(refused([](TaskRecord& r) { r.phases.pop_back(); }));
    EXPECT_TRUE(refused([](TaskRecord& r) { r.threads.resize(2); }));
    EXPECT_TRUE(refused([](TaskRecord& r) { std::swap(r.threads[0][0].task, r.threads[0][1].task); }));
}

TEST(Schedule, RegionsOutsideAllPhasesCount) {
    TaskRecord record = two_steps();
    record.phases.clear();
    const Schedule s = make_schedule(record, kFree, {1});
    ASSERT_EQ(s.rows.size(), 2u);
    EXPECT_EQ(s.total.serial, 0);
    EXPECT_EQ(s.total.work, 1000);
    EXPECT_EQ(make_schedule(TaskRecord{}, kFree, {1, 2}).total.work, 0);
}

TEST(Schedule, AMillionTasksTakeSeconds) {
    constexpr std::int32_t kTasks = 1'000'000, kThings = 10'000;
    std::mt19937 random(3);
    Graph g(kThings);
    for (std::int32_t i = 0; i < kTasks; ++i)
        g.add(1000 + static_cast<std::int64_t>(random() % 1000), static_cast<std::int32_t>(random() % kThings),
              static_cast<std::int32_t>(random() % kThings));
    const auto begin = std::chrono::steady_clock::now();
    for (const int cores : {2, 16, 256}) EXPECT_GT(time_of(g.region(), cores, CostModel({{2, 500, 100, 200}})), 0);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    RecordProperty("seconds", std::to_string(seconds.count()));
    EXPECT_LT(seconds.count(), 20) << "9 widths of 10 million tasks within a minute need 0.7 s per million and width";
}

} // namespace
} // namespace flotilla
