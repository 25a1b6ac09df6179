// SPDX-License-Identifier: MIT
// Stage 1 as a whole: blows that go on from body to body, its limit, what it keeps, and the order of its operations.
#include <gtest/gtest.h>

#include "collision/stage.hpp"
#include "support/joint_solver.hpp"

namespace flotilla {
namespace {

using scenario::add_body;
using scenario::add_shape;
using test::collide;
using test::StageWorld;

class CollisionStage : public test::BothWays {};

INSTANTIATE_TEST_SUITE_P(Ways, CollisionStage, testing::Values(Collisions::sequential, Collisions::accumulated),
                         test::name_of_way);

/// Octahedra and boxes in turn along x, a corner `gap` before a face each time, with the given velocities.
SceneDescription row(SceneDescription s, const std::vector<double>& velocities, double restitution,
                     double gap = 0.008) {
    const std::int32_t shapes[] = {test::add_octahedron(s, 1), add_shape(s, make_box(1, 1, 1, 4), 1)};
    for (std::size_t i = 0; i < velocities.size(); ++i)
        add_body(s, shapes[i % 2], BodyType::dynamic, {static_cast<double>(i) * (1 + gap), 0, 0}, 0, restitution)
            .velocity = {velocities[i], 0, 0};
    return s;
}

void expect_velocities(const StageWorld& world, const std::vector<double>& wanted) {
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const Vec3 v = world.velocity(static_cast<std::int32_t>(i));
        EXPECT_NEAR(v.x, wanted[i], 2e-3) << "body " << i; // accumulated: a round leaves 1e-4 of the approach undone
        EXPECT_LE(std::hypot(v.y, v.z), 1e-9) << "body " << i;
    }
}

TEST_P(CollisionStage, ARowHandsABlowToItsLastBody) {
    StageWorld world(row(scene(), {10, 0, 0, 0, 0}, 1));
    EXPECT_FALSE(collide(world).limit);
    expect_velocities(world, {0, 0, 0, 0, 10});
}

TEST_P(CollisionStage, BlowsFromBothSidesPassEachOther) {
    StageWorld world(row(scene(), {10, 0, -10}, 1));
    EXPECT_FALSE(collide(world).limit);
    expect_velocities(world, {-10, 0, 10});
}

// A light body hands on to the wall, in a sweep, no more than its mass takes of what a heavy one brings.
TEST_P(CollisionStage, AHeavyBodyStopsAtALightOneBeforeAWall) {
    for (const double mass : {100.0, 1e3, 1e4})
        for (const double restitution : {0.0, 0.5}) {
            SceneDescription s = scene();
            const std::int32_t wall = test::add_octahedron(s, 1), light = add_shape(s, make_box(1, 1, 1, 4), 1),
                               heavy = test::add_octahedron(s, mass);
            add_body(s, wall, BodyType::fixed, {0, 0, 0}, 0, restitution);
            add_body(s, light, BodyType::dynamic, {1.008, 0, 0}, 0, restitution);
            add_body(s, heavy, BodyType::dynamic, {2.016, 0, 0}, 0, restitution).velocity = {-5, 0, 0};
            StageWorld alone(s);
            (void)collide(alone);
            EXPECT_GT(std::abs(alone.velocity(2).x), mass > 100 ? 1.0 : 0.0) << mass;
            StageWorld world(s);
            test::JointSolver solver(world);
            EXPECT_FALSE(collide(world, &solver.joint).limit) << mass;
            for (const std::int32_t i : {1, 2})
                EXPECT_LT(length(world.velocity(i)), 0.02) << mass << ' ' << restitution << " body " << i;
        }
}

// Where sweeps get through there is nothing to solve together, and where rebounds are not used up nothing is.
TEST_P(CollisionStage, ReboundsStayWhereHitsMayBeSolvedTogether) {
    SceneDescription few = scene();
    few.settings.collision_iterations = 3;
    for (const SceneDescription& s : {row(scene(), {10, 0, 0, 0, 0}, 1), row(few, {10, 0, 0, 0, 0, 0, 0, 0, 0}, 1)}) {
        StageWorld alone(s), world(s);
        test::JointSolver solver(world);
        const StageCounters expected = collide(alone), counters = collide(world, &solver.joint);
        EXPECT_EQ(counters.limit, expected.limit); // what is left still hits
        EXPECT_FALSE(counters.rebound_lost);
        for (std::int32_t i = 0; i < std::ssize(s.bodies); ++i)
            EXPECT_EQ(world.velocity(i), alone.velocity(i)) << "body " << i;
    }
}

TEST_P(CollisionStage, WhatDoesNotMeetIsLeftAlone) {
    StageWorld world(row(scene(), {-1, 0, 1}, 1));
    const std::vector<Pose> ends = world.ends();
    const StageCounters counters = collide(world);
    EXPECT_EQ(counters.impulses, 0);
    EXPECT_FALSE(counters.limit);
    EXPECT_EQ(world.ends(), ends);
    expect_velocities(world, {-1, 0, 1});
}

TEST_P(CollisionStage, WithoutSweepsItSaysSoAndLeavesAllAsItWas) {
    SceneDescription s = row(scene(), {10, 0}, 1);
    s.settings.collision_iterations = 0;
    StageWorld world(s);
    const std::vector<Pose> ends = world.ends();
    const StageCounters counters = collide(world);
    EXPECT_TRUE(counters.limit);
    EXPECT_EQ(counters.sweeps, 0);
    EXPECT_EQ(world.ends(), ends);
    expect_velocities(world, {10, 0});
}

TEST_P(CollisionStage, EndsWhereShellsHandEachOtherOnWhatNoBlowEnds) {
    SceneDescription s = test::nested_boxes(scene(), 2);
    s.settings.collision_iterations = 200;
    s.settings.approach_threshold = 0.5 * length(s.gravity) * s.settings.time_step; // nothing is left as calm
    StageWorld world(s);
    const StageCounters counters = collide(world);
    EXPECT_TRUE(counters.limit) << "what is left is for later stages";
    EXPECT_LE(counters.sweeps, 60);
}

/// 27 bodies of three shapes that fly towards the middle, spinning.
SceneDescription implosion(SceneDescription s) {
    const std::int32_t shapes[] = {add_shape(s, make_box(1, 0.7, 0.4), 3), add_shape(s, make_plate(1, 1), 1),
                                   add_shape(s, make_ring(0.6, 0.15, 8, 5), 2)};
    s.settings.time_step = 1.0 / 12;
    for (int k = 0; k < 27; ++k) {
        const int x = k % 3 - 1, y = k / 3 % 3 - 1, z = k / 9 - 1;
        const Vec3 place{1.5 * x + 0.05 * y, 1.5 * y - 0.03 * z, 1.5 * z + 0.07 * x};
        BodyDescription& body = add_body(s, shapes[k % 3], BodyType::dynamic, place, 0.3, 0.1 * (k % 11));
        body.rotation = rotation_from_vector({0.3 * k, 0.2 * x, -0.1 * y});
        body.velocity = -6.0 * place + Vec3{0.3, -0.2, 0.1};
        body.angular_velocity = {2.0 * x, 1.0 * y, 3.0 * z};
    }
    return s;
}

TEST_P(CollisionStage, KeepsMomentumAndGivesNoEnergy) {
    StageWorld world(implosion(scene()));
    const Vec3 momentum = world.momentum();
    const double energy = world.energy();
    EXPECT_GE(collide(world).impulses, 30);
    EXPECT_LE(length(world.momentum() - momentum), 1e-13 * 54 * 20);
    EXPECT_LE(world.energy(), energy * (1 + 1e-13));
    EXPECT_LE(world.energy(), 0.95 * energy) << "much of it is lost in friction and restitution below 1";
}

TEST_P(CollisionStage, HasTheBitsOfThePlainLoopOnAnyNumberOfThreads) {
    StageWorld serial(implosion(scene()));
    const StageCounters wanted = collide(serial);
    for (const int threads : {2, 3, 8}) {
        StageWorld world(implosion(scene()), threads);
        const StageCounters counters = collide(world);
        EXPECT_EQ(world.ends(), serial.ends()) << threads;
        EXPECT_EQ(counters.impulses, wanted.impulses) << threads;
        EXPECT_EQ(counters.sweeps, wanted.sweeps) << threads;
        EXPECT_EQ(counters.settled, wanted.settled) << threads;
    }
}

} // namespace
} // namespace flotilla
