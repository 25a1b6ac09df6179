// SPDX-License-Identifier: MIT
#include "response/frictional_impact.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

constexpr Vec3 kUp{0, 0, 1};

/// Of a body of unit mass and the given inverse inertia, 1/(kg m^2) about axes of the world, at `arm`.
Mat3 mobility(const Vec3& inverse_inertia, const Vec3& arm) {
    const Mat3 r = cross_matrix(arm);
    return identity() + transpose(r) * (diagonal(inverse_inertia) * r);
}

struct Outcome {
    Vec3 impulse, after;
};
Outcome impact(const Mat3& k, const Vec3& before, double target, double friction) {
    const Vec3 impulse = frictional_impact({k, kUp, friction, false}, before, target);
    return {impulse, before + k * impulse};
}

/// A rod of length 2 on its lower end, `angle` from the vertical, moving in the plane y = 0: K of that end.
Mat3 rod(double angle) {
    constexpr double kInverse = 3; // m l^2 / 3
    return mobility({kInverse, kInverse, kInverse}, {std::sin(angle), 0, -std::cos(angle)});
}

// In a plane the course has two legs, with friction against the slip before it stops and after. K of the rod is
// (xx, xz; xz, zz).
TEST(FrictionalImpact, RodSlidesStopsAndTurnsBack) {
    const Mat3 k = rod(0.6);
    const double xx = k.m[0], xz = k.m[2], zz = k.m[8];
    ASSERT_GT(xz, 0);
    for (const double friction : {0.1, 0.3, 0.5 * xz / xx}) {
        const Vec3 before{-0.2, 0, -1}; // slips in -x; the normal impulse drives the end to +x
        const double to_stop = -before.x / (xz + friction * xx);
        const double at_stop = before.z + to_stop * (zz + friction * xz);
        ASSERT_LT(at_stop, 0.4);
        const bool holds = xz <= friction * xx;
        ASSERT_FALSE(holds);
        const double rest = (0.4 - at_stop) / (zz - friction * xz);
        const Outcome out = impact(k, before, 0.4, friction);
        EXPECT_NEAR(out.impulse.z, to_stop + rest, 1e-5);
        EXPECT_NEAR(out.impulse.x, friction * (to_stop - rest), 1e-5);
        EXPECT_NEAR(out.impulse.y, 0, 1e-14);
        EXPECT_NEAR(out.after.z, 0.4, 1e-14);
    }
}

TEST(FrictionalImpact, RodSticksWhereItsSlipStops) {
    const Mat3 k = rod(0.6);
    const double friction = 1.01 * k.m[2] / k.m[0];
    const Outcome out = impact(k, {-0.2, 0, -1}, 0.4, friction);
    EXPECT_NEAR(length(out.after - Vec3{0, 0, 0.4}), 0, 1e-14);
    EXPECT_LT(std::abs(out.impulse.x), friction * out.impulse.z);
}

// Friction pulls the end in at first: it ends where the rod stops to slide and is thrown up.
TEST(FrictionalImpact, JamEndsWithTheSlip) {
    const Mat3 k = rod(0.6);
    const double xx = k.m[0], xz = k.m[2], zz = k.m[8], friction = 1.5 * zz / xz;
    const Outcome out = impact(k, {3, 0, -0.1}, 0, friction);
    EXPECT_NEAR(length(out.after), 0, 1e-14);
    EXPECT_GT(out.impulse.z, 3 / (friction * xx - xz)) << "up to where it stops it is drawn in";
}

/// The course in 10^6 legs of the first order.
Vec3 in_small_legs(const Mat3& k, const Vec3& before, double target, double friction) {
    Vec3 u = before, impulse;
    const double p = 1e-6 * (target - before.z);
    while (u.z < target) {
        const Vec3 slip{u.x, u.y, 0};
        const Vec3 push = kUp - friction * normalized(slip);
        u += p * (k * push);
        impulse += p * push;
    }
    return impulse;
}

