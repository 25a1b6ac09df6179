// SPDX-License-Identifier: MIT
// flotilla sweep: cost against error over the product of some settings.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <flotilla/error.hpp>
#include <flotilla/sweep.hpp>

#include "cli/commands.hpp"
#include "cli/member_run.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "cli/stop_request.hpp"
#include "cli/value_checks.hpp"

namespace flotilla::cli {
namespace {

struct SweepArguments {
    SceneArguments options;
    SweepOptions sweep;
    std::vector<std::string> vary; ///< "key=a,b"
    int seeds = 0;
    std::string dt, time_limit, output;
    bool quiet = false;
};

SweepOptions resolve(const SweepArguments& arguments) {
    SweepOptions sweep = arguments.sweep;
    const SceneFileOptions options = arguments.options.resolve();
    sweep.preset = options.preset;
    sweep.overrides = options.overrides;
    if (!arguments.dt.empty()) sweep.overrides.emplace_back("time_step", arguments.dt);
    for (const std::string& text : arguments.vary) sweep.vary.push_back(parse_axis(text));
    if (arguments.seeds > 0) {
        SweepAxis seeds{"seed", {}};
        for (int k = 1; k <= arguments.seeds; ++k) seeds.values.push_back(std::to_string(k));
        sweep.vary.push_back(seeds);
    }
    sweep.output = arguments.output;
    return sweep;
}

std::string three_digits(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

std::string value_text(const SweepValue& value) {
    if (value.starts == 0) return "-";
    return three_digits(value.mean) + (value.starts > 1 ? " ± " + three_digits(value.spread) : "");
}

/// Columns of one terminal cell per character.
std::size_t width(const std::string& text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

void print_columns(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows)
        for (std::size_t k = 0; k < row.size(); ++k) {
            if (k == widths.size()) widths.push_back(0);
            widths[k] = std::max(widths[k], width(row[k]));
        }
    for (const auto& row : rows) {
        for (std::size_t k = 0; k < row.size(); ++k) {
            const std::string space(widths[k] - width(row[k]), ' ');
            std::cout << (k > 0 ? "  " : "") << (k > 0 ? space + row[k] : row[k] + space);
        }
        std::cout << '\n';
    }
}

void print_report(const SweepReport& report) {
    const SweepMetric& headline = report.metrics[report.headline];
    std::vector<std::vector<std::string>> rows{
        {"point", "starts", "cost, s", "error of " + std::string(headline.name)}};
    for (const SweepMetric& m : report.metrics)
        rows.front().push_back(std::string(m.name) + (m.unit.empty() ? "" : ", " + std::string(m.unit)));
    for (const SweepPoint& p : report.points) {
        const std::string mark = p.reference ? " (reference)" : p.on_front ? " *" : "";
        rows.push_back({p.label + mark, std::to_string(p.complete), value_text(p.cost),
                        p.reference ? "-" : value_text(p.errors[report.headline])});
        for (const SweepValue& v : p.values_of) rows.back().push_back(value_text(v));
    }
    print_columns(rows);
    std::cout << "* on the front: nothing here has less of both cost and error of " << headline.name << '\n';
    for (const std::string& text : report.advice) std::cout << text << '\n';
}

int run_sweep(const SweepArguments& arguments) {
    (void)parse_time_limit(arguments.time_limit);
    SweepOptions sweep = resolve(arguments);
    const StopRequest stop({}, true);
    const auto say = [&](const std::string& text) { std::cerr << "flotilla: " << text << '\n'; };
    SweepReport report;
    {
        std::unique_ptr<Progress> progress;
        sweep.stop = [&] { return stop.signalled(); };
        sweep.run = [&](const SweepMember& m) { return run_member(kThisProgram, m, arguments.time_limit, sweep.stop); };
        sweep.note = [&](const std::string& text) {
            if (!arguments.quiet) say(text);
        };
        sweep.progress = [&](std::size_t done, std::size_t total, const std::string& member) {
            if (!progress)
                progress = std::make_unique<Progress>("run", static_cast<std::int64_t>(total), arguments.quiet);
            progress->update(static_cast<std::int64_t>(done), member);
        };
        report = flotilla::run_sweep(sweep);
    }
    for (const std::string& problem : report.problems) say(problem);
    if (!arguments.quiet)
        for (const std::string& remark : report.remarks) say(remark);
    if (!arguments.quiet) {
        if (report.complete > 0) print_report(report);
        say("wrote " + (sweep.output / "sweep.html").string() + ", sweep.csv, members.csv and sweep.json");
    }
    if (report.stopped)
        say(std::to_string(report.complete) + " of " + std::to_string(report.members) +
            " runs are complete; --resume goes on");
    return report.exit_code;
}

void add_options(CLI::App& command, SweepArguments& arguments) {
    SweepOptions& sweep = arguments.sweep;
    command
        .add_option("SCENE", sweep.scenes,
                    "Scene files, or names of scenes of the library: several starts of one problem")
        ->required();
    command.add_option("--bodies", sweep.bodies, "Number of bodies of scenes of the library")->check(kPositiveCount);
    command
        .add_option("--vary", arguments.vary,
                    "key=a,b,...: values of a setting (plan --settings lists them), of preset, dt, or seed; every "
                    "combination is run")
        ->allow_extra_args(false)
        ->type_name("KEY=A,B,...");
    command
        .add_option(
            "--seeds", arguments.seeds,
            "As --vary seed=1,2,...,N: so many starts of a scene of the library (of a scene file, of its random "
            "tangents), over which mean and spread are taken")
        ->check(kPositiveCount);
    command.add_option("--reference", sweep.reference,
                       "Preset to compare with; where the time step is varied, at half of the shortest");
    std::string names;
    for (const SweepMetric& m : sweep_metrics()) (names += names.empty() ? "" : ", ").append(m.name);
    command
        .add_option("--metric", sweep.metrics,
                    "What to measure, the error of the front first: " + names +
                        " (default: all; the front's is position, "
                        "or height where the runs are chaotic)")
        ->allow_extra_args(false);
    add_scene_options(command, arguments.options);
    auto* steps = command.add_option("--steps", sweep.steps, "Steps of a run; with other time steps, the same time")
                      ->check(kPositiveCount);
    command.add_option("--duration", sweep.duration, "Time of a run, s (default 10)")
        ->check(kPositive)
        ->excludes(steps);
    command.add_option("--dt", arguments.dt, "Time step, s; replaces the scene's")->check(kPositive);
    command.add_option("--output", arguments.output, "Folder of the campaign: tables, page and the runs' folders")
        ->required()
        ->check(kNotEmpty);
    command.add_option("--threads", sweep.threads, "Threads of a run")->check(kPositiveCount)->capture_default_str();
    command
        .add_option("--jobs", sweep.jobs,
                    "Runs at a time (default and most: as many as have cores of their own, so that times are true)")
        ->check(kPositiveCount);
    command.add_option("--time-limit", arguments.time_limit,
                       "H:M:S of a run; what takes longer stops with a checkpoint (exit code 6)");
    auto* overwrite = command.add_flag("--overwrite", sweep.overwrite, "Replace an earlier campaign in the folder");
    command
        .add_flag(
            "--resume", sweep.resume,
            "Go on: complete runs are kept, stopped ones go on; other values of --vary add runs, another scene or "
            "setting is refused")
        ->excludes(overwrite);
    command.add_flag("--quiet", arguments.quiet, "No progress, no notes and no table; problems are printed");
}

} // namespace

void register_sweep(CLI::App& app, Action& action, const std::vector<std::string>& command_line) {
    const auto arguments = std::make_shared<SweepArguments>();
    arguments->sweep.command_line = command_line;
    CLI::App* command = app.add_subcommand(
        "sweep",
        "Run a scene with every combination of some settings: cost against error, and what to change first; exit "
        "code 6 where runs stopped early: --resume goes on. Where runs failed, that of the first");
    add_options(*command, *arguments);
    command->callback([arguments, &action] { action = [arguments] { return run_sweep(*arguments); }; });
}

} // namespace flotilla::cli
