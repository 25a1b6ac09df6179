// SPDX-License-Identifier: MIT
#include "parallel/measure_costs.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>

#include "parallel/team.hpp"

namespace flotilla {
namespace {

constexpr int kRounds = 15;

double now_ns() {
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The median of kRounds results of f() after one that is not counted.
template <class F>
double median(F&& f) {
    std::vector<double> values;
    f();
    for (int round = 0; round < kRounds; ++round) values.push_back(f());
    const auto middle = values.begin() + kRounds / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double fork_join(Team& team) {
    constexpr int kCalls = 50;
    return median([&] {
        const double begin = now_ns();
        for (int i = 0; i < kCalls; ++i) team.together(team.size(), [](int, SpinBarrier&) {});
        return (now_ns() - begin) / kCalls;
    });
}

double barrier_round(Team& team) {
    constexpr int kCalls = 200;
    return median([&] {
        double time = 0;
        team.together(team.size(), [&](int thread, SpinBarrier& barrier) {
            barrier.wait(); // all are there
            const double begin = now_ns();
            for (int i = 0; i < kCalls; ++i) barrier.wait();
            if (thread == 0) time = (now_ns() - begin) / kCalls;
        });
        return time;
    });
}

/// Tasks in threes: one that uses two things, then one for each of them. Two threads do the latter side by side, and one of them gets
/// its task from the other.
constexpr int kLevels = 60;
constexpr double kTaskTime = 5000; // ns; a hand-over that takes longer is measured as this

TaskOrder ladder() {
    TaskOrder order;
    order.start(2);
    for (int level = 0; level < kLevels; ++level) {
        order.add(0, 1);
        order.add(0, -1);
        order.add(1, -1);
    }
    return order;
}

/// ns of a level of the ladder.
double level_time(Team& team, const TaskOrder& order) {
    return median([&] {
        const double begin = now_ns();
        team.run("", order, [](std::size_t, int) {
            for (const double end = now_ns() + kTaskTime; now_ns() < end;) {
            }
        });
        return (now_ns() - begin) / kLevels;
    });
}

} // namespace

std::vector<ThreadCosts> measure_costs(int widest) {
    std::vector<ThreadCosts> costs;
    if (widest < 2) return costs;
    const TaskOrder order = ladder();
    Team one;
    const double task = level_time(one, order) / 3;
    for (int threads = 2;; threads = std::min(widest, threads + std::max(1, threads / 8))) {
        Team team({threads});
        ThreadCosts c;
        c.threads = threads;
        c.fork_join = fork_join(team);
        c.barrier = barrier_round(team);
        // Of three tasks two run side by side; what is left beside two tasks is the hand-over.
        c.hand_over = std::max(0.0, level_time(team, order) - 2 * task);
        costs.push_back(c);
        if (threads == widest) return costs;
    }
}

} // namespace flotilla
