// SPDX-License-Identifier: MIT
// flotilla check: validates a scene and looks for bodies that intersect at the start.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include <flotilla/error.hpp>
#include <flotilla/scene_check.hpp>

#include "cli/commands.hpp"
#include "cli/scene_options.hpp"

namespace flotilla::cli {
namespace {

struct CheckArguments {
    std::string scene;
    SceneArguments options;
    std::string output; ///< of the intersecting triangles; empty: beside the scene
};

constexpr std::size_t kMaxPairsShown = 20;

std::string count(std::int64_t n, const std::string& what) {
    return std::to_string(n) + " " + what + (n == 1 ? "" : what.ends_with('y') ? "" : "s");
}

void print_summary(const SceneCheck& check) {
    const std::int64_t bodies = check.dynamic_bodies + check.static_bodies + check.kinematic_bodies;
    std::cout << "ok: " << bodies << (bodies == 1 ? " body (" : " bodies (") << check.dynamic_bodies << " dynamic, "
              << check.static_bodies << " static, " << check.kinematic_bodies << " kinematic), "
              << count(check.shapes, "shape") << ", " << count(check.triangles, "triangle") << ", mass " << check.mass
              << " kg";
    if (check.locked_bodies > 0) std::cout << ", " << check.locked_bodies << " with locked axes";
    if (check.driven_bodies > 0) std::cout << ", " << check.driven_bodies << " with a force or a torque";
    std::cout << '\n';
}

void print_pairs(const char* kind, const std::vector<InitialIntersection>& pairs) {
    const std::size_t shown = std::min(pairs.size(), kMaxPairsShown);
    for (std::size_t i = 0; i < shown; ++i) {
        const InitialIntersection& p = pairs[i];
        std::cerr << kind << ": bodies \"" << p.body_a << "\" and \"" << p.body_b
                  << "\" intersect at t = 0: " << count(p.triangle_pairs, "triangle pair") << ", near (" << p.place.x
                  << ", " << p.place.y << ", " << p.place.z << ")\n";
    }
    if (shown < pairs.size()) std::cerr << kind << ": and " << pairs.size() - shown << " more pairs of bodies\n";
}

void print_repairs(const std::vector<InitialRepair>& repairs) {
    for (const InitialRepair& r : repairs)
        std::cerr << "note: body \"" << r.body << "\" intersects another at t = 0 and will be moved by "
                  << std::hypot(r.by.x, r.by.y, r.by.z) << " m: (" << r.by.x << ", " << r.by.y << ", " << r.by.z
                  << ")\n";
}

std::filesystem::path overlap_file(const CheckArguments& arguments) {
    if (!arguments.output.empty()) return arguments.output;
    const bool piped = arguments.scene == kStandardInput;
    return std::filesystem::path(piped ? "scene.json" : arguments.scene).replace_extension(".overlap.obj");
}

int run_check(const CheckArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene, arguments.options.resolve());
    for (const std::string& text : arguments.options.overridden_by_scene(loaded.scene.settings))
        std::cerr << "note: " << text << '\n';
    const SceneCheck check = check_scene(loaded.scene, loaded.source);
    for (const std::string& warning : check.warnings) std::cerr << "warning: " << warning << '\n';
    print_pairs("warning", check.ignored_intersections);
    print_repairs(check.repairs);
    if (check.intersections.empty()) {
        print_summary(check);
        return kOk;
    }
    print_pairs("error", check.intersections);
    const std::filesystem::path file = overlap_file(arguments);
    try {
        write_intersections(file, check.intersections);
        std::cerr << "the intersecting triangles are in " << file.string() << '\n';
    } catch (const IoError& error) {
        std::cerr << "warning: " << error.what() << '\n'; // the verdict matters more than the picture of it
    }
    return kOverlap;
}

} // namespace

void register_check(CLI::App& app, Action& action) {
    const auto arguments = std::make_shared<CheckArguments>();
    CLI::App* command =
        app.add_subcommand("check", "Validate a scene; exit code 2 where it is invalid, 4 where bodies intersect");
    command->add_option("SCENE", arguments->scene, "Scene file (JSON), or - for standard input")->required();
    add_scene_options(*command, arguments->options);
    command->add_option("--output", arguments->output,
                        "OBJ file for intersecting triangles (default: SCENE with .overlap.obj)");
    command->callback([arguments, &action] { action = [arguments] { return run_check(*arguments); }; });
}

} // namespace flotilla::cli
