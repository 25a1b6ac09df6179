// SPDX-License-Identifier: MIT
// Lets a plate fall through the public headers alone; CMake adds a file that includes all of them.
#include <cmath>
#include <cstdio>

#include <flotilla/ccd.hpp>
#include <flotilla/error.hpp>
#include <flotilla/scene.hpp>
#include <flotilla/world.hpp>

namespace {

flotilla::SceneDescription falling_plate() {
    flotilla::SceneDescription scene;
    scene.shapes.push_back({.name = "plate",
                            .vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                            .triangles = {{0, 1, 2}},
                            .mass_kind = flotilla::MassKind::mass,
                            .mass_value = 2});
    scene.bodies.push_back({.name = "b0", .shape = 0, .position = {0, 0, 5}});
    return scene;
}

bool falls() {
    const flotilla::SceneDescription scene = falling_plate();
    flotilla::World world(scene);
    const flotilla::StepReport report = world.step();
    const flotilla::BodyState plate = world.body(0);
    const double dt = scene.settings.time_step;
    std::printf("step %ld: %zu body at %.17g m, %.17g m/s\n", static_cast<long>(report.step), scene.bodies.size(),
                plate.position.z, plate.velocity.z);
    return report.step == 1 && plate.position.z < 5 &&
           std::abs(plate.velocity.z - scene.gravity.z * dt) <= 1e-12 * std::abs(scene.gravity.z * dt);
}

} // namespace

int main() {
    if (!falls()) return 1;
    try {
        static_cast<void>(flotilla::evaluate_ccd_file("no_such_file.csv"));
    } catch (const flotilla::IoError& error) {
        std::printf("refused as it should be: %s\n", error.what());
        return 0;
    }
    return 1;
}
