// SPDX-License-Identifier: MIT
// contact_reuse: what rests is not searched, and is the same as if it were.
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

constexpr int kSteps = 80;

SceneDescription resting_stack(double reuse) {
    SceneDescription scene = make_scene("stack", 6);
    scene.settings.sleeping = false;
    scene.settings.contact_reuse = reuse;
    return scene;
}

/// Of all vertical forces, N: of the ground on the stack, and of its boxes on each other.
double forces(const World& world) {
    double sum = 0;
    for (const ContactState& c : world.contacts()) sum += std::abs(c.impulse.z) / world.settings().time_step;
    return sum;
}

TEST(ContactReuse, WhatRestsIsNotSearchedAndStandsAsBefore) {
    World searching(resting_stack(0)), reusing(resting_stack(1.0 / 64));
    StepReport every, last;
    std::int64_t searched = 0;
    for (int n = 0; n < kSteps; ++n) {
        every = searching.step();
        last = reusing.step();
        if (n >= kSteps / 2) searched += last.proximities;
    }
    EXPECT_GT(every.proximities, 0);
    EXPECT_EQ(searched, 0);
    EXPECT_EQ(last.contacts, every.contacts);
    EXPECT_NEAR(last.min_distance, every.min_distance, 1e-2 * every.min_distance);
    const double due = forces(searching);
    EXPECT_GT(due, 0);
    EXPECT_NEAR(forces(reusing), due, 1e-3 * due);
    for (std::size_t i = 0; i < reusing.size(); ++i)
        EXPECT_NEAR(length(reusing.body(i).position - searching.body(i).position), 0, 1e-4) << i;
}

/// A block on a moving belt is searched again and again: the reference of a scripted body is where it is.
TEST(ContactReuse, WhatMovesIsSearched) {
    SceneDescription scene = empty_scene();
    scene.settings.sleeping = false;
    auto& belt = add_body(scene, add_shape(scene, make_plate(20, 20)), BodyType::kinematic, {}, 1);
    belt.keyframes = {{0, {0, 0, 0}, {}}, {4, {2, 0, 0}, {}}};
    add_body(scene, add_shape(scene, make_box(1, 1, 1), 10), BodyType::dynamic, {0, 0, 0.505}, 1);
    World world(scene);
    for (int n = 0; n < kSteps; ++n) EXPECT_GT(world.step().proximities, 0) << n;
    const BodyState block = world.body(1);
    EXPECT_NEAR(block.velocity.x, 0.5, 5e-3);
}

/// Bodies that come loose from where they rested: the slope holds, a push ends that.
TEST(ContactReuse, APushedBlockFindsItsNewContacts) {
    SceneDescription scene = resting_stack(1.0 / 64);
    const auto ball = add_shape(scene, make_sphere(0.6, 1), 800);
    add_body(scene, ball, BodyType::dynamic, {-60, 0.1, 1.4}).velocity = {25, 0, 1.2 * 9.8};
    scene.settings.restitution = 0;
    World world(scene);
    bool quiet = false, hit = false;
    for (int n = 0; n < 120; ++n) {
        const StepReport r = world.step();
        quiet = quiet || (n > 20 && r.contacts > 0 && r.proximities == 0);
        hit = hit || (quiet && r.proximities > 0);
        ASSERT_EQ(r.warnings & kReboundLost, 0u) << n;
    }
    EXPECT_TRUE(quiet);
    EXPECT_TRUE(hit);
}

} // namespace
} // namespace flotilla::scenario
