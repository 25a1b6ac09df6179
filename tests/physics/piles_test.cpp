// SPDX-License-Identifier: MIT
// Piles of boats in a bowl come to rest.
#include "physics/physics.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scene/household_meshes.hpp"

namespace flotilla::physics {
namespace {

constexpr double kTime = 8.3, kEnd = 14, kWatched = 1; // s
/// Of the way of a body that still slides, by which a frame's one step may be off.
constexpr double kAstray = 0.3;
constexpr double kResting = 1e-4; // sizes a second

/// The scene with its bodies as they are.
SceneDescription as_it_is(Motion& motion) {
    SceneDescription scene = motion.scene();
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyState s = motion.body(i);
        scene.bodies[i].position = s.position;
        scene.bodies[i].rotation = s.rotation;
        scene.bodies[i].velocity = s.velocity;
        scene.bodies[i].angular_velocity = s.angular_velocity;
    }
    return scene;
}

/// What moves has come from where it was as far as with sixteen times as many steps; what one body pushes on its way,
/// by no more than that one may be off.
void expect_due_way(SceneDescription was, Motion& motion) {
    was.settings.substeps *= 16;
    Motion finer(was);
    finer.run(kWatched);
    const std::size_t count = was.bodies.size();
    double farthest = 0;
    for (std::size_t i = 0; i < count; ++i)
        farthest = std::max(farthest, length(finer.body(i).position - was.bodies[i].position));
    for (std::size_t i = 0; i < count; ++i) {
        const BodyState now = motion.body(i);
        const double speed = length(now.velocity);
        if (motion.mass(i) == 0 || speed < kResting * motion.size(i)) continue;
        const Vec3 due = finer.body(i).position - was.bodies[i].position, way = now.position - was.bodies[i].position;
        std::printf("body %zu moves at %.3g m/s, has come %.4g m, due %.4g\n", i, speed, length(way), length(due));
        EXPECT_LT(length(way - due), kAstray * farthest + kResting * motion.size(i)) << "body " << i;
    }
}

// With friction of 0.1 a boat of its own may slide for long. What is not at rest must have come as far in the last
// second as it should, and all are at rest in the end.
void pile_rests(const std::string& preset, int bodies, std::uint64_t seed) {
    SceneDescription scene = make_scene("boats-in-bowl", bodies, seed);
    scene.settings = Run{preset, 24}.settings();
    Motion motion(scene);
    motion.run(kTime - kWatched);
    const SceneDescription watched = as_it_is(motion);
    motion.run(kTime);
    if (motion.outcome().fastest_sizes >= kResting) {
        expect_due_way(watched, motion);
        motion.run(kEnd);
    }
    motion.print();
    expect_rest(motion);
    expect_no_rise(motion);
    EXPECT_EQ(motion.outcome().held, 0);
}

// Stones in a narrow cone lean on each other along many ways: their sweeps converge slowly, and hardly any two contacts
// say the same. `count` octahedra, 25 mm long, all asleep within two seconds.
void stones_fall_asleep(const Run& run, int count, std::uint64_t seed) {
    constexpr double kRadius = 0.0125, kPitch = 0.028, kMostAside = 0.11, kFirst = 0.4335; // m
    Settings settings = run.settings();
    settings.sleeping = true;
    SceneDescription scene = make_scene_with(settings);
    constexpr double kFriction = 0.3;
    const TriangleMesh cone = library::revolve({{0.002, 0.3}, {0.14, 0.42}, {0.14, 0.75}}, 24);
    add_body(scene, add_shape(scene, cone, 1), BodyType::fixed, {}, kFriction, 0);
    TriangleMesh stone = scenario::make_octahedron(kRadius);
    for (Vec3& v : stone.vertices) v = {v.x, 0.93 * v.y, 0.8 * v.z};
    const std::int32_t shape = add_solid(scene, stone, 1500);
    Numbers numbers(seed);
    for (int k = 0, layer = 0; k < count; ++layer)
        for (int i = -3; i <= 3; ++i)
            for (int j = -3; j <= 3; ++j) {
                const Vec3 place{i * kPitch, j * kPitch, kFirst + layer * kPitch};
                if (k == count || std::hypot(place.x, place.y) > kMostAside) continue;
                add_body(scene, shape, BodyType::dynamic, place, kFriction, 0).rotation = numbers.rotation();
                ++k;
            }
    Motion motion(scene);
    motion.run(2);
    motion.print("%d stones, seed %d", count, static_cast<int>(seed));
    EXPECT_EQ(motion.outcome().asleep, count);
    expect_no_rise(motion);
}

[[maybe_unused]] const bool registered = [] {
    for (const std::uint64_t seed : {1, 2, 3})
        add_runs("Piles", "StonesInAConeFallAsleep_seed" + std::to_string(seed), {{"balanced", 60}}, seed == 1,
                 [=](const Run& r) { stones_fall_asleep(r, 80, seed); });
    add_runs("Piles", "StonesInAConeFallAsleep_120", {{"balanced", 60}}, false,
             [=](const Run& r) { stones_fall_asleep(r, 120, 1); });
    for (const std::string preset : {"balanced", "accurate", "reference"}) {
        const auto add = [&](int bodies, std::uint64_t seed, Slice slice = Slice::full) {
            add_test("Piles", preset + "_boats" + std::to_string(bodies) + "_seed" + std::to_string(seed), slice,
                     [=] { pile_rests(preset, bodies, seed); });
        };
        add(22, 0, preset == "balanced" ? Slice::fast : Slice::full);
        for (std::uint64_t seed = 0; seed < 10; ++seed) add(102, seed);
        add(252, 1);
    }
    return true;
}();

} // namespace
} // namespace flotilla::physics
