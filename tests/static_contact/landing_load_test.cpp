// SPDX-License-Identifier: MIT
// What two corners of a body that rolls are given of its load.
#include "static_contact/landing_load.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/stage_world.hpp"

namespace flotilla {
namespace {

using scenario::add_body;
using scenario::add_shape;

constexpr double kShare = 0.25, kMass = 8, kSeconds = 0.02, kGravity = 9.8;
constexpr std::int32_t kGround = 0, kBox = 1;

/// A box of 2 m, its weight on the ground: one corner carries for a quarter of the step, the other one lands then.
struct Rolling {
    test::StageWorld world{[] {
        SceneDescription s;
        s.gravity = {0, 0, -kGravity};
        add_body(s, add_shape(s, make_plate(4, 4)), BodyType::fixed, {}, 0.5, 0);
        add_body(s, add_shape(s, make_box(2, 2, 2), kMass), BodyType::dynamic, {0, 0, 1}, 0.5, 0);
        return s;
    }()};
    ContactTargets targets;
    VelocityArrays bodies;
    std::vector<Vec3> impulses;
    LandingLoads landing;

    explicit Rolling(const Vec3& carried) : impulses{carried, {}} {
        for (const double x : {-1.0, 1.0}) {
            targets.contacts.push_back(
                {.a = kGround, .b = kBox, .point = {x, 0, 0}, .normal = {0, 0, 1}, .friction = 0.5});
            targets.arcs.push_back({.carries = x < 0 ? kShare : kShare - 1});
            targets.carries.push_back(1);
        }
        bodies.load(nullptr, world.model(), 0, world.state().pose, world.state().motion);
        give_landing_loads(world.model(), targets, kSeconds, impulses, bodies, landing);
    }
};

TEST(LandingLoad, TheCornerThatCarriesHasItsShareOfTheWeightAndOfItsFriction) {
    const Rolling rolling({0.3, 0, 3});
    const double weight = kMass * kGravity * kSeconds;
    ASSERT_EQ(rolling.landing.contacts, std::vector<std::size_t>{0});
    EXPECT_NEAR(rolling.landing.impulses[0].z, kShare * weight, 1e-12);
    EXPECT_NEAR(rolling.landing.impulses[0].x, 0.1 * kShare * weight, 1e-12) << "as the corner's was";
    EXPECT_NEAR(rolling.impulses[0].z, 3 - kShare * weight, 1e-12) << "the solve starts with the rest";
    EXPECT_NEAR(rolling.bodies.velocity[kBox].z, kShare * weight / kMass, 1e-12)
        << "the other one is found by the solve";
}

// What piles leave of an impulse may be so small that its inverse is no number: an arch that had fallen had velocities
// that were none from there.
TEST(LandingLoad, AnImpulseOfNextToNothingGivesNothing) {
    for (const double least : {std::numeric_limits<double>::denorm_min(), 1e-310}) {
        const Rolling rolling({0, 0, least});
        EXPECT_TRUE(rolling.landing.contacts.empty());
        EXPECT_EQ(rolling.impulses[0].z, least);
        EXPECT_EQ(rolling.bodies.velocity[kBox], Vec3{});
    }
    const Rolling small({1e-302, 0, 1e-300});
    EXPECT_TRUE(std::isfinite(length(small.bodies.velocity[kBox])));
    EXPECT_TRUE(std::isfinite(length(small.impulses[0])));
}

} // namespace
} // namespace flotilla
