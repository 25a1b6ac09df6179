// SPDX-License-Identifier: MIT
#include "fuzz/small_scene.hpp"

#include <algorithm>

#include "mesh/primitives.hpp"
#include "step/scene_parts.hpp"

namespace flotilla::fuzz {

void cut_limits(Settings& s) {
    s.substeps = std::min(s.substeps, 2);
    for (int* limit : {&s.collision_iterations, &s.collision_pair_iterations, &s.dynamic_iterations,
                       &s.dynamic_pair_iterations, &s.static_iterations})
        *limit = std::min(*limit, 20);
}

SceneDescription small_pile() {
    SceneDescription scene;
    const std::int32_t box = scenario::add_shape(scene, make_box(1, 1, 1), 1);
    const std::int32_t plate = scenario::add_shape(scene, make_plate(4, 4));
    scene.shapes[0].name = "box";
    scene.shapes[1].name = "plate";
    scenario::add_body(scene, box, BodyType::dynamic, {0, 0, 0.501}).name = "low";
    BodyDescription& high = scenario::add_body(scene, box, BodyType::dynamic, {0.1, 0, 1.51});
    high.name = "high";
    high.velocity = {0, 0, -2};
    scenario::add_body(scene, plate, BodyType::fixed, {}).name = "floor";
    BodyDescription& lid = scenario::add_body(scene, plate, BodyType::kinematic, {0, 0, 4});
    lid.name = "lid";
    lid.keyframes = {{0, {0, 0, 4}, {}}, {1, {0, 0, 3}, {}}};
    cut_limits(scene.settings);
    // Of a snapshot's input two thirds of the time were exact solves of states that were changed; targets of whole
    // scenes and meshes have them.
    scene.settings.contact_solver = ContactSolver::pgs;
    return scene;
}

} // namespace flotilla::fuzz
