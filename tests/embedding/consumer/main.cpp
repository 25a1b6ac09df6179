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

/// Every way to change a World, and its state in the end: the same bits however this program is compiled.
bool edits() {
    namespace f = flotilla;
    f::SceneDescription scene = falling_plate();
    scene.shapes.push_back(
        {.name = "floor", .vertices = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, .triangles = {{0, 1, 2}}});
    scene.bodies.push_back({.name = "floor", .shape = 1, .type = f::BodyType::fixed});
    f::World world(scene);
    std::printf("scene hash: %016lx\n", static_cast<unsigned long>(world.scene_hash()));
    int stages = 0;
    world.set_observer([&](f::Phase) { return ++stages > 0; });
    world.set_force_callback([](f::World& w) { w.apply_torque(w.find("b0"), {0, 0, 0.1}); });
    const std::int32_t wedge = world.add_shape({.name = "wedge",
                                                .vertices = {{0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}},
                                                .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
                                                .mass_kind = f::MassKind::density,
                                                .mass_value = 100});
    const f::BodyId a = world.add_body({.name = "a", .shape = wedge, .position = {0, 0, 1}}),
                    b = world.add_body({.name = "b", .shape = wedge, .position = {0, 1, 1}});
    for (int i = 0; i < 20; ++i) world.step();
    world.apply_impulse(a, {0, 0, 1}, world.body(2).center_of_mass);
    world.apply_force(a, {1, 0, 0}, world.body(2).center_of_mass);
    world.set_force(a, {0, 0, 0.5}, {});
    world.set_material(a, 0.5, 0.2);
    world.set_velocity(b, {0, 0, 1}, {0, 1, 0});
    world.set_gravity({0, 0.1, -9.8});
    world.set_group(a, "g");
    world.set_group(b, "g");
    world.ignore_groups("g", "g");
    world.ignore_pair(a, b);
    world.set_pose(b, {0, 2, 2}, {});
    world.set_type(b, f::BodyType::fixed);
    world.set_script(b, {{world.time() + 1, {0, 2, 3}, {}}});
    world.wake(a);
    const std::vector<std::byte> snapshot = world.snapshot();
    for (int i = 0; i < 20; ++i) world.step();
    f::World clone = world.clone();
    world.restore(snapshot);
    for (int i = 0; i < 20; ++i) world.step();
    if (clone.state_hash() != world.state_hash()) return false;
    world.remove_body(b);
    try {
        world.remove_body(b);
        return false;
    } catch (const f::InputError&) {
    }
    world.step();
    const auto hit = world.ray({0, 0, 9}, {0, 0, -1}, 99);
    const bool asked = hit && world.contains(hit->body) && world.closest(a, world.find("floor")).distance > 0 &&
                       !world.bodies_in({-9, -9, -9}, {9, 9, 9}).empty() && world.memory().total() > 0 &&
                       world.overlapping(wedge, {0, 0, 50}, {}).empty() && world.poses().size() == 4;
    (void)world.contacts_of(a);
    std::printf("state hash: %016lx\n", static_cast<unsigned long>(world.state_hash()));
    return asked && stages > 0;
}

} // namespace

int main() {
    if (!falls() || !edits()) return 1;
    try {
        static_cast<void>(flotilla::evaluate_ccd_file("no_such_file.csv"));
    } catch (const flotilla::IoError& error) {
        std::printf("refused as it should be: %s\n", error.what());
        return 0;
    }
    return 1;
}
