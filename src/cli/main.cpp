// SPDX-License-Identifier: MIT
// The flotilla command: arguments and exit codes. Everything it does goes through the public headers.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <sys/resource.h>

#include <flotilla/build_info.hpp>
#include <flotilla/error.hpp>
#include <flotilla/names.hpp>
#include <flotilla/world.hpp>

#include "cli/commands.hpp"

namespace {

using namespace flotilla;

/// The limit on what the process may ask for, where there is one.
std::string memory_limit_text() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return {};
    return ": the process may have " + std::to_string(limit.rlim_cur >> 20) + " MiB (ulimit -v)";
}

/// Memory for the way out: where some is refused, destructors may need some all the same (a JSON document's lists what
/// it holds), and one that throws ends the process.
std::atomic<void*> g_reserve = nullptr;

void keep_reserve() {
    constexpr std::size_t kReserve = std::size_t{4}
                                     << 20; // never touched: a JSON document of some 250,000 values needs it
    g_reserve = std::malloc(kReserve);
    if (g_reserve == nullptr) throw std::bad_alloc();
    std::set_new_handler([] {
        std::free(g_reserve.exchange(nullptr));
        throw std::bad_alloc();
    });
}

/// The one place where exceptions become exit codes.
int run(const cli::Action& action) {
    try {
        const int code = action();
        if (!std::cout.flush()) throw IoError("cannot write to standard output");
        return code;
    } catch (const OverlapError& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return cli::kOverlap;
    } catch (const ScriptError& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return cli::kScript;
    } catch (const BrokenPromise& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return cli::kBrokenPromise;
    } catch (const InputError& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return cli::kBadInput;
    } catch (const IoError& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return cli::kIoFailure;
    } catch (const std::bad_alloc&) {
        std::cerr << "flotilla: not enough memory" << memory_limit_text() << '\n';
        return cli::kInternalError;
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
    return action();
}

} // namespace

int main(int argc, char** argv) {
    std::signal(SIGXFSZ, SIG_IGN); // a file that may not grow any more is an error of its write, like a full disk
    return run([&] {
        keep_reserve();
        return parse_and_run(argc, argv);
    });
}
