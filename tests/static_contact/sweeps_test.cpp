// SPDX-License-Identifier: MIT
// How fast sweeps converge, and when they end without.
#include <cmath>
#include <numbers>

#include "static_contact/contact_systems.hpp"

namespace flotilla {
namespace {

TEST(SolveContacts, AColumnConvergesAtTheLawOfGaussSeidel) {
    // The error falls by cos^2(pi / 2N) per sweep, whatever the order, because the matrix of a column
    // is tridiagonal and so consistently ordered by rows as well as by two colours.
    for (const int n : {5, 10, 20, 50}) {
        const auto residual_after = [&](int sweeps) {
            ContactWorld w = make_column(n, 1);
            return w.solve({.iterations = sweeps, .tolerance = 0, .momentum = false, .shock = false}).residual;
        };
        const int late = 2 * n * n;
        const double rate = std::pow(residual_after(late + n) / residual_after(late), 1.0 / n);
        const double c = std::cos(std::numbers::pi / (2 * n));
        EXPECT_NEAR((1 - rate) / (1 - c * c), 1, 1e-3) << n;
    }
}

TEST(SolveContacts, MomentumNeedsTensOfTimesFewerSweeps) {
    for (const int n : {20, 50}) {
        ContactSolveOptions options{.iterations = 100000, .tolerance = 1e-6, .shock = false};
        ContactWorld with = make_column(n, 1), without = with;
        const ContactSolveStats fast = with.solve(options);
        options.momentum = false;
        const ContactSolveStats slow = without.solve(options);
        EXPECT_LE(fast.residual, 1e-6);
        EXPECT_LT(10 * fast.iterations, slow.iterations) << n;
        for (std::size_t k = 0; k < with.impulses.size();
             ++k) // both within tolerance times the column's flexibility, n^2 / 2
            EXPECT_NEAR(with.impulses[k].z, without.impulses[k].z, 1e-6 * n * n);
    }
}

// One contact carries, the other asks for a little more: all the load has to go from one to the other.
TEST(SolveContacts, ContactsOfAPairHandOverTheirLoadInFewSweeps) {
    constexpr double kMore = 1e-3; // m/s
    ContactWorld w;
    w.add_body(0);
    const auto body = w.add_body(1);
    w.velocity[1] = {0, 0, -1};
    w.add_contact(0, body, {}, kUp, 0, 0);
    w.add_contact(0, body, {}, kUp, 0, kMore);
    w.impulses[0] = {0, 0, 1};
    ContactWorld once = w;
    ContactSolveOptions options{.iterations = 10000, .tolerance = kMore / 4, .shock = false};
    const ContactSolveStats again = w.solve(options);
    options.tuning.most_visits = 1;
    const ContactSolveStats alone = once.solve(options);
    for (const ContactWorld* solved : {&w, &once}) {
        EXPECT_NEAR(solved->velocity[1].z, kMore, options.tolerance);
        EXPECT_NEAR(solved->impulses[1].z, 1 + kMore, 0.3);
    }
    EXPECT_LE(again.residual, options.tolerance);
    EXPECT_LE(alone.residual, options.tolerance);
    EXPECT_LT(3 * again.iterations, alone.iterations);
}

TEST(SolveContacts, GivesUpWhereTheResidualFallsNoMore) {
    ContactWorld w = make_body_between_walls(false);
    w.velocity[1] = {0, 0.5, 0};
    const ContactSolveStats stats = w.solve({.patience = 50});
    EXPECT_GT(stats.residual, 0.09);
    EXPECT_GE(stats.iterations, 50);
    EXPECT_LE(stats.iterations, 100);
}

TEST(SolveContacts, GivesUpAJamSooner) {
    ContactWorld w = make_body_between_walls(true); // its residual stands from the first look on
    ContactWorld moving = w;
    w.velocity[1] = {0, 0.3, 0};
    const ContactSolveStats stats = w.solve({.patience = 50, .rest_speed = 0.4});
    EXPECT_GT(stats.residual, 0.09);
    EXPECT_EQ(stats.iterations, 30); // a look in ten sweeps; two that found it where the one before did
    moving.velocity[1] = {0, 0.5, 0};
    EXPECT_GE(moving.solve({.patience = 50, .rest_speed = 0.4}).iterations, 50);
}

} // namespace
} // namespace flotilla
