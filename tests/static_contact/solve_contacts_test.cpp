// SPDX-License-Identifier: MIT
#include "static_contact/solve_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "static_contact/assemble.hpp"
#include "static_contact/contact_systems.hpp"
#include "static_contact/tangents.hpp"

namespace flotilla {
namespace {

// --- one contact ---

TEST(SolveContacts, LeavesASeparatingContactAlone) {
    ContactWorld w;
    w.add_body(0);
    w.add_body(2);
    w.velocity[1] = {1, 2, 0.5};
    w.add_contact(0, 1, {}, kUp, 0.5);
    const ContactSolveStats stats = w.solve(accurate());
    EXPECT_EQ(w.velocity[1], (Vec3{1, 2, 0.5}));
    EXPECT_EQ(w.impulses[0], Vec3{});
    EXPECT_EQ(stats.iterations, 1);
    EXPECT_EQ(stats.residual, 0);
}

TEST(SolveContacts, ReachesTheTargetVelocity) {
    for (const double target : {-0.2, 0.0, 0.24}) {
        ContactWorld w;
        w.add_body(0);
        w.add_body(2);
        w.velocity[1] = {0, 0, -1};
        w.add_contact(0, 1, {}, kUp, 0, target);
        w.solve(accurate());
        EXPECT_NEAR(w.velocity[1].z, target, 1e-15);
        EXPECT_NEAR(w.impulses[0].z, 2 * (1 + target), 1e-14); // m dv
    }
}

TEST(SolveContacts, SticksOrSlidesAsCoulombSays) {
    for (const double angle : {0.0, 0.3, 1.0, 2.5})
        for (const double slip : {0.49, 0.51}) { // against mu |v_n| = 0.5
            ContactWorld w;
            w.add_body(0);
            w.add_body(2);
            w.velocity[1] = {slip * std::cos(angle), slip * std::sin(angle), -1};
            w.add_contact(0, 1, {}, kUp, 0.5);
            w.solve(accurate());
            const double left = std::max(0.0, slip - 0.5);
            EXPECT_NEAR(w.velocity[1].x, left * std::cos(angle), 1e-14);
            EXPECT_NEAR(w.velocity[1].y, left * std::sin(angle), 1e-14);
            EXPECT_NEAR(w.velocity[1].z, 0, 1e-15);
        }
}

TEST(SolveContacts, EqualMassesShareTheApproachVelocity) {
    ContactWorld w;
    w.add_body(3);
    w.add_body(3, {}, {0, 0, 1});
    w.velocity[1] = {0, 0, -1};
    w.add_contact(0, 1, {0, 0, 0.5}, kUp);
    w.solve(accurate());
    EXPECT_NEAR(w.velocity[0].z, -0.5, 1e-15);
    EXPECT_NEAR(w.velocity[1].z, -0.5, 1e-15);
}

TEST(SolveContacts, ARodStruckAtItsEndTurns) {
    // Free rod, mass m, inertia I, contact at distance r: W = 1/m + r^2/I.
    ContactWorld w;
    w.add_body(0);
    w.add_body(2, {0.5, 0.5, 0.5}, {0, 0, 0});
    w.velocity[1] = {0, 0, -1};
    w.add_contact(0, 1, {0.7, 0, 0}, kUp);
    w.solve(accurate());
    const double lambda = 1 / (1 / 2.0 + 0.7 * 0.7 / 0.5);
    EXPECT_NEAR(w.impulses[0].z, lambda, 1e-15);
    EXPECT_NEAR(w.velocity[1].z, -1 + lambda / 2, 1e-15);
    EXPECT_NEAR(w.angular_velocity[1].y, -0.7 * lambda / 0.5, 1e-15);
    EXPECT_NEAR(w.velocity_at(1, {0.7, 0, 0}).z, 0, 1e-15);
}

TEST(SolveContacts, PrescribedVelocitiesAreReadAndNeverWritten) {
    ContactWorld w;
    w.add_body(0); // an elevator, turning
    w.add_body(1, {1, 1, 1}, {0, 0, 1});
    w.add_body(0, {}, {0, 0, 2});
    w.velocity[0] = {-0.0, 0, 2};
    w.angular_velocity[0] = {0, 0, 3};
    w.add_contact(0, 1, {0.1, 0, 0.5}, kUp, 0.3);
    w.add_contact(0, 2, {0, 0, 1}, kUp, 0.3); // two prescribed bodies: ignored
    w.impulses[1] = {1, 2, 3};
    w.solve(accurate());
    EXPECT_EQ(w.velocity[0], (Vec3{-0.0, 0, 2}));
    EXPECT_TRUE(std::signbit(w.velocity[0].x));
    EXPECT_EQ(w.angular_velocity[0], (Vec3{0, 0, 3}));
    EXPECT_EQ(w.velocity[2], Vec3{});
    EXPECT_EQ(w.impulses[1], Vec3{});
    EXPECT_NEAR(w.velocity_at(1, {0.1, 0, 0.5}).z, 2, 1e-12);
}

// --- friction ---

// A box on a plane through the origin, gravity leaning by `angle` towards `heading` in the plane. One corner contact
// each.
ContactWorld make_sliding_box(double friction) {
    ContactWorld w;
    w.add_body(0);
    w.add_body(3, {0.5, 0.7, 0.8}, {0, 0, 0.4});
    for (const double x : {-0.5, 0.5})
        for (const double y : {-0.6, 0.6}) w.add_contact(0, 1, {x, y, 0}, kUp, friction);
    return w;
}

Vec3 leaning_gravity(double angle, double heading) {
    return 9.8 * Vec3{std::sin(angle) * std::cos(heading), std::sin(angle) * std::sin(heading), -std::cos(angle)};
}

void run_steps(ContactWorld& w, const Vec3& gravity, int steps, ContactSolveOptions options) {
    for (int i = 0; i < steps; ++i) {
        options.step = static_cast<std::uint64_t>(i);
        w.velocity[1] += (1.0 / 24) * gravity;
        w.solve(options);
    }
}

TEST(Incline, HoldsJustAboveTheThresholdInEveryDirection) {
    for (const double angle : {0.1, 0.3, 0.6})
        for (const double heading : {0.0, 0.2, 0.8, 2.0, 4.0}) {
            ContactWorld w = make_sliding_box(1.01 * std::tan(angle));
            run_steps(w, leaning_gravity(angle, heading), 24, accurate());
            EXPECT_LT(length(w.velocity[1]), 1e-9) << angle << ' ' << heading;
            EXPECT_LT(length(w.angular_velocity[1]), 1e-9) << angle << ' ' << heading;
        }
}

TEST(Incline, SlidesJustBelowTheThresholdAtTheAccelerationOfCoulomb) {
    for (const double angle : {0.1, 0.3, 0.6})
        for (const double ratio : {0.5, 0.99})
            for (const double heading : {0.0, 0.2, 0.8, 2.0, 4.0}) {
                const double mu = ratio * std::tan(angle);
                ContactWorld w = make_sliding_box(mu);
                run_steps(w, leaning_gravity(angle, heading), 24, accurate());
                const Vec3 downhill{std::cos(heading), std::sin(heading), 0};
                const double expected = 9.8 * (std::sin(angle) - mu * std::cos(angle)); // after 1 s
                EXPECT_NEAR(dot(w.velocity[1], downhill) / expected, 1, 1e-6)
                    << angle << ' ' << ratio << ' ' << heading;
                EXPECT_LT(length(w.velocity[1] - dot(w.velocity[1], downhill) * downhill), 1e-6 * expected);
            }
}

TEST(Friction, OfTheRandomPyramidIsTooLargeByFourOverPi) {
    // Both rows saturate, |cos| + |sin| of a uniform angle has the mean 4/pi.
    ContactWorld w;
    w.add_body(0);
    w.add_body(1);
    w.add_contact(0, 1, {}, kUp, 0.1);
    double sum = 0, least = 10, most = 0;
    const int steps = 20000;
    for (int i = 0; i < steps; ++i) {
        w.velocity[1] = {5, 0, -1};
        w.solve({.warm_start = false, .tangents = Tangents::random, .step = static_cast<std::uint64_t>(i)});
        const double friction = (5 - w.velocity[1].x) / 0.1; // of mu lambda_n
        sum += friction;
        least = std::min(least, friction);
        most = std::max(most, friction);
    }
    EXPECT_NEAR(sum / steps, 4 / std::numbers::pi, 0.003);
    EXPECT_NEAR(least, 1, 1e-3);
    EXPECT_NEAR(most, std::numbers::sqrt2, 1e-3);
}

TEST(Friction, AContactThatSticksKeepsItsTangents) {
    const auto left = [](bool sticks, std::uint64_t step) {
        ContactWorld w;
        w.add_body(0);
        w.add_body(1);
        w.add_contact(0, 1, {}, kUp, 0.1);
        w.contacts.back().sticks = sticks;
        w.velocity[1] = {5, 0, -1};
        w.solve({.warm_start = false, .tangents = Tangents::random, .step = step});
        return w.velocity[1];
    };
    for (std::uint64_t step = 1; step < 20; ++step) {
        EXPECT_EQ(left(true, step), left(true, 0));
        EXPECT_FALSE(left(false, step) == left(false, 0));
    }
}

TEST(Friction, TangentsDependOnKeyAndStepOnly) {
    const Contact c{.a = 3, .b = 8, .point = {}, .normal = normalized(Vec3{1, -2, 0.5}), .feature_key = 77};
    const TangentPair t = keyed_tangents(c, 1, 2);
    EXPECT_NEAR(length(t.t1), 1, 1e-15);
    EXPECT_NEAR(length(t.t2), 1, 1e-15);
    EXPECT_NEAR(length(cross(t.t1, t.t2) - c.normal), 0, 1e-15);
    Contact moved = c;
    moved.point = {1, 2, 3};
    moved.friction = 4;
    EXPECT_EQ(keyed_tangents(moved, 1, 2).t1, t.t1);
    EXPECT_FALSE(keyed_tangents(c, 1, 3).t1 == t.t1);
    EXPECT_FALSE(keyed_tangents(c, 2, 2).t1 == t.t1);
    moved.feature_key = 78;
    EXPECT_FALSE(keyed_tangents(moved, 1, 2).t1 == t.t1);
    for (const Vec3& n : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, -0.0}}) {
        moved.normal = n;
        EXPECT_NEAR(dot(keyed_tangents(moved, 0, 0).t1, n), 0, 1e-16);
    }
}

