// SPDX-License-Identifier: MIT
// The disc's step of one contact: its fixed points are Coulomb's law, and it adds no energy.
#include <gtest/gtest.h>

#include <random>

#include "static_contact/friction_problem.hpp"

namespace flotilla {
namespace {

/// A contact with a random symmetric positive definite W, of a condition of up to about `spread`, and the velocity q
/// without impulse.
struct OneContact {
    FrictionProblem problem;
    std::mt19937_64 rng;

    OneContact(unsigned seed, double spread) : rng(seed) {
        problem.contacts.resize(1);
        problem.row.resize(1);
        problem.q.resize(1);
        std::normal_distribution<double> normal;
        Mat3 f;
        for (double& m : f.m) m = normal(rng);
        Mat3 w = diagonal({1 / spread, 1 / spread, 1 / spread});
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                for (std::size_t k = 0; k < 3; ++k) w.m[3 * i + j] += f.m[3 * i + k] * f.m[3 * j + k];
        problem.row[0].push_back({0, w});
        problem.set_diagonal(0, w);
        problem.turn_tangents();
        contact().friction = 0.1 + 0.9 * std::uniform_real_distribution<double>{}(rng);
    }
    LocalContact& contact() { return problem.contacts[0]; }
    const Mat3& w() const { return problem.row[0][0].w; }
    /// Makes `impulse` lead to the relative velocity u.
    void set(const Vec3& impulse, const Vec3& u) {
        contact().impulse = impulse;
        problem.q[0] = u - w() * impulse;
    }
    Vec3 change() const {
        const auto update = visit<Cone::disc>(to_pack(problem.contacts[0]), to_pack(problem.velocity(0)));
        return {update.change.x.v, update.change.y.v, update.change.z.v};
    }
    double number() { return std::normal_distribution<double>{}(rng); }
};

constexpr double kRounding = 1e-11; // of a W with a condition of 1e3

TEST(DiscStep, RestsWhereCoulombsLawHolds) {
    for (unsigned seed = 0; seed < 1000; ++seed) {
        OneContact c(seed, 1e3);
        const double mu = c.contact().friction, angle = 10 * c.number(), normal = std::exp(c.number());
        const Vec3 direction{0, std::cos(angle), std::sin(angle)};
        c.set(Vec3{normal, 0, 0} + 0.9 * mu * normal * direction, {}); // sticks
        EXPECT_LT(length(c.change()), kRounding * normal) << seed;
        c.set(Vec3{normal, 0, 0} + mu * normal * direction, -std::exp(c.number()) * direction); // slides
        EXPECT_LT(length(c.change()), kRounding * normal) << seed;
        c.set({}, {std::abs(c.number()), c.number(), c.number()}); // opens
        EXPECT_EQ(c.change(), Vec3{}) << seed;
        c.contact().friction = 0;
        c.set({normal, 0, 0}, {0, c.number(), c.number()});
        EXPECT_LT(length(c.change()), kRounding * normal) << seed;
    }
}

TEST(DiscStep, MovesWhereItDoesNotHold) {
    for (unsigned seed = 0; seed < 1000; ++seed) {
        OneContact c(seed, 10);
        const double mu = c.contact().friction, angle = 10 * c.number();
        const Vec3 direction{0, std::cos(angle), std::sin(angle)}, across{0, -direction.z, direction.y};
        c.set(Vec3{1, 0, 0} + 0.5 * mu * direction, -1.0 * direction); // slides without its full friction
        EXPECT_GT(length(c.change()), 1e-3) << seed;
        c.set(Vec3{1, 0, 0} + mu * direction, direction); // pushes
        EXPECT_GT(length(c.change()), 1e-3) << seed;
        c.set(Vec3{1, 0, 0} + mu * direction, -1.0 * direction + 0.3 * across); // not opposite to the slip
        EXPECT_GT(length(c.change()), 1e-4) << seed;
    }
}

TEST(DiscStep, AddsNoEnergyAndStaysInTheDisc) {
    for (unsigned seed = 0; seed < 10000; ++seed) {
        OneContact c(seed, 1e3);
        const double mu = c.contact().friction, normal = std::abs(c.number()), angle = 10 * c.number();
        const double part = std::min(1.0, std::abs(c.number()));
        c.set({normal, part * mu * normal * std::cos(angle), part * mu * normal * std::sin(angle)},
              {0, c.number(), c.number()});
        const Vec3 u = c.problem.velocity(0), change = c.change();
        EXPECT_EQ(change.x, 0) << "the normal velocity is what it should be";
        // 1/2 l W l + l u, in the change l.
        EXPECT_LE(dot(change, u) + 0.5 * dot(change, c.w() * change), 1e-14 * length(u) * normal) << seed;
        const Vec3 after = c.contact().impulse + change;
        EXPECT_LE(std::hypot(after.y, after.z), mu * normal * (1 + 1e-14)) << seed;
    }
}

TEST(DiscStep, VisitsEndAtTheSolution) {
    int most = 0;
    for (unsigned seed = 0; seed < 1000; ++seed) {
        OneContact c(seed, 10);
        c.set({}, {-std::abs(c.number()) - 0.1, c.number(), c.number()});
        c.contact().friction *= 0.3; // a contact that couples more strongly than this may have no solution or several
        most = std::max(most, c.problem.solve<Cone::disc>(1e-12, 100000));
        EXPECT_LE(c.problem.residual<Cone::disc>(), 1e-12) << seed;
        EXPECT_LT(c.problem.natural_map(), 1e-8) << seed;
    }
    std::printf("at most %d visits\n", most);
}

} // namespace
} // namespace flotilla
