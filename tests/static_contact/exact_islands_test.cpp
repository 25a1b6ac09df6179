// SPDX-License-Identifier: MIT
// Small islands that sweeps leave unsolved are solved exactly, and only those.
#include "static_contact/exact_islands.hpp"

#include <gtest/gtest.h>

#include <random>
#include <utility>

#include "static_contact/contact_systems.hpp"

namespace flotilla {
namespace {

ContactSolveOptions exact_at(double tolerance) {
    return {.iterations = 20, .tolerance = tolerance, .exact = true, .shock = false};
}

/// n unit masses and a thousand on top of them.
ContactWorld make_loaded_column(int n) {
    ContactWorld w = make_column(n + 1, 0.4);
    w.inv_mass.back() = 1e-3;
    return w;
}

/// The largest violation of the law (without friction) by the velocities.
double violation(const ContactWorld& w) {
    double worst = 0;
    for (std::size_t k = 0; k < w.contacts.size(); ++k) {
        const Contact& c = w.contacts[k];
        const double u = dot(c.normal, w.velocity_at(c.b, c.point) - w.velocity_at(c.a, c.point)) - c.target;
        worst = std::max(worst, w.impulses[k].z > 0 ? std::abs(u) : -u);
    }
    return worst;
}

TEST(ExactIslands, AHeavyBodyOnLightOnesIsCarried) {
    constexpr int kLight = 8;
    constexpr double kTolerance = 1e-4;
    ContactWorld w = make_loaded_column(kLight), swept = w;
    ContactSolveOptions options = exact_at(kTolerance);
    const ContactSolveStats stats = w.solve(options);
    options.exact = false;
    const ContactSolveStats without = swept.solve(options);
    EXPECT_EQ(without.unsolved_islands, 1);
    EXPECT_EQ(without.exact_islands, 0);
    EXPECT_GT(violation(swept), 100 * kTolerance);
    EXPECT_EQ(stats.exact_islands, 1);
    EXPECT_EQ(stats.unsolved_islands, 0);
    EXPECT_LE(stats.residual, kExactShare * kTolerance);
    EXPECT_LE(violation(w), 2 * kExactShare * kTolerance);
    for (int k = 0; k <= kLight; ++k)
        EXPECT_NEAR(w.impulses[static_cast<std::size_t>(k)].z / ((1000 + kLight - k) * 0.4), 1, 1e-6);
    EXPECT_EQ(w.scratch.unsolved, std::vector<std::uint8_t>(w.position.size()));
    std::vector<std::uint8_t> all(w.position.size(), 1);
    all[0] = 0; // the ground
    EXPECT_EQ(swept.scratch.unsolved, all);
}

// A body held all round, to be let go by every contact at once: there is no solution, and what comes nearest to one are
// impulses that balance each other, 1e12 times what would stop the bodies, whose rounding is momentum.
TEST(ExactIslands, ImpulsesThatBalanceEachOtherAreRefused) {
    int exact = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
        std::mt19937 generator(seed);
        const auto number = [&] { return static_cast<double>(generator()) * 0x1p-31 - 1; };
        const auto vector = [&] {
            const double x = number(), y = number(), z = number();
            return Vec3{x, y, z};
        };
        ContactWorld w;
        const std::int32_t shell = w.add_body(2, {1, 1, 1}), core = w.add_body(1, {0.1, 0.1, 0.1});
        for (const std::int32_t body : {shell, core}) {
            w.velocity[static_cast<std::size_t>(body)] = vector();
            w.angular_velocity[static_cast<std::size_t>(body)] = vector();
        }
        for (int k = 0; k < 6; ++k) {
            const Vec3 out = vector(), point = 0.5 / length(out) * out, normal = 0.3 * vector() - 2 * point;
            w.add_contact(shell, core, point, 1 / length(normal) * normal, 1, number());
        }
        const Vec3 before = w.momentum();
        exact += w.solve(exact_at(1e-4)).exact_islands;
        EXPECT_LT(length(w.momentum() - before), 1e-8) << seed;
    }
    EXPECT_GT(exact, 0);
}

TEST(ExactIslands, WithFrictionVelocitiesAreThoseOfTheImpulses) {
    int exact = 0; // in some of them the sweeps get as far
    for (unsigned seed = 0; seed < 10; ++seed) {
        ContactWorld w = make_random(seed, 12, 12, 0.1, seed % 2 == 0);
        const std::vector<Vec3> before = w.velocity, turning = w.angular_velocity;
        const double energy = w.kinetic_energy();
        const ContactSolveStats stats = w.solve(exact_at(1e-6));
        exact += stats.exact_islands;
        EXPECT_EQ(stats.unsolved_islands, 0) << seed << ' ' << stats.residual;
        EXPECT_LE(w.kinetic_energy(), energy);
        std::vector<Vec3> velocity = before, angular = turning;
        for (std::size_t k = 0; k < w.contacts.size(); ++k) {
            const Contact& c = w.contacts[k];
            for (const auto& [body, l] : {std::pair{c.a, -w.impulses[k]}, {c.b, w.impulses[k]}}) {
                const auto i = static_cast<std::size_t>(body);
                if (w.inv_mass[i] == 0) continue;
                velocity[i] += w.inv_mass[i] * l;
                angular[i] += w.inv_inertia[i] * cross(c.point - w.position[i], l);
            }
        }
        for (std::size_t i = 0; i < velocity.size(); ++i) {
            EXPECT_LT(length(w.velocity[i] - velocity[i]), 1e-12 * (1 + length(velocity[i])));
            EXPECT_LT(length(w.angular_velocity[i] - angular[i]), 1e-12 * (1 + length(angular[i])));
        }
    }
    EXPECT_GE(exact, 5);
}

TEST(ExactIslands, WhatSweepsSolveIsLeftToThem) {
    ContactWorld w;
    w.add_body(0);
    w.add_body(1);
    w.velocity[1] = {0.1, 0, -1};
    w.add_contact(0, 1, {}, kUp, 0.5);
    const ContactSolveStats stats = w.solve(exact_at(1e-6));
    EXPECT_EQ(stats.exact_islands, 0);
    EXPECT_EQ(stats.unsolved_islands, 0);
}

// Under 1e9 masses the rounding of a contact is far above the tolerance. Sweeps that go on from the solution end within
// that too, some of them nearer by what they measure.
TEST(ExactIslands, WhatOnlyRoundingLeavesIsSolved) {
    ContactWorld w = make_column(9, 0.4);
    w.inv_mass.back() = 1e-9;
    const ContactWorld before = w;
    const ContactSolveOptions options = exact_at(1e-12);
    for (int step = 0; step < 20; ++step) {
        w.velocity = before.velocity;
        w.angular_velocity = before.angular_velocity;
        const ContactSolveStats stats = w.solve(options);
        EXPECT_EQ(stats.unsolved_islands, 0) << step << ' ' << stats.residual;
    }
}

TEST(ExactIslands, AtSpeedWhatRoundingMayLeaveIsSolved) {
    constexpr double kTolerance = 1e-12, kSpeed = 300;
    ContactWorld w = make_column(2, 0.4);
    w.inv_mass.back() = 3; // sweeps get on fast
    for (const std::size_t body : {1u, 2u}) w.velocity[body].x = kSpeed;
    ContactSolveOptions options = exact_at(kTolerance);
    options.momentum = false; // it would pass by
    const ContactSolveStats stats = w.solve(options);
    EXPECT_GT(stats.residual, kTolerance) << "or this test shows nothing";
    EXPECT_LT(stats.residual, 1.01 * kOfSpeed * kSpeed);
    EXPECT_EQ(stats.exact_islands, 0);
    EXPECT_EQ(stats.unsolved_islands, 0);
}

TEST(ExactIslands, ThePyramidIsLeftToTheSweeps) {
    ContactWorld w = make_loaded_column(8), swept = w;
    ContactSolveOptions options = exact_at(1e-4);
    options.tangents = Tangents::random;
    EXPECT_EQ(w.solve(options).exact_islands, 0);
    options.exact = false;
    EXPECT_EQ(swept.solve(options).unsolved_islands, 1);
    EXPECT_EQ(w.velocity, swept.velocity);
    EXPECT_EQ(w.impulses, swept.impulses);
}

TEST(ExactIslands, IslandsWithMoreContactsAreLeftToTheSweeps) {
    for (const int contacts : {256, 257}) {
        ContactWorld w = make_column(contacts, 1), swept = w; // falls, so it does not rest
        ContactSolveOptions options = exact_at(1e-4);
        const ContactSolveStats stats = w.solve(options);
        EXPECT_EQ(stats.exact_islands, contacts <= 256 ? 1 : 0);
        EXPECT_EQ(stats.unsolved_islands, contacts <= 256 ? 0 : 1);
        options.exact = false;
        (void)swept.solve(options);
        EXPECT_EQ(w.velocity == swept.velocity, contacts > 256);
    }
}

TEST(ExactIslands, OnlyFewBodiesAreSolvedSoWhereThatIsAsked) {
    for (const int light : {7, 8}) {
        ContactWorld few = make_loaded_column(light), other = few;
        ContactSolveOptions options = exact_at(1e-4);
        options.exact_few = true;
        const ContactSolveStats stats = few.solve(options);
        options.exact_few = false;
        options.exact = light + 1 <= options.tuning.bodies_factorised_soon;
        EXPECT_EQ(stats.exact_islands, other.solve(options).exact_islands);
        EXPECT_EQ(stats.exact_islands, options.exact ? 1 : 0);
        EXPECT_EQ(few.velocity, other.velocity);
        EXPECT_EQ(few.impulses, other.impulses);
    }
}

TEST(ExactIslands, AColumnAtRestIsSolvedHoweverManyContactsItHas) {
    ContactWorld w = make_column(300, 0.4);
    ContactSolveOptions options = exact_at(10); // the sweeps are content with anything
    options.rest_speed = 10;
    const ContactSolveStats stats = w.solve(options);
    EXPECT_EQ(stats.exact_islands, 1);
    EXPECT_EQ(stats.unsolved_islands, 0);
    EXPECT_LE(violation(w), 2 * kExactShare * 10);
}

// Boxes that fill a crate stand in columns, and are beside one another.
TEST(ExactIslands, NothingIsSlenderThatTouchesAllRound) {
    ContactScratch::Island column;
    column.end_body = 12, column.active_pairs = column.end = 12;
    EXPECT_TRUE(is_slender(column));
    ContactScratch::Island row = column; // each beside the next
    row.end = 23;
    EXPECT_TRUE(is_slender(row));
    ContactScratch::Island crate = column; // beside the next, and walls
    crate.end = 35;
    EXPECT_FALSE(is_slender(crate));
}

// A heavy box on twenty light ones, which the sweeps leave far from solved.
TEST(ExactIslands, WhereFewAreAskedForAColumnAtRestGetsNewtonsSteps) {
    ContactWorld w = make_loaded_column(20), swept = w;
    ContactSolveOptions options = exact_at(1e-4);
    options.exact_few = true;
    EXPECT_EQ(w.solve(options).exact_islands, 0);
    options.rest_speed = 100;
    const ContactSolveStats stats = swept.solve(options);
    EXPECT_EQ(stats.exact_islands, 1);
    EXPECT_LE(violation(swept), violation(w));
}

TEST(ExactIslands, AnIslandIsSolvedToTheLeastToleranceOfItsContacts) {
    ContactWorld w = make_loaded_column(8), first = w;
    w.contacts[3].tolerance = 1e-8;
    EXPECT_LE(w.solve(exact_at(1e-2)).residual, kExactShare * 1e-8 + 1e-12);
    EXPECT_DOUBLE_EQ(w.scratch.islands[0].tolerance, 1e-8);
    (void)first.solve(exact_at(1e-2));
    EXPECT_DOUBLE_EQ(first.scratch.islands[0].tolerance, 1e-2);
}

// 1e9 kg on eight bodies of 1 kg: what they carry is known to 1e-7 m/s of them. That is a tolerance's end where it was
// asked for, and the solve begins with the loads of the last.
TEST(ExactIslands, NoToleranceIsBelowTheRoundingOfLoads) {
    constexpr double kLoad = 1e9 * 0.4, kMass = 2; // N s, and 1/kg: W of two bodies of 1 kg
    constexpr double kTolerance = 1e-12;
    const auto solved_again = [&](double of_load, int patience) {
        ContactWorld w = make_column(9, 0.4);
        w.inv_mass.back() = 1e-9;
        ContactSolveOptions options = exact_at(kTolerance);
        options.tuning.of_load = of_load;
        options.patience = patience;
        (void)w.solve(options);
        EXPECT_DOUBLE_EQ(w.scratch.islands[0].tolerance, kTolerance);
        w.velocity = make_column(9, 0.41).velocity;
        const ContactSolveStats stats = w.solve(options);
        return std::pair(w.scratch.islands[0].tolerance, stats);
    };
    const double of_load = ContactTuning{}.of_load;
    const auto [raised, stats] = solved_again(of_load, 0);
    EXPECT_NEAR(raised, of_load * kLoad * kMass, 1e-4 * raised);
    EXPECT_EQ(stats.unsolved_islands, 0);
    EXPECT_GT(stats.residual, kTolerance);
    EXPECT_LT(stats.residual, raised);
    EXPECT_EQ(solved_again(0, 0).first, kTolerance);
    EXPECT_EQ(solved_again(of_load, 50).first, kTolerance); // not asked for
}

// A light body beside such a column, which its floor pushes up against the heavy one's underside. That contact carries
// nothing, is parked by the tolerance that was asked for, and must not be believed to hold by the raised one.
TEST(ExactIslands, WhatIsParkedIsSeenBesideHeavyLoads) {
    ContactWorld w = make_column(8, 0.4);
    w.inv_mass.back() = 1e-9;
    const std::int32_t heavy = 8, light = w.add_body(1, {}, {2, 0, 1});
    w.velocity.back() = {0, 0, -0.4};
    w.add_contact(0, light, {2, 0, 0.5}, kUp, 0);
    w.add_contact(heavy, light, {2, 0, 1.5}, -kUp, 0, -1e3);
    ContactSolveOptions options = exact_at(1e-12);
    options.iterations = 10000;
    (void)w.solve(options);
    for (int body = 1; body <= light; ++body) w.velocity[static_cast<std::size_t>(body)] = {0, 0, -0.4};
    w.contacts[8].target = 5e-5;
    w.contacts[9].target = -1e-6;
    const ContactSolveStats stats = w.solve(options);
    const auto speed = [&](std::int32_t body) { return w.velocity[static_cast<std::size_t>(body)].z; };
    EXPECT_LT(speed(light) - speed(heavy), 1e-5); // 5e-5 where nobody looks
    EXPECT_GE(stats.residual, speed(light) - speed(heavy) - 1e-6);
}

TEST(ExactIslands, ThreadsAndOtherIslandsChangeNoBit) {
    const ContactWorld start = make_random(4, 48, 6, 0.4, true);
    ContactWorld alone = start;
    const ContactSolveStats expected = alone.solve(exact_at(1e-9));
    EXPECT_GE(expected.exact_islands, 3);
    for (const int threads : {2, 3}) {
        Team team({threads});
        ContactWorld w = start;
        ContactSolveOptions options = exact_at(1e-9);
        options.team = &team;
        EXPECT_EQ(w.solve(options).exact_islands, expected.exact_islands);
        EXPECT_EQ(w.velocity, alone.velocity);
        EXPECT_EQ(w.impulses, alone.impulses);
    }
}

} // namespace
} // namespace flotilla
