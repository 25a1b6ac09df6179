// SPDX-License-Identifier: MIT
// flotilla run: simulates a scene into a run folder.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <numeric>
#include <optional>

#include <flotilla/edit_file.hpp>
#include <flotilla/error.hpp>
#include <flotilla/run.hpp>

#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "cli/stop_request.hpp"
#include "cli/value_checks.hpp"

namespace flotilla::cli {
namespace {

struct RunArguments {
    std::string scene;
    SceneArguments options;
    std::string output;
    std::int64_t steps = -1;
    double duration = -1; ///< s
    double dt = 0;        ///< s; 0: the scene's
    int frame_every = 1;
    int threads = 0; ///< 0: as many as the process may use
    std::string executor = "parallel";
    std::string trace, contacts, edits;
    int trace_every = 1;
    bool overwrite = false, resume = false, quiet = false, audit = false;
    int checkpoint_every = 0; ///< 0: the library's own rule
    std::string time_limit;   ///< H:M:S
    std::vector<std::string> command_line;
};

constexpr double kDefaultDuration = 10; // s

std::string exact_text(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
}

/// `duration`: what the scene file asks for, s; 0: nothing.
std::int64_t total_steps(const RunArguments& arguments, double dt, double duration) {
    if (arguments.steps >= 0) return arguments.steps;
    if (arguments.duration >= 0)
        duration = arguments.duration;
    else if (duration == 0)
        duration = kDefaultDuration;
    const double steps = std::ceil(duration / dt - 1e-9);
    if (!(steps <= kMostCount))
        throw InputError("run: " + exact_text(duration) + " s in steps of " + exact_text(dt) + " s are too many steps");
    return static_cast<std::int64_t>(steps);
}

/// Mean time of the last steps, as single ones differ too much to be read.
class StepTimes {
  public:
    void add(double ms) {
        last_[count_ % last_.size()] = ms;
        ++count_;
    }
    [[nodiscard]] double mean() const {
        const std::size_t n = std::min(count_, last_.size());
        return std::accumulate(last_.begin(), last_.begin() + static_cast<std::ptrdiff_t>(n), 0.0) /
               static_cast<double>(std::max<std::size_t>(n, 1));
    }