// --- columns: the convergence law of Gauss-Seidel ---

TEST(SolveContacts, AColumnCarriesTheWeightAbove) {
    const int n = 12;
    const double m = 3, g = 9.8, dt = 1.0 / 24;
    ContactWorld w = make_column(n, g * dt, m);
    const ContactSolveStats stats = w.solve(accurate());
    EXPECT_LE(stats.residual, 1e-12);
    EXPECT_EQ(stats.colors, 2);
    EXPECT_EQ(stats.islands, 1);
    for (int k = 0; k < n; ++k)
        EXPECT_NEAR(w.impulses[static_cast<std::size_t>(k)].z / ((n - k) * m * g * dt), 1, 1e-9);
}

TEST(SolveContacts, AWarmStartFromTheSolutionNeedsOneSweep) {
    for (const Tangents tangents : {Tangents::random, Tangents::cone}) {
        ContactWorld w = make_column(12, 0.4, 3);
        for (Contact& c : w.contacts) c.friction = 0.5;
        for (Vec3& v : w.velocity) v.x = v.z / 8;
        const std::vector<Vec3> free = w.velocity;
        ContactSolveOptions options = accurate();
        options.tangents = tangents;
        options.momentum = false;
        options.tolerance = 1e-10;
        EXPECT_GT(w.solve(options).iterations, 100);
        w.velocity = free;
        options.step = 1; // other tangents
        options.tolerance = 1e-9;
        EXPECT_EQ(w.solve(options).iterations, 1);
        w.velocity = free;
        options.warm_start = false;
        EXPECT_GT(w.solve(options).iterations, 100);
    }
}

