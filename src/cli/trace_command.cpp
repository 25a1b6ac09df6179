// SPDX-License-Identifier: MIT
// flotilla trace: what the recorded task graph of a run says about more cores.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <flotilla/trace.hpp>

#include "cli/commands.hpp"
#include "cli/enum_option.hpp"
#include "cli/value_checks.hpp"

namespace flotilla::cli {
namespace {

struct TraceArguments {
    std::vector<std::filesystem::path> files;
    TraceOptions options;
    bool csv = false;
};

std::string number(double value, const char* format) {
    char text[48];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

using Line = std::vector<std::string>;

/// The first columns left-aligned, the others right-aligned.
void print_table(const std::vector<Line>& lines, std::size_t left) {
    std::vector<std::size_t> width;
    for (const Line& line : lines) {
        width.resize(std::max(width.size(), line.size()));
        for (std::size_t i = 0; i < line.size(); ++i) width[i] = std::max(width[i], line[i].size());
    }
    for (const Line& line : lines) {
        std::string text;
        for (std::size_t i = 0; i < line.size(); ++i) {
            const std::string padding(width[i] - line[i].size(), ' ');
            text += (i > 0 ? "  " : "") + (i < left ? line[i] + padding : padding + line[i]);
        }
        std::cout << text << '\n';
    }
}

void print_header(const TraceReport& r) {
    std::cout << "command:    ";
    for (std::size_t i = 0; i < r.command_line.size(); ++i) std::cout << (i > 0 ? " " : "") << r.command_line[i];
    std::cout << "\nprogram:    flotilla " << r.version << ", commit " << r.commit << "\nmachine:    " << r.processor
              << ", " << r.threads << (r.threads == 1 ? " thread" : " threads") << "\nrecorded:   " << r.steps
              << " steps (every " << r.trace_every
              << (r.recordings > 1 ? ") in " + std::to_string(r.recordings) + " recordings, " : "), ")
              << number(r.wall_seconds, "%.3f") << " s, CPU time " << number(r.cpu_seconds, "%.3f")
              << " s\ncovered:    " << number(100 * r.covered, "%.1f")
              << " % of the CPU time is in recorded tasks and serial stretches\n";
}

void print_costs(const TraceReport& r, CostGrowth growth) {
    std::vector<Line> lines{{"costs, ns"}, {"fork and join"}, {"barrier"}, {"hand-over of a task"}};
    for (const TraceCosts& c : r.costs) {
        lines[0].push_back(std::to_string(c.cores));
        lines[1].push_back(number(c.fork_join, "%.0f"));
        lines[2].push_back(number(c.barrier, "%.0f"));
        lines[3].push_back(number(c.hand_over, "%.0f"));
    }
    std::cout << '\n';
    print_table(lines, 1);
    std::cout << (r.measured_cores > 1 ? "measured up to " + std::to_string(r.measured_cores) : "assumed for 2")
              << " cores; beyond, fork-join and barrier grow with "
              << (growth == CostGrowth::log2 ? "log2 of the cores" : "the cores") << ", a hand-over stays\n";
}

void print_rows(const TraceReport& r) {
    Line header{"ms per step", "kind", "number", "tasks", "serial", "work", "critical path", "parallelism"};
    for (const int cores : r.cores) header.push_back("x" + std::to_string(cores));
    std::vector<Line> lines{header};
    const double steps = r.steps > 0 ? static_cast<double>(r.steps) : 1;
    const auto add = [&](const TraceRow& row, int depth) {
        Line line{std::string(2 * static_cast<std::size_t>(depth), ' ') + row.name,
                  row.kind,
                  number(static_cast<double>(row.count) / steps, "%.1f"),
                  number(static_cast<double>(row.tasks) / steps, "%.1f"),
                  number(row.serial_ms / steps, "%.3f"),
                  number(row.work_ms / steps, "%.3f"),
                  number(row.critical_path_ms / steps, "%.3f"),
                  number(row.parallelism, "%.2f")};
        for (const double s : row.speedup) line.push_back(number(s, "%.2f"));
        lines.push_back(line);
    };
    for (const TraceRow& row : r.rows) add(row, row.depth);
    add(r.total, 0);
    std::cout << '\n';
    print_table(lines, 2);
}

/// Names of phases and regions are our own and need no quotes; a path tells parts of one name apart.
void print_csv(const TraceReport& r) {
    std::cout << "phase,kind,number,regions,tasks,wall_ms,serial_ms,work_ms,critical_path_ms,parallelism";
    for (const int cores : r.cores) std::cout << ",speedup_" << cores;
    std::cout << '\n';
    const auto print = [&](const std::string& path, const TraceRow& row) {
        std::cout << path << ',' << row.kind << ',' << row.count << ',' << row.regions << ',' << row.tasks;
        for (const double ms : {row.wall_ms, row.serial_ms, row.work_ms, row.critical_path_ms})
            std::cout << ',' << number(ms, "%.6f");
        std::cout << ',' << number(row.parallelism, "%.6g");
        for (const double s : row.speedup) std::cout << ',' << number(s, "%.6g");
        std::cout << '\n';
    };
    std::vector<std::string> path;
    for (const TraceRow& row : r.rows) {
        path.resize(static_cast<std::size_t>(row.depth));
        path.push_back(path.empty() ? row.name : path.back() + "/" + row.name);
        print(path.back(), row);
    }
    print("total", r.total);
}

int run_trace(const TraceArguments& arguments) {
    const TraceReport report = analyze_trace(arguments.files, arguments.options);
    for (const std::string& note : report.notes) std::cerr << "note: " << note << '\n';
    if (arguments.csv) {
        print_csv(report);
        return kOk;
    }
    print_header(report);
    print_costs(report, arguments.options.growth);
    print_rows(report);
    std::cout << "\nxN: speed-up on N cores of a greedy schedule (a core that becomes free takes the lowest ready "
                 "task), with costs\n";
    return kOk;
}

} // namespace

void register_trace(CLI::App& app, Action& action) {
    const auto arguments = std::make_shared<TraceArguments>();
    CLI::App* command =
        app.add_subcommand("trace", "Work, critical path and predicted speed-up of a run recorded with run --trace");
    command->footer("Regions (parallel sections) follow one another; what lies between them is serial. A loop's chunks "
                    "and ordered tasks\n"
                    "are given to cores greedily, lowest number first; sweeps take ceil(tasks / cores) rounds for each "
                    "visit of a group,\n"
                    "and a barrier after it or, where shares wait for their neighbours alone, a hand-over. A region "
                    "pays fork and\n"
                    "join once, a task that waited for one on another core its hand-over. Costs are those\n"
                    "measured on the machine of the run up to its cores; beyond them --growth tells how fork-join and "
                    "barrier grow.\n"
                    "Record on one thread (run --threads 1 --trace FILE): tasks then do not disturb each other; on a "
                    "machine with other\n"
                    "work record several times and give all files: of each task the shortest time counts. The table "
                    "gives means per\n"
                    "recorded step, the CSV form sums over all recorded steps.");
    command
        ->add_option("FILE", arguments->files,
                     "Written by run --trace; several: recordings of the same run on one thread, of each task the "
                     "shortest time counts")
        ->required();
    command->add_flag("--assume-costs", arguments->options.assume_costs,
                      "Take costs of an idle machine (two threads: fork-join 1000 ns, barrier and hand-over 300 ns)");
    command->add_flag("--csv", arguments->csv, "Print the rows as CSV");
    command->add_option("--cores", arguments->options.cores, "Numbers of cores (default: 1 2 4 ... 256)")
        ->check(kPositiveCount)
        ->delimiter(',')
        ->allow_extra_args(false);
    add_enum_option<CostGrowth>(*command, "--growth", arguments->options.growth,
                                {{"log2", CostGrowth::log2}, {"linear", CostGrowth::linear}},
                                "Of fork-join and barrier beyond the measured cores: log2 or linear in them");
    command->callback([arguments, &action] { action = [arguments] { return run_trace(*arguments); }; });
}

} // namespace flotilla::cli
