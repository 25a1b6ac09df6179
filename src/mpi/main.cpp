// SPDX-License-Identifier: MIT
// The flotilla-mpi command: what mpirun starts on every rank.
#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include <flotilla/build_info.hpp>

#include "cli/run_action.hpp"
#include "mpi/model_command.hpp"
#include "mpi/run_command.hpp"
#include "mpi/session.hpp"

namespace {

using namespace flotilla;

int parse_and_run(int argc, char** argv) {
    mpi::Session session(argc, argv);
    CLI::App app{"flotilla-mpi: flotilla on several machines; started by mpirun", "flotilla-mpi"};
    app.require_subcommand(1);
    const BuildInfo build = build_info();
    app.set_version_flag("--version",
                         "flotilla-mpi " + std::string(build.version) + "\ncommit:   " + std::string(build.commit),
                         "Print version and commit, and exit");
    const std::vector<std::string> command_line(argv, argv + argc);
    cli::Action action;
    mpi::register_model(app, action);
    mpi::register_run(app, action, session, command_line);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        // All ranks have the same arguments; one of them says what is wrong with them.
        if (!session.first()) return e.get_exit_code() == 0 ? cli::kOk : cli::kBadInput;
        return app.exit(e) == 0 ? cli::kOk : cli::kBadInput;
    }
    return action();
}

} // namespace

int main(int argc, char** argv) {
    return cli::run_action([&] { return parse_and_run(argc, argv); });
}
