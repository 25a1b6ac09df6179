// SPDX-License-Identifier: MIT
#include "mpi/run_command.hpp"

#include <CLI/CLI.hpp>

#include <charconv>
#include <iostream>
#include <memory>

#include <flotilla/error.hpp>

#include "cli/member_run.hpp"
#include "cli/run_action.hpp"
#include "cli/scene_options.hpp"
#include "cli/stop_request.hpp"
#include "cli/value_checks.hpp"
#include "mpi/ensemble.hpp"

namespace flotilla::mpi {
namespace {

struct RunArguments {
    cli::SceneArguments options;
    SweepOptions sweep;            ///< what a member is
    std::vector<std::string> vary; ///< "key=a,b"
    std::string seeds, dt, time_limit, output;
    bool quiet = false;
};

std::uint64_t parse_seed(const std::string& text, const std::string& all) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
        throw InputError("--seeds " + all + ": must be N, FIRST-LAST, or a list of such");
    return value;
}

/// "16" as 1 to 16, as of sweep; "3-5,9" as 3, 4, 5, 9.
SweepAxis parse_seeds(const std::string& text) {
    SweepAxis axis{"seed", {}};
    const bool single = text.find_first_of(",-") == std::string::npos;
    const std::string list = single ? "1-" + text : text;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const std::string part = list.substr(begin, end - begin);
        const std::size_t dash = part.find('-');
        const std::uint64_t first = parse_seed(part.substr(0, dash), text);
        const std::uint64_t last = dash == std::string::npos ? first : parse_seed(part.substr(dash + 1), text);
        if (last < first) throw InputError("--seeds " + text + ": " + part + " is empty");
        if (last - first >= 10000) throw InputError("--seeds " + text + ": more than 10000 runs");
        for (std::uint64_t seed = first; seed <= last; ++seed) axis.values.push_back(std::to_string(seed));
        begin = end + 1;
    }
    return axis;
}

SweepOptions resolve(const RunArguments& arguments) {
    SweepOptions sweep = arguments.sweep;
    const SceneFileOptions options = arguments.options.resolve();
    sweep.preset = options.preset;
    sweep.overrides = options.overrides;
    if (!arguments.dt.empty()) sweep.overrides.emplace_back("time_step", arguments.dt);
    for (const std::string& text : arguments.vary) sweep.vary.push_back(cli::parse_axis(text));
    if (!arguments.seeds.empty()) sweep.vary.push_back(parse_seeds(arguments.seeds));
    sweep.output = arguments.output;
    return sweep;
}

void say(const std::string& text) { std::cerr << "flotilla-mpi: " + text + '\n'; }

void print_report(const Ensemble& ensemble, const EnsembleReport& report, bool quiet) {
    for (const std::string& text : report.lost) say(text);
    for (const std::string& text : report.problems) say(text);
    if (!quiet)
        say("wrote " + (ensemble.folder / kEnsembleJson).string() + " and " + std::string(kEnsembleCsv) + ": " +
            std::to_string(report.complete) + " of " + std::to_string(report.members) + " runs are complete" +
            (report.complete < report.members ? "; --resume goes on" : ""));
}

int run_ensemble(const RunArguments& arguments, Session& session) {
    Ensemble ensemble;
    const auto prepare = [&] {
        (void)cli::parse_time_limit(arguments.time_limit);
        if (arguments.output.empty()) throw InputError("run: an ensemble needs --output DIR");
        ensemble.plan = sweep::make_plan(resolve(arguments));
        ensemble.folder = arguments.output;
        ensemble.rank = session.rank();
        ensemble.job.ranks = session.size();
        ensemble.job.command_line = arguments.sweep.command_line;
        ensemble.note = [&](const std::string& text) {
            if (!arguments.quiet) say(text);
        };
        if (!session.first()) return cli::kOk;
        prepare_ensemble(ensemble, arguments.sweep.overwrite, arguments.sweep.resume);
        for (const std::string& text : ensemble.plan.notes) ensemble.note(text);
        return cli::kOk;
    };
    const std::int64_t code = session.from_first(session.first() ? cli::run_action(prepare) : cli::kOk);
    if (code != cli::kOk) return static_cast<int>(code);
    if (!session.first()) (void)prepare();
    ensemble.job.number = session.from_first(ensemble.job.number);
    session.end();

    const cli::StopRequest stop({}, true);
    const std::filesystem::path command = std::filesystem::read_symlink(cli::kThisProgram).parent_path() / "flotilla";
    ensemble.stop = [&] { return stop.signalled(); };
    ensemble.run = [&](const SweepMember& m) {
        return cli::run_member(command, m, arguments.time_limit, ensemble.stop);
    };
    const EnsembleReport report = work_on_ensemble(ensemble);
    if (session.first()) print_report(ensemble, report, arguments.quiet);
    return report.exit_code;
}

void add_options(CLI::App& command, RunArguments& arguments) {
    using namespace cli;
    SweepOptions& sweep = arguments.sweep;
    command.add_option("SCENE", sweep.scenes, "Scene files, or names of scenes of the library")->required();
    command.add_option("--bodies", sweep.bodies, "Number of bodies of scenes of the library")->check(kPositiveCount);
    command.add_option("--seeds", arguments.seeds,
                       "N (1 to N), FIRST-LAST, or a list of such: seeds of scenes of the library (of a scene file, of "
                       "its random tangents)");
    command
        .add_option("--vary", arguments.vary,
                    "key=a,b,...: values of a setting (flotilla plan --settings lists them), of preset, or dt; every "
                    "combination is run")
        ->allow_extra_args(false)
        ->type_name("KEY=A,B,...");
    add_scene_options(command, arguments.options);
    auto* steps = command.add_option("--steps", sweep.steps, "Steps of a run; with other time steps, the same time")
                      ->check(kPositiveCount);
    command.add_option("--duration", sweep.duration, "Time of a run, s (default 10)")
        ->check(kPositive)
        ->excludes(steps);
    command.add_option("--dt", arguments.dt, "Time step, s; replaces the scene's")->check(kPositive);
    command.add_option("--output", arguments.output, "Folder of the runs and the tables, where all ranks see it")
        ->check(kNotEmpty);
    command.add_option("--threads", sweep.threads, "Threads of a run")->check(kPositiveCount)->capture_default_str();
    command.add_option("--time-limit", arguments.time_limit,
                       "H:M:S of a run; what takes longer stops with a checkpoint (exit code 6)");
    auto* overwrite = command.add_flag("--overwrite", sweep.overwrite, "Replace earlier runs in the folder");
    command
        .add_flag("--resume", sweep.resume,
                  "Go on: complete runs are kept, those that were stopped or lost go on from their checkpoints; more "
                  "seeds and values add runs, another scene or setting is refused")
        ->excludes(overwrite);
    command.add_flag("--quiet", arguments.quiet, "Problems alone are printed");
}

} // namespace

void register_run(CLI::App& app, cli::Action& action, Session& session, const std::vector<std::string>& command_line) {
    const auto arguments = std::make_shared<RunArguments>();
    arguments->sweep.command_line = command_line;
    CLI::App* command = app.add_subcommand(
        "run", "Run a scene from several seeds, with every combination of some settings, shared out over ranks; exit "
               "code 6 where runs stopped early: --resume goes on. Where runs failed, that of the first");
    add_options(*command, *arguments);
    command->callback([arguments, &action, &session] {
        action = [arguments, &session] { return run_ensemble(*arguments, session); };
    });
}

} // namespace flotilla::mpi
