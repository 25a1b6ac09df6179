// SPDX-License-Identifier: MIT
// What the recorded task graph of a run says about more cores.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace flotilla {

/// How the cost of bringing threads together grows beyond the widest measured team: as log2 of the width (signals
/// passed on as a tree), or with the width (one after the other).
enum class CostGrowth { log2, linear };

struct TraceOptions {
    std::vector<int> cores{1, 2, 4, 8, 16, 32, 64, 128, 256}; ///< >= 1
    CostGrowth growth = CostGrowth::log2;
    bool assume_costs = false; ///< of an idle machine, in place of those measured on a busy one
};

/// What a number of cores pays beside its tasks, ns.
struct TraceCosts {
    int cores = 1;
    double fork_join = 0; ///< a parallel section without work
    double barrier = 0;   ///< of all threads
    double hand_over = 0; ///< of a task to another thread
};

/// A phase of a step, or the parallel sections (regions) of one name in it. Times are sums over all recorded steps.
struct TraceRow {
    std::string name;
    std::string kind;            ///< phase, rest (of a phase outside its parts), loop, ordered, sweeps
    int depth = 0;               ///< rows follow the row that they are part of, which has less depth
    std::int64_t count = 0;      ///< of phases or regions
    std::int64_t regions = 0;    ///< parallel sections, of all parts
    std::int64_t tasks = 0;      ///< of sweeps: visits
    double wall_ms = 0;          ///< as recorded
    double serial_ms = 0;        ///< outside regions
    double work_ms = 0;          ///< serial and all tasks: one core
    double critical_path_ms = 0; ///< any number of cores, no costs
    double parallelism = 1;      ///< work over critical path
    std::vector<double> speedup; ///< by TraceOptions::cores: work over the time of a greedy schedule with costs
};

struct TraceReport {
    std::string version, commit, processor;
    std::vector<std::string> command_line;
    int threads = 1;             ///< of the recorded run
    std::int64_t recordings = 1; ///< files
    std::int64_t steps = 0;      ///< recorded
    int trace_every = 1;         ///< steps per recorded step
    double wall_seconds = 0;     ///< of the recorded steps; least of all recordings
    double cpu_seconds = 0;      ///< of the process in them; least of all recordings
    double covered = 0; ///< tasks and serial stretches as a share of cpu_seconds; above 1 where others had the core;
                        ///< least of all recordings
    std::vector<int> cores;
    std::vector<TraceCosts> costs; ///< by `cores`
    int measured_cores = 1;        ///< costs of more follow CostGrowth; 1: none was measured, all are assumed
    TraceRow total;
    std::vector<TraceRow> rows;
    std::vector<std::string> notes; ///< what to keep in mind with these numbers
};

/// Below this share the record misses too much of the run for its numbers to stand for it.
inline constexpr double kTraceCoverage = 0.95;

/// Reads files of `flotilla run --trace` and builds greedy schedules (a core that becomes free takes the lowest task
/// that is ready) for each number of cores. Several files must be recordings of the same run on one thread: of each
/// task the shortest time counts, so that what other work on the machine took from one of them drops out. Throws
/// InputError (content, options) and IoError (file that cannot be read).
[[nodiscard]] TraceReport analyze_trace(const std::vector<std::filesystem::path>& files,
                                        const TraceOptions& options = {});

} // namespace flotilla
