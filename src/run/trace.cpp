// SPDX-License-Identifier: MIT
#include <flotilla/trace.hpp>

#include <algorithm>
#include <cstdio>

#include <flotilla/error.hpp>

#include "trace/merge_records.hpp"
#include "trace/schedule.hpp"
#include "trace/trace_file.hpp"

namespace flotilla {
namespace {

constexpr double kMsPerNs = 1e-6;

const char* name_of(ScheduleRow::Kind kind) {
    switch (kind) {
    case ScheduleRow::Kind::phase: return "phase";
    case ScheduleRow::Kind::rest: return "rest";
    case ScheduleRow::Kind::loop: return "loop";
    case ScheduleRow::Kind::ordered: return "ordered";
    case ScheduleRow::Kind::sweeps: return "sweeps";
    }
    return "";
}

TraceRow report_row(const ScheduleRow& row) {
    TraceRow out;
    out.name = row.name;
    out.kind = name_of(row.kind);
    out.depth = row.depth;
    out.count = row.count;
    out.regions = row.regions;
    out.tasks = row.tasks;
    out.wall_ms = kMsPerNs * row.wall;
    out.serial_ms = kMsPerNs * row.serial;
    out.work_ms = kMsPerNs * row.work;
    out.critical_path_ms = kMsPerNs * row.critical_path;
    out.parallelism = row.parallelism();
    for (std::size_t w = 0; w < row.time.size(); ++w) out.speedup.push_back(row.speedup(w));
    return out;
}

void check_options(const TraceOptions& options) {
    constexpr int kMostCores = 1 << 16;
    for (const int cores : options.cores)
        if (cores < 1 || cores > kMostCores)
            throw InputError("trace: " + std::to_string(cores) + " is not a number of cores from 1 to " +
                             std::to_string(kMostCores));
}

/// ns; two threads that both have a core need a few cache misses.
constexpr double kMostForkJoin = 50e3;

void add_notes(const TraceOptions& options, const CostModel& costs, TraceReport& report) {
    if (report.threads > 1)
        report.notes.push_back(
            "recorded on " + std::to_string(report.threads) +
            " threads, which disturb each other: durations of tasks are less certain than those of a "
            "recording on one");
    if (report.threads == 1 && report.recordings == 1 && report.cpu_seconds < kTraceCoverage * report.wall_seconds)
        report.notes.emplace_back(
            "other work had the core for part of the recorded time: tasks that were interrupted seem longer than "
            "they are; give several recordings of the run");
    if (report.measured_cores == 1 && !options.assume_costs)
        report.notes.emplace_back("the machine of the run had one core: costs are assumed, not measured");
    if (costs.at(2).fork_join > kMostForkJoin)
        report.notes.emplace_back(
            "the machine of the run was too busy to measure what threads cost: see --assume-costs");
    if (report.covered < kTraceCoverage && report.steps > 0) {
        char text[160];
        std::snprintf(text, sizeof text, "tasks and serial stretches are below %.0f %% of the CPU time: %s",
                      100 * kTraceCoverage,
                      report.threads > 1 ? "the rest is waiting and recording"
                                         : "the rest is recording, or something in the steps is not recorded");
        report.notes.emplace_back(text);
    }
}

/// Tasks and serial stretches as a share of the CPU time.
double coverage(const io::Trace& trace) {
    const Schedule plain = make_schedule(trace.record, CostModel({}), {});
    return trace.info.cpu_seconds > 0 ? 1e-9 * (plain.tasks_time + plain.total.serial) / trace.info.cpu_seconds : 0;
}

/// Costs of the same machine, the least of each.
void keep_least(std::vector<ThreadCosts>& costs, const std::vector<ThreadCosts>& others) {
    if (costs.size() != others.size()) return;
    for (std::size_t i = 0; i < costs.size(); ++i) {
        costs[i].fork_join = std::min(costs[i].fork_join, others[i].fork_join);
        costs[i].barrier = std::min(costs[i].barrier, others[i].barrier);
        costs[i].hand_over = std::min(costs[i].hand_over, others[i].hand_over);
    }
}

} // namespace

TraceReport analyze_trace(const std::vector<std::filesystem::path>& files, const TraceOptions& options) {
    check_options(options);
    if (files.empty()) throw InputError("trace: no file");
    io::Trace trace = io::read_trace(files[0]);
    TraceReport report;
    report.covered = coverage(trace);
    for (std::size_t i = 1; i < files.size(); ++i) {
        const io::Trace other = io::read_trace(files[i]);
        if (!keep_shortest(trace.record, other.record))
            throw InputError(files[i].string() + ": not a recording of the same run as " + files[0].string() +
                             ", both on one thread");
        report.covered = std::min(report.covered, coverage(other));
        trace.info.cpu_seconds = std::min(trace.info.cpu_seconds, other.info.cpu_seconds);
        trace.info.wall_seconds = std::min(trace.info.wall_seconds, other.info.wall_seconds);
        keep_least(trace.info.costs, other.info.costs);
    }
    if (options.assume_costs) trace.info.costs.clear();
    const CostModel costs(trace.info.costs,
                          options.growth == CostGrowth::log2 ? CostModel::Growth::log2 : CostModel::Growth::linear);
    const Schedule schedule = make_schedule(trace.record, costs, options.cores);
    report.recordings = static_cast<std::int64_t>(files.size());
    report.version = trace.info.version;
    report.commit = trace.info.commit;
    report.processor = trace.info.processor;
    report.command_line = trace.info.command_line;
    report.threads = trace.info.threads;
    report.steps = trace.info.steps;
    report.trace_every = trace.info.trace_every;
    report.wall_seconds = trace.info.wall_seconds;
    report.cpu_seconds = trace.info.cpu_seconds;
    report.cores = options.cores;
    for (const int cores : options.cores) {
        const ThreadCosts c = costs.at(cores);
        report.costs.push_back({cores, c.fork_join, c.barrier, c.hand_over});
    }
    report.measured_cores = costs.assumed() ? 1 : costs.widest();
    report.total = report_row(schedule.total);
    for (const ScheduleRow& row : schedule.rows) report.rows.push_back(report_row(row));
    add_notes(options, costs, report);
    return report;
}

} // namespace flotilla
