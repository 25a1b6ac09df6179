// SPDX-License-Identifier: MIT
// The flotilla command: arguments and exit codes. Everything it does goes through the public headers.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include <flotilla/build_info.hpp>
#include <flotilla/environment.hpp>
#include <flotilla/names.hpp>

#include "cli/commands.hpp"
#include "cli/run_action.hpp"

namespace {

using namespace flotilla;

std::string version_text() {
    const BuildInfo build = build_info();
    std::string text = "flotilla " + std::string(build.version);
    ((text += "\ncommit:   ") += build.commit) += "\ncompiler: ";
    return ((text += build.compiler) += "\nflags:    ") += build.flags;
}

/// CLI11 takes an unknown first word for a missing subcommand. Empty where the word is known, or an option.
std::string unknown_command(const CLI::App& app, int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') return {};
    std::vector<std::string_view> known;
    for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
    const std::string_view word = argv[1];
    if (std::find(known.begin(), known.end(), word) != known.end()) return {};
    return unknown_name("command", word, known) + " (flotilla --help lists them)";
}

int parse_and_run(int argc, char** argv) {
    CLI::App app{"flotilla: interpenetration-free rigid bodies without thickness", "flotilla"};
    app.require_subcommand(1);
    app.set_version_flag("--version", version_text(), "Print version, commit, compiler and flags, and exit");
    const std::vector<std::string> command_line(argv, argv + argc);
    cli::Action action;
    cli::register_ccd(app, action);
    cli::register_check(app, action);
    cli::register_compare(app, action);
    cli::register_export(app, action);
    cli::register_import(app, action);
    cli::register_info(app, action);
    cli::register_picture(app, action);
    cli::register_plan(app, action);
    cli::register_report(app, action);
    cli::register_run(app, action, command_line);
    cli::register_scene(app, action);
    cli::register_sweep(app, action, command_line);
    cli::register_trace(app, action);
    cli::register_verify(app, action);
    if (const std::string complaint = unknown_command(app, argc, argv); !complaint.empty()) {
        std::cerr << "flotilla: " << complaint << '\n';
        return cli::kBadInput;
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        // Prints help to stdout (code 0) or the complaint to stderr.
        return app.exit(e) == 0 ? cli::kOk : cli::kBadInput;
    }
    check_environment();
    return action();
}

} // namespace

int main(int argc, char** argv) {
    return cli::run_action([&] { return parse_and_run(argc, argv); });
}
