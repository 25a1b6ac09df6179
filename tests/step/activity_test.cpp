// SPDX-License-Identifier: MIT
// What a step reports of single bodies.
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

/// A block of edge 1 whose underside is at height z, over a large plate at 0.
SceneDescription block_over_plate(double z) {
    SceneDescription scene = empty_scene();
    const auto block = add_shape(scene, make_box(1, 1, 1), 3);
    const auto plate = add_shape(scene, make_box(10, 10, 1));
    add_body(scene, plate, BodyType::fixed, {0, 0, -0.5});
    add_body(scene, block, BodyType::dynamic, {0, 0, z + 0.5});
    return scene;
}

TEST(BodyActivity, ABodyInFreeFallHasNoContactsAndCostsLeast) {
    World world(block_over_plate(3));
    EXPECT_EQ(world.activity()[1].cost, 0) << "before the first step";
    (void)world.step();
    const std::vector<BodyActivity> activity = world.activity();
    ASSERT_EQ(activity.size(), 2u);
    EXPECT_EQ(activity[1].contacts, 0);
    EXPECT_EQ(activity[1].cluster, ClusterState::free);
    EXPECT_EQ(activity[1].cost, 2);
    EXPECT_EQ(activity[0].cost, 0) << "a static body";
}

TEST(BodyActivity, CountsTheContactsOfBothBodies) {
    World world(block_over_plate(1e-4));
    for (int i = 0; i < 10; ++i) (void)world.step();
    const std::vector<BodyActivity> activity = world.activity();
    EXPECT_GE(activity[1].contacts, 4);
    EXPECT_EQ(activity[0].contacts, activity[1].contacts);
    EXPECT_EQ(static_cast<std::size_t>(activity[1].contacts), world.contacts().size());
}

TEST(BodyActivity, SumsAgreeWithTheReport) {
    SceneDescription scene = make_scene("boats-in-bowl", 12, 1);
    scene.settings.collision_iterations = 0; // nothing but the failsafe keeps bodies apart
    scene.settings.dynamic_iterations = 0;
    World world(scene);
    std::int64_t clustered = 0;
    for (int i = 0; i < 70; ++i) {
        const StepReport report = world.step();
        std::int64_t count[5] = {};
        for (const BodyActivity& a : world.activity()) ++count[static_cast<int>(a.cluster)];
        EXPECT_EQ(count[1], report.kinematic_bodies);
        EXPECT_EQ(count[2], report.rigid_bodies);
        EXPECT_EQ(count[3], report.held);
        EXPECT_EQ(count[4], report.sleeping);
        clustered += count[1] + count[2] + count[3];
    }
    EXPECT_GT(clustered, 0);
}

TEST(BodyActivity, IsTheSameAtAnyNumberOfThreads) {
    const SceneDescription scene = make_scene("boats-in-bowl", 22, 1);
    World one(scene, "scene", {1, Executor::serial}), three(scene, "scene", {3, Executor::parallel});
    std::int64_t contacts = 0;
    for (int i = 0; i < 65; ++i) {
        (void)one.step(), (void)three.step();
        const auto a = one.activity(), b = three.activity();
        for (std::size_t k = 0; k < a.size(); ++k) {
            EXPECT_EQ(a[k].contacts, b[k].contacts);
            EXPECT_EQ(a[k].cluster, b[k].cluster);
            EXPECT_EQ(a[k].cost, b[k].cost);
            contacts += a[k].contacts;
        }
    }
    EXPECT_GT(contacts, 0);
}

} // namespace
} // namespace flotilla::scenario
