// SPDX-License-Identifier: MIT
// The ladder of the failsafe, rung by rung: resolved, merged, held at x^n; against each other and against bodies of
// infinite mass.
#include "failsafe/stage.hpp"

namespace flotilla::test {
namespace {

using scenario::add_body;
using scenario::add_shape;

constexpr double kGap = 0.02; // m

/// An octahedron of 2 kg that flies at a box, `gap` away.
SceneDescription shot(double speed, BodyType box = BodyType::dynamic) {
    SceneDescription s = weightless_scene();
    add_body(s, add_octahedron(s, 2), BodyType::dynamic, {-1 - kGap, 0, 0}, 0, 0).velocity = {speed, 0, 0};
    add_body(s, add_shape(s, make_box(1, 1, 1, 4), box == BodyType::dynamic ? 1 : 0), box, {}, 0, 0);
    return s;
}

TEST(Failsafe, LeavesAloneWhatIsProved) {
    StageWorld world(shot(1));
    const std::vector<Pose> ends = world.ends();
    const FailsafeStats stats = run_failsafe_of(world);
    EXPECT_EQ(stats.merges + stats.rung_changes, 0);
    EXPECT_EQ(stats.trigger_a, -1);
    EXPECT_EQ(world.ends(), ends);
    expect_resolved(world, stats);
}

// Equations 11 to 13: the members keep the motion that resolved them, and only what comes later is common.
TEST(Failsafe, APairThatIsResolvedMergesKinematically) {
    StageWorld world(shot(12));
    EXPECT_FALSE(proved_apart(world));
    const FailsafeStats stats = run_failsafe_of(world);
    EXPECT_EQ(stats.merges, 1);
    EXPECT_EQ(stats.rung_changes, 0);
    EXPECT_EQ(std::pair(stats.trigger_a, stats.trigger_b), std::pair(0, 1));
    const Cluster& c = world.clusters()[0];
    EXPECT_EQ(c.rung, Rung::kinematic);
    EXPECT_EQ(c.members, (std::vector<std::int32_t>{0, 1}));
    EXPECT_TRUE(world.clusters()[1].members.empty());
    EXPECT_NEAR(c.velocity.x, 8, 1e-12);
    EXPECT_NEAR(world.end(1).com.x - world.end(0).com.x - 1, world.lengths(0, 1).rest, 1e-13);
    expect_resolved(world, stats);
}

TEST(Failsafe, APairThatIsNotResolvedMergesRigidly) {
    for (const bool by_setting : {false, true}) {
        SceneDescription s = shot(12);
        if (by_setting)
            s.settings.rigidification = Rigidification::rigid;
        else
            s.settings.dynamic_pair_iterations = 0;
        StageWorld world(s);
        const FailsafeStats stats = run_failsafe_of(world);
        EXPECT_EQ(stats.merges, 1);
        EXPECT_EQ(stats.rung_changes, 0);
        EXPECT_EQ(world.clusters()[0].rung, Rung::rigid);
        EXPECT_NEAR(world.velocity(0).x, 8, 1e-12);
        EXPECT_NEAR(world.velocity(1).x, 8, 1e-12);
        EXPECT_NEAR(world.end(1).com.x - world.end(0).com.x, 1 + kGap, 1e-14);
        expect_resolved(world, stats);
    }
}

// A body between six that fly at it takes in all of them in one sweep.
TEST(Failsafe, AClusterGrowsByAllThatItMeets) {
    for (const int impulses : {0, 20}) {
        SceneDescription s = weightless_scene();
        s.settings.dynamic_pair_iterations = impulses;
        const std::int32_t shape = add_octahedron(s, 1);
        add_body(s, shape, BodyType::dynamic, {}, 0, 0);
        for (const double side : {-1.0, 1.0})
            for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
                add_body(s, shape, BodyType::dynamic, side * (1 + kGap) * axis, 0, 0).velocity = -12 * side * axis;
        StageWorld world(s);
        const FailsafeStats stats = run_failsafe_of(world);
        EXPECT_EQ(stats.merges, 6);
        EXPECT_EQ(stats.counters.sweeps, 1);
        EXPECT_EQ(world.clusters()[0].members.size(), 7u);
        expect_resolved(world, stats);
    }
}

// Once, and the body stays as free as it was.
TEST(Failsafe, AgainstAWallABodyIsResolved) {
    StageWorld world(shot(12, BodyType::fixed));
    const FailsafeStats stats = run_failsafe_of(world);
    EXPECT_EQ(stats.merges + stats.rung_changes, 0);
    EXPECT_EQ(world.clusters()[0].rung, Rung::free);
    EXPECT_EQ(world.clusters()[0].resolved_against, std::vector<std::int32_t>{1});
    EXPECT_NEAR(world.end(0).com.x, -1 - world.lengths(0, 1).rest, 1e-13);
    expect_resolved(world, stats);
}

void expect_held(StageWorld& world, std::int32_t body) {
    const std::int32_t cluster = world.clusters().of(static_cast<std::size_t>(body));
    EXPECT_EQ(world.clusters()[cluster].rung, Rung::held);
    EXPECT_TRUE(world.clusters()[cluster].infinite());
    EXPECT_EQ(world.end(body), world.start(body)) << "bit for bit";
    EXPECT_TRUE(world.trajectories().still(static_cast<std::size_t>(body)));
    EXPECT_EQ(world.velocity(body), Vec3{});
    EXPECT_EQ(world.clusters().impulsive(cluster).velocity, Vec3{});
}

TEST(Failsafe, WhatAWallCannotResolveIsHeld) {
    SceneDescription s = shot(12, BodyType::fixed);
    s.bodies[0].angular_velocity = {1, 2, 3};
    s.settings.dynamic_pair_iterations = 0;
    StageWorld world(s);
    const FailsafeStats stats = run_failsafe_of(world);
    EXPECT_EQ(stats.merges, 0);
    EXPECT_EQ(stats.rung_changes, 1) << "a body alone goes to the last rung at once";
    expect_held(world, 0);
    expect_resolved(world, stats);
}

// Both are pressed on the same wall, and side by side: the wall joins nobody.
TEST(Failsafe, AWallJoinsNobody) {
    SceneDescription s = weightless_scene();
    const std::int32_t shape = add_octahedron(s, 1);
    for (const double y : {-0.51, 0.51})
        add_body(s, shape, BodyType::dynamic, {-1 - kGap, y, 0}, 0, 0).velocity = {12, 0, 0};
    add_body(s, add_shape(s, make_box(1, 4, 4, 3)), BodyType::fixed, {}, 0, 0);
    StageWorld world(s);
    const FailsafeStats stats = run_failsafe_of(world);
    EXPECT_EQ(stats.merges, 0);
    EXPECT_EQ(world.clusters().of(0), 0);
    EXPECT_EQ(world.clusters().of(1), 1);
    expect_resolved(world, stats);
}

// A rigid cluster that the wall stops goes down with all its members.
TEST(Failsafe, AClusterIsHeldAsAWhole) {
    SceneDescription s = weightless_scene();
    const std::int32_t ball = add_octahedron(s, 2), box = add_shape(s, make_box(1, 1, 1, 4), 1);
    add_body(s, ball, BodyType::dynamic, {-2 - 2 * kGap, 0, 0}, 0, 0).velocity = {12, 0, 0};
    add_body(s, box, BodyType::dynamic, {-1 - kGap, 0, 0}, 0, 0);
    add_body(s, add_shape(s, make_plate(4, 4)), BodyType::fixed, {-0.5, 0, 0}, 0, 0).rotation =
        rotation_from_vector({0, -scenario::kPi / 2, 0});
    s.settings.dynamic_pair_iterations = 0;
    StageWorld world(s);
    const FailsafeStats stats = run_failsafe_of(world);
    EXPECT_EQ(stats.merges, 1);
    EXPECT_EQ(stats.rung_changes, 1);
    expect_held(world, 0);
    expect_held(world, 1);
    expect_resolved(world, stats);
}

/// Twenty bodies of three shapes that fly at each other inside of four walls.
SceneDescription brawl(std::uint64_t seed, int impulses) {
    SceneDescription s = weightless_scene();
    s.settings.time_step = 1.0 / 24;
    s.settings.dynamic_pair_iterations = impulses;
    const std::int32_t shapes[] = {add_shape(s, make_box(0.8, 0.6, 0.4), 3), add_shape(s, make_plate(0.8, 0.8), 1),
                                   add_shape(s, make_ring(0.4, 0.1, 8, 5), 2)};
    for (int k = 0; k < 18; ++k) {
        const int x = k % 3 - 1, y = k / 3 % 3 - 1;
        const Vec3 place{1.1 * x, 1.1 * y, 0.55 * (2 * (k / 9) - 1)};
        BodyDescription& body = add_body(s, shapes[k % 3], BodyType::dynamic, place, 0, 0);
        const auto number =
            static_cast<double>((seed * 7919 + static_cast<std::uint64_t>(k) * 104729) % 1000) / 500 - 1;
        body.velocity = {20 * number, -15 * number + x, 25 * number * number - 10};
        body.angular_velocity = {20 * number, 3.0 * x, -10.0 * y};
    }
    const std::int32_t wall = add_shape(s, make_plate(5, 5));
    for (const double side : {-1.0, 1.0}) {
        add_body(s, wall, BodyType::fixed, {1.9 * side, 0, 0}, 0, 0).rotation =
            rotation_from_vector({0, scenario::kPi / 2, 0});
        add_body(s, wall, BodyType::fixed, {0, 0, 1.9 * side}, 0, 0);
    }
    return s;
}

TEST(Failsafe, ResolvesWhateverIsLeftToItWithinItsBounds) {
    std::int64_t merges = 0, rungs = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed)
        for (const int impulses : {0, 1, 20}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << impulses << " impulses");
            StageWorld world(brawl(seed, impulses));
            const FailsafeStats stats = run_failsafe_of(world);
            expect_resolved(world, stats);
            merges += stats.merges;
            rungs += stats.rung_changes;
        }
    EXPECT_GE(merges, 100) << "there is much to do";
    EXPECT_GE(rungs, 20);
}

TEST(Failsafe, HasTheSameBitsOnAnyNumberOfThreads) {
    StageWorld serial(brawl(3, 1));
    const FailsafeStats wanted = run_failsafe_of(serial);
    for (const int threads : {2, 3, 8}) {
        StageWorld world(brawl(3, 1), threads);
        const FailsafeStats stats = run_failsafe_of(world);
        EXPECT_EQ(world.ends(), serial.ends()) << threads;
        EXPECT_EQ(stats.merges, wanted.merges) << threads;
        EXPECT_EQ(stats.rung_changes, wanted.rung_changes) << threads;
    }
}

} // namespace
} // namespace flotilla::test
