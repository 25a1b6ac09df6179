// SPDX-License-Identifier: MIT
// Dynamic contact alone: what it does with one pair in closed form, how clusters grow, and when it gives up.
#include <gtest/gtest.h>

#include "dynamic_contact/dynamic_contact.hpp"
#include "support/joint_solver.hpp"
#include "support/stage_world.hpp"

namespace flotilla {
namespace {

using scenario::add_body;
using scenario::add_shape;
using test::proved_apart;
using test::StageWorld;

DynamicContactStats run(StageWorld& world) {
    return handle_dynamic_contact(world.view(), world.movers(), world.book(), world.workers(), nullptr);
}

/// Octahedra and boxes in turn along x with the given masses and velocities, `gap` apart.
SceneDescription row(const std::vector<std::pair<double, double>>& bodies, double gap = 0.02, double off = 0) {
    SceneDescription s = test::weightless_scene();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto [mass, velocity] = bodies[i];
        const std::int32_t shape =
            i % 2 == 0 ? test::add_octahedron(s, mass) : add_shape(s, make_box(1, 1, 1, 4), mass);
        const Vec3 place{static_cast<double>(i) * (1 + gap), i % 2 == 0 ? off : 0, 0};
        add_body(s, shape, mass > 0 ? BodyType::dynamic : BodyType::fixed, place, 0, 0).velocity = {velocity, 0, 0};
    }
    return s;
}

// The pair's approach becomes what brings it to its rest distance at the end of the step.
TEST(DynamicContact, BringsAPairToItsRestDistance) {
    for (const double mass : {0.01, 1.0, 300.0}) {
        StageWorld world(row({{2, 7}, {mass, -5}}));
        EXPECT_FALSE(proved_apart(world));
        const DynamicContactStats stats = run(world);
        EXPECT_EQ(stats.merges, 0);
        EXPECT_EQ(stats.trigger_a, -1);
        EXPECT_TRUE(proved_apart(world));
        const double rest = world.lengths(0, 1).rest;
        EXPECT_NEAR(world.end(1).com.x - world.end(0).com.x - 1, rest, 1e-13);
        const double impulse = (12 + (rest - 0.02) / world.dt()) / (1.0 / 2 + 1 / mass);
        EXPECT_NEAR(world.velocity(0).x, 7 - impulse / 2, 1e-11);
        EXPECT_NEAR(world.velocity(1).x, -5 + impulse / mass, 1e-11);
    }
}

TEST(DynamicContact, LeavesAloneWhatIsApart) {
    StageWorld world(row({{1, -1}, {1, 1}}));
    const std::uint64_t version = world.trajectories().version(0);
    const DynamicContactStats stats = run(world);
    EXPECT_EQ(stats.counters.sweeps, 0);
    EXPECT_EQ(world.trajectories().version(0), version);
    EXPECT_TRUE(proved_apart(world));
}

// Of what a heavy body brings a sweep hands on to the wall what the mass of the one between takes: thousands of sweeps,
// or a few rounds in which both hits are solved together.
TEST(DynamicContact, ALightBodyBetweenAHeavyOneAndAWall) {
    for (const double ratio : {100.0, 1e3, 1e6}) {
        StageWorld world(row({{0, 0}, {1, -2}, {ratio, -5}}));
        EXPECT_TRUE(run(world).counters.limit) << "sweeps alone";
        StageWorld again(row({{0, 0}, {1, -2}, {ratio, -5}}));
        test::JointSolver solver(again);
        JointSolve& joint = solver.joint;
        const DynamicContactStats stats =
            handle_dynamic_contact(again.view(), again.movers(), again.book(), again.workers(), &joint);
        EXPECT_EQ(stats.merges, 0) << ratio;
        EXPECT_FALSE(stats.counters.limit) << ratio;
        EXPECT_LE(stats.counters.sweeps, 100) << ratio;
        EXPECT_TRUE(proved_apart(again));
        for (const std::int32_t i : {0, 1}) {
            const double rest = again.lengths(i, i + 1).rest, gap = again.end(i + 1).com.x - again.end(i).com.x - 1;
            EXPECT_GT(gap, 0.5 * rest) << ratio; // what is apart is not asked for more
            EXPECT_LT(gap, 1.1 * rest) << ratio;
        }
    }
}

// A limit that sweeps come to before they are seen to gain nothing is theirs alone.
TEST(DynamicContact, HitsAreSolvedTogetherAfterFewSweepsToo) {
    SceneDescription s = row({{0, 0}, {1, -2}, {1e3, -5}});
    s.settings.dynamic_iterations = 2;
    StageWorld world(s);
    test::JointSolver solver(world);
    JointSolve& joint = solver.joint;
    const DynamicContactStats stats =
        handle_dynamic_contact(world.view(), world.movers(), world.book(), world.workers(), &joint);
    EXPECT_EQ(stats.merges, 0);
    EXPECT_FALSE(stats.counters.limit);
    EXPECT_TRUE(proved_apart(world));
}

// What is given up moves as sweeps left it: nothing of what was tried stays in it.
TEST(DynamicContact, GivesBackWhatItCouldNotSolve) {
    for (const int tries : {1, 2, 3}) {
        SceneDescription s = row({{0, 0}, {1, -2}, {1e3, -5}, {1, -9}, {1e3, -20}, {1, -30}}, 0.02, 0.3);
        s.settings.dynamic_iterations = 1000; // more than it takes to see that sweeps gain nothing
        s.settings.dynamic_pair_iterations = tries;
        StageWorld alone(s), world(s);
        run(alone);
        test::JointSolver solver(world);
        JointSolve& joint = solver.joint;
        const DynamicContactStats stats =
            handle_dynamic_contact(world.view(), world.movers(), world.book(), world.workers(), &joint);
        EXPECT_TRUE(stats.counters.limit) << tries;
        EXPECT_GT(std::ranges::count(joint.left, 1), 1) << tries;
        EXPECT_EQ(world.ends(), alone.ends()) << tries;
        for (std::int32_t i = 0; i < 6; ++i) EXPECT_LT(length(world.velocity(i)), 40) << tries;
    }
}

// Equations 5 to 10: with no impulses to spend the pair moves as one, with its momentum and its angular momentum.
TEST(DynamicContact, APairThatIsNotResolvedMovesAsOne) {
    SceneDescription s = row({{2, 12}, {1, 0}}, 0.02, 0.3);
    s.settings.dynamic_pair_iterations = 0;
    StageWorld world(s);
    const DynamicContactStats stats = run(world);
    EXPECT_EQ(stats.merges, 1);
    EXPECT_EQ(stats.trigger_a, 0);
    EXPECT_EQ(stats.trigger_b, 1);
    const Cluster& c = world.clusters()[0];
    EXPECT_EQ(c.members, (std::vector<std::int32_t>{0, 1}));
    EXPECT_EQ(c.rung, Rung::rigid);
    EXPECT_NEAR(c.velocity.x, 8, 1e-13);
    EXPECT_NEAR(c.com0.y, 0.2, 1e-13);
    // About the common centre of mass: 0.1 m and 0.2 m from the lines of the two.
    const double spin = -2 * 12 * 0.1, inertia = c.inertia.tensor.m[8];
    EXPECT_NEAR(c.momentum.z, spin, 1e-12);
    const auto inertia_of = [&](std::size_t i) { return world.model().shape_of(i).inertia.m[8]; };
    const double arm = (1.02 * 1.02 + 0.3 * 0.3) * 2.0 / 3; // reduced mass times the square of the distance
    EXPECT_NEAR(inertia, inertia_of(0) + inertia_of(1) + arm, 1e-12);
    EXPECT_NEAR(world.trajectories().turn(0).z, world.dt() * spin / inertia, 1e-6);
    EXPECT_EQ(world.trajectories().turn(0), world.trajectories().turn(1));
    EXPECT_NEAR(length(world.end(1).com - world.end(0).com), std::hypot(1.02, 0.3), 1e-14);
    EXPECT_TRUE(proved_apart(world));
}

/// Two boxes of 1 m that face each other along x, `apart` from face to face, as one mesh.
TriangleMesh jaws(double apart) {
    TriangleMesh out = make_box(1, 1, 1), other = out;
    const auto first = static_cast<std::int32_t>(out.vertices.size());
    for (Vec3& v : out.vertices) v.x -= (1 + apart) / 2;
    for (Vec3& v : other.vertices) v.x += (1 + apart) / 2;
    out.vertices.insert(out.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const auto& t : other.triangles) out.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return out;
}

// Between jaws with less room than a rest distance on each side a push to the one side hits the other.
TEST(DynamicContact, APinchedBodyStaysWhereItIs) {
    const double rest = StageWorld(row({{1, 0}, {1, 0}})).lengths(0, 1).rest;
    for (const double room : {0.1, 0.3, 0.6}) {
        SceneDescription s = row({{1, 3}});
        add_body(s, add_shape(s, jaws(1 + 2 * room * rest), 5), BodyType::dynamic, {}, 0, 0);
        s.settings.dynamic_pair_iterations = 20;
        StageWorld world(s);
        EXPECT_FALSE(proved_apart(world));
        EXPECT_EQ(run(world).merges, 0) << room;
        EXPECT_TRUE(proved_apart(world));
        EXPECT_LT(std::abs(world.end(0).com.x - world.end(1).com.x), room * rest);
    }
}

// The first takes in the second, both the third: one body a sweep.
TEST(DynamicContact, AClusterGrowsByWhatItMeets) {
    SceneDescription s = row({{3, 12}, {1, 0}, {2, 0}});
    s.settings.dynamic_pair_iterations = 0;
    StageWorld world(s);
    const DynamicContactStats stats = run(world);
    EXPECT_EQ(stats.merges, 2);
    EXPECT_EQ(stats.counters.sweeps, 2);
    EXPECT_EQ(world.clusters()[0].members, (std::vector<std::int32_t>{0, 1, 2}));
    EXPECT_NEAR(world.clusters()[0].velocity.x, 6, 1e-13);
    EXPECT_TRUE(proved_apart(world));
}

// All four hit in the first sweep. (0, 1) and (2, 3) merge; (1, 2) meets a body that is taken, and waits for the next.
TEST(DynamicContact, OfRequestsForOneClusterTheFirstCounts) {
    SceneDescription s = row({{1, 16}, {1, 8}, {1, -8}, {1, -16}});
    s.settings.dynamic_pair_iterations = 0;
    StageWorld world(s);
    const DynamicContactStats stats = run(world);
    EXPECT_EQ(stats.merges, 3);
    EXPECT_EQ(stats.counters.sweeps, 2);
    EXPECT_EQ(world.clusters()[0].members, (std::vector<std::int32_t>{0, 1, 2, 3}));
    EXPECT_NEAR(world.clusters()[0].velocity.x, 0, 1e-13);
}

TEST(DynamicContact, NeverTakesABodyOfInfiniteMassIntoACluster) {
    SceneDescription s = row({{1, 12}, {0, 0}});
    s.settings.dynamic_pair_iterations = 0;
    s.settings.dynamic_iterations = 4;
    StageWorld world(s);
    const std::vector<Pose> ends = world.ends();
    const DynamicContactStats stats = run(world);
    EXPECT_EQ(stats.merges, 0);
    EXPECT_TRUE(stats.counters.limit);
    EXPECT_GE(stats.counters.sweeps, 4);
    EXPECT_LE(stats.counters.sweeps, 8) << "as many hits again as up to the limit";
    EXPECT_EQ(world.ends(), ends);
    EXPECT_FALSE(proved_apart(world)) << "the failsafe's to solve";
}

TEST(DynamicContact, WithoutSweepsItSaysSoAndLeavesAllAsItWas) {
    SceneDescription s = row({{1, 12}, {1, 0}});
    s.settings.dynamic_iterations = 0;
    StageWorld world(s);
    const std::vector<Pose> ends = world.ends();
    const DynamicContactStats stats = run(world);
    EXPECT_TRUE(stats.counters.limit);
    EXPECT_EQ(stats.counters.sweeps, 0);
    EXPECT_EQ(world.ends(), ends);
}

// On paths that turn, what starts nearer than the arcs leave their chords hits whatever its centre does, and beyond one
// radian a step impulses act on the centre alone: none is spent.
TEST(DynamicContact, SpendsNoImpulsesOnWhatTurnsTooFar) {
    SceneDescription s = row({{1, 1}, {0, 0}}, 1e-4);
    s.settings.trajectory = Trajectory::rigid;
    s.settings.dynamic_iterations = 4;
    for (const double spin : {1e3, 1e5}) {
        s.bodies[0].angular_velocity = {0, 0, spin};
        StageWorld world(s);
        const std::vector<Pose> ends = world.ends();
        const DynamicContactStats stats = run(world);
        EXPECT_EQ(stats.counters.impulses, 0);
        EXPECT_TRUE(stats.counters.limit);
        EXPECT_EQ(world.ends(), ends);
        EXPECT_FALSE(proved_apart(world)) << "the failsafe's to solve";
    }
}

TEST(DynamicContact, IsGivenUpWhereNoPushEndsTheHits) {
    SceneDescription s = test::nested_boxes(test::weightless_scene(), 3);
    s.settings.dynamic_iterations = 1000;
    BodyDescription& outer = s.bodies[0]; // no cluster can be made with it
    outer.type = BodyType::fixed;
    outer.velocity = outer.angular_velocity = {};
    StageWorld world(s);
    const DynamicContactStats stats = run(world);
    EXPECT_TRUE(stats.counters.limit) << "the failsafe's to solve";
    EXPECT_LE(stats.counters.sweeps, 20);
}

/// A row that is pushed together from both ends, hitting in every gap.
SceneDescription crush() {
    std::vector<std::pair<double, double>> bodies;
    for (int i = 0; i < 12; ++i) bodies.emplace_back(1 + i % 3, 6.0 - i);
    return row(bodies, 0.01, 0.2);
}

// Most pairs hit in the first sweeps, few in the last ones, which cost little: the limit does not end those.
TEST(DynamicContact, GoesOnBeyondItsLimitWhileFewerHit) {
    StageWorld whole(crush());
    const std::int64_t sweeps = run(whole).counters.sweeps;
    EXPECT_GT(sweeps, 8);
    SceneDescription s = crush();
    s.settings.dynamic_iterations = static_cast<int>(3 * sweeps / 4);
    StageWorld limited(s);
    const DynamicContactStats stats = run(limited);
    EXPECT_FALSE(stats.counters.limit);
    EXPECT_EQ(stats.counters.sweeps, sweeps);
    EXPECT_EQ(stats.merges, 0);
    EXPECT_EQ(limited.ends(), whole.ends());
}

// Of twenty pairs that hit nineteen merge; the other one has a wall in it, and hits in every sweep.
TEST(DynamicContact, EndsAtTenLimitsInAnyCase) {
    SceneDescription s = row({{1, 12}, {0, 0}});
    for (int k = 1; k < 20; ++k)
        for (const double side : {-0.51, 0.51})
            add_body(s, 0, BodyType::dynamic, {side, 3.0 * k, 0}, 0, 0).velocity = {-20 * side, 0, 0};
    s.settings.dynamic_pair_iterations = 0;
    s.settings.dynamic_iterations = 1;
    StageWorld world(s);
    const DynamicContactStats stats = run(world);
    EXPECT_EQ(stats.merges, 19);
    EXPECT_TRUE(stats.counters.limit);
    EXPECT_EQ(stats.counters.sweeps, 10);
}

TEST(DynamicContact, HasTheBitsOfThePlainLoopOnAnyNumberOfThreads) {
    for (const int impulses : {0, 1, 20}) {
        SceneDescription s = crush();
        s.settings.dynamic_pair_iterations = impulses;
        StageWorld serial(s);
        const DynamicContactStats wanted = run(serial);
        EXPECT_LE(wanted.merges, 11);
        for (const int threads : {2, 3, 8}) {
            StageWorld world(s, threads);
            const DynamicContactStats stats = run(world);
            EXPECT_EQ(world.ends(), serial.ends()) << threads;
            EXPECT_EQ(stats.merges, wanted.merges) << threads;
            EXPECT_EQ(std::pair(stats.trigger_a, stats.trigger_b), std::pair(wanted.trigger_a, wanted.trigger_b));
        }
    }
}

} // namespace
} // namespace flotilla
