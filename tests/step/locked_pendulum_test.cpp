// SPDX-License-Identifier: MIT
// A compound pendulum on a knife's edge, with every axis locked but those of its plane. The edge stands on a plate at
// the rest distance, held by friction, and the centre of mass hangs below, so that theory has no play, no curvature and
// no fit.
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

constexpr double kArm = 0.25, kMass = 2, kInertia = 0.04; // m, kg, kg m^2 about the centre of mass
constexpr double kRest = 1e-3;                            // m
constexpr double kWeightArm = kMass * kGravity * kArm;
const double kRate = std::sqrt(kWeightArm / (kInertia + kMass * kArm * kArm)); // rad/s, of small swings

/// s, exact for any amplitude, by the arithmetic-geometric mean.
double period(double amplitude) {
    double x = 1, y = std::cos(amplitude / 2);
    while (std::abs(x - y) > 1e-15) {
        const double mean = (x + y) / 2;
        y = std::sqrt(x * y);
        x = mean;
    }
    return 2 * kPi / (kRate * x);
}

SceneDescription pendulum(double angle, double time_step, VelocityUpdate update) {
    SceneDescription scene = empty_scene();
    scene.settings.velocity_update = update;
    scene.settings.time_step = time_step;
    scene.settings.rest_distance = kRest;
    const TriangleMesh knife{
        {{0, -0.15, 0}, {0, 0.15, 0}, {-0.1, -0.15, 0.1}, {-0.1, 0.15, 0.1}, {0.1, -0.15, 0.1}, {0.1, 0.15, 0.1}},
        {{0, 4, 2}, {1, 3, 5}, {0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {2, 4, 5}, {2, 5, 3}}};
    const auto shape = add_shape(scene, knife, kMass);
    scene.shapes.back().inertia = diagonal({kInertia, kInertia, kInertia});
    scene.shapes.back().center_of_mass = Vec3{0, 0, -kArm};
    const auto plate = add_shape(scene, {{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}});
    BodyDescription& body = add_body(scene, shape, BodyType::dynamic, {0, 0, kRest}, 1, 0);
    body.rotation = {std::cos(angle / 2), 0, std::sin(angle / 2), 0};
    body.locked_translation = {false, true, false};
    body.locked_rotation = {true, false, true};
    add_body(scene, plate, BodyType::fixed, {}, 1, 0);
    return scene;
}

struct Swings {
    std::vector<double> periods, amplitudes; ///< s, rad
    double edge_x = 0, edge_z = 0;           ///< m, farthest from the start
    double edge_end = 0;                     ///< m, along x
};
Swings swing(double angle, double time_step, int steps, VelocityUpdate update) {
    World world(pendulum(angle, time_step, update), "pendulum", {1});
    Swings out;
    double before = angle, crossing = -1, highest = 0;
    for (int n = 1; n <= steps; ++n) {
        const StepReport report = world.step();
        EXPECT_EQ(report.energy_corrections + report.held + report.merges, 0) << n;
        const BodyState s = world.body(0);
        EXPECT_EQ(s.center_of_mass.y, 0);
        EXPECT_EQ(s.velocity.y, 0);
        EXPECT_EQ(s.angular_velocity.x, 0);
        EXPECT_EQ(s.angular_velocity.z, 0);
        out.edge_x = std::max(out.edge_x, std::abs(s.position.x));
        out.edge_z = std::max(out.edge_z, std::abs(s.position.z - kRest));
        const double now = 2 * std::atan2(s.rotation.y, s.rotation.w);
        out.edge_end = s.position.x;
        highest = std::max(highest, now);
        if (before < 0 && now >= 0) {
            const double time = (n - now / (now - before)) * time_step;
            if (crossing >= 0) {
                out.periods.push_back(time - crossing);
                out.amplitudes.push_back(highest);
            }
            crossing = time;
            highest = 0;
        }
        before = now;
    }
    return out;
}

struct Expected {
    VelocityUpdate update;
    double loss; ///< of the amplitude a period, in pi w dt / 2
};

// Stages 3 and 7 hold the edge at the poses of both ends of a step. Where each does half of it, swings keep amplitude and
// period to second order; where the end does all, as in the paper, swings at the rate w lose pi w dt / 2 of their
// amplitude a period.
TEST(LockedPendulum, SwingsAtItsPeriodAndStaysInItsPlace) {
    constexpr double kStep = 1.0 / 240;
    for (const auto& [update, loss] : {Expected{VelocityUpdate::trapezoidal, 0}, Expected{VelocityUpdate::end, 1}}) {
        const Swings s = swing(0.2, kStep, 10000, update);
        ASSERT_GE(s.periods.size(), 30U);
        double worst = 0, worst_loss = 0;
        for (std::size_t i = 0; i < s.periods.size(); ++i) {
            worst = std::max(worst, std::abs(s.periods[i] / period(s.amplitudes[i]) - 1));
            if (i == 0) continue;
            const double lost = 1 - s.amplitudes[i] / s.amplitudes[i - 1];
            worst_loss = std::max(worst_loss, std::abs(lost / (0.5 * kPi * kRate * kStep) - loss));
        }
        std::printf("pendulum: %zu periods, worst %.2g off theory, amplitude %.6f then %.6f, its loss %.2g of the "
                    "first order's off; edge %.2g m, %.2g m\n",
                    s.periods.size(), worst, s.amplitudes.front(), s.amplitudes.back(), worst_loss, s.edge_x, s.edge_z);
        EXPECT_LE(worst, 1e-3);
        EXPECT_LE(worst_loss, 0.1);
        // To and fro by what a solve may leave undone of friction (Settings::static_tolerance), and back.
        EXPECT_LE(s.edge_x, 0.02 * kRest);
        EXPECT_LE(std::abs(s.edge_end), 1e-3 * kRest);
        EXPECT_LE(s.edge_z, 1e-3 * kRest);
    }
}

// A hinge and a torque that goes by its angle, taken where the body will be in the middle of the step: what free motion makes
// of it is Verlet's scheme, which keeps the amplitude for ever and the period to (w dt)^2 / 24.
TEST(LockedPendulum, OnAHingeNeitherDriftsNorGainsIn10000Steps) {
    constexpr double kStep = 1.0 / 240, kAngle = 0.2;
    constexpr double kAboutPivot = kInertia + kMass * kArm * kArm;
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    scene.settings.time_step = kStep;
    const auto shape = add_shape(scene, make_box(0.1, 0.1, 0.5), kMass);
    scene.shapes.back().inertia = diagonal({kAboutPivot, kAboutPivot, kAboutPivot});
    BodyDescription& body = add_body(scene, shape, BodyType::dynamic, {});
    body.rotation = {std::cos(kAngle / 2), 0, std::sin(kAngle / 2), 0};
    body.locked_translation = {true, true, true};
    body.locked_rotation = {true, false, true};
    World world(scene, "pendulum", {1});
    const auto angle = [&] {
        const BodyState s = world.body(0);
        return 2 * std::atan2(s.rotation.y, s.rotation.w);
    };
    world.set_force_callback([&](World& w) {
        const double middle = angle() + 0.5 * kStep * w.body(0).angular_velocity.y;
        w.apply_torque(w.id(0), {0, -kWeightArm * std::sin(middle), 0});
    });
    double before = kAngle, crossing = -1, worst = 0, first = 0, last = 0, highest = 0;
    int periods = 0;
    for (int n = 1; n <= 10000; ++n) {
        world.step();
        const double now = angle();
        highest = std::max(highest, now);
        if (before < 0 && now >= 0) {
            const double time = (n - now / (now - before)) * kStep;
            if (crossing >= 0) {
                worst = std::max(worst, std::abs((time - crossing) / period(kAngle) - 1));
                (periods++ == 0 ? first : last) = highest;
            }
            crossing = time;
            highest = 0;
        }
        before = now;
    }
    std::printf("hinge: %d periods, worst %.2g off theory; amplitude %.6f rad, then %.6f\n", periods, worst, first,
                last);
    EXPECT_GE(periods, 30);
    EXPECT_LE(worst, 1e-3);
    EXPECT_NEAR(last, kAngle, 1e-3 * kAngle);
    EXPECT_EQ(world.body(0).center_of_mass, Vec3{});
}

TEST(LockedPendulum, LosesLessInShorterSteps) {
    const auto last = [](double step) {
        return swing(0.2, step, static_cast<int>(6 / step), VelocityUpdate::end).amplitudes.back();
    };
    const double coarse = 0.2 - last(1.0 / 240), fine = 0.2 - last(1.0 / 960);
    EXPECT_LE(fine, 0.3 * coarse);
}

} // namespace
} // namespace flotilla::scenario
