// SPDX-License-Identifier: MIT
#include "response/impulse.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

Impulsive ball(double mass, const Vec3& velocity) {
    const double i = 2.5 / mass; // solid, radius 1
    return {1 / mass, diagonal({i, i, i}), velocity, {}};
}

void apply(Impulsive& body, const Vec3& arm, const Vec3& impulse) {
    body.velocity += body.inverse_mass * impulse;
    body.angular_velocity += body.inverse_inertia * cross(arm, impulse);
}

double energy(const Impulsive& b) {
    // For the isotropic bodies of this test only.
    return 0.5 * length_sq(b.velocity) / b.inverse_mass + 0.5 * length_sq(b.angular_velocity) / b.inverse_inertia.m[0];
}

ContactPoint between(const Impulsive& a, const Impulsive& b, const Vec3& n, const Vec3& ra, const Vec3& rb, double mu) {
    return {n, ra, rb, point_velocity(b, rb) - point_velocity(a, ra), mu};
}

TEST(ContactImpulse, EqualBallsSwapVelocities) {
    Impulsive a = ball(2, {3, 0, 0}), b = ball(2, {-1, 0, 0});
    const ContactPoint p = between(a, b, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}, 0.5);
    const Vec3 l = contact_impulse(a, b, p, 4).value();
    apply(a, p.arm_a, -l);
    apply(b, p.arm_b, l);
    EXPECT_NEAR(a.velocity.x, -1, 1e-14);
    EXPECT_NEAR(b.velocity.x, 3, 1e-14);
}

TEST(ContactImpulse, SticksInsideTheConeAndSlidesOnIt) {
    const Impulsive ground{};
    for (double mu : {0.05, 0.2, 0.5, 2.0}) {
        Impulsive b = ball(1, {1, 0, -1});
        const ContactPoint p = between(ground, b, {0, 0, 1}, {}, {0, 0, -1}, mu);
        const Vec3 l = contact_impulse(ground, b, p, 0).value();
        apply(b, p.arm_b, l);
        const Vec3 v = point_velocity(b, p.arm_b);
        EXPECT_NEAR(v.z, 0, 1e-14);
        // A solid ball sticks where |tangential impulse| = 2/7 m v <= mu m v_n.
        if (mu > 2.0 / 7) {
            EXPECT_NEAR(v.x, 0, 1e-14);
            EXPECT_NEAR(l.x, -2.0 / 7, 1e-14);
        } else {
            EXPECT_NEAR(l.x, -mu * l.z, 1e-14);
            EXPECT_GT(v.x, 0);
        }
    }
}

TEST(ContactImpulse, DoesNothingForSeparatingPointsAndImmovablePairs) {
    const Impulsive ground{};
    Impulsive b = ball(1, {0, 0, 1});
    EXPECT_FALSE(contact_impulse(ground, b, between(ground, b, {0, 0, 1}, {}, {0, 0, -1}, 0.1), 0.5).has_value());
    EXPECT_FALSE(contact_impulse(ground, ground, between(ground, ground, {0, 0, 1}, {}, {}, 0.1), 0.5).has_value());
}

TEST(EnergyClamp, NeverLetsTheEnergyGrowAndKeepsHonestImpulses) {
    std::mt19937_64 rng(3);
    std::normal_distribution<double> n;
    const auto vec = [&] { return Vec3{n(rng), n(rng), n(rng)}; };
    int clamped = 0, kept = 0, refused = 0;
    for (int i = 0; i < 5000; ++i) {
        Impulsive a = ball(1 + std::abs(n(rng)), vec()), b = ball(1 + std::abs(n(rng)), vec());
        a.angular_velocity = vec();
        b.angular_velocity = vec();
        // Arms and velocities that do not belong together, as for linearised hits.
        const ContactPoint p{normalized(vec()), vec(), vec(), vec(), 0.3};
        const double vn = dot(p.normal, p.relative_velocity);
        const auto l = contact_impulse(a, b, p, std::abs(vn));
        if (!l) continue;
        const double s = energy_clamp(a, b, p.arm_a, p.arm_b, *l);
        const double before = energy(a) + energy(b);
        apply(a, p.arm_a, -s * *l);
        apply(b, p.arm_b, s * *l);
        ASSERT_LE(energy(a) + energy(b), before * (1 + 1e-13));
        ++(s == 0 ? refused : s < 1 ? clamped : kept);
    }
    EXPECT_GT(clamped, 100);
    EXPECT_GT(kept, 100);
    EXPECT_GT(refused, 100);
}

} // namespace
} // namespace flotilla
