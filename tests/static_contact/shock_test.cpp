// SPDX-License-Identifier: MIT
#include <algorithm>

#include <gtest/gtest.h>

#include "static_contact/contact_systems.hpp"

namespace flotilla {
namespace {

/// m/s, along the normal: what contacts that all hold are off their target 0.
double fastest_contact(const ContactWorld& w) {
    double fastest = 0;
    for (const Contact& c : w.contacts)
        fastest = std::max(fastest, std::abs(dot(w.velocity_at(c.b, c.point) - w.velocity_at(c.a, c.point), c.normal)));
    return fastest;
}

TEST(Shock, SettlesAColumnThatGaussSeidelCannot) {
    ContactWorld w = make_column(100, 0.4);
    ContactWorld pgs = w;
    const ContactSolveOptions options{.iterations = 20, .tolerance = 1e-9};
    ContactSolveOptions without = options;
    without.shock = false;
    const ContactSolveStats stats = w.solve(options);
    const ContactSolveStats stats_pgs = pgs.solve(without);
    EXPECT_EQ(stats.shocked_islands, 1);
    EXPECT_GT(stats_pgs.residual, 0.01);
    EXPECT_EQ(stats.unsolved_islands, 1) << "a shock is no solution";
    EXPECT_NEAR(stats.residual, fastest_contact(w), 1e-15) << "of the state that it left";
    EXPECT_NEAR(stats_pgs.residual, fastest_contact(pgs), 1e-15);
    EXPECT_EQ(w.impulses, pgs.impulses);
    for (std::size_t i = 1; i < w.velocity.size(); ++i) EXPECT_NEAR(w.velocity[i].z, 0, 1e-8) << i;
    EXPECT_LT(pgs.velocity[50].z, -0.1);
    EXPECT_EQ(w.scratch.shocked, ([] {
                  std::vector<std::uint8_t> all(101, 1);
                  all[0] = 0;
                  return all;
              }()));
}

TEST(Shock, IsUndoneWhereALevelHasNoSolution) {
    ContactWorld w = make_body_between_walls(false);
    ContactWorld pgs = w;
    ContactWorld moving = w;
    ContactSolveOptions options{.patience = 50, .rest_speed = 0.4};
    EXPECT_EQ(w.solve(options).shocked_islands, 0);
    moving.velocity[1] = {0, 0.5, 0};
    EXPECT_EQ(moving.solve(options).shocked_islands, 1);
    options.shock = false;
    (void)pgs.solve(options);
    EXPECT_EQ(w.velocity, pgs.velocity);
    EXPECT_EQ(w.impulses, pgs.impulses);
}

TEST(Shock, StandsAtRestWhereItSolvesEveryLevel) {
    ContactWorld w = make_column(100, 0.4);
    EXPECT_EQ(w.solve({.iterations = 20, .tolerance = 1e-9, .rest_speed = 0.8}).shocked_islands, 1);
    for (std::size_t i = 1; i < w.velocity.size(); ++i) EXPECT_NEAR(w.velocity[i].z, 0, 1e-8) << i;
}

TEST(Shock, InMotionIsAChoice) {
    const auto shocked = [](double rest_speed, bool in_motion) {
        ContactWorld w = make_column(100, 0.4);
        return w.solve({.iterations = 20, .tolerance = 1e-9, .rest_speed = rest_speed, .shock_in_motion = in_motion})
            .shocked_islands;
    };
    EXPECT_EQ(shocked(0.3, true), 1);
    EXPECT_EQ(shocked(0.3, false), 0);
    EXPECT_EQ(shocked(0.8, false), 1) << "at rest";
}

TEST(Shock, NeedsTheGround) {
    ContactWorld w = make_column(30, 0.4);
    w.inv_mass[0] = 1; // nothing prescribed any more
    w.velocity[0] = {0, 0, 0.4};
    const Vec3 before = w.momentum();
    const ContactSolveStats stats = w.solve({.iterations = 3, .tolerance = 1e-9});
    EXPECT_EQ(stats.shocked_islands, 0);
    EXPECT_EQ(std::count(w.scratch.shocked.begin(), w.scratch.shocked.end(), 1), 0);
    EXPECT_NEAR(w.momentum().z, before.z, 1e-13);
}

} // namespace
} // namespace flotilla
