// SPDX-License-Identifier: MIT
// Bodies of segments and points alone: rods, hoops, frames, clouds.
#include "base/rotation.hpp"
#include "step/audited_run.hpp"

namespace flotilla::scenario {
namespace {

const TriangleMesh kRod{{{-1, 0, 0}, {1, 0, 0}}, {segment_element(0, 1)}};

std::int32_t add_wire(SceneDescription& scene, TriangleMesh mesh, double line_density) {
    const std::int32_t shape = add_shape(scene, std::move(mesh));
    scene.shapes.back().mass_kind = MassKind::line_density;
    scene.shapes.back().mass_value = line_density;
    return shape;
}

TriangleMesh hoop(double radius, int segments) {
    TriangleMesh mesh;
    for (int k = 0; k < segments; ++k) {
        const SinCos a = sin_cos(2 * kPi * k / segments);
        mesh.vertices.push_back({radius * a.cos, radius * a.sin, 0});
        mesh.triangles.push_back(segment_element(k, (k + 1) % segments));
    }
    return mesh;
}

Vec3 direction(const World& world, std::size_t body) { return rotate(world.body(body).rotation, {1, 0, 0}); }

TEST(Wires, AFallingHeapKeepsApartOnAnyThreads) {
    const SceneDescription scene = make_scene("wires", 21, 3);
    AuditedRun run(scene);
    StepReport last;
    for (int n = 0; n < 96; ++n) {
        last = run.step();
        expect_ladder_bounds(last, scene.bodies.size());
    }
    EXPECT_EQ(run.findings, 0U);
    EXPECT_GT(run.audited_pairs, 1000);
    EXPECT_GT(run.totals.collisions, 200);
    EXPECT_LT(last.kinetic_energy, 1e-2) << "of 40 J that they fell by";
    for (std::size_t i = 0; i + 1 < scene.bodies.size(); ++i)
        EXPECT_GT(run.stepper().state().pose[i].com.z, 0) << scene.bodies[i].name;

    WorldOptions threads;
    threads.threads = 3;
    World again(scene, "scene", threads);
    for (int n = 0; n < 96; ++n) again.step();
    EXPECT_EQ(again.state_hash(), state_hash(run.stepper().state()));
}

TEST(Wires, ARodTurnsInItsPlaneAndKeepsItsEnergy) {
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    BodyDescription& rod = add_body(scene, add_wire(scene, kRod, 1.5), BodyType::dynamic, {});
    rod.angular_velocity = {40, 0, 3}; // what is about the rod itself means nothing
    World world(scene);
    EXPECT_EQ(world.body(0).angular_velocity, (Vec3{0, 0, 3}));
    double energy = 0;
    for (int n = 1; n <= 1000; ++n) {
        const StepReport report = world.step();
        if (n == 1) energy = report.kinetic_energy;
        ASSERT_NEAR(report.kinetic_energy, energy, 1e-12 * energy);
        const double angle = 3 * report.time;
        ASSERT_LT(length(direction(world, 0) - Vec3{std::cos(angle), std::sin(angle), 0}), 1e-10) << "step " << n;
    }
    EXPECT_NEAR(energy, 0.5 * (3.0 * 4 / 12) * 9, 1e-12) << "m l^2 / 12";
}

TEST(Wires, RodsThatClashNeverSpinAboutThemselvesOrGainEnergy) {
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    const std::int32_t shape = add_wire(scene, kRod, 1);
    for (int i = 0; i < 4; ++i) {
        BodyDescription& rod = add_body(scene, shape, BodyType::dynamic, {0.2 * i, 0.1 * i, 0.4 * i}, 0.5, 1);
        rod.rotation = rotation_from_vector({0.3 * i, 0.2, 0.9 * i});
        rod.velocity = {0, 0, 3.0 - 2 * i};
    }
    AuditedRun run(scene);
    double energy = 0, momentum_z = 0;
    for (int n = 0; n < 200; ++n) {
        const StepReport report = run.step();
        if (n == 0) energy = report.kinetic_energy, momentum_z = report.momentum.z;
        ASSERT_LE(report.kinetic_energy, energy * (1 + 1e-12));
        ASSERT_NEAR(report.momentum.z, momentum_z, 1e-12);
        energy = report.kinetic_energy;
        for (const Pose& pose : run.stepper().state().pose) {
            const auto i = static_cast<std::size_t>(&pose - run.stepper().state().pose.data());
            const Vec3 axis = rotate(pose.rotation, {1, 0, 0});
            ASSERT_LT(std::abs(dot(axis, run.stepper().state().motion[i].momentum)), 1e-13);
        }
    }
    EXPECT_EQ(run.findings, 0U);
    EXPECT_GT(run.totals.collisions, 2);
}

TEST(Wires, ARodLiesOnTwoBarsAndSlidesAcrossThem) {
    SceneDescription scene = empty_scene();
    const std::int32_t bar = add_shape(scene, {{{-5, 0, 0}, {5, 0, 0}}, {segment_element(0, 1)}});
    add_body(scene, bar, BodyType::fixed, {0, 0.5, 0}, 0.3);
    add_body(scene, bar, BodyType::fixed, {0, -0.5, 0}, 0.3);
    BodyDescription& rod = add_body(scene, add_wire(scene, kRod, 1), BodyType::dynamic, {-4, 0, 0.01}, 0.3);
    rod.rotation = rotation_from_vector({0, 0, kPi / 2});
    rod.velocity = {3, 0, 0};
    World world(scene);
    for (int n = 0; n < 48; ++n) world.step();
    const BodyState s = world.body(2);
    const double way = 9.0 / (2 * 0.3 * kGravity); // it would roll on if it could
    EXPECT_NEAR(s.position.x, -4 + way, 0.1 * way);
    EXPECT_LT(length(s.velocity), 1e-6);
    EXPECT_GT(s.position.z, 0);
}

// Stage 1 lets points pass the wires, 0.4 rest distances to the side; the contacts at a rest distance do not. A
// velocity left for a bounce that never comes would stay for ever.
TEST(Wires, WhatIsHeldBesideAWireStandsStill) {
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    const TriangleMesh points{{{0, 0.5, 0}, {0, -0.5, 0}, {-1, 0, 0}},
                              {point_element(0), point_element(1), point_element(2)}};
    add_body(scene, add_shape(scene, points, 1), BodyType::dynamic, {-0.0035, 0, 0}, 0, 0).velocity = {0.5, 0, 0};
    const double rest = 2 * bounding_sphere(points).radius / 330;
    const std::int32_t wire = add_shape(scene, {{{0, 0, -1}, {0, 0, 1}}, {segment_element(0, 1)}});
    for (const double side : {-1.0, 1.0}) add_body(scene, wire, BodyType::fixed, {0, side * (0.5 + 0.4 * rest), 0});
    World world(scene);
    for (int n = 0; n < 48; ++n) world.step();
    EXPECT_LT(world.body(0).position.x, 0);
    EXPECT_LT(length(world.body(0).velocity), 1e-9);
}

TEST(Wires, AChainOfHoopsHangs) {
    SceneDescription scene = empty_scene();
    const std::int32_t shape = add_wire(scene, hoop(0.5, 24), 1);
    for (int i = 0; i < 4; ++i) {
        BodyDescription& link =
            add_body(scene, shape, i == 0 ? BodyType::fixed : BodyType::dynamic, {0.02, 0.03, -0.9 * i});
        link.rotation = rotation_from_vector({i % 2 == 0 ? kPi / 2 : 0, i % 2 == 0 ? 0 : kPi / 2, 0});
    }
    AuditedRun run(scene);
    StepReport last;
    for (int n = 0; n < 240; ++n) last = run.step();
    EXPECT_EQ(run.findings, 0U);
    for (std::size_t i = 1; i < 4; ++i) {
        const Vec3 gap = run.stepper().state().pose[i].com - run.stepper().state().pose[i - 1].com;
        EXPECT_LT(length(gap), 1) << "inside each other still";
    }
    EXPECT_LT(run.stepper().state().pose[3].com.z, -2.7) << "as low as they get";
    EXPECT_LT(last.kinetic_energy, 5);
}

TEST(Wires, LocksOfARodThatHasNoInertiaThereAreRefused) {
    const auto refusal = [](const std::array<bool, 3>& locked, const Vec3& turn) -> std::string {
        SceneDescription scene = empty_scene();
        BodyDescription& rod = add_body(scene, add_wire(scene, kRod, 1), BodyType::dynamic, {});
        rod.locked_rotation = locked;
        rod.rotation = rotation_from_vector(turn);
        try {
            World world(scene);
            for (int n = 0; n < 10; ++n) world.step();
            return "";
        } catch (const InputError& error) {
            return error.what();
        }
    };
    EXPECT_EQ(refusal({true, true, true}, {}), "");
    EXPECT_EQ(refusal({true, true, false}, {}), "");
    EXPECT_NE(refusal({false, true, true}, {}).find("/bodies/0/locked: a straight line has no inertia"),
              std::string::npos);
    EXPECT_EQ(refusal({false, true, true}, {0, 1, 0}), "");
    EXPECT_NE(refusal({false, false, true}, {}), "");
}

TEST(Wires, ATiltedRodOnAHingeHasTheInertiaOfItsReach) {
    constexpr double kTilt = 0.6, kTorque = 2;
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    BodyDescription& rod = add_body(scene, add_wire(scene, kRod, 1), BodyType::dynamic, {});
    rod.rotation = rotation_from_vector({0, -kTilt, 0}); // lifts its end
    rod.locked_rotation = {true, true, false};
    rod.torque = {0, 0, kTorque};
    World world(scene);
    for (int n = 0; n < 24; ++n) world.step();
    const double c = std::cos(kTilt), inertia = 2.0 * 4 / 12 * c * c;
    EXPECT_NEAR(world.body(0).angular_velocity.z, kTorque / inertia, 1e-9);
}

} // namespace
} // namespace flotilla::scenario