  private:
    std::array<double, 24> last_{}; // ms
    std::size_t count_ = 0;
};

std::string note(const StepReport& r, double mean_ms) {
    char text[96];
    const char* const format = mean_ms < 1    ? "t = %.3f s, mean %.2g ms/step, %ld contacts"
                               : mean_ms < 10 ? "t = %.3f s, mean %.1f ms/step, %ld contacts"
                                              : "t = %.3f s, mean %.0f ms/step, %ld contacts";
    std::snprintf(text, sizeof text, format, r.time, mean_ms, static_cast<long>(r.contacts + r.sleeping_contacts));
    return text;
}

void print_threads(const std::vector<ThreadReport>& threads) {
    if (threads.size() < 2) return;
    std::printf("threads:   busy, ms  waiting, ms       tasks      stolen\n");
    for (std::size_t k = 0; k < threads.size(); ++k)
        std::printf("  %4zu %12.0f %12.0f %11ld %11ld\n", k, threads[k].busy_ms, threads[k].waiting_ms,
                    static_cast<long>(threads[k].tasks), static_cast<long>(threads[k].stolen));
}

/// The most memory that the process ever had resident, MiB, without what was inherited from the one that started it;
/// none where the system does not say.
std::optional<double> peak_memory() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024; // kB
    return std::nullopt;
}

/// The stages first, which make up a step; then what some of them do, in the units that Phase says.
void print_phases(const RunTotals& s, double n) {
    const auto row = [&](std::size_t p, const char* clock) {
        if (s.phase_ms[p] / n >= 0.005)
            std::printf("  %-24s %9.2f ms%s\n", std::string(kPhaseNames[p]).c_str(), s.phase_ms[p] / n, clock);
    };
    constexpr auto kSplit = static_cast<std::size_t>(Phase::detection);
    for (std::size_t p = 0; p < kSplit; ++p) row(p, "");
    const auto split = s.phase_ms.begin() + kSplit;
    if (std::none_of(split, s.phase_ms.end(), [&](double ms) { return ms / n >= 0.005; })) return;
    std::printf("of these:\n");
    for (const Phase p : {Phase::detection, Phase::response})
        row(static_cast<std::size_t>(p), ", stages 1 and 5, sum over threads");
    for (const Phase p : {Phase::static_detection, Phase::static_response})
        row(static_cast<std::size_t>(p), ", stages 3 and 7, wall time");
}

void print_summary(const RunTotals& s) {
    const double n = s.steps > 0 ? static_cast<double>(s.steps) : 1;
    std::printf("%ld bodies, %ld steps", static_cast<long>(s.bodies), static_cast<long>(s.steps));
    if (s.resumed_after > 0) std::printf(" after the %ld that were there", static_cast<long>(s.resumed_after));
    if (s.steps == 0) {
        std::printf("\n");
        return;
    }
    std::printf(", %.3f s simulated\n", s.last.time);
    std::printf("time per step: mean %.2f ms, slowest %.2f ms; wall time of its stages:\n", s.total_ms / n, s.worst_ms);
    print_phases(s, n);
    if (s.output_ms > 0)
        std::printf("output: %.2f ms per step (%.2f %% of the steps' time)\n", s.output_ms / n,
                    100 * s.output_ms / s.total_ms);
    std::printf("collision impulses: %.1f per step; contacts at the end: %ld", static_cast<double>(s.collisions) / n,
                static_cast<long>(s.last.contacts + s.last.sleeping_contacts));
    if (s.last.sleeping_contacts > 0)
        std::printf(s.last.contacts > 0 ? ", %ld of them asleep" : ", all asleep",
                    static_cast<long>(s.last.sleeping_contacts));
    std::printf("\n");
    std::printf("failsafe: %ld merges, %ld rung changes, %ld bodies held (all steps together)\n",
                static_cast<long>(s.merges), static_cast<long>(s.rung_changes), static_cast<long>(s.held));
    std::printf("contact solves above tolerance: in %ld of %ld steps", static_cast<long>(s.above_tolerance),
                static_cast<long>(s.steps));
    std::printf(", %.3g m/s in the last\n", s.last.residual);
    std::printf("energy taken by the last resort: %.3g J from %ld islands (all steps together); lift: %.3g J\n",
                s.energy_removed, static_cast<long>(s.energy_corrections), s.last.lift);
    std::printf("smallest distance at the end of a step: ");
    if (std::isfinite(s.min_distance))
        std::printf("%.6g m\n", s.min_distance);
    else
        std::printf("nothing came within the proximity distance\n");
    if (const std::optional<double> peak = peak_memory()) std::printf("peak memory: %.1f MiB\n", *peak);
    std::printf("energy at the end: %.6g J (kinetic %.6g J)\n", s.last.energy, s.last.kinetic_energy);
    std::printf("state hash: %016lx\n", static_cast<unsigned long>(s.last.state_hash));
    print_threads(s.threads);
}

/// What a run did, and the script that ended it early.
struct Ended {
    RunTotals totals;
    std::optional<ScriptError> blocked;
};

Ended simulate(const SceneDescription& scene, const std::string& source, RunOptions run, StopRequest& stop,
               bool quiet) {
    Ended ended;
    Progress progress("step", run.steps, quiet);
    StepTimes times;
    run.after_step = [&](const StepReport& r) {
        times.add(r.total_ms);
        progress.update(r.step, note(r, times.mean()));
        return !stop.asked(r.total_ms / 1000);
    };
    run.blocked = [&](const RunTotals& totals) { ended.totals = totals; };
    try {
        ended.totals = run_scene(scene, source, run);
    } catch (const ScriptError& e) {
        ended.blocked = e;
    }
    return ended;
}

int run_run(const RunArguments& arguments) {
    const auto needs_output = [&](bool given, const char* option, const char* what) {
        if (given && arguments.output.empty())
            throw InputError(std::string("run: ") + option + " needs --output, " + what);
    };
    needs_output(arguments.audit, "--audit", "the frames to audit");
    needs_output(arguments.resume, "--resume", "the folder of the run to go on with");
    needs_output(!arguments.time_limit.empty(), "--time-limit", "the folder for the checkpoint");
    SceneFileOptions options = arguments.options.resolve();
    if (arguments.dt > 0) options.overrides.emplace_back("time_step", exact_text(arguments.dt));
    const auto [source, scene_json, scene, origin] = load_scene(arguments.scene, options);
    for (const std::string& text : arguments.options.overridden_by_scene(scene.settings))
        std::cerr << "flotilla: " << source << ": " << text << '\n';
    if (!arguments.quiet && arguments.output.empty() && arguments.trace.empty() && arguments.contacts.empty())
        std::cerr << "flotilla: nothing of this run is kept; --output DIR keeps it\n";
    std::optional<StopRequest> stop(std::in_place, parse_time_limit(arguments.time_limit), !arguments.output.empty());
    RunOptions run;
    run.output = arguments.output;
    run.overwrite = arguments.overwrite;
    run.resume = arguments.resume;
    run.checkpoint_every = arguments.checkpoint_every;
    run.note = [](const std::string& text) { std::cerr << "flotilla: " << text << '\n'; };
    run.steps = total_steps(arguments, scene.settings.time_step, origin.duration);
    run.frame_every = arguments.frame_every;
    run.command_line = arguments.command_line;
    run.scene_json = scene_json;
    run.world.threads = arguments.threads;
    run.world.executor = arguments.executor == "serial" ? Executor::serial : Executor::parallel;
    run.trace = arguments.trace;
    run.contacts = arguments.contacts;
    run.trace_every = arguments.trace_every;
    if (!arguments.edits.empty()) run.edits = read_edits(arguments.edits, scene);
    const Ended ended = simulate(scene, source, run, *stop, arguments.quiet);
    const std::string reason = stop->reason();
    stop.reset(); // all is written: a signal ends the process as usual
    const RunTotals& totals = ended.totals;
    if (!arguments.quiet) print_summary(totals);
    if (!arguments.quiet && !arguments.trace.empty())
        std::printf("trace of %ld steps: %s\n", static_cast<long>(totals.traced_steps), arguments.trace.c_str());
    if (!totals.complete && !ended.blocked) {
        std::cerr << "flotilla: stopped after step " << totals.last.step << " of " << run.steps << " (" << reason
                  << "); --resume goes on\n";
        if (arguments.audit) std::cerr << "flotilla: not audited; flotilla verify proves what there is\n";
        return kResumable;
    }
    const int proved = arguments.audit ? audit_run(arguments.output, arguments.threads, arguments.quiet) : kOk;
    if (!ended.blocked) return proved;
    std::cerr << "flotilla: " << ended.blocked->what() << '\n';
    if (!arguments.output.empty() && !arguments.quiet) // a hint, and no problem
        std::cerr << "flotilla: --resume --set unsatisfiable_script=hold goes on from here\n";
    return proved != kOk ? proved : kScript;
}

} // namespace

