// SPDX-License-Identifier: MIT
// Contacts with a point on each body.
#include "static_contact/solve_contacts.hpp"

#include <gtest/gtest.h>

#include "static_contact/contact_systems.hpp"

namespace flotilla {
namespace {

// A rod of radius r, and a gap above it another one: friction turns each by its own radius. With one point for both, on
// the lower rod, the upper one would be turned by its radius and the gap.
TEST(SolveContacts, FrictionTurnsBodiesByTheirOwnPoints) {
    constexpr double kRadius = 0.01, kGap = 0.3, kMass = 2, kInertia = kMass * kRadius * kRadius / 2;
    for (const Isa isa : {Isa::scalar, Isa::avx2, Isa::avx512}) {
        if (isa > best_isa()) continue;
        ContactWorld w;
        for (const double z : {-kRadius, kGap + kRadius}) w.add_body(kMass, {kInertia, 10, 10}, {0, 0, z});
        w.velocity[1] = {0, 1e-3, -0.1};
        w.add_contact(0, 1, {}, kUp, 10);
        w.contacts[0].across = {0, 0, kGap};
        ContactSolveOptions options = accurate();
        options.isa = isa;
        const Vec3 before = w.angular_momentum();
        w.solve(options);
        EXPECT_LE(length(w.angular_momentum() - before - cross(w.contacts[0].across, w.impulses[0])), 1e-15);
        // They stick: 1/W = m / (2 (1 + m r^2 / I)) = m / 6 of the slip, and half of the approach.
        const double stops = 1e-3 * kMass / 6;
        EXPECT_NEAR(w.impulses[0].y, -stops, 1e-12);
        EXPECT_NEAR(w.impulses[0].z, 0.05 * kMass, 1e-12);
        EXPECT_NEAR(w.angular_velocity[0].x, -stops * kRadius / kInertia, 1e-9);
        EXPECT_NEAR(w.angular_velocity[1].x, -stops * kRadius / kInertia, 1e-9);
        EXPECT_NEAR(w.velocity_at(1, {0, 0, kGap}).y, w.velocity_at(0, {}).y, 1e-12);
    }
}

} // namespace
} // namespace flotilla
