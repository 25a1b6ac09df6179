// SPDX-License-Identifier: MIT
// The flotilla command: arguments and exit codes. Everything it does goes through the public headers.
#include <CLI/CLI.hpp>

#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include <flotilla/build_info.hpp>
#include <flotilla/error.hpp>
#include <flotilla/world.hpp>

#include "cli/commands.hpp"

namespace {

using namespace flotilla;

/// The one place where exceptions become exit codes.
int run(const cli::Action& action) {
    try {
        const int code = action();
        if (!std::cout.flush()) throw IoError("cannot write to standard output");
        return code;
    } catch (const OverlapError& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return cli::kOverlap;
    } catch (const BrokenPromise& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return cli::kBrokenPromise;
    } catch (const InputError& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return cli::kBadInput;
    } catch (const IoError& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return cli::kIoFailure;
    } catch (const std::exception& e) {
        std::cerr << "flotilla: internal error: " << e.what() << '\n';
        return cli::kInternalError;
    }
}

std::string version_text() {
    const BuildInfo build = build_info();
    std::string text = "flotilla " + std::string(build.version);
    ((text += "\ncommit:   ") += build.commit) += "\ncompiler: ";
    return ((text += build.compiler) += "\nflags:    ") += build.flags;
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app{"flotilla: interpenetration-free rigid bodies without thickness", "flotilla"};
    app.require_subcommand(1);
    app.set_version_flag("--version", version_text(), "Print version, commit, compiler and flags, and exit");
    cli::Action action;
    cli::register_ccd(app, action);
    cli::register_check(app, action);
    cli::register_compare(app, action);
    cli::register_export(app, action);
    cli::register_info(app, action);
    cli::register_picture(app, action);
    cli::register_plan(app, action);
    cli::register_report(app, action);
    cli::register_run(app, action, std::vector<std::string>(argv, argv + argc));
    cli::register_scene(app, action);
    cli::register_trace(app, action);
    cli::register_verify(app, action);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        // Prints help to stdout (code 0) or the complaint to stderr.
        return app.exit(e) == 0 ? cli::kOk : cli::kBadInput;
    }
    return run(action);
}
