// SPDX-License-Identifier: MIT
#include <flotilla/trace.hpp>

#include <algorithm>
#include <cstdio>

#include <flotilla/error.hpp>

#include "io/trace_file.hpp"
#include "parallel/schedule.hpp"

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

void add_notes(TraceReport& report) {
    if (report.threads > 1)
        report.notes.push_back(
            "recorded on " + std::to_string(report.threads) +
            " threads, which disturb each other: durations of tasks are less certain than those of a "
            "recording on one");
    if (report.threads == 1 && report.cpu_seconds < kTraceCoverage * report.wall_seconds)
        report.notes.emplace_back(
            "other work had the core for part of the recorded time: tasks that were interrupted seem longer than "
            "they are");
    if (report.measured_cores == 1)
        report.notes.emplace_back("the machine of the run had one core: costs are assumed, not measured");
    if (report.covered < kTraceCoverage && report.steps > 0) {
        char text[128];
        std::snprintf(
            text, sizeof text, "tasks and serial stretches are below %.0f %% of the CPU time: %s", 100 * kTraceCoverage,
            report.threads > 1 ? "the rest is waiting and recording" : "something in the steps is not recorded");
        report.notes.emplace_back(text);
    }
}

} // namespace

TraceReport analyze_trace(const std::filesystem::path& path, const TraceOptions& options) {
    check_options(options);
    const io::Trace trace = io::read_trace(path);
    const CostModel costs(trace.info.costs,
                          options.growth == CostGrowth::log2 ? CostModel::Growth::log2 : CostModel::Growth::linear);
    const Schedule schedule = make_schedule(trace.record, costs, options.cores);
    TraceReport report;
    report.version = trace.info.version;
    report.commit = trace.info.commit;
    report.processor = trace.info.processor;
    report.command_line = trace.info.command_line;
    report.threads = trace.info.threads;
    report.steps = trace.info.steps;
    report.trace_every = trace.info.trace_every;
    report.wall_seconds = trace.info.wall_seconds;
    report.cpu_seconds = trace.info.cpu_seconds;
    if (trace.info.cpu_seconds > 0)
        report.covered = 1e-9 * (schedule.tasks_time + schedule.total.serial) / trace.info.cpu_seconds;
    report.cores = options.cores;
    for (const int cores : options.cores) {
        const ThreadCosts c = costs.at(cores);
        report.costs.push_back({cores, c.fork_join, c.barrier, c.hand_over});
    }
    report.measured_cores = costs.assumed() ? 1 : costs.widest();
    report.total = report_row(schedule.total);
    for (const ScheduleRow& row : schedule.rows) report.rows.push_back(report_row(row));
    add_notes(report);
    return report;
}

} // namespace flotilla