TEST(SolveContacts, AWarmStartThatAddsEnergyIsTakenBack) {
    ContactWorld w = make_column(12, 0.4, 3), cold = w;
    const ContactSolveOptions options{.iterations = 3, .tolerance = 1e-9, .shock = false};
    for (Vec3& impulse : w.impulses) impulse = {0, 0, 100};
    const double before = w.kinetic_energy();
    const ContactSolveStats stats = w.solve(options);
    (void)cold.solve(options);
    EXPECT_EQ(stats.cold_islands, 1);
    EXPECT_LE(w.kinetic_energy(), before);
    EXPECT_EQ(w.velocity, cold.velocity);
    EXPECT_EQ(w.impulses, cold.impulses);
}

// --- random piles ---

TEST(SolveContacts, KeepsTheMomentumOfAFreeSystem) {
    for (unsigned seed = 0; seed < 10; ++seed) {
        ContactWorld w = make_random(seed, 40, 40, 0.5, false);
        const Vec3 p = w.momentum(), l = w.angular_momentum();
        w.solve({.iterations = 50, .tangents = seed % 2 ? Tangents::cone : Tangents::random});
        EXPECT_LT(length(w.momentum() - p), 1e-12);
        EXPECT_LT(length(w.angular_momentum() - l), 1e-11);
    }
}

