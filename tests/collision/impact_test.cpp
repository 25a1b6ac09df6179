// SPDX-License-Identifier: MIT
// Single impacts against their closed forms, in both ways of stage 1: a corner of an octahedron meets a face.
#include <gtest/gtest.h>

#include "collision/stage.hpp"

namespace flotilla {
namespace {

using scenario::add_body;
using scenario::add_shape;
using test::collide;
using test::StageWorld;

constexpr double kGap = 0.02, kRadius = 0.5; // m, before the impact; of the octahedron
constexpr double kSolved = 2e-4 * 10;        // m/s: accumulated hits are solved to 1e-4 of the approach

class Impact : public test::BothWays {
  protected:
    static void expect_near(const Vec3& x, const Vec3& y, double tolerance) {
        EXPECT_LE(length(x - y), tolerance)
            << x.x << ' ' << x.y << ' ' << x.z << " for " << y.x << ' ' << y.y << ' ' << y.z;
    }
};

INSTANTIATE_TEST_SUITE_P(Ways, Impact, testing::Values(Collisions::sequential, Collisions::accumulated),
                         test::name_of_way);

// u1 = v1 - (1 + e) m2 / (m1 + m2) (v1 - v2), and the same for the other.
TEST_P(Impact, CentralOneSharesTheSpeedByMassAndRestitution) {
    for (const double mass : {1e-3, 0.5, 1.0, 20.0, 1e4})
        for (const double e : {0.0, 0.3, 1.0}) {
            SceneDescription s = scene();
            add_body(s, test::add_octahedron(s, 2), BodyType::dynamic, {-0.5 - kRadius - kGap, 0, 0}, 0, e).velocity = {
                8, 0, 0};
            add_body(s, add_shape(s, make_box(1, 1, 1, 4), mass), BodyType::dynamic, {}, 0, 0).velocity = {-2, 0, 0};
            StageWorld world(s);
            const Vec3 momentum = world.momentum();
            EXPECT_EQ(collide(world).impulses, 1);
            const double change = (1 + e) * 10 / (2 + mass);
            expect_near(world.velocity(0), {8 - mass * change, 0, 0}, 1e-12 * 10);
            expect_near(world.velocity(1), {-2 + 2 * change, 0, 0}, 1e-12 * 20);
            expect_near(world.momentum(), momentum, 1e-14 * (16 + 2 * mass));
            expect_near(world.spin(0), {}, 1e-12);
        }
}

// j = (1 + e) v / (1/m1 + 1/m2 + d^2 / I), which also turns the box by w = d j / I.
TEST_P(Impact, EccentricOneTurnsWhatItMeets) {
    constexpr double kOff = 0.3;
    SceneDescription s = scene();
    add_body(s, test::add_octahedron(s, 2), BodyType::dynamic, {-0.5 - kRadius - kGap, kOff, 0}, 0, 0.5).velocity = {
        10, 0, 0};
    add_body(s, add_shape(s, make_box(1, 1, 1, 4), 5), BodyType::dynamic, {}, 0, 0);
    StageWorld world(s);
    const double energy = world.energy();
    EXPECT_EQ(collide(world).impulses, 1);
    const double inertia = world.model().shape_of(1).inertia.m[8];
    const double along = 1.0 / 2 + 1.0 / 5 + kOff * kOff / inertia;
    const double impulse = 1.5 * 10 / along;
    expect_near(world.velocity(0), {10 - impulse / 2, 0, 0}, 1e-11);
    expect_near(world.velocity(1), {impulse / 5, 0, 0}, 1e-11);
    expect_near(world.spin(1), {0, 0, -kOff * impulse / inertia}, 1e-11);
    // What is lost is (1 - e^2) of the energy of the approach.
    EXPECT_NEAR(energy - world.energy(), (1 - 0.25) * 0.5 * 100 / along, 1e-10);
}

/// An octahedron that meets a plate with a corner, moving along it as well.
struct Oblique {
    Oblique(SceneDescription s, double friction, double restitution) {
        add_body(s, test::add_octahedron(s, 2), BodyType::dynamic, {0.3, 0.1, kRadius + kGap}, friction, restitution)
            .velocity = {4, 3, -10};
        add_body(s, add_shape(s, make_plate(4, 4)), BodyType::fixed, {}, friction, 0);
        world = std::make_unique<StageWorld>(s);
        inertia = world->model().shape_of(0).inertia.m[0];
    }
    std::unique_ptr<StageWorld> world;
    double inertia = 0; // kg m^2, about every axis
};

// j_t = mu j_n against the sliding, which turns the body too.
TEST_P(Impact, FrictionSlidesOnItsCone) {
    Oblique impact(scene(), 0.05, 0.5);
    collide(*impact.world);
    const double normal = 2 * 1.5 * 10, tangent = 0.05 * normal, w = kRadius * tangent / impact.inertia;
    expect_near(impact.world->velocity(0), {4 - 0.8 * tangent / 2, 3 - 0.6 * tangent / 2, 5}, 1e-9);
    expect_near(impact.world->spin(0), {-0.6 * w, 0.8 * w, 0}, 1e-9);
}

// j_t = v_t / (1/m + r^2/I) stops the corner.
TEST_P(Impact, FrictionSticksInsideOfItsCone) {
    Oblique impact(scene(), 2, 0.5);
    collide(*impact.world);
    const double tangent = 5 / (1.0 / 2 + kRadius * kRadius / impact.inertia);
    expect_near(impact.world->velocity(0), {4 - 0.8 * tangent / 2, 3 - 0.6 * tangent / 2, 5}, kSolved);
    const Vec3 corner = impact.world->velocity(0) + cross(impact.world->spin(0), Vec3{0, 0, -kRadius});
    expect_near(corner, {0, 0, 5}, kSolved);
}

TEST_P(Impact, AFaceLandsFlat) {
    SceneDescription s = scene();
    add_body(s, add_shape(s, make_box(1, 1, 1), 3), BodyType::dynamic, {0.2, 0.1, 0.5 + kGap}, 0, 0.4).velocity = {0, 0,
                                                                                                                   -10};
    add_body(s, add_shape(s, make_plate(4, 4)), BodyType::fixed, {}, 0, 0);
    StageWorld world(s);
    collide(world);
    expect_near(world.velocity(0), {0, 0, 4}, kSolved);
    expect_near(world.spin(0), {}, kSolved);
}

// Of a blow that comes within the step the velocity has all, the way of the step what leaves e^2 of the gap.
TEST_P(Impact, AHitWithinTheStepIsLateForItsWay) {
    constexpr double kFall = 10, kHigh = 0.05; // m/s, of which the step has 0.1 m; m
    for (const double e : {0.0, 0.4, 1.0}) {
        SceneDescription s = scene();
        add_body(s, test::add_octahedron(s, 2), BodyType::dynamic, {0.3, 0.1, kRadius + kHigh}, 0, e).velocity = {
            0, 0, -kFall};
        add_body(s, add_shape(s, make_plate(4, 4)), BodyType::fixed, {}, 0, 0);
        StageWorld world(s);
        const double dt = world.dt(), rest = world.lengths(0, 1).rest;
        collide(world);
        EXPECT_NEAR(world.velocity(0).z, e * kFall, 1e-9);
        const double end = world.end(0).com.z - kRadius;
        EXPECT_NEAR(end, rest + e * e * (kHigh - rest) + e * kFall * dt, 1e-9) << e;
    }
}

// What falls straight, does not spin and meets no friction is stopped corner by corner, and may rise in the end, but by
// no more than 0.157 of its fall: the largest of the exact sequences of these hundred cubes (0.1565), see
// Impact.PlasticCubesRiseAsInTheExactSequence.
TEST(SequentialImpact, WhatLandsWithoutReboundRisesNoFasterThanItMay) {
    constexpr double kFall = 3, kEdge = 0.6; // m/s, m
    const TriangleMesh cube = make_box(kEdge, kEdge, kEdge);
    int rise = 0;
    for (int i = 0; i < 100; ++i) {
        SceneDescription s = test::weightless_scene();
        s.settings.time_step = 1.0 / 24;
        const Quat rotation = rotation_from_vector({0.9 * (i % 5) - 2, 0.37 * i, 1.3 * (i % 7)});
        double lowest = 0;
        for (const Vec3& v : cube.vertices) lowest = std::min(lowest, rotate(rotation, v).z);
        const double gap = (i % 10 + 0.5) / 10 * kFall * s.settings.time_step;
        BodyDescription& body = add_body(s, add_shape(s, cube, 200), BodyType::dynamic, {0, 0, gap - lowest}, 0, 0);
        body.rotation = rotation;
        body.velocity = {0, 0, -kFall};
        add_body(s, add_shape(s, make_plate(40, 40)), BodyType::fixed, {}, 0, 0);
        StageWorld world(s);
        EXPECT_GE(collide(world).impulses, 1) << i;
        EXPECT_LE(world.velocity(0).z, 0.157 * kFall) << i;
        rise += world.velocity(0).z > 0.01 * kFall ? 1 : 0;
    }
    EXPECT_GE(rise, 5) << "solved at once, none does";
    EXPECT_LE(rise, 30) << "most hit again in the next step";
}

/// The corner of an octahedron `gap` above a plate, with gravity: its velocity after the stage, and whether the pair
/// was processed.
std::pair<double, bool> near_plate(SceneDescription s, double gap, double velocity) {
    s.gravity = {0, 0, -9.8};
    add_body(s, test::add_octahedron(s, 2), BodyType::dynamic, {0.3, 0.1, kRadius + gap}, 0, 1).velocity = {0, 0,
                                                                                                            velocity};
    add_body(s, add_shape(s, make_plate(4, 4)), BodyType::fixed, {}, 0, 1);
    StageWorld world(s);
    CollisionScratch scratch;
    handle_collisions(world.view(), world.movers(), world.book(), world.workers(), {}, nullptr, scratch);
    const PairRecord* record = world.pairs().find(0, 1);
    return {world.velocity(0).z, record != nullptr && record->processed};
}

// What is slower than |g| dt / 2 = 0.049 m/s is left to static contact, and its pair counts as processed all the same.
TEST_P(Impact, AtTheEndOfTheStepReboundsFromItsThreshold) {
    EXPECT_EQ(near_plate(scene(), 0.002, -0.048), std::pair(-0.048, true));
    const auto [fast, processed] = near_plate(scene(), 0.002, -0.05);
    EXPECT_NEAR(fast, 0.05, 1e-14);
    EXPECT_TRUE(processed);
    EXPECT_EQ(near_plate(scene(), 0.002, 0.05), std::pair(0.05, true)) << "it leaves";
    EXPECT_EQ(near_plate(scene(), 0.1, -0.05), std::pair(-0.05, false)) << "it is not near";
}

} // namespace
} // namespace flotilla
