// SPDX-License-Identifier: MIT
#include "mpi/run_command.hpp"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>

#include <flotilla/error.hpp>

#include "cli/member_run.hpp"
#include "cli/progress.hpp"
#include "cli/run_action.hpp"
#include "cli/scene_options.hpp"
#include "cli/stop_request.hpp"
#include "cli/value_checks.hpp"
#include "mpi/ensemble.hpp"
#include "mpi/one_scene.hpp"

namespace flotilla::mpi {
namespace {

constexpr double kDefaultDuration = 10; // s

struct RunArguments {
    cli::SceneArguments options;
    int frame_every = 1, checkpoint_every = 0; ///< of one scene
    SweepOptions sweep;                        ///< what a member is
    std::vector<std::string> vary;             ///< "key=a,b"
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

std::int64_t total_steps(const SweepOptions& sweep, double asked, double dt) {
    if (sweep.steps >= 0) return sweep.steps;
    return static_cast<std::int64_t>(std::ceil((asked > 0 ? asked : sweep.duration) / dt - 1e-9));
}

void print_totals(const OneSceneTotals& totals, int ranks) {
    const RunTotals& run = totals.run;
    if (run.steps == 0) return;
    const double n = static_cast<double>(run.steps);
    std::printf("%ld bodies, %ld steps on %d ranks, %.3f s simulated\n", static_cast<long>(run.bodies),
                static_cast<long>(run.steps), ranks, run.last.time);
    std::printf("time per step: mean %.2f ms, slowest %.2f ms\n", run.total_ms / n, run.worst_ms);
    const RankTraffic& traffic = totals.traffic;
    std::printf("rank 0 per step: %.1f messages with %.0f bytes, %.1f gathers with %.0f bytes of its own\n",
                static_cast<double>(traffic.messages) / n, static_cast<double>(traffic.bytes) / n,
                static_cast<double>(traffic.gathers) / n, static_cast<double>(traffic.gathered_bytes) / n);
    std::printf("the rank with most to do had %.2f times the mean at the end\n", totals.imbalance);
    std::printf("state hash: %016lx\n", static_cast<unsigned long>(run.last.state_hash));
}

/// What rank 0 does with a run.
RunOptions run_options(const RunArguments& arguments, const cli::LoadedScene& loaded) {
    const SweepOptions& sweep = arguments.sweep;
    RunOptions run;
    run.output = arguments.output;
    run.overwrite = sweep.overwrite;
    run.resume = sweep.resume;
    run.steps = total_steps(sweep, loaded.origin.duration, loaded.scene.settings.time_step);
    run.frame_every = arguments.frame_every;
    run.checkpoint_every = arguments.checkpoint_every;
    run.command_line = sweep.command_line;
    run.scene_json = loaded.text;
    run.world.threads = sweep.threads;
    run.note = say;
    return run;
}

int run_one(const RunArguments& arguments, Session& session) {
    std::optional<cli::LoadedScene> loaded;
    const auto load = [&] {
        if (arguments.sweep.scenes.size() > 1) throw InputError("run: several scenes need --seeds or --vary");
        if (arguments.output.empty() && (arguments.sweep.resume || !arguments.time_limit.empty()))
            throw InputError("run: --resume and --time-limit need --output, the folder of the run");
        SceneFileOptions options = arguments.options.resolve();
        if (!arguments.dt.empty()) options.overrides.emplace_back("time_step", arguments.dt);
        loaded = cli::load_scene(arguments.sweep.scenes.front(), options);
        return cli::kOk;
    };
    const std::int64_t code = session.from_first(session.first() ? cli::run_action(load) : cli::kOk);
    if (code != cli::kOk) return static_cast<int>(code);
    if (!session.first()) load();
    OneScene one{loaded->scene, loaded->source, run_options(arguments, *loaded)};
    cli::StopRequest stop(cli::parse_time_limit(arguments.time_limit), !arguments.output.empty());
    std::optional<cli::Progress> progress;
    if (session.first()) progress.emplace("step", one.run.steps, arguments.quiet);
    one.run.after_step = [&](const StepReport& report) {
        progress->update(report.step, "");
        return !stop.asked(report.total_ms / 1000);
    };
    const OneSceneTotals totals = run_one_scene(one, session);
    if (!session.first()) return cli::kOk;
    progress.reset();
    if (!arguments.quiet) print_totals(totals, session.size());
    if (totals.run.complete) return cli::kOk;
    say("stopped after step " + std::to_string(totals.run.last.step) + " of " + std::to_string(one.run.steps) + " (" +
        stop.reason() + "); --resume goes on");
    return cli::kResumable;
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
    command.add_option("--frame-every", arguments.frame_every, "Steps per written frame of one scene")
        ->check(kPositiveCount);
    command
        .add_option("--checkpoint-every", arguments.checkpoint_every,
                    "Steps per checkpoint of one scene (default 100, and one in five minutes)")
        ->check(kPositiveCount);
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
        "run",
        "Run one scene over all ranks; or, with --seeds or --vary, one from several seeds with every combination "
        "of some settings, shared out over ranks. Exit code 6 where it stopped early: --resume goes on. Where "
        "runs of an ensemble failed, that of the first");
    add_options(*command, *arguments);
    command->callback([arguments, &action, &session] {
        const bool one = arguments->seeds.empty() && arguments->vary.empty();
        action = [arguments, &session, one] {
            return one ? run_one(*arguments, session) : run_ensemble(*arguments, session);
        };
    });
}

} // namespace flotilla::mpi
