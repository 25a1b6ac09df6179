// SPDX-License-Identifier: MIT
#include "state/rotation_step.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

struct Top {
    Vec3 inertia, momentum;
    Quat q{};

    PrincipalInertia world() const {
        return turned(PrincipalInertia{{}, inertia, {1 / inertia.x, 1 / inertia.y, 1 / inertia.z}}, q);
    }
    Vec3 omega() const { return angular_velocity(world(), momentum); }
    double energy() const { return 0.5 * dot(momentum, omega()); }
    Vec3 body_omega() const { return rotate(conjugate(q), omega()); }
    RotationStep step(double dt) {
        const RotationStep r = rotate_for(world(), momentum, dt);
        q = normalized(r.rotation * q);
        return r;
    }
};

Top spinning(const Vec3& inertia, const Vec3& omega) {
    return {inertia, {inertia.x * omega.x, inertia.y * omega.y, inertia.z * omega.z}};
}

TEST(RotationStep, KeepsTheEnergyOfFastSlenderAndFlatBodies) {
    const double dt = 1.0 / 24;
    for (Top top : {spinning({1, 2, 3}, {0.01, 5, 0.01}), spinning({1, 2, 3}, {0.01, 20, 0.01}),
                    spinning({1, 1, 0.02}, {3, 0, 30}), spinning({0.5, 0.5, 1}, {14, 0, 14}),
                    spinning({1, 2, 3}, {700, 600, 400}), spinning({1, 1, 1}, {1, 2, 3})}) {
        const double e0 = top.energy();
        for (int i = 0; i < 2400; ++i) {
            top.step(dt);
            ASSERT_NEAR(top.energy() / e0, 1, 1e-12) << "step " << i;
        }
    }
}

TEST(RotationStep, DoesNotAddUpWhatSmallStepsErr) {
    // Equation 4 alone errs by less than rounding here, always to the same side.
    Top top = spinning({1, 2, 3}, {0.01, 1, 0.01});
    const double e0 = top.energy();
    for (int i = 0; i < 200'000; ++i) top.step(1.0 / 3840);
    EXPECT_NEAR(top.energy() / e0, 1, 2e-13);
}

TEST(RotationStep, KeepsTheEnergyOfNeedles) {
    // Inertia ratios of 1e6 and 1e12, axes askew to the world's.
    for (const double thin : {1e-6, 1e-12}) {
        Top top = spinning({thin, 1, 1}, {0, 1, 0.5});
        top.q = normalized(Quat{0.3, 0.5, -0.2, 0.7});
        top.momentum = rotate(top.q, top.momentum);
        const double e0 = top.energy();
        for (int i = 0; i < 1000; ++i) {
            const RotationStep r = top.step(1.0 / 24);
            ASSERT_LT(length(r.vector), 0.1) << "step " << i;
            ASSERT_NEAR(top.energy() / e0, 1, 1e-9) << "step " << i;
        }
    }
}

TEST(RotationStep, AsymmetricTopTumblesWithTheEllipticPeriod) {
    // By Jacobi's elliptic functions: I = (1,2,3), omega = (.01,1,.01): T = 39.1057 s; omega dt = 0.04.
    Top top = spinning({1, 2, 3}, {0.01, 1, 0.01});
    const double dt = 1.0 / 24;
    std::vector<double> crossings;
    double last = top.body_omega().y;
    for (int i = 1; i < 24 * 200; ++i) {
        top.step(dt);
        const double now = top.body_omega().y;
        if (last > 0 && now <= 0) crossings.push_back((i - now / (now - last)) * dt);
        last = now;
    }
    ASSERT_GE(crossings.size(), 4u);
    const double period = (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
    EXPECT_NEAR(period / 39.1057, 1, 0.01);
}

TEST(RotationStep, SymmetricTopPrecessesAboutTheMomentum) {
    // Space precession rate L / I1.
    Top top = spinning({2, 2, 1}, {0.5, 0, 1});
    const double dt = 1.0 / 240;
    const double rate = length(top.momentum) / 2;
    const Vec3 l = normalized(top.momentum);
    const auto axis = [&] { return rotate(top.q, {0, 0, 1}); };
    const Vec3 start = axis();
    const int steps = static_cast<int>(std::round(2 * std::numbers::pi / rate / dt));
    for (int i = 0; i < steps; ++i) top.step(dt);
    EXPECT_NEAR(dot(axis(), l), dot(start, l), 1e-10);
    EXPECT_NEAR(length(axis() - start), 0, 0.02);
}

// The energy of a cube or a ball does not depend on how it is turned, and what rounding makes of that is no error to be
// corrected by a turn.
TEST(RotationStep, TurnsBodiesOfEqualMomentsByTheirAngularVelocity) {
    constexpr double kUlp = 0x1p-52;
    for (const Vec3& inertia :
         {Vec3{1, 1, 1}, Vec3{0.3, 0.3 * (1 + kUlp), 0.3 * (1 - kUlp)}, Vec3{7e-4, 7e-4, 7e-4 * (1 + 4 * kUlp)}})
        for (const Vec3& omega : {Vec3{0, 0, 20}, Vec3{0.1, 0, 20}, Vec3{1, 2, 3}, Vec3{0.1, 0.05, 3}})
            for (const double dt : {1.0 / 24, 1.0 / 240, 1.0 / 1920}) {
                Top top = spinning(inertia, omega);
                top.q = normalized(Quat{0.94, 0.09, 0.18, 0.27});
                for (int i = 0; i < 2000; ++i) {
                    const Vec3 due = dt * top.omega();
                    ASSERT_LT(length(top.step(dt).vector - due), 1e-13 * length(due)) << i;
                }
            }
}

TEST(RotationStep, CountsWholeTurns) {
    Top top = spinning({1, 2, 3}, {0, 0, 1000});
    const RotationStep r = top.step(1.0 / 24);
    EXPECT_NEAR(length(r.vector), 1000.0 / 24, 1e-9);
    EXPECT_NEAR(length(rotate(rotation_from_vector(r.vector), {1, 0, 0}) - rotate(r.rotation, {1, 0, 0})), 0, 1e-12);
}

TEST(RotationStep, RestingBodyStaysBitwise) {
    Top top = spinning({1, 2, 3}, {});
    const RotationStep r = top.step(1.0 / 24);
    EXPECT_EQ(r.rotation, Quat{});
    EXPECT_EQ(r.vector, Vec3{});
}

} // namespace
} // namespace flotilla
