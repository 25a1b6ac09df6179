// SPDX-License-Identifier: MIT
// The file of `flotilla run --trace`: the executed task graph in the Chrome trace format, which chrome://tracing and
// Perfetto show.
//
// A JSON object:
//   "otherData"    flotilla_trace (the format's version, 2), version, commit, processor, threads, command_line, steps,
//                  trace_every, cpu_seconds and wall_seconds of the recorded steps, and what was measured of thread
//                  costs: the arrays cost_threads, cost_fork_join_ns, cost_barrier_ns, cost_hand_over_ns, an element
//                  per width
//   "traceEvents"  complete events (ph "X"; ts, dur in us with three decimals, so exact in ns), a line each, told apart
//     by cat:
//     phase                  a step or a part of one; args: step
//     loop, ordered, sweeps  a region, named as the team's call; args: region (its number), tasks, step; of sweeps
//                            tasks is the most threads they get, and groups is [tasks, visits, barriers, busy ns]
//                            of each, because visits are too many
//     task                   a task of a loop or an ordered run; tid is its thread; args: region, task (number within
//                            it), and of ordered ones next: the tasks that waited for it
// Phases and regions are on the thread that calls the team, 0. Regions come before all tasks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "parallel/task_recorder.hpp"
#include "trace/schedule.hpp"

namespace flotilla::io {

struct TraceInfo {
    int threads = 1;
    std::vector<std::string> command_line;
    std::int64_t steps = 0;  ///< recorded
    int trace_every = 1;     ///< steps per recorded step
    double cpu_seconds = 0;  ///< of the process in the recorded steps, all threads
    double wall_seconds = 0; ///< of the recorded steps
    std::vector<ThreadCosts> costs;
    std::string version, commit, processor; ///< ignored by writing
};

/// What a file holds. `record` has its names in `names`.
struct Trace {
    TraceInfo info;
    TaskRecord record;
    std::set<std::string, std::less<>> names; // nodes stay where they are when the trace is moved

    Trace() = default;
    Trace(Trace&&) = default;
    Trace& operator=(Trace&&) = default;
};

/// Writes in one pass, without a copy of the record; compressed where the name ends with .gz.
void write_trace(const std::filesystem::path& path, const TraceInfo& info, const TaskRecord& record);

/// InputError where the content is not such a trace or contradicts itself, IoError where the file cannot be read.
[[nodiscard]] Trace read_trace(const std::filesystem::path& path);

} // namespace flotilla::io