TEST(SolveContacts, NeverAddsEnergyWhereTargetsAreZero) {
    for (unsigned seed = 0; seed < 40; ++seed)
        for (const int sweeps : {1, 3, 30, 300}) {
            ContactWorld w = make_random(seed, 40, 10, 0.6, seed % 2 == 0);
            const double before = w.kinetic_energy();
            w.solve({.iterations = sweeps, .tangents = seed % 3 ? Tangents::cone : Tangents::random});
            EXPECT_LE(w.kinetic_energy(), before * (1 + 1e-14)) << seed << ' ' << sweeps;
        }
}

// Coulomb's law is not the minimum of a function: where friction is large, sweeps may grow without bound.
TEST(SolveContacts, SweepsThatGrowWithoutBoundEndWithNumbersAndAddNoEnergy) {
    int unsolved = 0;
    for (unsigned seed = 0; seed < 10; ++seed)
        for (const double friction : {10.0, 100.0, 1000.0})
            for (const int patience : {0, 50}) {
                ContactWorld w = make_random(seed, 20, 10, friction, seed % 2 == 0);
                const Vec3 ground = seed % 4 == 0 ? Vec3{0.1, 0.2, -0.3} : Vec3{}; // moved by a script
                const auto accelerate = [&](const Vec3& by) {
                    for (Vec3& v : w.velocity) v += by;
                };
                const double before = w.kinetic_energy();
                accelerate(ground);
                const ContactSolveStats stats =
                    w.solve({.iterations = 20000, .tolerance = 1e-9, .patience = patience, .shock = false});
                accelerate(-ground);
                unsolved += stats.residual > 1 ? 1 : 0;
                EXPECT_TRUE(std::isfinite(stats.residual)) << seed << ' ' << friction;
                EXPECT_LE(w.kinetic_energy(), before * (1 + 1e-12)) << seed << ' ' << friction;
                for (std::size_t k = 0; k < w.contacts.size(); ++k) {
                    const double ln = dot(w.impulses[k], w.contacts[k].normal);
                    EXPECT_GE(ln, 0);
                    EXPECT_LE(length(w.impulses[k] - ln * w.contacts[k].normal), friction * ln * (1 + 1e-12));
                }
            }
    EXPECT_GT(unsolved, 20); // or nothing is tested
}

