// SPDX-License-Identifier: MIT
// Bodies with locked axes: what is locked keeps its bits, and what is free moves as in textbooks.
#include <cstring>

#include "base/rotation.hpp"
#include "step/audited_run.hpp"

namespace flotilla::scenario {
namespace {

constexpr std::array kNone{false, false, false}, kAll{true, true, true};

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// What no step may change.
struct Start {
    Vec3 com;
    Quat rotation;
};
void expect_locked(const BodyDescription& body, const Start& start, const Vec3& com, const Quat& rotation,
                   const Vec3& velocity, const Vec3& omega) {
    int free = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        free += body.locked_rotation[k] ? 0 : 1;
        if (body.locked_translation[k]) {
            ASSERT_TRUE(same_bits(component(com, axis), component(start.com, axis))) << body.name << " axis " << axis;
            ASSERT_EQ(component(velocity, axis), 0) << body.name << " axis " << axis;
        }
        if (body.locked_rotation[k]) {
            ASSERT_EQ(component(omega, axis), 0) << body.name << " axis " << axis;
        }
    }
    if (free == 0) {
        ASSERT_EQ(rotation, start.rotation) << body.name;
    }
    if (free != 1) return;
    for (int axis = 0; axis < 3; ++axis) {
        if (body.locked_rotation[static_cast<std::size_t>(axis)]) continue;
        const Vec3 hinge{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
        const auto in_body = [&](const Quat& q) { return rotate(conjugate(q), hinge); };
        ASSERT_LE(length(in_body(rotation) - in_body(start.rotation)), 16 * kRoundOff) << body.name;
    }
}
void expect_locked(const SceneDescription& scene, const World& world, const std::vector<Start>& start) {
    for (std::size_t i = 0; i < world.size(); ++i) {
        const BodyState s = world.body(i);
        ASSERT_NO_FATAL_FAILURE(
            expect_locked(scene.bodies[i], start[i], s.center_of_mass, s.rotation, s.velocity, s.angular_velocity));
    }
}
std::vector<Start> starts(const World& world) {
    std::vector<Start> out;
    for (std::size_t i = 0; i < world.size(); ++i)
        out.push_back({world.body(i).center_of_mass, world.body(i).rotation});
    return out;
}

/// A turned body whose inertia has products in world axes; 2 kg.
BodyDescription& add_skew_body(SceneDescription& scene, const Vec3& position) {
    const auto shape = add_shape(scene, make_box(0.6, 0.4, 0.2), 2);
    scene.shapes.back().inertia = diagonal({0.3, 0.4, 0.6});
    BodyDescription& body = add_body(scene, shape, BodyType::dynamic, position);
    body.rotation = normalized(Quat{0.8, 0.3, -0.4, 0.33});
    return body;
}

TEST(LockedAxes, SliderGoesByItsOwnAxisAlone) {
    SceneDescription scene = empty_scene();
    scene.gravity = {1, 2, -kGravity};
    BodyDescription& body = add_skew_body(scene, {0.1, 0.2, 0.3});
    body.locked_translation = {false, true, true};
    body.locked_rotation = kAll;
    body.velocity = {0.5, 0, 0};
    body.force = {3, 70, -9};
    body.torque = {1, 2, 3};
    World world(scene, "scene", {1});
    const auto start = starts(world);
    const double a = 1 + 3.0 / 2, dt = scene.settings.time_step;
    for (int n = 1; n <= 1000; ++n) {
        ASSERT_EQ(world.step().energy_corrections, 0);
        ASSERT_NO_FATAL_FAILURE(expect_locked(scene, world, start));
        const double t = n * dt, x = start[0].com.x + 0.5 * t + 0.5 * a * t * t;
        ASSERT_NEAR(world.body(0).center_of_mass.x, x, 10 * n * kRoundOff * std::abs(x));
        ASSERT_NEAR(world.body(0).velocity.x, 0.5 + a * t, 10 * n * kRoundOff * (1 + a * t));
    }
}

TEST(LockedAxes, HingeTurnsByItsTorqueAboutItsAxisAlone) {
    for (int axis = 0; axis < 3; ++axis) {
        SceneDescription scene = empty_scene();
        BodyDescription& body = add_skew_body(scene, {});
        body.locked_translation = kAll;
        body.locked_rotation = kAll;
        body.locked_rotation[static_cast<std::size_t>(axis)] = false;
        body.torque = {0.02, 0.02, 0.02};
        const Mat3 r = matrix(body.rotation);
        const Mat3 inertia = r * (diagonal({0.3, 0.4, 0.6}) * transpose(r));
        const double alpha = 0.02 / inertia.m[static_cast<std::size_t>(4 * axis)], dt = scene.settings.time_step;
        World world(scene, "scene", {1});
        const auto start = starts(world);
        double angle = 0;
        for (int n = 1; n <= 10000; ++n) {
            const StepReport report = world.step();
            ASSERT_EQ(report.energy_corrections, 0) << n;
            ASSERT_NO_FATAL_FAILURE(expect_locked(scene, world, start));
            angle += component(world.turn(0), axis);
            ASSERT_EQ(length(world.turn(0)), std::abs(component(world.turn(0), axis)));
            const double t = n * dt;
            ASSERT_NEAR(component(world.body(0).angular_velocity, axis), alpha * t, 1e-12 * (1 + alpha * t));
            ASSERT_NEAR(angle, 0.5 * alpha * t * t, 1e-12 * (1 + alpha * t * t));
        }
    }
}

/// The end of a second of a free body with a locked axis of rotation.
Vec3 spin_after_a_second(int steps, int locked, double& energy_error) {
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    scene.settings.time_step = 1.0 / steps;
    BodyDescription& body = add_skew_body(scene, {});
    body.locked_rotation[static_cast<std::size_t>(locked)] = true;
    body.angular_velocity = {3, -2, 4};
    if (locked == 0) body.angular_velocity.x = 0;
    if (locked == 1) body.angular_velocity.y = 0;
    if (locked == 2) body.angular_velocity.z = 0;
    World world(scene, "scene", {1});
    const auto start = starts(world);
    double before = 0;
    for (int n = 1; n <= steps; ++n) {
        const StepReport report = world.step();
        EXPECT_EQ(report.energy_corrections, 0);
        expect_locked(scene, world, start);
        EXPECT_EQ(component(world.turn(0), locked), 0);
        if (n > 1) energy_error = std::max(energy_error, std::abs(report.kinetic_energy - before) / before);
        before = report.kinetic_energy;
    }
    return world.body(0).angular_velocity;
}

TEST(LockedAxes, TopWithOneLockedAxisKeepsItsEnergyAndConverges) {
    for (int locked = 0; locked < 3; ++locked) {
        double energy_error = 0;
        const Vec3 fine = spin_after_a_second(6400, locked, energy_error);
        const double coarse = length(spin_after_a_second(100, locked, energy_error) - fine);
        const double half = length(spin_after_a_second(200, locked, energy_error) - fine);
        std::printf("locked %d: error at 1/100 s %.3g, at 1/200 s %.3g of %.3g rad/s; energy %.2g\n", locked, coarse,
                    half, length(fine), energy_error);
        EXPECT_LE(energy_error, 1e-13);
        EXPECT_LE(half, 0.3 * coarse) << "second order";
        EXPECT_LE(coarse, 0.02 * length(fine));
    }
}

/// A crate at rest distance above a floor, with friction 0.5, pushed by `force`.
SceneDescription crate_on_floor(const Vec3& force) {
    SceneDescription scene = empty_scene();
    scene.settings.time_step = 1.0 / 120;
    const auto floor = add_shape(scene, make_box(50, 50, 0.2));
    const auto crate = add_shape(scene, make_box(1, 1, 1), 10);
    add_body(scene, floor, BodyType::fixed, {0, 0, -0.1}, 0.5);
    const double rest = std::sqrt(3.0) / 330;
    BodyDescription& body = add_body(scene, crate, BodyType::dynamic, {0, 0, 0.5 + rest}, 0.5);
    body.locked_rotation = kAll;
    body.force = force;
    return scene;
}

TEST(LockedAxes, CratePushedAlongAFloorGoesByCoulombsLaw) {
    const SceneDescription scene = crate_on_floor({60, 24, 0});
    World world(scene, "scene", {1});
    const auto start = starts(world);
    const double pull = std::hypot(6.0, 2.4), a = pull - 0.5 * kGravity, dt = scene.settings.time_step;
    for (int n = 1; n <= 240; ++n) {
        ASSERT_EQ(world.step().energy_corrections, 0) << n;
        ASSERT_NO_FATAL_FAILURE(expect_locked(scene, world, start));
        const Vec3 v = world.body(1).velocity;
        ASSERT_NEAR(v.x, a * n * dt * 6 / pull, 1e-3 * a * n * dt) << n;
        ASSERT_NEAR(v.y, a * n * dt * 2.4 / pull, 1e-3 * a * n * dt) << n;
    }
    World stays(crate_on_floor({45, 0, 0}));
    for (int n = 0; n < 240; ++n) stays.step();
    EXPECT_NEAR(stays.body(1).center_of_mass.x, 0, 1e-4);
}

TEST(LockedAxes, BodiesOnOneRailBounceByTheirMasses) {
    for (const char* collisions : {"sequential", "accumulated"}) {
        SceneDescription scene = empty_scene();
        set_setting(scene.settings, "collisions", collisions);
        const auto light = add_shape(scene, make_box(0.5, 0.5, 0.5), 1);
        const auto heavy = add_shape(scene, make_box(0.5, 0.5, 0.5), 3);
        BodyDescription& a = add_body(scene, light, BodyType::dynamic, {-1, 0, 0}, 0, 1);
        a.velocity = {2, 0, 0};
        a.rotation = normalized(Quat{0.9, 0.1, 0.3, 0.2});
        add_body(scene, heavy, BodyType::dynamic, {1, 0.1, 0}, 0, 1).velocity = {-1, 0, 0};
        for (BodyDescription& body : scene.bodies)
            body.locked_translation = {false, true, true}, body.locked_rotation = kAll;
        World world(scene, "scene", {1});
        const auto start = starts(world);
        for (int n = 0; n < 60; ++n) {
            ASSERT_EQ(world.step().energy_corrections, 0);
            ASSERT_NO_FATAL_FAILURE(expect_locked(scene, world, start));
        }
        // v1' = ((m1 - m2) v1 + 2 m2 v2) / (m1 + m2), v2' = ((m2 - m1) v2 + 2 m1 v1) / (m1 + m2)
        EXPECT_NEAR(world.body(0).velocity.x, (-2 * 2.0 + 2 * 3 * -1.0) / 4, 1e-6) << collisions;
        EXPECT_NEAR(world.body(1).velocity.x, (2 * -1.0 + 2 * 1 * 2.0) / 4, 1e-6) << collisions;
    }
}

/// Crates with all kinds of locks fall onto a floor and onto each other.
SceneDescription locked_pile() {
    SceneDescription scene = empty_scene();
    const auto floor = add_shape(scene, make_box(20, 20, 0.2));
    const auto crate = add_shape(scene, make_box(0.5, 0.4, 0.3), 5);
    const auto plate = add_shape(scene, make_box(1.2, 0.8, 0.02), 5);
    add_body(scene, floor, BodyType::fixed, {0, 0, -0.1}, 0.4);
    constexpr std::array<std::array<bool, 3>, 8> kLocks{{{false, false, false},
                                                         {true, false, false},
                                                         {false, false, true},
                                                         {true, true, false},
                                                         {false, true, true},
                                                         {true, true, true},
                                                         {false, true, false},
                                                         {true, false, true}}};
    for (int i = 0; i < 24; ++i) {
        const double x = 0.5 * (i % 3) - 0.5, y = 0.3 * (i % 2), z = 0.8 + 0.55 * i;
        BodyDescription& body =
            add_body(scene, i % 4 == 3 ? plate : crate, BodyType::dynamic, {x, y, z}, 0.4, i % 2 == 0 ? 0.3 : 0.0);
        body.rotation = normalized(Quat{1, 0.1 * (i % 5), 0.07 * (i % 3), -0.2});
        const auto k = static_cast<std::size_t>(i);
        body.locked_translation = i % 3 == 0 ? kNone : kLocks[k / 3];
        body.locked_rotation = i % 3 == 1 ? kNone : kLocks[(3 * k) % 8];
        if (i % 7 == 0) body.force = {20, 0, -10};
        if (i % 5 == 0) body.torque = {0.5, 0.2, 1};
    }
    return scene;
}

TEST(LockedAxes, PileOfAllKindsStaysApartAndLocked) {
    const SceneDescription scene = locked_pile();
    AuditedRun run(scene);
    std::vector<Start> start;
    for (const Pose& pose : run.stepper().state().pose) start.push_back({pose.com, pose.rotation});
    World world(scene, "scene", {1});
    for (int n = 0; n < 240; ++n) {
        ASSERT_EQ(run.step().state_hash, world.step().state_hash);
        ASSERT_NO_FATAL_FAILURE(expect_locked(scene, world, start)) << "step " << n;
        expect_locked(scene, world, start);
        ASSERT_EQ(run.findings, 0U) << "step " << n;
    }
    std::printf("pile: %ld merges, %ld rung changes, %ld held\n", static_cast<long>(run.totals.merges),
                static_cast<long>(run.totals.rung_changes), static_cast<long>(run.totals.held));
}

TEST(LockedAxes, PileUnderTheFailsafeAloneStaysApartAndLocked) {
    SceneDescription scene = locked_pile();
    scene.settings.collision_iterations = scene.settings.dynamic_iterations = 0;
    AuditedRun run(scene);
    World world(scene, "scene", {1});
    const auto start = starts(world);
    for (int n = 0; n < 120; ++n) {
        ASSERT_EQ(run.step().state_hash, world.step().state_hash);
        ASSERT_NO_FATAL_FAILURE(expect_locked(scene, world, start)) << "step " << n;
        ASSERT_EQ(run.findings, 0U) << "step " << n;
    }
    EXPECT_GT(run.totals.merges + run.totals.rung_changes, 0);
}

TEST(LockedAxes, SameBitsWithAnyThreadsAndFromASnapshot) {
    const SceneDescription scene = locked_pile();
    World one(scene, "scene", {1}), three(scene, "scene", {3});
    std::vector<std::byte> snapshot;
    std::vector<std::uint64_t> hashes;
    for (int n = 0; n < 150; ++n) {
        if (n == 70) snapshot = one.snapshot();
        hashes.push_back(one.step().state_hash);
        ASSERT_EQ(three.step().state_hash, hashes.back()) << n;
    }
    World rest(scene, snapshot, "scene", {2});
    for (std::size_t n = 70; n < 150; ++n) ASSERT_EQ(rest.step().state_hash, hashes[n]) << n;
}

TEST(LockedAxes, SceneHashSeesLocksAndLoads) {
    SceneDescription scene = crate_on_floor({});
    const std::uint64_t plain = World(scene).scene_hash();
    const auto changed = [&](auto&& change) {
        SceneDescription other = scene;
        change(other.bodies[1]);
        return World(other).scene_hash() != plain;
    };
    EXPECT_TRUE(changed([](BodyDescription& b) { b.locked_rotation = {true, true, false}; }));
    EXPECT_TRUE(changed([](BodyDescription& b) { b.locked_translation[0] = true; }));
    EXPECT_TRUE(changed([](BodyDescription& b) { b.force.x = 1; }));
    EXPECT_TRUE(changed([](BodyDescription& b) { b.torque.z = 1; }));
}

} // namespace
} // namespace flotilla::scenario
