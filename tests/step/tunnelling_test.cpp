// SPDX-License-Identifier: MIT
// Speeds and spins at which a body would be through another within one step.
#include "base/rotation.hpp"
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

TEST(Tunnelling, FastPlateNeverPasses) {
    for (const double speed : {100.0, 10000.0})
        for (const Vec3& tilt : {Vec3{}, Vec3{0.1, 0, 0}, Vec3{1.2, 0.7, -0.4}, Vec3{kPi / 2, 0, 0}})
            for (const Vec3& spin : {Vec3{}, Vec3{3, 20, -7}}) {
                SceneDescription scene = make_scene("fast-plate");
                scene.settings.sleeping = false;
                scene.bodies[0].velocity = {0, 0, -speed};
                scene.bodies[0].rotation = rotation_from_vector(tilt);
                scene.bodies[0].angular_velocity = spin;
                World world(scene);
                RunTotals totals;
                for (int n = 0; n < 24; ++n) {
                    totals.add(world.step());
                    const Vec3 p = world.body(0).center_of_mass;
                    if (std::abs(p.x) < 4 && std::abs(p.y) < 4) { // beyond, it may fall past the edge
                        ASSERT_GT(p.z, 0) << "speed " << speed << ", step " << n;
                    }
                    ASSERT_EQ(count_intersections(scene, world), 0) << "speed " << speed << ", step " << n;
                }
                EXPECT_GE(totals.collisions, 1);
            }
}

TEST(Tunnelling, SpinningBoatBreaksNothingInThePile) {
    SceneDescription scene = make_scene("falling-boats", 9, 3);
    scene.settings.sleeping = false;
    World world(scene);
    RunTotals totals;
    for (int n = 0; n < 24; ++n) totals.add(world.step());
    // The same pile with its last boat spinning and thrown down at the others.
    for (std::size_t i = 0; i + 1 < scene.bodies.size(); ++i) {
        const BodyState s = world.body(i);
        scene.bodies[i].position = s.position;
        scene.bodies[i].rotation = s.rotation;
        scene.bodies[i].velocity = s.velocity;
        scene.bodies[i].angular_velocity = s.angular_velocity;
    }
    scene.bodies[7].angular_velocity = {600, 640, -480}; // 1000 rad/s
    scene.bodies[7].velocity = {0, 0, -30};
    double ground_half = 0;
    for (const Vec3& v : scene.shapes[1].vertices) ground_half = std::max(ground_half, std::abs(v.x));
    World spun(scene);
    totals = {};
    int above = 0; // checks that a boat is above the ground
    for (int n = 0; n < 36; ++n) {
        const StepReport r = spun.step();
        totals.add(r);
        expect_ladder_bounds(r, spun.size());
        ASSERT_EQ(count_intersections(scene, spun), 0) << "step " << n;
        for (std::size_t i = 0; i < 8; ++i) {
            // Boats that are thrown off the ground's edge may fall on; a boat fits into 2 m around its centre.
            const Vec3 p = spun.body(i).center_of_mass;
            if (std::max(std::abs(p.x), std::abs(p.y)) > ground_half - 2) continue;
            ++above;
            ASSERT_GT(p.z, 0) << "boat " << i << " at " << p.x << ", " << p.y << ", step " << n;
        }
    }
    std::printf("spinning boat: %lld impulses, %lld merges, %lld rung changes in 36 steps\n",
                static_cast<long long>(totals.collisions), static_cast<long long>(totals.merges),
                static_cast<long long>(totals.rung_changes));
    EXPECT_GE(totals.collisions, 50);
    EXPECT_GE(above, 8 * 36 / 2); // most of them stay on the ground
}

TEST(Tunnelling, WallsClosingOnABoatAreHeld) {
    SceneDescription scene = make_scene("closing-walls");
    scene.settings.sleeping = false;
    World world(scene);
    RunTotals totals;
    const auto steps = static_cast<int>(3 / scene.settings.time_step);
    for (int n = 0; n < steps; ++n) {
        const StepReport r = world.step();
        totals.add(r);
        expect_ladder_bounds(r, world.size());
        ASSERT_EQ(count_intersections(scene, world), 0) << "step " << n;
    }
    const double left = world.body(1).position.y, right = world.body(2).position.y;
    std::printf("closing walls: %.3f m apart at the end, %lld impulses, %lld held\n", right - left,
                static_cast<long long>(totals.collisions), static_cast<long long>(totals.held));
    EXPECT_GE(totals.collisions, 1);
    EXPECT_NE(totals.warnings & kScriptDelayed, 0u);
    EXPECT_GT(right, left);
}

} // namespace
} // namespace flotilla::scenario