TEST(SolveContacts, ASolvedStateObeysEveryRow) {
    for (unsigned seed = 0; seed < 6; ++seed) {
        ContactWorld w = make_random(seed, 30, 10, 0.4, true);
        const ContactSolveStats stats = w.solve(accurate());
        ASSERT_LE(stats.residual, 1e-12) << seed;
        for (std::size_t k = 0; k < w.contacts.size(); ++k) {
            const Contact& c = w.contacts[k];
            const Vec3 u = w.velocity_at(c.b, c.point) - w.velocity_at(c.a, c.point);
            const double un = dot(u, c.normal), ln = dot(w.impulses[k], c.normal);
            const Vec3 ut = u - un * c.normal, lt = w.impulses[k] - ln * c.normal;
            EXPECT_GE(un, -1e-10);
            EXPECT_GE(ln, -1e-15);
            EXPECT_LE(std::min(un, ln), 1e-9);
            EXPECT_LE(length(lt), c.friction * ln + 1e-12);
            if (length(ut) > 1e-6) { // slides: full friction against the slip
                EXPECT_NEAR(dot(lt, ut), -c.friction * ln * length(ut), 1e-9 * length(ut));
            }
        }
    }
}

TEST(SolveContacts, PacketsHaveFewIdleLanes) {
    ContactWorld w = make_random(7, 900, 900, 0.4, true); // pairs of one to four contacts, in many regions
    w.solve({.iterations = 1});
    const auto lanes = static_cast<double>(w.scratch.packed.rows.size() * kPacketLanes);
    EXPECT_GT(static_cast<double>(w.contacts.size()) / lanes, 0.8);
}

// --- no friction ---

/// Two bodies far away that touch with friction: then no contact of the world is solved as one without.
ContactWorld with_friction_elsewhere(ContactWorld w) {
    const auto a = w.add_body(1, {1, 1, 1}, {9e3, 0, 0}), b = w.add_body(1, {1, 1, 1}, {9e3, 0, 1});
    w.add_contact(a, b, {9e3, 0, 0.5}, kUp, 0.3);
    return w;
}

TEST(Frictionless, AContactIsOneRowWithTheResultsOfThree) {
    for (unsigned seed = 0; seed < 16; ++seed) {
        ContactWorld one = make_random(seed, 60, seed % 2 ? 60 : 7, 0, seed % 4 != 0);
        if (seed % 3 == 0) open_gaps(one);
        ContactWorld three = with_friction_elsewhere(one);
        ContactSolveOptions options{.iterations = seed < 8 ? 15 : 500, .tolerance = 1e-9, .rest_speed = 0.8};
        options.tangents = seed % 5 < 2 ? Tangents::cone : Tangents::random;
        for (int step = 0; step < 2; ++step) { // the second one from warm impulses
            const ContactSolveStats stats = one.solve(options), of_three = three.solve(options);
            EXPECT_EQ(stats.shocked_islands, of_three.shocked_islands);
            EXPECT_EQ(stats.residual, of_three.residual);
            for (std::size_t i = 0; i < one.velocity.size(); ++i) {
                EXPECT_EQ(one.velocity[i], three.velocity[i]) << seed << ' ' << i;
                EXPECT_EQ(one.angular_velocity[i], three.angular_velocity[i]) << seed << ' ' << i;
            }
            for (std::size_t k = 0; k < one.impulses.size(); ++k) EXPECT_EQ(one.impulses[k], three.impulses[k]);
        }
        const PackedContacts &packed = one.scratch.packed, &of_three = three.scratch.packed;
        EXPECT_TRUE(packed.rows.empty());
        EXPECT_EQ(packed.normal_rows.size() + 1, of_three.rows.size());
        EXPECT_TRUE(of_three.normal_rows.empty());
    }
}

// --- parked contacts ---

