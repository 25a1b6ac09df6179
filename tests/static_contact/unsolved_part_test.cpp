// SPDX-License-Identifier: MIT
#include "static_contact/unsolved_part.hpp"

#include <span>

#include <gtest/gtest.h>

#include "static_contact/contact_systems.hpp"
#include "static_contact/sweep_island.hpp"

namespace flotilla {
namespace {

/// Every island rests.
ContactSolveOptions at_rest() { return {.iterations = 100000, .tolerance = 1e-6, .rest_speed = 1e6, .shock = false}; }

SweepView view_of(ContactScratch& s, std::size_t first, std::size_t n) {
    return {.packets = s.packed.packets.data() + first,
            .num_packets = static_cast<std::int64_t>(n),
            .rows = s.packed.rows.data(),
            .bodies = s.velocity.data()};
}

void expect_every_violated_pair_found(Tangents tangents, Cone cone) {
    constexpr double kTolerance = 0.02;
    ContactWorld w = make_random(3, 900, 900, 0.4, true);
    (void)w.solve({.iterations = 3, .shock = false, .tangents = tangents});
    ContactScratch& s = w.scratch;
    const std::size_t n = s.packed.packets.size();
    std::vector<std::uint8_t> narrow(n), wide(n);
    const double worst = find_violated(cone, view_of(s, 0, n), kTolerance, narrow.data(), Isa::scalar);
    EXPECT_EQ(worst, largest_violation(cone, view_of(s, 0, n), Isa::scalar));
    EXPECT_EQ(worst, find_violated(cone, view_of(s, 0, n), kTolerance, wide.data(), best_isa()));
    EXPECT_EQ(narrow, wide);
    int pairs = 0, violated = 0;
    for (std::size_t p = 0; p < n; ++p) {
        for (int lane = 0; lane < s.packed.packets[p].num_pairs; ++lane) {
            ContactPacket one = s.packed.packets[p]; // all lanes but one made idle: a mass of 1, no direction
            std::vector<PacketRow> rows(s.packed.rows.begin() + one.first, s.packed.rows.begin() + one.end);
            const auto is_mass = [](int field) {
                const auto of_tangents = [&](int first) { return field == first || field == first + 1; };
                return field == PacketRow::kNormalMass || field == PacketRow::kInvNormalMass ||
                       of_tangents(PacketRow::kTangentMass) || of_tangents(PacketRow::kInvTangentMass);
            };
            for (PacketRow& row : rows)
                for (int field = 0; field < 26; ++field)
                    for (int other = 0; other < kPacketLanes; ++other)
                        if (other != lane) row.field[field][other] = is_mass(field) ? 1 : 0;
            ASSERT_EQ(one.woken, 0);
            one.end -= one.first;
            one.first = 0;
            const SweepView view{.packets = &one, .num_packets = 1, .rows = rows.data(), .bodies = s.velocity.data()};
            const bool found = (narrow[p] >> lane & 1) != 0;
            EXPECT_EQ(found, largest_violation(cone, view, Isa::scalar) > kTolerance) << p << ' ' << lane;
            ++pairs;
            violated += found ? 1 : 0;
        }
        EXPECT_EQ(narrow[p] >> s.packed.packets[p].num_pairs, 0) << "an idle lane of " << p;
    }
    EXPECT_GT(violated, pairs / 20);
    EXPECT_LT(violated, pairs / 2);
}

TEST(UnsolvedPart, EveryViolatedPairIsFound) {
    expect_every_violated_pair_found(Tangents::random, Cone::pyramid);
    expect_every_violated_pair_found(Tangents::cone, Cone::disc);
}

TEST(UnsolvedPart, SweptAloneGivesTheSameSolution) {
    ContactWorld parts = make_floor_with_tower(40, 30, 0), whole = parts; // without friction the velocities are unique
    const ContactWorld start = parts;
    ContactSolveOptions options = at_rest();
    const ContactSolveStats with = parts.solve(options);
    options.rest_speed = 0;
    const ContactSolveStats without = whole.solve(options);
    EXPECT_GT(with.part_rounds, 0);
    EXPECT_EQ(without.part_rounds, 0);
    EXPECT_LE(with.residual, options.tolerance);
    EXPECT_LE(without.residual, options.tolerance);
    std::printf("%lld contact updates in parts, %lld as a whole\n", static_cast<long long>(with.visits),
                static_cast<long long>(without.visits));
    EXPECT_LT(5 * with.visits, without.visits);
    ContactWorld pushed = start; // by the impulses that came out
    for (std::size_t k = 0; k < pushed.contacts.size(); ++k) {
        const Contact& c = pushed.contacts[k];
        const Vec3& l = parts.impulses[k];
        const auto push = [&](std::int32_t body, double sign) {
            const auto i = static_cast<std::size_t>(body);
            pushed.velocity[i] += sign * pushed.inv_mass[i] * l;
            pushed.angular_velocity[i] += sign * (pushed.inv_inertia[i] * cross(c.point - pushed.position[i], l));
        };
        push(c.a, -1);
        push(c.b, 1);
    }
    for (std::size_t i = 0; i < parts.velocity.size(); ++i) {
        EXPECT_LT(length(parts.velocity[i] - whole.velocity[i]), 1000 * options.tolerance) << i;
        EXPECT_LT(length(parts.velocity[i] - pushed.velocity[i]), 1e-12) << i;
        EXPECT_LT(length(parts.angular_velocity[i] - pushed.angular_velocity[i]), 1e-12) << i;
    }
}

TEST(UnsolvedPart, TheLimitHolds) {
    const ContactWorld start = make_floor_with_tower(40, 30, 0.3);
    for (const int limit : {0, 1, 10, 11, 15, 25, 60}) {
        ContactSolveOptions options = at_rest();
        options.iterations = limit;
        ContactWorld w = start;
        const ContactSolveStats stats = w.solve(options);
        EXPECT_LE(stats.iterations, limit);
        EXPECT_EQ(stats.unsolved_islands, stats.residual <= options.tolerance ? 0 : 1);
    }
}

void expect_equal(const ContactWorld& w, const ContactWorld& expected, std::size_t bodies) {
    for (std::size_t i = 0; i < bodies; ++i) {
        EXPECT_EQ(w.velocity[i], expected.velocity[i]) << i;
        EXPECT_EQ(w.angular_velocity[i], expected.angular_velocity[i]) << i;
    }
}

TEST(UnsolvedPart, ThreadsAndVectorsChangeNoBit) {
    ContactWorld gaps = make_floor_with_tower(40, 30, 0.4);
    open_gaps(gaps);
    for (const ContactWorld& start : {make_floor_with_tower(40, 30, 0.4), make_floor_with_tower(60, 12, 0), gaps}) {
        ContactSolveOptions options = at_rest();
        options.iterations = 500;
        options.rest_speed = 0.8;
        expect_same_bits(start, options);
    }
}

// Too small for several threads together, each has one, and that one's memory of parts.
TEST(UnsolvedPart, SmallIslandsSideBySideChangeNoBit) {
    constexpr int kIslands = 24;
    ContactWorld w;
    for (int k = 0; k < kIslands; ++k) {
        const ContactWorld one = make_floor_with_tower(7, 16 + k % 3, 0.3);
        const auto first = static_cast<std::int32_t>(w.position.size());
        const Vec3 shift{100.0 * k, 0, 0};
        for (std::size_t i = 0; i < one.position.size(); ++i) {
            (void)w.add_body(i == 0 ? 0 : 1, {0.2, 0.2, 0.2}, one.position[i] + shift);
            w.velocity.back() = one.velocity[i];
        }
        for (const Contact& c : one.contacts)
            w.add_contact(first + c.a, first + c.b, c.point + shift, c.normal, c.friction);
    }
    for (const int patience : {0, 50}) {
        ContactSolveOptions options = at_rest();
        options.iterations = 3000;
        options.tolerance = 1e-4;
        options.rest_speed = 0.8;
        options.patience = patience;
        ContactWorld once = w;
        EXPECT_EQ(once.solve(options).islands, kIslands);
        for (const ContactScratch::Island& island : once.scratch.islands) EXPECT_FALSE(is_large(island, once.scratch));
        expect_same_bits(w, options);
    }
}

TEST(UnsolvedPart, OtherIslandsChangeNoBit) {
    const ContactWorld alone_start = make_floor_with_tower(40, 30, 0.4);
    ContactWorld alone = alone_start, together = alone_start;
    const auto first = static_cast<std::int32_t>(together.position.size());
    const ContactWorld other = make_floor_with_tower(33, 5, 0.4); // far away, on another ground
    for (std::size_t i = 0; i < other.position.size(); ++i) {
        (void)together.add_body(i == 0 ? 0 : 1, {0.2, 0.2, 0.2}, other.position[i] + Vec3{500, -70, 3});
        together.velocity.back() = other.velocity[i];
    }
    for (const Contact& c : other.contacts)
        for (const Vec3& shift : {Vec3{}, Vec3{0.1, 0.2, 0}}) // twice as many contacts a pair as the first has
            together.add_contact(first + c.a, first + c.b, c.point + Vec3{500, -70, 3} + shift, c.normal, c.friction);
    ContactSolveOptions options = at_rest();
    options.iterations = 200;
    options.rest_speed = 0.8;
    const ContactSolveStats stats = together.solve(options);
    EXPECT_EQ(stats.islands, 2);
    EXPECT_GT(alone.solve(options).part_rounds, 0);
    expect_equal(together, alone, alone.velocity.size());
}

TEST(UnsolvedPart, AJamHidesNothing) {
    ContactWorld w = make_floor_with_tower(40, 30, 0);
    const std::vector<Contact> once = w.contacts;
    for (const Vec3& shift : {Vec3{0.1, 0.2, 0}, Vec3{-0.1, 0.2, 0}}) // more contacts than degrees of freedom
        for (const Contact& c : once) w.add_contact(c.a, c.b, c.point + shift, c.normal, c.friction);
    for (const double side : {1.0, -1.0}) // two walls that ask the first body to come
        w.add_contact(1, w.add_body(0), w.position[1] - Vec3{side * 0.5, 0, 0}, {-side, 0, 0}, 0, 0.1);
    ContactSolveOptions options = at_rest();
    options.tolerance = 1e-4;
    options.patience = 50;
    const ContactSolveStats stats = w.solve(options);
    EXPECT_GT(stats.residual, 0.05);
    EXPECT_EQ(stats.unsolved_islands, 1);
    EXPECT_LT(stats.iterations, 1000);
    for (std::size_t i = 1; i <= 1600 + 30; ++i) EXPECT_LT(std::abs(w.velocity[i].z), 100 * options.tolerance) << i;
}

/// On three corners near each other, on top of what rests, slides a body.
ContactWorld make_slider_on_a_tower() {
    ContactWorld w = make_floor_with_tower(40, 4, 0);
    const auto top = static_cast<std::int32_t>(w.position.size()) - 1;
    const Vec3 foot = w.position.back() + 0.5 * kUp;
    const auto slides = w.add_body(1, {0.2, 0.2, 0.2}, foot + 0.5 * kUp);
    w.velocity.back() = {0.5, 0, -0.4};
    for (const Vec3& corner : {Vec3{0.02, 0.01, 0}, Vec3{-0.02, 0.01, 0}, Vec3{0, -0.02, 0}})
        w.add_contact(top, slides, foot + corner, kUp);
    return w;
}

ContactSolveOptions settling(double settle_above) {
    ContactSolveOptions options = at_rest();
    options.tolerance = 1e-4;
    options.patience = 50;
    options.tuning.settle_above = settle_above;
    return options;
}

TEST(UnsolvedPart, WhatMovesIsSweptToLess) {
    const auto largest_error = [](double settle_above) {
        ContactWorld w = make_slider_on_a_tower();
        EXPECT_LE(w.solve(settling(settle_above)).residual, 1e-4);
        EXPECT_NEAR(w.velocity.back().x, 0.5, 1e-12);
        double error = 0;
        for (const Contact& c : std::span(w.contacts).last(3))
            error = std::max(error, std::abs((w.velocity_at(c.b, c.point) - w.velocity_at(c.a, c.point)).z));
        return error;
    };
    EXPECT_LT(4 * largest_error(1), largest_error(0));
}

TEST(UnsolvedPart, ThreadsAndVectorsChangeNoBitOfWhatMoves) {
    ContactWorld with = make_slider_on_a_tower(), without = with;
    EXPECT_NE(with.solve(settling(1)).visits, without.solve(settling(0)).visits);
    expect_same_bits(make_slider_on_a_tower(), settling(1));
}

TEST(UnsolvedPart, TheLimitHoldsWhereThingsMove) {
    for (int limit = 0; limit < 80; limit += 3) {
        ContactSolveOptions options = settling(1);
        options.iterations = limit;
        ContactWorld with = make_slider_on_a_tower(), without = with;
        const ContactSolveStats stats = with.solve(options);
        EXPECT_LE(stats.iterations, limit);
        EXPECT_EQ(stats.unsolved_islands, stats.residual <= options.tolerance ? 0 : 1);
        options.tuning.settle_above = 0;
        EXPECT_LE(stats.unsolved_islands, without.solve(options).unsolved_islands) << limit;
    }
}

} // namespace
} // namespace flotilla
