// SPDX-License-Identifier: MIT
// Systems that several tests of the contact solver use.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "parallel/team.hpp"
#include "static_contact/contact_world.hpp"

namespace flotilla {

inline constexpr Vec3 kUp{0, 0, 1};

inline ContactSolveOptions accurate() {
    return {.iterations = 10000, .tolerance = 1e-12, .shock = false, .tangents = Tangents::aligned};
}

/// N equal bodies on the ground, each held by one contact, moving down at `speed`.
inline ContactWorld make_column(int n, double speed, double mass = 1) {
    ContactWorld w;
    w.add_body(0);
    for (int i = 1; i <= n; ++i) {
        const std::int32_t body = w.add_body(mass, {}, {0, 0, static_cast<double>(i)});
        w.velocity.back() = {0, 0, -speed};
        w.add_contact(body - 1, body, {0, 0, i - 0.5}, kUp);
    }
    return w;
}

/// A body held between two walls that both ask it to come: no impulses do that, and they grow for ever. With five walls
/// beside it, it is a jam: more contacts than degrees of freedom.
inline ContactWorld make_body_between_walls(bool jam) {
    ContactWorld w;
    w.add_body(0);
    const auto body = w.add_body(1);
    w.add_body(0);
    w.add_contact(0, body, {}, kUp, 0, 0.1);
    w.add_contact(body, 2, {}, kUp, 0, 0.1);
    for (int k = 0; k < 5 && jam; ++k) w.add_contact(body, w.add_body(0), {}, {1, 0, 0}, 0, 0.1);
    return w;
}

/// Bodies of many masses with contacts between random pairs; every `island` bodies share one island.
inline ContactWorld make_random(unsigned seed, int num_bodies, int island, double friction, bool grounded) {
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> normal;
    const auto vec = [&] { return Vec3{normal(rng), normal(rng), normal(rng)}; };
    ContactWorld w;
    w.add_body(grounded ? 0 : 1e3, {500, 600, 700});
    for (int i = 1; i <= num_bodies; ++i) {
        const double mass = std::exp(normal(rng));
        w.add_body(mass, mass * Vec3{0.1, 0.15, 0.2}, vec());
        w.velocity.back() = vec();
        w.angular_velocity.back() = vec();
        const int first = (i - 1) / island * island + 1;
        for (int k = 0; k < 3; ++k) {
            const int partner = k == 0 ? 0 : first + static_cast<int>(rng() % static_cast<unsigned>(island));
            if (partner >= i || (k == 0 && i % 3 != 0 && grounded)) continue;
            const int points = 1 + static_cast<int>(rng() % 4);
            const Vec3 n = normalized(vec());
            for (int p = 0; p < points; ++p) w.add_contact(partner, i, w.position.back() + 0.5 * vec(), n, friction);
        }
    }
    return w;
}

/// Every second contact a gap that is about as wide as what the bodies cross, but so that they do not close at the
/// start.
inline void open_gaps(ContactWorld& w) {
    for (std::size_t k = 0; k < w.contacts.size(); k += 2) {
        Contact& c = w.contacts[k];
        c.target = -1.01 * length(w.velocity_at(c.b, c.point) - w.velocity_at(c.a, c.point)) - 0.01;
    }
}

/// Bodies on the ground, side by side in a square, and a tower on one of them: slow to solve, while the others need a
/// few sweeps.
inline ContactWorld make_floor_with_tower(int side, int height, double friction) {
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

/// That a solve, which sweeps parts, has the same bits with any number of threads and any vectors.
inline void expect_same_bits(const ContactWorld& start, const ContactSolveOptions& options) {
    ContactWorld alone = start;
    const ContactSolveStats expected = alone.solve(options);
    EXPECT_GT(expected.part_rounds, 0);
    const auto expect_same = [&](const ContactSolveOptions& other) {
        ContactWorld w = start;
        const ContactSolveStats stats = w.solve(other);
        EXPECT_EQ(w.velocity, alone.velocity);
        EXPECT_EQ(w.angular_velocity, alone.angular_velocity);
        EXPECT_EQ(w.impulses, alone.impulses);
        EXPECT_EQ(stats.visits, expected.visits);
        EXPECT_EQ(stats.iterations, expected.iterations);
        EXPECT_EQ(stats.residual, expected.residual);
    };
    for (const int threads : {1, 2, 3, 8}) {
        Team team({threads});
        ContactSolveOptions other = options;
        other.team = &team;
        expect_same(other);
    }
    for (const Isa isa : {Isa::scalar, Isa::avx2}) {
        if (isa >= best_isa()) continue;
        ContactSolveOptions other = options;
        other.isa = isa;
        expect_same(other);
    }
}

} // namespace flotilla