TEST(SolveContacts, AContactThatOthersCloseIsWoken) {
    ContactWorld w; // a moves against b, which would then cross its gap to c, at rest as well
    const auto a = w.add_body(1), b = w.add_body(1), c = w.add_body(1);
    w.velocity[static_cast<std::size_t>(a)] = {0, 0, 10};
    w.add_contact(a, b, {}, kUp);
    w.add_contact(b, c, {}, kUp, 0, -0.1);
    w.solve({.tolerance = 1e-9});
    EXPECT_EQ(w.scratch.parked, (std::vector<std::uint8_t>{0, 1}));
    const auto z = [&](std::int32_t body) { return w.velocity[static_cast<std::size_t>(body)].z; };
    EXPECT_NEAR(z(a), 10.1 / 3, 1e-8);
    EXPECT_NEAR(z(b), 10.1 / 3, 1e-8);
    EXPECT_NEAR(z(c), 10.1 / 3 - 0.1, 1e-8);
}

TEST(SolveContacts, AContactThatATurnClosesIsWoken) {
    // Two bodies turn b, whose mass keeps its centre where it is, until its end would cross the gap to c.
    ContactWorld w;
    const auto up = w.add_body(1), down = w.add_body(1), b = w.add_body(1e6, {0.5, 0.5, 0.5}), c = w.add_body(1);
    w.velocity[static_cast<std::size_t>(up)] = {0, 0, 10};
    w.velocity[static_cast<std::size_t>(down)] = {0, 0, -10};
    w.add_contact(up, b, {1, 0, 0}, kUp);
    w.add_contact(down, b, {-1, 0, 0}, -kUp);
    w.add_contact(b, c, {1, 0, 0}, kUp, 0, -0.1);
    EXPECT_LE(w.solve({.tolerance = 1e-9}).residual, 1e-9);
    EXPECT_EQ(w.scratch.parked, (std::vector<std::uint8_t>{0, 0, 1}));
    const auto z = [&](std::int32_t body) { return w.velocity_at(body, {1, 0, 0}).z; };
    EXPECT_GT(z(b), 1);
    EXPECT_NEAR(z(c) - z(b), -0.1, 1e-8);
}

TEST(SolveContacts, AParkedContactIsNotSwept) {
    ContactWorld w;
    w.add_body(0);
    for (int i = 0; i < 8; ++i) {
        const auto body = w.add_body(1);
        w.velocity.back() = {0, 0, -0.4};
        w.add_contact(0, body, {}, kUp, 0, i < 4 ? 0.0 : -1.0);
    }
    constexpr double kTolerance = 1e-3, kMargin = ContactTuning{}.parked_margin * kTolerance; // m/s
    const ContactSolveStats stats = w.solve({.iterations = 10, .tolerance = kTolerance});
    EXPECT_EQ(stats.visits, 4 * stats.iterations);
    for (std::size_t i = 1; i <= 8; ++i) EXPECT_EQ(w.velocity[i].z, i <= 4 ? 0 : -0.4);
    w.velocity[8].z = -1 + 1.01 * kMargin;
    EXPECT_EQ(w.solve({.iterations = 1, .tolerance = kTolerance}).visits, 4);
    w.velocity[8].z = -1 + 0.99 * kMargin; // near enough: no longer parked
    EXPECT_EQ(w.solve({.iterations = 1, .tolerance = kTolerance}).visits, 5);
    w.velocity[8].z = -1 + 0.99 * kMargin;
    w.contacts[7].tolerance = 0.5 * kTolerance; // a contact's own tolerance counts where it is less
    EXPECT_EQ(w.solve({.iterations = 1, .tolerance = kTolerance}).visits, 4);
}

TEST(SolveContacts, ParkedContactsAreObeyed) {
    std::int64_t parked = 0, woken = 0;
    for (unsigned seed = 0; seed < 40; ++seed) {
        ContactWorld w = make_random(seed, 60, 20, 0, true);
        open_gaps(w);
        ASSERT_LE(w.solve(accurate()).residual, 1e-12) << seed;
        for (const Contact& c : w.contacts)
            EXPECT_GE(dot(c.normal, w.velocity_at(c.b, c.point) - w.velocity_at(c.a, c.point)), c.target - 1e-11)
                << seed;
        for (const std::uint8_t p : w.scratch.parked) parked += p;
        for (const ContactPacket& p : w.scratch.packed.packets) woken += p.woken;
    }
    EXPECT_GT(parked, 100);
    EXPECT_GT(woken, 10);
}

