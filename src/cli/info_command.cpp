// SPDX-License-Identifier: MIT
// flotilla info: what a run folder holds and where it comes from.
#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>
#include <string>

#include <flotilla/run_folder.hpp>

#include "cli/commands.hpp"

namespace flotilla::cli {
namespace {

int run_info(const std::string& folder) {
    const RunSummary s = summarize_run(folder);
    std::string command_line;
    for (const auto& argument : s.command_line) command_line += (command_line.empty() ? "" : " ") + argument;
    std::cout << "status:       " << s.status << ", started " << s.started << ", last written " << s.updated << "\n"
              << "command:      " << command_line << "\n"
              << "program:      flotilla " << s.version << " (" << s.commit << "), " << s.compiler << "\n"
              << "machine:      " << s.processor << ", " << s.threads << (s.threads == 1 ? " thread" : " threads")
              << "\n"
              << "bodies:       " << s.bodies << " (" << s.dynamic_bodies << " dynamic), " << s.shapes << " shapes, "
              << s.triangles << " triangles\n"
              << "time step:    " << s.time_step << " s"
              << (s.substeps > 1 ? ", of " + std::to_string(s.substeps) + " inner ones" : "") << "\n"
              << "frames:       " << s.frames << ", the last at step " << s.last_step << ", t = " << s.last_time
              << " s\n"
              << "size:         " << static_cast<double>(s.frame_bytes) / 1e6 << " MB of frames\n"
              << "checkpoint:   "
              << (s.checkpoint_step < 0 ? std::string("none") : "step " + std::to_string(s.checkpoint_step)) << "\n"
              << "settings:     " << s.settings_json << "\n";
    for (const auto& problem : s.problems) std::cerr << "flotilla: " << problem << '\n';
    return s.problems.empty() ? kOk : kIoFailure;
}

} // namespace

void register_info(CLI::App& app, Action& action) {
    const auto folder = std::make_shared<std::string>();
    CLI::App* command = app.add_subcommand("info", "Describe a run folder");
    command->add_option("DIR", *folder, "Run folder")->required();
    command->callback([folder, &action] { action = [folder] { return run_info(*folder); }; });
}

} // namespace flotilla::cli
