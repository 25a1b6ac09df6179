// SPDX-License-Identifier: MIT
// Crates whose corners touch at one time: what lands flat rebounds without spin (pair/simultaneous_hits.hpp).
#include "base/rotation.hpp"
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

constexpr double kEdge = 0.8, kMass = 2, kRestitution = 0.5;
constexpr double kSolved = 2e-3; // m/s and rad/s: hits of 4 m/s are resolved together to 1e-4 of that

SceneDescription weightless(const TriangleMesh& crate, double friction) {
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    const auto shape = add_shape(scene, crate, kMass), plate = add_shape(scene, make_plate(10, 10));
    add_body(scene, shape, BodyType::dynamic, {0.1, 0.23, 2}, friction, kRestitution).velocity = {0, 0, -4};
    add_body(scene, plate, BodyType::fixed, {}, friction, kRestitution);
    return scene;
}

/// Steps until after the first collision.
void hit(World& world) {
    for (int n = 0; n < 240; ++n)
        if (world.step().collisions > 0) break;
    (void)world.step();
}

// In some steps it hits, in others it ends within the proximity distance: those are hits as well.
TEST(FlatLanding, ACrateReboundsAsAPointDoes) {
    for (const double friction : {0.0, 0.5})
        for (const double heading : {0.0, 0.3}) // about the vertical
            for (const double dt : {1.0 / 24, 1.0 / 240})
                for (int phase = 0; phase < 40; ++phase) {
                    SceneDescription scene = weightless(make_box(kEdge, kEdge, kEdge), friction);
                    scene.settings.time_step = dt;
                    scene.bodies[0].rotation = rotation_from_vector({0, 0, heading});
                    scene.bodies[0].position.z += 0.0043 * phase;
                    World world(scene);
                    hit(world);
                    const BodyState s = world.body(0);
                    EXPECT_NEAR(s.velocity.z, kRestitution * 4, kSolved) << friction << ' ' << heading << ' ' << phase;
                    EXPECT_LT(length(s.velocity - Vec3{0, 0, s.velocity.z}), kSolved);
                    EXPECT_LT(length(s.angular_velocity), kSolved);
                }
}

// Two corners are one: a rod that hits with its end.
TEST(FlatLanding, ACrateThatLandsOnAnEdgeTurnsAboutThatEdgeOnly) {
    constexpr double kTilt = 0.5;
    SceneDescription scene = weightless(make_box(kEdge, kEdge, kEdge), 0);
    scene.bodies[0].rotation = rotation_from_vector({0, kTilt, 0});
    scene.settings.time_step = 1.0 / 240; // the other edge stays up in the step of the hit
    World world(scene);
    hit(world);
    const BodyState s = world.body(0);
    EXPECT_LT(std::abs(s.angular_velocity.x), kSolved);
    EXPECT_LT(std::abs(s.angular_velocity.z), kSolved);
    EXPECT_GT(std::abs(s.angular_velocity.y), 1);
    const double inertia = kMass * kEdge * kEdge * 5 / 18; // of the cube's surface
    const double arm = kEdge * std::sqrt(0.5) * std::sin(kPi / 4 - kTilt);
    const double impulse = (1 + kRestitution) * 4 / (1 / kMass + arm * arm / inertia);
    EXPECT_NEAR(s.velocity.z, -4 + impulse / kMass, kSolved);
    EXPECT_NEAR(std::abs(s.angular_velocity.y), arm * impulse / inertia, kSolved);
}

// A crate that falls over: the edge it stands on is nearer to the plate than the one that lands, where that ends the step
// within the proximity distance. Both ends of that are hit.
TEST(FlatLanding, ACrateThatFallsOverLandsOnBothEndsOfItsEdge) {
    constexpr double kFall = 1.5; // rad/s
    int hits = 0;
    for (int phase = 0; phase < 60; ++phase) {
        SceneDescription scene = weightless(make_box(kEdge, kEdge, kEdge), 0);
        scene.settings.time_step = 1.0 / 24;
        const double tilt = 0.02 + 0.002 * phase;
        BodyDescription& crate = scene.bodies[0];
        crate.rotation = rotation_from_vector({0, tilt, 0});
        crate.restitution = 0;
        scene.bodies[1].restitution = 0;
        const Vec3 arm = rotate(crate.rotation, Vec3{0.5 * kEdge, 0, -0.5 * kEdge}); // to the edge it stands on
        crate.position = Vec3{0, 0, 0.002} - arm;
        crate.angular_velocity = {0, -kFall, 0};
        crate.velocity = cross(crate.angular_velocity, -arm);
        World world(scene);
        hits += world.step().collisions > 0 ? 1 : 0;
        const BodyState s = world.body(0);
        EXPECT_LT(std::abs(s.angular_velocity.x), kSolved) << phase;
        EXPECT_LT(std::abs(s.angular_velocity.z), kSolved) << phase;
    }
    EXPECT_GT(hits, 10);
}

// Both bodies move, and what touches are faces of different sizes: corners of the smaller one.
TEST(FlatLanding, TwoCratesExchangeTheirMomentum) {
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    const auto small = add_shape(scene, make_box(kEdge, kEdge, kEdge), kMass);
    const auto large = add_shape(scene, make_box(2 * kEdge, 3 * kEdge, kEdge), 3 * kMass);
    add_body(scene, large, BodyType::dynamic, {0, 0, 0}, 0.3, 1).velocity = {0, 0, 1};
    add_body(scene, small, BodyType::dynamic, {0, 0, 2}, 0.3, 1).velocity = {0, 0, -3};
    World world(scene);
    hit(world);
    // Masses 3 and 1 at 1 and -3 m/s: the centre of mass rests, so both turn round.
    EXPECT_NEAR(world.body(0).velocity.z, -1, kSolved);
    EXPECT_NEAR(world.body(1).velocity.z, 3, kSolved);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(length(world.body(i).angular_velocity), kSolved) << i;
}

} // namespace
} // namespace flotilla::scenario
