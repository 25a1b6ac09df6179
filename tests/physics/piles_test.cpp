// SPDX-License-Identifier: MIT
// Piles of boats in a bowl come to rest.
#include "physics/physics.hpp"

#include <algorithm>
#include <cstdio>

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

[[maybe_unused]] const bool registered = [] {
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
