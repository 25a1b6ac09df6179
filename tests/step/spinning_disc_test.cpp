// SPDX-License-Identifier: MIT
// Bodies in contact at many points of one plane, whose impulses are not determined. Sweeps with momentum there overshoot
// in turn to either side, farther each time, where plain ones converge: discs of 32 sides tilted, and lost their spin.
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

constexpr double kHeight = 0.2;

std::int32_t add_disc_shape(SceneDescription& scene) { return add_shape(scene, make_cylinder(0.5, kHeight, 32), 100); }

SceneDescription frictionless_floor(const Settings& settings, double time_step) {
    SceneDescription scene = empty_scene();
    scene.settings = settings;
    scene.settings.time_step = time_step;
    scene.settings.sleeping = false;
    add_body(scene, add_shape(scene, make_plate(100, 100)), BodyType::fixed, {0, 0, 0}, 0, 0);
    return scene;
}

/// The fastest tilt of any body in a step, rad/s.
double tilt(const World& world) {
    double most = 0;
    for (std::size_t i = 0; i < world.size(); ++i) {
        const Vec3 w = world.body(i).angular_velocity;
        most = std::max(most, std::hypot(w.x, w.y));
    }
    return most;
}

TEST(SpinningDisc, KeepsSpinAndSpeedWithoutFriction) {
    Settings swept;
    swept.contact_solver = ContactSolver::pgs;
    for (const auto& [name, settings] : {std::pair("paper", preset("paper")), std::pair("swept", swept)})
        for (const double time_step : {1.0 / 24, 0.1, 0.2}) {
            SceneDescription scene = frictionless_floor(settings, time_step);
            BodyDescription& disc =
                add_body(scene, add_disc_shape(scene), BodyType::dynamic, {0, 0, 0.5 * kHeight + 0.002}, 0, 0);
            disc.velocity = {0.5, 0, 0};
            disc.angular_velocity = {0, 0, 3};
            World world(scene);
            double most_tilt = 0, removed = 0;
            for (int n = 0; n < 60; ++n) {
                removed += world.step().energy_removed;
                most_tilt = std::max(most_tilt, tilt(world));
            }
            EXPECT_LT(most_tilt, 1e-3) << name << ' ' << time_step;
            EXPECT_EQ(removed, 0) << name << ' ' << time_step;
            EXPECT_NEAR(world.body(1).angular_velocity.z, 3, 1e-6) << name << ' ' << time_step;
            EXPECT_NEAR(world.body(1).velocity.x, 0.5, 1e-6) << name << ' ' << time_step;
        }
}

/// The rims pass each other, corner by corner.
TEST(SpinningDisc, OneOnAnotherBesideItsAxisTurnsWithItForEver) {
    for (const double time_step : {1.0 / 24, 1.0 / 60}) {
        SceneDescription scene = frictionless_floor(preset("balanced"), time_step);
        const auto disc = add_disc_shape(scene);
        for (int k = 0; k < 2; ++k)
            add_body(scene, disc, BodyType::dynamic, {0.03 * k, 0, (0.5 + k) * (kHeight + 0.0035)}, 0, 0)
                .angular_velocity = {0, 0, 0.3};
        World world(scene);
        for (int n = 0; n < 8 / time_step; ++n) world.step();
        for (const std::size_t body : {std::size_t{1}, std::size_t{2}}) {
            EXPECT_NEAR(world.body(body).angular_velocity.z, 0.3, 1e-3) << body << ' ' << time_step;
            EXPECT_LT(length(world.body(body).velocity), 1e-3) << body << ' ' << time_step;
        }
    }
}

/// Nine discs that spin on a raft, which stands on the floor.
SceneDescription raft(const Settings& settings, double time_step) {
    SceneDescription scene = frictionless_floor(settings, time_step);
    const auto slab = add_shape(scene, make_box(4.2, 4.2, 0.3), 10000), disc = add_disc_shape(scene);
    add_body(scene, slab, BodyType::dynamic, {0, 0, 0.1535}, 0, 0);
    for (int k = 0; k < 9; ++k)
        add_body(scene, disc, BodyType::dynamic, {1.3 * (k % 3 - 1), 1.3 * (k / 3 - 1), 0.411}, 0, 0)
            .angular_velocity = {0, 0, k % 2 == 0 ? 3.0 - 0.2 * k : -1.0 - 0.2 * k};
    return scene;
}

TEST(SpinningDisc, NineOnARaftStayFlatInEveryPresetAndStep) {
    struct Case {
        const char* preset;
        double time_step;
        int steps;
    };
    for (const Case& c : {Case{"preview", 1.0 / 24, 40}, Case{"balanced", 1.0 / 24, 40}, Case{"balanced", 1.0 / 96, 80},
                          Case{"accurate", 1.0 / 24, 12}}) {
        World world(raft(preset(c.preset), c.time_step));
        double most_tilt = 0, residual = 0;
        for (int n = 0; n < c.steps; ++n) {
            residual = std::max(residual, world.step().residual);
            most_tilt = std::max(most_tilt, tilt(world));
        }
        EXPECT_LT(most_tilt, 2e-3) << c.preset << ' ' << c.time_step;
        EXPECT_LT(residual, 1e-3) << c.preset << ' ' << c.time_step << ": gravity adds 0.1 m/s and more";
    }
}

} // namespace
} // namespace flotilla::scenario
