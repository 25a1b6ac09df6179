// SPDX-License-Identifier: MIT
// Uses types and a function of the library through the public headers alone.
#include <cstdio>

#include <flotilla/ccd.hpp>
#include <flotilla/error.hpp>
#include <flotilla/scene.hpp>

int main() {
    flotilla::SceneDescription scene;
    scene.shapes.push_back({.name = "plate",
                            .vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                            .triangles = {{0, 1, 2}},
                            .mass_kind = flotilla::MassKind::mass,
                            .mass_value = 2});
    scene.bodies.push_back({.name = "b0", .shape = 0, .position = {0, 0, 5}});
    std::printf("%zu body, %zu shape, time step %.17g s\n", scene.bodies.size(), scene.shapes.size(),
                scene.settings.time_step);
    try {
        static_cast<void>(flotilla::evaluate_ccd_file("no_such_file.csv"));
    } catch (const flotilla::IoError& error) {
        std::printf("refused as it should be: %s\n", error.what());
        return 0;
    }
    return 1;
}
