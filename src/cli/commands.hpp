// SPDX-License-Identifier: MIT
// The subcommands, one file each. A command declares its arguments in register_<name> and leaves what it does in
// `action`, which runs once the whole command line is parsed; main.cpp turns exceptions into exit codes, in one place.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace flotilla::cli {

/// Exit codes of every command.
enum ExitCode : int {
    kOk = 0,
    kInternalError = 1,
    kBadInput = 2,      ///< usage, options, files with wrong content
    kBrokenPromise = 3, ///< something that flotilla promises does not hold
    kOverlap = 4,       ///< bodies intersect at t = 0
    kIoFailure = 5,
    kResumable = 6, ///< stopped early
    kScript = 7,    ///< a script cannot be satisfied and the scene asked for an error; resumable
};

/// What --threads is where it is not given (default_threads()).
inline constexpr const char* kThreadsHelp =
    "threads (default FLOTILLA_NUM_THREADS, else OpenMP's: OMP_NUM_THREADS, else all usable cores)";

/// What the command line asks for; returns the exit code.
using Action = std::function<int()>;

void register_ccd(CLI::App& app, Action& action);
void register_check(CLI::App& app, Action& action);
void register_compare(CLI::App& app, Action& action);
void register_export(CLI::App& app, Action& action);
void register_import(CLI::App& app, Action& action);
void register_info(CLI::App& app, Action& action);
void register_picture(CLI::App& app, Action& action);
void register_plan(CLI::App& app, Action& action);
void register_report(CLI::App& app, Action& action);
/// `command_line` goes into the run folder.
void register_run(CLI::App& app, Action& action, const std::vector<std::string>& command_line);
void register_scene(CLI::App& app, Action& action);
/// `command_line` goes into the campaign's folder.
void register_sweep(CLI::App& app, Action& action, const std::vector<std::string>& command_line);
void register_trace(CLI::App& app, Action& action);
void register_verify(CLI::App& app, Action& action);

/// What verify does with a run folder, for run --audit: prints the report and returns the exit code.
int audit_run(const std::filesystem::path& folder, int threads, bool quiet);
/// For VerifyOptions::progress: shows the part done on stderr.
std::function<void(double)> verify_progress();

} // namespace flotilla::cli