void register_run(CLI::App& app, Action& action, const std::vector<std::string>& command_line) {
    auto arguments = std::make_shared<RunArguments>();
    arguments->command_line = command_line;
    CLI::App* command = app.add_subcommand("run", "Simulate a scene; exit code 6 where it stopped early and 7 where a "
                                                  "script cannot go on and the scene asks for an "
                                                  "error (unsatisfiable_script): --resume goes on");
    command->add_option("scene", arguments->scene, "scene file, or - for standard input")->required();
    add_scene_options(*command, arguments->options);
    command->add_option("--output", arguments->output, "run folder; without it nothing is written")->check(kNotEmpty);
    auto* steps = command->add_option("--steps", arguments->steps, "total number of steps")->check(kCount);
    command
        ->add_option("--duration", arguments->duration,
                     "total time, s (default: what the scene file of another program asks for, else 10)")
        ->check(kNonNegative)
        ->excludes(steps);
    command->add_option("--dt", arguments->dt, "time step, s; replaces the scene's")->check(kPositive);
    command->add_option("--frame-every", arguments->frame_every, "steps per written frame")->check(kPositiveCount);
    auto* overwrite = command->add_flag("--overwrite", arguments->overwrite, "replace an earlier run in the folder");
    command->add_flag("--resume", arguments->resume, "go on from the folder's last checkpoint, with the same bits")
        ->excludes(overwrite);
    command
        ->add_option("--checkpoint-every", arguments->checkpoint_every,
                     "steps per checkpoint (default 100, and one in five minutes)")
        ->check(kPositiveCount);
    command->add_option("--time-limit", arguments->time_limit,
                        "H:M:S; stop with a checkpoint before so much time has passed (exit code 6)");
    command->add_option("--threads", arguments->threads, kThreadsHelp)->check(kPositiveCount);
    command
        ->add_option("--executor", arguments->executor,
                     "parallel, or serial: a plain loop on one thread; the results are the same bits")
        ->check(CLI::IsMember({"parallel", "serial"}));
    auto* trace = command
                      ->add_option("--trace", arguments->trace,
                                   "record the executed tasks into FILE (.gz: compressed) for flotilla trace, "
                                   "chrome://tracing and Perfetto")
                      ->check(kNotEmpty);
    command->add_option("--trace-every", arguments->trace_every, "steps per recorded step")
        ->needs(trace)
        ->check(kPositiveCount);
    command
        ->add_option(
            "--contacts", arguments->contacts,
            "write the contact points of every step and their impulses into FILE as CSV (.gz: compressed); those of "
            "sleeping bodies are marked; --resume goes on with the file")
        ->check(kNotEmpty);
    command
        ->add_option(
            "--edits", arguments->edits,
            "file of edits to be made between steps: bodies that come and go, forces, scripts (src/io/README.md)")
        ->check(kNotEmpty);
    command->add_flag_callback(
        "--pin",
        [] { throw CLI::ValidationError("--pin", "is gone: OMP_PROC_BIND=true binds threads, OMP_PLACES says where"); },
        "gone: OMP_PROC_BIND=true binds threads, OMP_PLACES says where");
    command->add_flag("--audit", arguments->audit, "prove the written frames free of intersections afterwards");
    command->add_flag("--quiet", arguments->quiet,
                      "no progress and no summary; problems and the report of --audit are printed");
    command->callback([arguments, &action] { action = [arguments] { return run_run(*arguments); }; });
}

} // namespace flotilla::cli
