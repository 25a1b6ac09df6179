// SPDX-License-Identifier: MIT
// flotilla scene: prints a scene of the library as JSON.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>
#include <flotilla/scene_library.hpp>

#include "cli/commands.hpp"
#include "cli/value_checks.hpp"

namespace flotilla::cli {
namespace {

struct LibraryArguments {
    std::string name;
    int bodies = 0;
    std::uint64_t seed = 0;
    bool list = false;
};

int print_list() {
    std::size_t width = 0;
    for (const LibraryScene& scene : list_scenes()) width = std::max(width, scene.name.size());
    for (const LibraryScene& scene : list_scenes())
        std::cout << scene.name << std::string(width + 2 - scene.name.size(), ' ') << scene.description << "; "
                  << scene.default_bodies << " bodies unless --bodies says otherwise\n";
    return kOk;
}

int run_scene(const LibraryArguments& arguments) {
    if (arguments.list) return print_list();
    if (arguments.name.empty()) throw InputError("scene: give the NAME of a scene, or --list");
    write_scene(std::cout, make_scene(arguments.name, arguments.bodies, arguments.seed));
    return kOk;
}

} // namespace

void register_scene(CLI::App& app, Action& action) {
    const auto arguments = std::make_shared<LibraryArguments>();
    CLI::App* command = app.add_subcommand("scene", "Print a scene of the library as JSON");
    command->add_option("NAME", arguments->name, "Name of the scene (--list prints them)");
    command->add_option("--bodies", arguments->bodies, "Number of bodies in all (default: the scene's own)")
        ->check(kPositiveCount);
    command->add_option("--seed", arguments->seed, "Of orientations and places")->check(kWhole)->capture_default_str();
    command->add_flag("--list", arguments->list, "List the scenes");
    command->callback([arguments, &action] { action = [arguments] { return run_scene(*arguments); }; });
}

} // namespace flotilla::cli