TEST(FrictionalImpact, SlipTurnsOnTheWay) {
    std::mt19937_64 rng(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    double least = 1; // of the impulse across, by friction times that along: below 1 where slip turned
    for (int i = 0; i < 25; ++i) {
        const Mat3 k = mobility({2 + unit(rng), 8 + 4 * unit(rng), 14 + 5 * unit(rng)}, {unit(rng), unit(rng), -1});
        const Vec3 before{2 * unit(rng), 2 * unit(rng), -1 + 0.4 * unit(rng)};
        const double friction = 0.25 + 0.2 * unit(rng), target = -0.3 * before.z;
        const Vec3 due = in_small_legs(k, before, target, friction);
        const Outcome out = impact(k, before, target, friction);
        EXPECT_LT(length(out.impulse - due), 3e-3 * length(due)) << i;
        EXPECT_NEAR(out.after.z, target, 1e-12);
        EXPECT_LE(std::hypot(out.impulse.x, out.impulse.y), friction * out.impulse.z * (1 + 1e-12));
        least = std::min(least, std::hypot(out.impulse.x, out.impulse.y) / (friction * out.impulse.z));
        EXPECT_LE(dot(out.impulse, before) + 0.5 * dot(out.impulse, k * out.impulse), 1e-12) << "energy";
    }
    EXPECT_LT(least, 0.8);
}

TEST(FrictionalImpact, OfWhatDoesNotSlipTakesTheCone) {
    const Mat3 k = mobility({2, 9, 14}, {0.3, 0.8, -1});
    const Outcome held = impact(k, {0, 0, -1}, 0.5, 2);
    EXPECT_NEAR(length(held.after - Vec3{0, 0, 0.5}), 0, 1e-14);
    std::mt19937_64 rng(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    int slide = 0;
    for (int i = 0; i < 2000; ++i) {
        const Mat3 any =
            mobility({1 + 20 * std::abs(unit(rng)), 1 + 20 * std::abs(unit(rng)), 1 + 20 * std::abs(unit(rng))},
                     {2 * unit(rng), 2 * unit(rng), -0.1 - std::abs(unit(rng))});
        const double friction = 0.5 * std::abs(unit(rng)) + 0.01;
        const Outcome out = impact(any, {0, 0, -1}, 0.5, friction);
        const Vec3 slip{out.after.x, out.after.y, 0}, drag{out.impulse.x, out.impulse.y, 0};
        EXPECT_NEAR(out.after.z, 0.5, 1e-12) << i;
        if (length(slip) < 1e-9) continue;
        ++slide;
        EXPECT_NEAR(length(drag), friction * out.impulse.z, 1e-9 * out.impulse.z) << i;
        EXPECT_NEAR(dot(normalized(slip), normalized(drag)), -1, 1e-6) << i;
    }
    EXPECT_GT(slide, 1000);
}

// A hinge about y lets the point move along one line in the plane y = 0, and a script drives it along x: a push that
// friction keeps off that line would be of any size.
TEST(FrictionalImpact, HingeThatFrictionBalancesTakesThePushWithoutIt) {
    for (const double friction : {0.4, 0.5, 0.5 + 1e-9, 0.500001, 0.6, 1.0}) {
        const Vec3 line = normalized(Vec3{2, 0, 1}); // n - mu t is across it for mu = 1/2
        Mat3 k{};
        const double of[3] = {line.x, line.y, line.z};
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) k.m[3 * i + j] = of[i] * of[j];
        const Vec3 impulse = frictional_impact({k, kUp, friction, true}, {5, 0, -1}, 0);
        const double alone = 1 / k.m[8];
        EXPECT_LT(length(impulse), 1100 * alone) << friction;
        EXPECT_NEAR(-1 + dot(kUp, k * impulse), 0, 1e-9) << friction;
    }
}

} // namespace
} // namespace flotilla
