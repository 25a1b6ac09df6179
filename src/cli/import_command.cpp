// SPDX-License-Identifier: MIT
// flotilla import: writes the scene of another program as one of ours.
#include <CLI/CLI.hpp>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "cli/commands.hpp"
#include "cli/scene_options.hpp"
#include "cli/value_checks.hpp"

namespace flotilla::cli {
namespace {

struct ImportArguments {
    std::string scene, output;
};

void write_text(const std::string& file, const std::string& text) {
    errno = 0;
    std::ofstream out(file, std::ios::binary);
    if (!(out << text).flush()) throw IoError("cannot write " + file + ": " + std::strerror(errno));
}

int run_import(const ImportArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene, {});
    const SceneOrigin& origin = loaded.origin;
    if (origin.format.empty()) throw InputError(loaded.source + ": is a scene of flotilla's own already");
    if (arguments.output.empty())
        std::cout << loaded.text;
    else
        write_text(arguments.output, loaded.text);
    std::cerr << "note: a scene of " << origin.format << " with " << loaded.scene.bodies.size()
              << " bodies, turned so that z points up; it wants to be run for " << origin.duration << " s (--duration "
              << origin.duration << ")\n";
    return kOk;
}

} // namespace

void register_import(CLI::App& app, Action& action) {
    const auto arguments = std::make_shared<ImportArguments>();
    CLI::App* command = app.add_subcommand(
        "import", "Write the scene of another program (Rigid-IPC's JSON) as one of flotilla; exit code "
                  "2 where it holds what would change the outcome and is not supported");
    command->add_option("SCENE", arguments->scene, "Scene file of the other program, or - for standard input")
        ->required();
    command->add_option("--output", arguments->output, "Scene file to write (default: standard output)")
        ->check(kNotEmpty);
    command->callback([arguments, &action] { action = [arguments] { return run_import(*arguments); }; });
}

} // namespace flotilla::cli
