// SPDX-License-Identifier: MIT
// Scenes on which runs with different numbers of threads are compared.
#pragma once

#include <algorithm>
#include <ostream>

#include "base/rotation.hpp"
#include "step/scenario.hpp"

namespace flotilla::scenario {

/// One pile, a single island once it has formed; the large one has 250 boats.
inline SceneDescription one_pile(bool large) {
    SceneDescription scene = make_scene("boats-in-bowl", large ? 252 : 32, 1);
    scene.settings.sleeping = false;
    return scene;
}

/// Piles of five boxes each, apart from each other: an island each.
inline SceneDescription piles_of_boxes(int piles) {
    SceneDescription scene = empty_scene();
    const auto floor = add_shape(scene, make_box(200, 200, 0.1));
    const auto crate = add_shape(scene, make_box(0.5, 0.5, 0.5), 20);
    add_body(scene, floor, BodyType::fixed, {0, 0, -0.1});
    for (int pile = 0; pile < piles; ++pile)
        for (int i = 0; i < 5; ++i) {
            const double x = 4.0 * (pile % 8), y = 4.0 * (pile / 8);
            auto& body = add_body(scene, crate, BodyType::dynamic, {x + 0.1 * i * (pile % 3), y, 0.6 + 1.2 * i});
            body.angular_velocity = {0.3 * (pile % 5), 0.2 * i, 0};
        }
    return scene;
}

inline SceneDescription small_piles(bool large) { return piles_of_boxes(large ? 40 : 12); }

/// Figure 9 with stage 1 and dynamic contact cut off at once, so that the failsafe does all.
inline SceneDescription forced_stack(bool) {
    SceneDescription scene = make_scene("stack", 9);
    scene.settings.sleeping = false;
    scene.settings.collision_iterations = scene.settings.dynamic_iterations = 0;
    const auto ball = add_shape(scene, make_sphere(0.6, 1), 800);
    add_body(scene, ball, BodyType::dynamic, {-3, 0.1, 3.2}).velocity = {12, 0, 0};
    return scene;
}

/// Heaps that slide into each other, get scattered by a ball and come to rest as islands of their own; some fall asleep
/// and wake.
inline SceneDescription changing_islands(bool large) {
    SceneDescription scene = small_piles(large);
    scene.settings.sleeping = true;
    scene.settings.friction = 0.05;
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
        const bool even = ((i - 1) / 5) % 2 == 0;
        scene.bodies[i].velocity = {even ? 5.0 : -5.0, 0, 0};
    }
    const auto ball = add_shape(scene, make_sphere(1.2, 1), 2000);
    add_body(scene, ball, BodyType::dynamic, {-12, 2, 1.5}).velocity = {20, 0, 0};
    return scene;
}

/// Groups of two and more dynamic bodies that touch each other, directly or through others.
inline std::size_t count_islands(const SceneDescription& scene, const World& world) {
    std::vector<std::size_t> parent(world.size());
    for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = i;
    const auto root = [&](std::size_t i) {
        while (parent[i] != i) i = parent[i];
        return i;
    };
    std::size_t joined = 0;
    std::vector<bool> touches(world.size());
    for (const ContactState& c : world.contacts()) {
        const auto a = static_cast<std::size_t>(c.body_a), b = static_cast<std::size_t>(c.body_b);
        if (scene.bodies[a].type != BodyType::dynamic || scene.bodies[b].type != BodyType::dynamic) continue;
        touches[a] = touches[b] = true;
        if (root(a) == root(b)) continue;
        parent[std::max(root(a), root(b))] = std::min(root(a), root(b));
        ++joined;
    }
    return static_cast<std::size_t>(std::count(touches.begin(), touches.end(), true)) - joined;
}

/// The same with hits that are solved together.
inline SceneDescription accumulated_pile(bool large) {
    SceneDescription scene = one_pile(large);
    scene.settings.collisions = Collisions::accumulated;
    return scene;
}
inline SceneDescription accumulated_islands(bool large) {
    SceneDescription scene = changing_islands(large);
    scene.settings = preset("preview");
    scene.settings.friction = 0.05;
    return scene;
}

struct ThreadScene {
    const char* name;
    SceneDescription (*make)(bool large);
    int fast_steps, slow_steps;

    friend void PrintTo(const ThreadScene& s, std::ostream* out) { *out << s.name; }
};

/// Cubes of 10 mm, which fall by as much in a step: contacts ahead (look_ahead.hpp).
inline SceneDescription small_cubes(bool) {
    constexpr double kEdge = 0.01;
    SceneDescription scene = empty_scene();
    const auto cube = add_shape(scene, make_box(kEdge, kEdge, kEdge), 1);
    for (int i = 0; i < 24; ++i)
        add_body(scene, cube, BodyType::dynamic, {0.004 * (i % 3), 0.007 * (i % 2), kEdge * (1 + 1.8 * i)}, 0.4)
            .rotation = rotation_from_vector({0.3 * i, 0.5 * (i % 5), 0.1});
    add_body(scene, add_shape(scene, make_plate(2, 2)), BodyType::fixed, {}, 0.4);
    return scene;
}

inline std::vector<ThreadScene> thread_scenes() {
    return {{"OnePile", one_pile, 45, 60},
            {"AccumulatedPile", accumulated_pile, 45, 60},
            {"AccumulatedIslands", accumulated_islands, 30, 100},
            {"SmallCubes", small_cubes, 30, 60},
            {"SmallPiles", small_piles, 40, 100},
            {"ForcedFailsafe", forced_stack, 20, 40},
            {"ChangingIslands", changing_islands, 40, 150}};
}

/// The state hash after every step.
inline std::vector<std::uint64_t> hashes_of_run(const SceneDescription& scene, int steps, const WorldOptions& options) {
    World world(scene, "scene", options);
    std::vector<std::uint64_t> out;
    for (int n = 0; n < steps; ++n) out.push_back(world.step().state_hash);
    return out;
}

} // namespace flotilla::scenario
