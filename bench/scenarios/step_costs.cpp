// SPDX-License-Identifier: MIT
// flotilla_step_costs SCENE: makes steps of a World as a program that embeds the library does, one thread, and nothing
// else. The scenario step_overhead counts what they cost beside the command's.
#include <CLI/CLI.hpp>

#include <string>

#include <flotilla/scene_file.hpp>
#include <flotilla/world.hpp>

int main(int argc, char** argv) {
    CLI::App app{"Steps of a World"};
    std::string scene_file;
    int steps = 100;
    app.add_option("scene", scene_file, "scene")->required();
    app.add_option("--steps", steps, "steps");
    CLI11_PARSE(app, argc, argv);

    flotilla::World world(flotilla::read_scene(scene_file), scene_file, {.threads = 1});
    for (int i = 0; i < steps; ++i) (void)world.step();
    return world.steps() == steps ? 0 : 1;
}
