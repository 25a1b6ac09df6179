// SPDX-License-Identifier: MIT
#include "trace/measure_costs.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>

#include "parallel/team.hpp"

namespace flotilla {
namespace {

double clock_ns() {
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Calls f(samples), which appends to them, until there are many or enough time is spent.
template <class F>
std::vector<double> collect(F&& f) {
    constexpr std::size_t kMany = 2000;
    constexpr double kTime = 200e6; // ns; where both threads have a core, a hundredth of it is enough
    std::vector<double> samples;
    f(samples); // wakes the threads and warms the caches
    samples.clear();
    const double begin = clock_ns();
    do f(samples);
    while (samples.size() < kMany && clock_ns() - begin < kTime);
    return samples;
}

/// The tenth percentile: other work on the machine only ever adds.
double undisturbed(std::vector<double> samples) {
    const auto place = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 10);
    std::nth_element(samples.begin(), place, samples.end());
    return *place;
}

double fork_join(Team& team) {
    return undisturbed(collect([&](std::vector<double>& samples) {
        for (int i = 0; i < 20; ++i) {
            const double begin = clock_ns();
            team.phases(team.size(), 1, [](std::size_t, int) {});
            samples.push_back(clock_ns() - begin);
        }
    }));
}

double barrier_round(Team& team) {
    constexpr std::size_t kRounds = 20; // their mean: the last to arrive does not wait, the first waits longer
    return undisturbed(collect([&](std::vector<double>& samples) {
        double begin = 0, end = 0;
        team.phases(team.size(), kRounds + 2, [&](std::size_t phase, int share) {
            if (share == 0 && phase == 1) begin = clock_ns(); // all are there
            if (share == 0 && phase == kRounds + 1) end = clock_ns();
        });
        samples.push_back((end - begin) / kRounds);
    }));
}

/// Tasks in threes: one that uses two things, then one for each of them, of which another thread gets one.
double hand_over(Team& team) {
    constexpr std::size_t kLevels = 40;
    constexpr double kTaskTime = 5000; // ns, long enough for a hand-over
    struct Ran {
        double begin = 0, end = 0;
        int thread = 0;
    };
    TaskOrder order;
    order.start(2);
    for (std::size_t level = 0; level < kLevels; ++level) {
        order.add(0, 1);
        order.add(0, -1);
        order.add(1, -1);
    }
    std::vector<Ran> ran(order.size());
    std::vector<double> samples = collect([&](std::vector<double>& out) {
        team.run("", order, [&](std::size_t task, int thread) {
            const double begin = clock_ns();
            double now = begin;
            while (now < begin + kTaskTime) now = clock_ns();
            ran[task] = {begin, now, thread};
        });
        for (std::size_t first = 0; first < ran.size(); first += 3)
            for (const std::size_t task : {first + 1, first + 2})
                if (ran[task].thread != ran[first].thread) out.push_back(ran[task].begin - ran[first].end);
    });
    if (samples.empty()) return kAssumedCosts.hand_over; // one thread did it all
    return undisturbed(std::move(samples));
}

} // namespace

std::vector<ThreadCosts> measure_costs(int widest) {
    std::vector<ThreadCosts> costs;
    if (widest < 2) return costs;
    for (int threads = 2;; threads = std::min(widest, threads + std::max(1, threads / 8))) {
        Team team({threads});
        team.region([&] { costs.push_back({threads, fork_join(team), barrier_round(team), hand_over(team)}); });
        if (threads == widest) return costs;
    }
}

} // namespace flotilla
