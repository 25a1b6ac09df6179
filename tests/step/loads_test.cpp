// SPDX-License-Identifier: MIT
// Constant forces and torques of bodies.
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

TEST(Loads, FreeBodyGainsWhatItsForceAndTorqueWork) {
    SceneDescription scene = empty_scene();
    const auto shape = add_shape(scene, make_octahedron(1), 2);
    scene.shapes.back().inertia = diagonal({1, 2, 2.5});
    BodyDescription& body = add_body(scene, shape, BodyType::dynamic, {});
    body.angular_velocity = {1, 3, -2};
    body.force = {4, 0, 12};
    body.torque = {0.5, -2, 1};
    World world(scene, "scene", {1});
    const double dt = scene.settings.time_step;
    for (int n = 1; n <= 1000; ++n) {
        const StepReport report = world.step();
        ASSERT_EQ(report.energy_corrections, 0) << n;
        ASSERT_EQ(report.lift, 0) << n;
        const double t = n * dt;
        ASSERT_NEAR(world.body(0).velocity.x, 2 * t, 1e-12 * (1 + t));
        ASSERT_NEAR(world.body(0).velocity.z, (6 - kGravity) * t, 1e-12 * (1 + t));
        const Vec3 l = report.angular_momentum - cross(world.body(0).center_of_mass, report.momentum);
        ASSERT_NEAR(l.y, 6 - 2 * t, 1e-9 * (1 + t * t));
    }
}

/// A crate between floor and wall, pressed against the wall.
SceneDescription pressed_crate(double weights, double friction) {
    SceneDescription scene = empty_scene();
    const auto floor = add_shape(scene, make_box(20, 20, 0.2)), wall = add_shape(scene, make_box(0.2, 20, 20));
    const auto crate = add_shape(scene, make_box(1, 1, 1), 10);
    add_body(scene, floor, BodyType::fixed, {-10.2, 0, -0.1}, friction);
    add_body(scene, wall, BodyType::fixed, {0.1, 0, 0}, friction);
    const double rest = std::sqrt(3.0) / 330;
    add_body(scene, crate, BodyType::dynamic, {-0.5 - rest, 0, 0.5 + rest}, friction).force = {weights * 10 * kGravity,
                                                                                               0, 0};
    return scene;
}

TEST(Loads, CratePressedAgainstAWallNeitherJittersNorHovers) {
    for (const double weights : {1.0, 100.0}) {
        const SceneDescription scene = pressed_crate(weights, 0.5);
        World world(scene, "scene", {1});
        for (int n = 0; n < 120; ++n) world.step();
        const Vec3 from = world.body(2).center_of_mass;
        double fastest = 0, farthest = 0;
        for (int n = 0; n < 240; ++n) {
            const StepReport report = world.step();
            EXPECT_EQ(report.held + report.merges, 0) << n;
            EXPECT_EQ(report.energy_corrections, 0) << n;
            fastest = std::max(fastest, length(world.body(2).velocity));
            farthest = std::max(farthest, length(world.body(2).center_of_mass - from));
        }
        const double rest = std::sqrt(3.0) / 330;
        std::printf("%g weights: speed %.3g m/s, way %.3g m, gap %.4g of rest\n", weights, fastest, farthest,
                    (-0.5 - world.body(2).center_of_mass.x) / rest);
        EXPECT_LE(fastest, 1e-3);
        EXPECT_LE(farthest, 0.05 * rest);
        EXPECT_NEAR(-0.5 - world.body(2).center_of_mass.x, rest, 0.05 * rest);
    }
}

TEST(Loads, CrateHeldUpByFrictionAlone) {
    // No floor below: the wall holds 100 weights, friction half of them.
    SceneDescription scene = pressed_crate(100, 0.5);
    scene.bodies[0].position.z = -10;
    World world(scene, "scene", {1});
    const double z = world.body(2).center_of_mass.z;
    for (int n = 0; n < 480; ++n) world.step();
    EXPECT_NEAR(world.body(2).center_of_mass.z, z, 1e-4);
}

TEST(Loads, CrateIsHeldAgainstAWallWithoutGravity) {
    SceneDescription scene = pressed_crate(0, 0.5);
    scene.gravity = {};
    scene.bodies[2].force = {0.01, 0, 0};
    World world(scene, "scene", {1});
    for (int n = 0; n < 480; ++n) ASSERT_EQ(world.step().energy_corrections, 0);
    const double rest = std::sqrt(3.0) / 330;
    EXPECT_NEAR(-0.5 - world.body(2).center_of_mass.x, rest, 0.05 * rest);
}

TEST(Loads, DoorPressedAgainstAStopRests) {
    SceneDescription scene = empty_scene();
    const auto door = add_shape(scene, make_box(1, 0.1, 1), 10), stop = add_shape(scene, make_box(0.1, 0.1, 0.5));
    BodyDescription& body = add_body(scene, door, BodyType::dynamic, {});
    body.locked_translation = {true, true, true};
    body.locked_rotation = {true, true, false};
    body.torque = {0, 0, 5};
    add_body(scene, stop, BodyType::fixed, {0.45, 0.3, 0});
    World world(scene, "scene", {1});
    for (int n = 0; n < 480; ++n) ASSERT_EQ(world.step().energy_corrections, 0) << n;
    const Quat from = world.body(0).rotation;
    double fastest = 0;
    for (int n = 0; n < 240; ++n) {
        world.step();
        fastest = std::max(fastest, length(world.body(0).angular_velocity));
    }
    std::printf("door: %.3g rad/s, turned by %.3g\n", fastest, std::abs(world.body(0).rotation.z - from.z));
    EXPECT_LE(fastest, 1e-3);
    EXPECT_LE(std::abs(world.body(0).rotation.z - from.z), 1e-4);
}

TEST(Loads, WhatAWeakForceMovesDoesNotFallAsleep) {
    SceneDescription scene = pressed_crate(0, 0);
    scene.settings.sleeping = true;
    scene.bodies[2].position.x = -5;
    World still(scene);
    scene.bodies[2].force = {-0.02, 0, 0}; // 1/5000 of its weight
    World pulled(scene);
    for (int n = 0; n < 480; ++n) still.step(), pulled.step();
    EXPECT_EQ(still.step().sleeping, 1);
    EXPECT_EQ(pulled.step().sleeping, 0);
    const double t = 481 * scene.settings.time_step;
    EXPECT_NEAR(pulled.body(2).velocity.x, -0.002 * t, 2e-5 * t);
}

TEST(Loads, PressedCrateFallsAsleepAtRest) {
    SceneDescription scene = pressed_crate(2, 0.5);
    scene.settings.sleeping = true;
    World world(scene, "scene", {1});
    for (int n = 0; n < 240; ++n) world.step();
    EXPECT_EQ(world.step().sleeping, 1);
}

} // namespace
} // namespace flotilla::scenario