TEST(SolveContacts, TheOrderOfTheInputChangesNoBit) {
    for (const Tangents tangents : {Tangents::random, Tangents::cone}) {
        ContactWorld sorted = make_random(5, 60, 12, 0.4, true), shuffled = sorted;
        std::vector<std::size_t> order(sorted.contacts.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::shuffle(order.begin(), order.end(), std::mt19937_64(1));
        for (std::size_t k = 0; k < order.size(); ++k) shuffled.contacts[k] = sorted.contacts[order[k]];
        for (int step = 0; step < 3; ++step) { // warm from the second on
            const ContactSolveOptions options{.iterations = 17, .tangents = tangents};
            sorted.solve(options);
            shuffled.solve(options);
            EXPECT_EQ(sorted.velocity, shuffled.velocity);
            EXPECT_EQ(sorted.angular_velocity, shuffled.angular_velocity);
            for (std::size_t k = 0; k < order.size(); ++k) EXPECT_EQ(shuffled.impulses[k], sorted.impulses[order[k]]);
        }
    }
}

/// Every body but each fourth, along one axis to all three.
void lock_some(ContactWorld& w) {
    for (std::size_t i = 0; i < w.locked.size(); ++i) {
        w.locked[i] = static_cast<AxisMask>(i % 4 == 0 ? 0 : 1 + 3 * i % 7);
        w.velocity[i] = free_part(w.locked[i], w.velocity[i]);
    }
}

TEST(SolveContacts, LockedAxesKeepTheirVelocityAndEnergyFalls) {
    for (unsigned seed = 0; seed < 12; ++seed)
        for (const bool exact : {false, true}) {
            ContactWorld w = make_random(seed, 60, seed % 2 ? 60 : 7, seed % 3 ? 0.4 : 0.0, true);
            lock_some(w);
            const double before = w.kinetic_energy();
            const ContactSolveStats stats = w.solve({.iterations = 400, .tolerance = 1e-9, .exact = exact});
            for (std::size_t i = 0; i < w.locked.size(); ++i) {
                EXPECT_EQ(w.velocity[i], free_part(w.locked[i], w.velocity[i])) << seed;
                EXPECT_TRUE(is_finite(w.velocity[i]) && is_finite(w.angular_velocity[i])) << seed;
            }
            EXPECT_LE(w.kinetic_energy(), before * (1 + 1e-12)) << seed;
            if (exact) {
                EXPECT_LE(stats.residual, 1e-8) << seed;
            }
        }
}

// A bead on a rail between two walls that close on it: the one that is no wall to the rail does nothing, the other
// pushes.
TEST(SolveContacts, NormalsAcrossARailDoNothing) {
    ContactWorld w;
    const std::int32_t wall = w.add_body(0), bead = w.add_body(2, {0.1, 0.1, 0.1});
    w.locked[1] = 6; // y and z
    w.velocity[1] = {-1, 0, 0};
    w.inv_inertia[1] = {};
    w.add_contact(wall, bead, {0, 0, -0.1}, {0, 0, 1}, 0.5);
    w.add_contact(wall, bead, {-0.1, 0, 0}, {0.6, 0, 0.8}, 0.5);
    w.add_contact(wall, bead, {0, 0, -0.1}, {0x1p-30, 0, 1}, 0.5);
    w.solve({.iterations = 100, .tolerance = 1e-12});
    EXPECT_NEAR(w.velocity[1].x, 0, 1e-9);
    EXPECT_EQ(w.velocity[1].y, 0);
    EXPECT_EQ(w.velocity[1].z, 0);
    EXPECT_EQ(w.impulses[0], Vec3{});
    EXPECT_EQ(w.impulses[2], Vec3{});
    EXPECT_NEAR(w.impulses[1].x, 2, 1e-9) << "what stops it along the rail";
}

TEST(SolveContacts, TheWidthOfTheVectorsChangesNoBit) {
    if (best_isa() == Isa::scalar) GTEST_SKIP() << "this processor has no wide kernel";
    for (unsigned seed = 0; seed < 12; ++seed) {
        ContactWorld start = make_random(seed, 60, seed % 2 ? 60 : 7, seed % 3 ? 0.4 : 0.0, seed % 4 != 0);
        if (seed % 2 == 0) open_gaps(start);
        if (seed > 7) lock_some(start);
        if (seed % 3 == 1)
            for (Contact& c : start.contacts) c.across = 0.02 * c.normal;
        ContactSolveOptions options{.iterations = 15, .tolerance = 1e-9};
        options.tangents = seed % 5 < 2 ? Tangents::cone : Tangents::random;
        for (const Isa isa : {Isa::scalar, Isa::avx2}) {
            if (isa >= best_isa()) continue;
            ContactWorld wide = start, narrow = start;
            for (int step = 0; step < 2; ++step) {
                options.isa = best_isa();
                const ContactSolveStats wide_stats = wide.solve(options);
                options.isa = isa;
                const ContactSolveStats stats = narrow.solve(options);
                EXPECT_EQ(wide.velocity, narrow.velocity) << seed;
                EXPECT_EQ(wide.angular_velocity, narrow.angular_velocity) << seed;
                EXPECT_EQ(wide.impulses, narrow.impulses) << seed;
                EXPECT_EQ(wide_stats.residual, stats.residual);
                EXPECT_EQ(wide_stats.visits, stats.visits);
            }
        }
    }
}

TEST(SolveContacts, OtherIslandsChangeNoBit) {
    struct Sizes {
        int bodies, island;
    };
    for (const Sizes s : {Sizes{60, 12}, Sizes{900, 300}}) { // one region of bodies, and many
        const ContactWorld all = make_random(6, s.bodies, s.island, 0.4, true);
        ContactWorld together = all, alone = all;
        std::erase_if(alone.contacts, [&](const Contact& c) { return c.b > s.island; }); // one island or more
        alone.impulses.resize(alone.contacts.size());
        ASSERT_GT(alone.contacts.size(), 10u);
        ASSERT_LT(alone.contacts.size(), together.contacts.size());
        const ContactSolveOptions options{.iterations = 200, .tolerance = 1e-3};
        together.solve(options);
        alone.solve(options);
        for (std::size_t i = 0; i <= static_cast<std::size_t>(s.island); ++i) {
            EXPECT_EQ(together.velocity[i], alone.velocity[i]) << i;
            EXPECT_EQ(together.angular_velocity[i], alone.angular_velocity[i]) << i;
        }
        // The sums that decide, to the last bit.
        for (std::size_t k = 0; k < alone.scratch.islands.size(); ++k)
            EXPECT_EQ(together.scratch.islands[k].energy_pgs, alone.scratch.islands[k].energy_pgs);
    }
}

TEST(SolveContacts, ASettledIslandStopsByItself) {
    // A body at rest on the ground beside a column of 20: two islands, of which one needs two sweeps.
    ContactWorld w = make_column(20, 1);
    w.add_contact(0, w.add_body(1), {5, 0, 0}, kUp);
    const ContactSolveStats stats = w.solve({.iterations = 1000, .tolerance = 1e-6, .momentum = false, .shock = false});
    EXPECT_EQ(stats.islands, 2);
    EXPECT_EQ(stats.iterations, 1000);
    EXPECT_EQ(stats.visits, 20 * 1000 + 1);
}

TEST(SolveContacts, NothingToDoIsFine) {
    ContactWorld w;
    w.add_body(1);
    w.velocity[0] = {1, 2, 3};
    const ContactSolveStats stats = w.solve({});
    EXPECT_EQ(stats.islands, 0);
    EXPECT_EQ(stats.residual, 0);
    EXPECT_EQ(w.velocity[0], (Vec3{1, 2, 3}));
    EXPECT_EQ(w.scratch.shocked, std::vector<std::uint8_t>{0});
}

} // namespace
} // namespace flotilla
