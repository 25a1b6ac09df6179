// SPDX-License-Identifier: MIT
// Scripted bodies that meet what cannot give way go as far as they can, and each is put back at most twice.
#include "failsafe/stage.hpp"

namespace flotilla::test {
namespace {

using scenario::add_body;
using scenario::add_shape;

constexpr double kGap = 0.02, kWay = 0.05; // m, before the impact; of a jaw in the step

/// A plate that stands across x and makes `way` along it in the step.
void add_jaw(SceneDescription& s, std::int32_t plate, double x, double way) {
    BodyDescription& jaw = add_body(s, plate, BodyType::kinematic, {x, 0, 0}, 0, 0);
    const Quat rotation = rotation_from_vector({0, scenario::kPi / 2, 0});
    jaw.rotation = rotation;
    jaw.keyframes = {{0, {x, 0, 0}, rotation}, {s.settings.time_step, {x + way, 0, 0}, rotation}};
}

/// The share of its way that a jaw makes: nine tenths of the way to the impact, which counts from the separation up to
/// the rest distance.
void expect_share(const StageWorld& world, const DelayedScript& script, double gap) {
    const PairLengths lengths =
        world.lengths(std::min(script.body, script.victim), std::max(script.body, script.victim));
    EXPECT_LE(script.share, 0.9 * gap / kWay);
    EXPECT_GE(script.share, 0.9 * (gap - lengths.rest) / kWay);
}

TEST(FailsafeScripts, JawsStopBeforeWhatTheyWouldCrush) {
    SceneDescription s = weightless_scene();
    const std::int32_t plate = add_shape(s, make_plate(3, 3));
    add_body(s, add_octahedron(s, 1), BodyType::dynamic, {}, 0, 0);
    add_jaw(s, plate, -0.5 - kGap, kWay);
    add_jaw(s, plate, 0.5 + kGap, -kWay);
    StageWorld world(s);
    const FailsafeStats stats = run_failsafe_of(world);
    EXPECT_EQ(stats.rung_changes, 1);
    EXPECT_EQ(world.end(0), world.start(0)) << "the body between them is held";
    ASSERT_EQ(stats.delayed_scripts.size(), 2u);
    for (std::int32_t jaw = 1; jaw <= 2; ++jaw) {
        const DelayedScript& script = stats.delayed_scripts[static_cast<std::size_t>(jaw) - 1];
        EXPECT_EQ(script.body, jaw);
        EXPECT_EQ(script.victim, 0);
        expect_share(world, script, kGap);
        const double way = jaw == 1 ? kWay : -kWay;
        EXPECT_NEAR(world.end(jaw).com.x, world.start(jaw).com.x + script.share * way, 1e-15);
        EXPECT_NEAR(world.velocity(jaw).x, script.share * way / world.dt(), 1e-12) << "it pushes with what it makes";
    }
    expect_resolved(world, stats);
}

TEST(FailsafeScripts, AFreeBodyIsPushedAndDelaysNobody) {
    SceneDescription s = weightless_scene();
    add_body(s, add_octahedron(s, 1), BodyType::dynamic, {}, 0, 0);
    add_jaw(s, add_shape(s, make_plate(3, 3)), -0.5 - kGap, kWay);
    StageWorld world(s);
    const FailsafeStats stats = run_failsafe_of(world);
    EXPECT_TRUE(stats.delayed_scripts.empty());
    EXPECT_EQ(stats.merges + stats.rung_changes, 0);
    EXPECT_NEAR(world.end(0).com.x - world.end(1).com.x, 0.5 + world.lengths(0, 1).rest, 1e-13);
    expect_resolved(world, stats);
}

/// Two bodies before one jaw that cannot be pushed, at different distances.
SceneDescription two_in_the_way(double first, double second) {
    SceneDescription s = weightless_scene();
    s.settings.dynamic_pair_iterations = 0; // held at their first conflict
    const std::int32_t ball = add_octahedron(s, 1);
    add_jaw(s, add_shape(s, make_plate(3, 3)), 0, kWay);
    add_body(s, ball, BodyType::dynamic, {0.5 + first, -0.6, 0}, 0, 0);
    add_body(s, ball, BodyType::dynamic, {0.5 + second, 0.6, 0}, 0, 0);
    return s;
}

// The nearer one comes second in the list: what is left of the way is not enough either, and the jaw stays where it
// was.
TEST(FailsafeScripts, AScriptThatIsStoppedTwiceStaysAtItsStart) {
    StageWorld world(two_in_the_way(0.04, 0.01));
    const FailsafeStats stats = run_failsafe_of(world);
    ASSERT_EQ(stats.delayed_scripts.size(), 1u);
    EXPECT_EQ(stats.delayed_scripts[0].body, 0);
    EXPECT_EQ(stats.delayed_scripts[0].share, 0);
    EXPECT_EQ(stats.delayed_scripts[0].victim, 1) << "the first in its way";
    EXPECT_EQ(world.end(0), world.start(0));
    EXPECT_EQ(world.velocity(0), Vec3{});
    expect_resolved(world, stats);
}

// Too near for the jaw to move by any amount worth a query.
TEST(FailsafeScripts, AScriptWithNoWayToGoStaysAtItsStart) {
    SceneDescription s = two_in_the_way(5e-4, 1.0);
    s.bodies.pop_back();
    StageWorld world(s);
    const FailsafeStats stats = run_failsafe_of(world);
    ASSERT_EQ(stats.delayed_scripts.size(), 1u);
    EXPECT_EQ(stats.delayed_scripts[0].share, 0);
    EXPECT_EQ(world.end(0), world.start(0));
    expect_resolved(world, stats);
}

} // namespace
} // namespace flotilla::test
