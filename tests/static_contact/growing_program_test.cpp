// SPDX-License-Identifier: MIT
// Pairs with many contacts are solved by few of them: the others hold as well.
#include "static_contact/growing_program.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

constexpr double kFall = 9.81 / 100; // m/s: what gravity adds in a step of 1/100 s

struct Problem {
    std::vector<ConeBody> bodies;
    std::vector<ConeContact> contacts;
    std::vector<Vec3> impulses;

    /// Discs of 1 kg and 1 m on each other's rims, of so many contacts each. `free`: m/s, of the lowest, along its normal
    /// and tangents.
    Problem(int discs, int rim, double friction, const Vec3& free) {
        for (int k = 0; k < discs; ++k) {
            bodies.push_back({1, diagonal({4, 4, 2}), 0});
            for (int i = 0; i < rim; ++i) {
                const double angle = 2 * std::numbers::pi * i / rim;
                const Vec3 arm{std::cos(angle), std::sin(angle), 0};
                // All fall alike: those above do not approach those below.
                contacts.push_back(
                    {k - 1, k, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, arm, arm, friction, k == 0 ? free : Vec3{}});
            }
        }
        impulses.resize(contacts.size());
    }

    ConeSolveStats solve(GrowingProgram& program, const ConeSolveOptions& options) {
        ConeScratch scratch;
        return program.solve(bodies, contacts, options, impulses, scratch);
    }
    /// m/s, over all contacts.
    [[nodiscard]] double residual() const {
        std::vector<ConeMotion> motion;
        std::vector<Vec3> u(contacts.size());
        cone_velocities(bodies, contacts, impulses, motion, u);
        std::vector<ConeDiagonal> w;
        ConeProgram program;
        build_cone_program(bodies, contacts, program, w);
        double worst = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i)
            worst = std::max(worst, cone_violation(w[i], contacts[i].friction, impulses[i], u[i]));
        return worst;
    }
    [[nodiscard]] std::vector<ConeMotion> motion() const {
        std::vector<ConeMotion> out;
        std::vector<Vec3> u(contacts.size());
        cone_velocities(bodies, contacts, impulses, out, u);
        return out;
    }
};

ConeSolveOptions to(double tolerance) { return {.tolerance = tolerance, .enough = tolerance}; }

TEST(GrowingProgram, DiscsRestOnAFewOfTheirContacts) {
    constexpr double kTolerance = 1e-10;
    for (const double friction : {0.0, 0.3}) {
        Problem p(3, 400, friction, {-kFall, 0.02, 0});
        GrowingProgram program;
        const ConeSolveStats stats = p.solve(program, to(kTolerance));
        EXPECT_TRUE(stats.solved);
        EXPECT_LE(stats.residual, kTolerance);
        EXPECT_LE(p.residual(), kTolerance);
        EXPECT_LE(program.taken_in(), 200u) << "of 1,200";
        EXPECT_GT(std::count_if(p.impulses.begin(), p.impulses.end(), [](const Vec3& r) { return r.x > 0; }), 2);
    }
}

TEST(GrowingProgram, MovesBodiesAsAllContactsDo) {
    for (const double aside : {0.0, 0.3, 0.98}) {
        // A disc that falls and turns: what it lands on is none of the contacts that are as far apart as they can be.
        Problem p(1, 400, 0.4, {-kFall, 0.03, 0.01});
        const Vec3 along = normalized(Vec3{1, 0.37, 0});
        for (ConeContact& c : p.contacts) c.free_velocity.x += aside * kFall * dot(c.arm_b, along);
        Problem all = p;
        GrowingProgram program;
        const ConeSolveStats stats = p.solve(program, to(1e-12));
        EXPECT_TRUE(stats.solved) << aside;
        EXPECT_LE(p.residual(), 1e-11);
        EXPECT_LT(program.taken_in(), 60u);
        ConeScratch scratch;
        ASSERT_TRUE(solve_cone_program(all.bodies, all.contacts, to(1e-12), all.impulses, scratch).solved);
        const ConeMotion one = p.motion()[0], other = all.motion()[0];
        EXPECT_LT(length(one.linear - other.linear), 1e-9) << aside;
        EXPECT_LT(length(one.angular - other.angular), 1e-9) << aside;
    }
}

TEST(GrowingProgram, FewContactsAreSolvedAsTheyAre) {
    Problem p(2, 12, 0.3, {-kFall, 0, 0}), all = p;
    GrowingProgram program;
    ConeScratch scratch;
    const ConeSolveStats stats = p.solve(program, to(1e-10));
    const ConeSolveStats without = solve_cone_program(all.bodies, all.contacts, to(1e-10), all.impulses, scratch);
    EXPECT_EQ(program.taken_in(), 24u);
    EXPECT_EQ(stats.iterations, without.iterations);
    EXPECT_EQ(p.impulses, all.impulses);
}

TEST(GrowingProgram, WhereAScriptPressesIsTakenIn) {
    Problem p(1, 400, 0.3, {-kFall, 0, 0});
    for (std::size_t i = 100; i < 130; ++i) p.contacts[i].pressed = true;
    GrowingProgram program;
    p.solve(program, to(1e-10));
    EXPECT_GE(program.taken_in(), 30u);
}

} // namespace
} // namespace flotilla
