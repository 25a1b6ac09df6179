// SPDX-License-Identifier: MIT
// A small recorded team: a loop of 10 tasks, an ordered run of 100, sweeps over two groups.
#pragma once

#include <cmath>

#include "parallel/team.hpp"
#include "trace/trace_file.hpp"

namespace flotilla::test {

/// Takes some microseconds.
inline void work_a_little(std::size_t i) {
    volatile double sum = 0;
    for (std::size_t k = 0; k < 200 + 50 * (i % 7); ++k) sum = sum + std::sqrt(static_cast<double>(k));
}

inline TaskRecorder record_sample(int threads) {
    Team team({threads});
    TaskRecorder recorder(threads);
    team.record_to(&recorder);
    recorder.set_step(4);
    const std::int64_t begin = recorder.now();
    team.for_chunks("first \"loop\"", 20, 2, [](std::size_t i, std::size_t, int) { work_a_little(i); });
    const std::int64_t middle = recorder.now();
    TaskOrder order;
    order.start(12);
    for (std::int32_t i = 0; i < 100; ++i) order.add(i % 12, (5 * i + 1) % 12);
    team.run("pairs", order, [](std::size_t i, int) { work_a_little(i); });
    recorder.add_phase("collisions", middle, recorder.now());
    const std::int32_t region = recorder.begin_region("sweeps", RegionKind::sweeps, 12, nullptr);
    recorder.end_region(region);
    recorder.add_group({region, 8, 3, 0, 240});
    recorder.add_group({region, 4, 3, 3, 120});
    recorder.add_phase("step", begin, recorder.now());
    team.record_to(nullptr);
    return recorder;
}

inline io::TraceInfo sample_trace_info(int threads) {
    io::TraceInfo info;
    info.threads = threads;
    info.command_line = {"flotilla", "run", "scene \"1\".json"};
    info.steps = 7;
    info.trace_every = 3;
    info.cpu_seconds = 0.125;
    info.wall_seconds = 0.1;
    info.costs = {{2, 900, 250, 300}, {4, 1500.25, 400, 320}};
    return info;
}

} // namespace flotilla::test
