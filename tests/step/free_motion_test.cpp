// SPDX-License-Identifier: MIT
// Free bodies: nothing touches, so the answers are those of textbooks.
#include "base/rotation.hpp"
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

/// One weightless-space body with the given principal inertia (kg m^2).
SceneDescription top(const Vec3& inertia, const Vec3& omega, double dt) {
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    scene.settings.time_step = dt;
    const auto shape = add_shape(scene, make_octahedron(1), 1);
    scene.shapes.back().inertia = diagonal(inertia);
    add_body(scene, shape, BodyType::dynamic, {}).angular_velocity = omega;
    return scene;
}

// Stages 2 to 6 are exact for constant gravity; what is left is the rounding of n additions.
TEST(FreeMotion, BallisticFlightIsExactToRounding) {
    for (const double dt : {1.0 / 24, 1.0 / 7, 1e-3}) {
        SceneDescription scene = empty_scene();
        scene.settings.time_step = dt;
        const auto shape = add_shape(scene, make_box(1, 2, 0.5), 3);
        const Vec3 start{100, -20, 50}, velocity{3, -7, 20};
        BodyDescription& body = add_body(scene, shape, BodyType::dynamic, start);
        body.velocity = velocity;
        body.angular_velocity = {1, 2, 3};
        World world(scene);
        const Vec3 com = world.body(0).center_of_mass;
        double largest = 0, largest_speed = 0;
        constexpr int kSteps = 1000;
        for (int n = 1; n <= kSteps; ++n) {
            ASSERT_EQ(world.step().contacts, 0);
            const BodyState s = world.body(0);
            const long double t = static_cast<long double>(dt) * n;
            const auto exact_x = [&](double x, double v, double g) {
                return static_cast<double>(x + t * v + 0.5L * t * t * g);
            };
            const Vec3 x{exact_x(com.x, velocity.x, 0), exact_x(com.y, velocity.y, 0),
                         exact_x(com.z, velocity.z, -kGravity)};
            const double vz = static_cast<double>(velocity.z - t * kGravity);
            largest = std::max(largest, max_component(abs(x)));
            largest_speed = std::max(largest_speed, std::abs(vz));
            ASSERT_LE(max_component(abs(s.center_of_mass - x)), 10 * n * kRoundOff * largest) << "step " << n;
            ASSERT_LE(std::abs(s.velocity.z - vz), 10 * n * kRoundOff * largest_speed) << "step " << n;
            ASSERT_EQ(s.velocity.x, velocity.x);
        }
    }
}

TEST(FreeMotion, TopsKeepEnergyAndMomentum) {
    struct Case {
        Vec3 inertia, omega;
    };
    for (const Case& c : {Case{{1, 2, 3}, {0.01, 5, 0.01}}, Case{{1, 2, 3}, {0.1, 20, 0.1}},
                          Case{{1, 1, 0.02}, {3, 0, 30}}, Case{{0.5, 0.5, 1}, {3, 0, 20}}}) {
        World world(top(c.inertia, c.omega, 1.0 / 24));
        const Vec3 l{c.inertia.x * c.omega.x, c.inertia.y * c.omega.y, c.inertia.z * c.omega.z};
        const double energy = 0.5 * dot(l, c.omega);
        double energy_error = 0, momentum_error = 0;
        for (int n = 0; n < 2400; ++n) {
            const StepReport r = world.step();
            energy_error = std::max(energy_error, std::abs(r.kinetic_energy - energy) / energy);
            momentum_error = std::max(momentum_error, length(r.angular_momentum - l) / length(l));
        }
        EXPECT_LE(energy_error, 1e-12);
        EXPECT_LE(momentum_error, 1e-12);
        std::printf("top: relative energy error %.2g, momentum %.2g\n", energy_error, momentum_error);
    }
}

// The axis of a symmetric top goes around L at the rate |L| / I1.
TEST(FreeMotion, SymmetricTopPrecesses) {
    const Vec3 inertia{1, 1, 1.6}, omega{0.3, 0, 0.9}; // |w| dt = 0.095
    const double dt = 0.1;
    World world(top(inertia, omega, dt));
    const Vec3 l{inertia.x * omega.x, 0, inertia.z * omega.z};
    const Vec3 up = normalized(l), side{0, 1, 0}, front = cross(side, up);
    double angle = 0, last = std::atan2(dot({0, 0, 1}, side), dot({0, 0, 1}, front));
    constexpr int kSteps = 1000;
    for (int n = 0; n < kSteps; ++n) {
        (void)world.step();
        const Vec3 axis = rotate(world.body(0).rotation, {0, 0, 1});
        const double now = std::atan2(dot(axis, side), dot(axis, front));
        angle += std::remainder(now - last, 2 * kPi);
        last = now;
    }
    const double exact = length(l) / inertia.x * dt * kSteps;
    std::printf("symmetric top: precession angle off by %.3g %%\n", 100 * (std::abs(angle) / exact - 1));
    EXPECT_NEAR(std::abs(angle) / exact, 1, 0.01);
}

// T = 4K(m) / sqrt(...) = 39.1057 s for this case; the middle component changes sign twice per period.
TEST(FreeMotion, AsymmetricTopHasTheRightPeriod) {
    const Vec3 inertia{1, 2, 3}, omega{0.01, 1, 0.01};
    const double dt = 0.1, exact = 39.1057;
    World world(top(inertia, omega, dt));
    std::vector<double> flips;
    double last = omega.y;
    for (int n = 1; n <= 4000; ++n) {
        (void)world.step();
        const BodyState s = world.body(0);
        const double now = rotate(conjugate(s.rotation), s.angular_velocity).y;
        if ((now < 0) != (last < 0)) flips.push_back((n - now / (now - last)) * dt);
        last = now;
    }
    ASSERT_GE(flips.size(), 15u);
    const double period = 2 * (flips.back() - flips.front()) / static_cast<double>(flips.size() - 1);
    std::printf("asymmetric top: period %.4f s, exact %.4f s (%.2f %%)\n", period, exact, 100 * (period / exact - 1));
    EXPECT_NEAR(period / exact, 1, 0.01);
}

} // namespace
} // namespace flotilla::scenario
