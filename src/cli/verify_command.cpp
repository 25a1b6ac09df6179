// SPDX-License-Identifier: MIT
// flotilla verify: proves a recorded trajectory free of intersections.
#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include <unistd.h>

#include <flotilla/error.hpp>
#include <flotilla/verify.hpp>

#include "cli/commands.hpp"
#include "cli/enum_option.hpp"
#include "cli/value_checks.hpp"

namespace flotilla::cli {
namespace {

struct VerifyArguments {
    std::string subject; ///< run folder, or scene file with --poses
    std::string poses;
    VerifyOptions options;
    bool quiet = false;
};

constexpr std::size_t kFaultsShown = 20;

void print_summary(const VerifyReport& r) {
    std::cout << "frames checked:       " << r.frames << " (" << r.bodies << " bodies)\n"
              << "motions checked:      " << r.motions;
    if (r.motions_skipped > 0) std::cout << " (" << r.motions_skipped << " not checked)";
    std::cout << "\nbody pairs examined:  " << r.pairs << " in frames, " << r.motion_pairs << " in motion\n"
              << "triangle pairs:       " << r.triangle_pairs << "\n"
              << "intersecting pairs:   " << r.intersecting_pairs << "\n"
              << "pairs passing through: " << r.crossing_pairs << "\n"
              << "pairs not proved:     " << r.unproved_pairs << "\n"
              << "bad poses:            " << r.bad_poses << "\n";
    if (std::isfinite(r.smallest_distance))
        std::cout << "smallest distance:    " << r.smallest_distance << " m (frame " << r.smallest_distance_frame
                  << ", \"" << r.smallest_distance_a << "\" and \"" << r.smallest_distance_b << "\")\n";
    std::cout << "time:                 " << r.seconds << " s";
    if (r.frames > 0) std::cout << ", " << 1000 * r.seconds / static_cast<double>(r.frames) << " ms per frame";
    std::cout << "\n";
}

int verdict(const VerifyReport& r) {
    if (!r.proved()) {
        std::cout << "verdict:              FAILED\n";
        return kBrokenPromise;
    }
    if (!r.unreadable.empty()) {
        std::cout << "verdict:              incomplete: part of the run cannot be read\n";
        return kIoFailure;
    }
    if (r.frames == 0)
        std::cout << "verdict:              nothing to verify\n";
    else
        std::cout << "verdict:              free of intersections"
                  << (r.motions_skipped == 0 ? ""
                      : r.motions == 0       ? " in every frame"
                                             : " in every frame, and where the motion was checked")
                  << "\n";
    return kOk;
}

int print_report(const VerifyReport& report) {
    for (const auto& message : report.unreadable) std::cerr << "flotilla: " << message << '\n';
    const std::size_t shown = std::min(report.faults.size(), kFaultsShown);
    for (std::size_t i = 0; i < shown; ++i) std::cout << to_string(report.faults[i]) << '\n';
    const auto all = report.intersecting_pairs + report.crossing_pairs + report.unproved_pairs + report.bad_poses;
    if (all > static_cast<std::int64_t>(shown))
        std::cout << "and " << all - static_cast<std::int64_t>(shown) << " more\n";
    for (const auto& note : report.notes) std::cout << "note: " << note << '\n';
    print_summary(report);
    return verdict(report);
}

int run_verify(VerifyArguments& arguments) {
    if (!arguments.quiet) arguments.options.progress = verify_progress();
    return print_report(arguments.poses.empty() ? verify_run(arguments.subject, arguments.options)
                                                : verify_poses(arguments.subject, arguments.poses, arguments.options));
}

} // namespace

// A line that is rewritten on a terminal; elsewhere one line for each tenth.
std::function<void(double)> verify_progress() {
    const bool terminal = isatty(STDERR_FILENO) == 1;
    auto shown = std::make_shared<int>(-1);
    return [terminal, shown](double part) {
        const int percent = static_cast<int>(100 * part);
        const int now = terminal ? percent : percent / 10 * 10;
        if (now == *shown) return;
        *shown = now;
        std::fprintf(stderr, terminal ? "\rverifying: %d %%%s" : "verifying: %d %%%s", now,
                     !terminal || percent == 100 ? "\n" : "");
    };
}

int audit_run(const std::filesystem::path& folder, int threads, bool quiet) {
    VerifyOptions options;
    options.threads = threads;
    if (!quiet) options.progress = verify_progress();
    return print_report(verify_run(folder, options));
}

void register_verify(CLI::App& app, Action& action) {
    const auto arguments = std::make_shared<VerifyArguments>();
    CLI::App* command =
        app.add_subcommand("verify", "Prove a trajectory free of intersections; exit code 3 where it is not");
    command->add_option("DIR", arguments->subject, "Run folder, or the scene file of --poses")->required();
    command->add_option("--poses", arguments->poses, "Trajectory of the scene in the CSV export format")
        ->check(kNotEmpty);
    add_enum_option<VerifyMotion>(
        *command, "--motion", arguments->options.motion,
        {{"auto", VerifyMotion::automatic}, {"always", VerifyMotion::always}, {"never", VerifyMotion::never}},
        "Check the motion between frames: auto (frames one time step apart), always, never");
    command->add_option("--threads", arguments->options.threads, kThreadsHelp)->check(kPositiveCount);
    command->add_flag("!--no-distance", arguments->options.distance, "Do not measure the smallest distance");
    command->add_flag("--quiet", arguments->quiet, "No progress; the report is printed");
    command->callback([arguments, &action] { action = [arguments] { return run_verify(*arguments); }; });
}

} // namespace flotilla::cli
