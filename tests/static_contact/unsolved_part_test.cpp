// SPDX-License-Identifier: MIT
#include "static_contact/unsolved_part.hpp"

#include <gtest/gtest.h>

#include "parallel/team.hpp"
#include "static_contact/contact_systems.hpp"

namespace flotilla {
namespace {

/// One island for many threads, at rest whatever its speed.
ContactSolveOptions at_rest() { return {.iterations = 100000, .tolerance = 1e-6, .rest_speed = 1e6, .shock = false}; }

/// Bodies on the ground, side by side in a square, and a tower on one of them: slow to solve, while the others need a few sweeps.
ContactWorld make_floor_with_tower(int side, int height, double friction) {
    ContactWorld w;
    w.add_body(0);
    const auto add = [&](const Vec3& x) {
        const auto body = w.add_body(1, {0.2, 0.2, 0.2}, x);
        w.velocity.back() = {0, 0, -0.4};
        return body;
    };
    for (int i = 0; i < side * side; ++i) {
        const Vec3 x{static_cast<double>(i % side), static_cast<double>(i / side), 0.5};
        const auto body = add(x);
        w.add_contact(0, body, x - 0.5 * kUp, kUp, friction);
        if (i % side > 0) w.add_contact(body - 1, body, x - Vec3{0.5, 0, 0}, {1, 0, 0}, friction);
        if (i >= side) w.add_contact(body - side, body, x - Vec3{0, 0.5, 0}, {0, 1, 0}, friction);
    }
    std::int32_t below = 1 + side * side / 2 + side / 2;
    for (int i = 0; i < height; ++i) {
        const Vec3 x = w.position[static_cast<std::size_t>(below)] + kUp;
        const auto body = add(x);
        w.add_contact(below, body, x - 0.5 * kUp, kUp, friction);
        below = body;
    }
    return w;
}

SweepView view_of(ContactScratch& s, std::size_t first, std::size_t n) {
    return {.packets = s.packed.packets.data() + first,
            .num_packets = static_cast<std::int64_t>(n),
            .rows = s.packed.rows.data(),
            .bodies = s.velocity.data()};
}

TEST(UnsolvedPart, EveryViolatedPairIsFound) {
    constexpr double kTolerance = 0.02;
    ContactWorld w = make_random(3, 900, 900, 0.4, true);
    (void)w.solve({.iterations = 3, .shock = false});
    ContactScratch& s = w.scratch;
    const std::size_t n = s.packed.packets.size();
    std::vector<std::uint8_t> narrow(n), wide(n);
    const double worst = find_violated(Cone::pyramid, view_of(s, 0, n), kTolerance, narrow.data(), Isa::scalar);
    EXPECT_EQ(worst, largest_violation(Cone::pyramid, view_of(s, 0, n), Isa::scalar));
    EXPECT_EQ(worst, find_violated(Cone::pyramid, view_of(s, 0, n), kTolerance, wide.data(), best_isa()));
    EXPECT_EQ(narrow, wide);
    int pairs = 0, violated = 0;
    for (std::size_t p = 0; p < n; ++p) {
        for (int lane = 0; lane < s.packed.packets[p].num_pairs; ++lane) {
            ContactPacket one = s.packed.packets[p]; // all lanes but one made idle: a mass of 1, no direction
            std::vector<PacketRow> rows(s.packed.rows.begin() + one.first, s.packed.rows.begin() + one.end);
            for (PacketRow& row : rows)
                for (auto& field : row.field)
                    for (int other = 0; other < kPacketLanes; ++other)
                        if (other != lane) field[other] = &field <= &row.field[PacketRow::kInvMassDiagonal + 2] ? 1 : 0;
            one.end -= one.first;
            one.first = 0;
            const SweepView view{.packets = &one, .num_packets = 1, .rows = rows.data(), .bodies = s.velocity.data()};
            const bool found = (narrow[p] >> lane & 1) != 0;
            EXPECT_EQ(found, largest_violation(Cone::pyramid, view, Isa::scalar) > kTolerance) << p << ' ' << lane;
            ++pairs;
            violated += found ? 1 : 0;
        }
        EXPECT_EQ(narrow[p] >> s.packed.packets[p].num_pairs, 0) << "an idle lane of " << p;
    }
    EXPECT_GT(violated, pairs / 20);
    EXPECT_LT(violated, pairs / 2);
}

TEST(UnsolvedPart, SweptAloneGivesTheSameSolution) {
    ContactWorld parts = make_floor_with_tower(40, 30, 0), whole = parts; // without friction the velocities are unique
    ContactSolveOptions options = at_rest();
    const ContactSolveStats with = parts.solve(options);
    options.rest_speed = 0;
    const ContactSolveStats without = whole.solve(options);
    EXPECT_GT(parts.scratch.unsolved.contacts, 0);
    EXPECT_EQ(whole.scratch.unsolved.contacts, 0);
    EXPECT_LE(with.residual, options.tolerance);
    EXPECT_LE(without.residual, options.tolerance);
    std::printf("%lld contact updates in parts, %lld as a whole\n", static_cast<long long>(with.visits),
                static_cast<long long>(without.visits));
    EXPECT_LT(5 * with.visits, without.visits);
    for (std::size_t i = 0; i < parts.velocity.size(); ++i)
        EXPECT_LT(length(parts.velocity[i] - whole.velocity[i]), 1000 * options.tolerance) << i;
}

TEST(UnsolvedPart, ThreadsChangeNoBit) {
    for (const ContactWorld& start : {make_floor_with_tower(40, 30, 0.4), make_floor_with_tower(60, 12, 0)}) {
        ContactSolveOptions options = at_rest();
        options.iterations = 500;
        ContactWorld alone = start;
        const ContactSolveStats expected = alone.solve(options);
        EXPECT_GT(alone.scratch.unsolved.contacts, 0);
        for (const int threads : {1, 2, 3, 8}) {
            Team team({threads});
            options.team = &team;
            ContactWorld w = start;
            const ContactSolveStats stats = w.solve(options);
            EXPECT_EQ(w.velocity, alone.velocity) << threads;
            EXPECT_EQ(w.angular_velocity, alone.angular_velocity) << threads;
            EXPECT_EQ(w.impulses, alone.impulses) << threads;
            EXPECT_EQ(stats.visits, expected.visits);
            EXPECT_EQ(stats.iterations, expected.iterations);
            EXPECT_EQ(stats.residual, expected.residual);
        }
    }
}

// --- what loaded contacts are let off ---

// A body at rest between four pads below and one above that press it. One of those below is out of reach by a little, but carries its
// part.
ContactWorld make_pressed_body(double load) {
    ContactWorld w;
    const auto body = w.add_body(1);
    for (int i = 0; i < 4; ++i) {
        w.add_contact(w.add_body(0), body, {}, kUp, 0, i == 0 ? -1e-3 : 0.0);
        w.impulses.back() = {0, 0, load / 4};
    }
    w.add_contact(body, w.add_body(0), {}, kUp);
    w.impulses.back() = {0, 0, load};
    return w;
}

TEST(LoadShare, ALoadedContactNeedNotHandItsLoadOn) {
    ContactSolveOptions options{.iterations = 500, .tolerance = 2e-4, .momentum = false, .rest_speed = 0.8};
    ContactWorld w = make_pressed_body(100);
    const ContactSolveStats stats = w.solve(options); // 25 m/s: 7 tolerances
    EXPECT_EQ(stats.iterations, 1);
    EXPECT_NEAR(stats.residual, 1e-3, 1e-12) << "what is reported is all of it";
    EXPECT_EQ(stats.shocked_islands, 0) << "nothing is left to do";
    EXPECT_GT(make_pressed_body(10).solve(options).iterations, 10) << "2.5 m/s: 1.6 tolerances";
    options.tolerance = 2e-6;
    EXPECT_GT(make_pressed_body(100).solve(options).iterations, 10) << "as accurate as it is asked to be";
    options.tolerance = 2e-4;
    options.rest_speed = 0;
    EXPECT_EQ(make_pressed_body(100).solve(options).iterations, 500);
}

} // namespace
} // namespace flotilla
