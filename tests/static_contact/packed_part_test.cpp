// SPDX-License-Identifier: MIT
#include "static_contact/packed_part.hpp"

#include <gtest/gtest.h>

#include "static_contact/contact_systems.hpp"

namespace flotilla {
namespace {

/// No island rests.
ContactSolveOptions in_motion() {
    return {.iterations = 2000, .tolerance = 1e-6, .patience = 2000, .rest_speed = 0, .shock = false};
}

std::vector<ContactWorld> worlds() {
    ContactWorld gaps = make_floor_with_tower(40, 30, 0.4);
    open_gaps(gaps);
    return {make_floor_with_tower(40, 30, 0.4), make_floor_with_tower(60, 12, 0), gaps};
}

void expect_velocities_of_impulses(const ContactWorld& solved, ContactWorld start) {
    for (std::size_t k = 0; k < start.contacts.size(); ++k) {
        const Contact& c = start.contacts[k];
        const Vec3& l = solved.impulses[k];
        const auto push = [&](std::int32_t body, double sign) {
            const auto i = static_cast<std::size_t>(body);
            start.velocity[i] += sign * start.inv_mass[i] * l;
            start.angular_velocity[i] += sign * (start.inv_inertia[i] * cross(c.point - start.position[i], l));
        };
        push(c.a, -1);
        push(c.b, 1);
    }
    for (std::size_t i = 0; i < start.velocity.size(); ++i) {
        EXPECT_LT(length(solved.velocity[i] - start.velocity[i]), 1e-12) << i;
        EXPECT_LT(length(solved.angular_velocity[i] - start.angular_velocity[i]), 1e-12) << i;
    }
}

TEST(PackedPart, SweptAloneGivesTheSameSolution) {
    const ContactWorld start = make_floor_with_tower(40, 30, 0); // without friction the velocities are unique
    ContactWorld parts = start, whole = start;
    ContactSolveOptions options = in_motion();
    options.iterations = options.patience = 100000;
    const ContactSolveStats with = parts.solve(options);
    options.tuning.packed_divisor = 0;
    const ContactSolveStats without = whole.solve(options);
    EXPECT_GT(with.part_rounds, 0);
    EXPECT_EQ(without.part_rounds, 0);
    EXPECT_LE(with.residual, options.tolerance);
    EXPECT_LE(without.residual, options.tolerance);
    std::printf("%lld contact updates in parts, %lld as a whole\n", static_cast<long long>(with.visits),
                static_cast<long long>(without.visits));
    EXPECT_LT(with.visits, without.visits);
    for (std::size_t i = 0; i < parts.velocity.size(); ++i)
        EXPECT_LT(length(parts.velocity[i] - whole.velocity[i]), 1000 * options.tolerance) << i;
}

TEST(PackedPart, VelocitiesAreThoseOfTheImpulses) {
    for (const ContactWorld& start : worlds()) {
        ContactWorld w = start;
        EXPECT_GT(w.solve(in_motion()).part_rounds, 0);
        expect_velocities_of_impulses(w, start);
    }
}

TEST(PackedPart, TheLimitHolds) {
    const ContactWorld start = make_floor_with_tower(40, 30, 0.3);
    for (const int limit : {0, 1, 10, 11, 15, 25, 60}) {
        ContactSolveOptions options = in_motion();
        options.iterations = limit;
        ContactWorld w = start;
        const ContactSolveStats stats = w.solve(options);
        EXPECT_LE(stats.iterations, limit);
        EXPECT_EQ(stats.unsolved_islands, stats.residual <= options.tolerance ? 0 : 1);
    }
}

TEST(PackedPart, ATargetOfOnesOwnIsSweptFor) {
    ContactWorld w = make_floor_with_tower(40, 30, 0.3);
    ContactSolveOptions options = in_motion();
    options.patience = 0; // as static_stage.cpp sets it where a tolerance was given
    EXPECT_EQ(w.solve(options).part_rounds, 0);
}

TEST(PackedPart, ThreadsAndVectorsChangeNoBit) {
    for (const ContactWorld& start : worlds()) {
        ContactSolveOptions options = in_motion();
        options.iterations = 500;
        expect_same_bits(start, options);
    }
}

} // namespace
} // namespace flotilla
