// SPDX-License-Identifier: MIT
// Contact points on arcs: a wheel rolls.
#include "response/arc.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "base/random.hpp"
#include "base/rotation.hpp"

namespace flotilla {
namespace {

constexpr Vec3 kUp{0, 0, 1};
constexpr TurningPoint kGround{};

/// A point of a wheel of radius r that rolls towards +x, by `angle` (rad) ahead of the one right below the axle.
TurningPoint ahead(double angle, double omega, double r) {
    return {{0, omega, 0}, {r * std::sin(angle), 0, -r * std::cos(angle)}};
}

TEST(ArcWay, IsTheTurnOfThePoint) {
    for (std::int64_t k = 0; k < 1000; ++k) {
        const auto number = [&](std::int64_t i) { return 2 * unit_interval(random_bits(k, i)) - 1; };
        const Vec3 w = unit_interval(random_bits(k, 0)) * normalized(Vec3{number(1), number(2), number(3)});
        const Vec3 arm{number(4), number(5), number(6)};
        const Vec3 exact = rotate(rotation_from_vector(w), arm) - arm;
        EXPECT_LE(length(arc_way(w, arm) - exact), 3e-5 * length(cross(w, arm)) + 1e-15);
    }
}

// Turned by tan(x) instead of x, a point x ahead goes past the lowest place by x^3 / 3 and is higher there by x^6 / 18.
TEST(MeetOnArcs, PointsAheadOfARollingWheelMeetTheGroundRightBelowTheAxle) {
    constexpr double kOmega = 3, kRadius = 0.7, kStep = 0.1;
    for (double angle = 0.01; std::tan(angle) <= kOmega * kStep; angle += 0.01) {
        const TurningPoint wheel = ahead(angle, kOmega, kRadius);
        const double gap = kRadius * (1 - std::cos(angle)); // of a wheel that touches the ground
        const ArcContact c = meet_on_arcs(kGround, wheel, kUp, kStep);
        EXPECT_NEAR(c.closer, gap, kRadius * (std::pow(angle, 6) / 10 + 1e-14)) << angle;
        EXPECT_NEAR(wheel.arm.x + c.shift.x, 0, kRadius * (std::pow(angle, 3) / 2 + 1e-14)) << angle;
        EXPECT_NEAR(wheel.arm.z + c.shift.z, -kRadius, kRadius * (std::pow(angle, 6) / 10 + 1e-14)) << angle;
        EXPECT_NEAR(c.approach, 0, kOmega * kRadius * std::pow(angle, 3)) << "nothing is left to brake the wheel";
        EXPECT_LE(c.approach, 0);
        EXPECT_FALSE(c.ahead);
        EXPECT_NEAR(c.apart, kOmega * kOmega * kRadius * std::cos(angle), 1e-14);
    }
}

TEST(MeetOnArcs, APointFartherAheadComesNearerUntilTheEndOfTheStep) {
    constexpr double kOmega = 3, kRadius = 0.7, kStep = 0.1;
    for (const double angle : {0.35, 0.6, 1.0}) {
        const TurningPoint wheel = ahead(angle, kOmega, kRadius);
        const ArcContact c = meet_on_arcs(kGround, wheel, kUp, kStep);
        const TurningPoint then = ahead(angle - kOmega * kStep, kOmega, kRadius);
        EXPECT_LT(length(wheel.arm + c.shift - then.arm), 1e-6);
        EXPECT_NEAR(c.approach, -kOmega * then.arm.x, 1e-5);
        EXPECT_TRUE(c.ahead);
    }
}

TEST(MeetOnArcs, EitherBodyMayBeTheWheel) {
    const TurningPoint wheel = ahead(0.2, 3, 0.7);
    const ArcContact above = meet_on_arcs(kGround, wheel, kUp, 0.1), below = meet_on_arcs(wheel, kGround, -kUp, 0.1);
    EXPECT_EQ(above.closer, below.closer);
    EXPECT_EQ(above.approach, below.approach);
    EXPECT_EQ(above.shift, below.shift);
    EXPECT_EQ(above.apart, below.apart);
}

TEST(MeetOnArcs, PointsThatSeparateStayWhereTheyAre) {
    for (const double angle : {-0.3, -0.01, 0.0, 0.75 * std::numbers::pi}) { // behind, below and above the axle
        const ArcContact c = meet_on_arcs(kGround, ahead(angle, 3, 0.7), kUp, 0.1);
        EXPECT_EQ(c.closer, 0) << angle;
        EXPECT_EQ(c.approach, 0) << angle;
        EXPECT_EQ(c.shift, Vec3{}) << angle;
    }
    const ArcContact still = meet_on_arcs(kGround, ahead(0.2, 0, 0.7), kUp, 0.1);
    EXPECT_EQ(still.shift, Vec3{});
    EXPECT_EQ(still.apart, 0);
}

TEST(MeetOnArcs, NothingTurnsByMoreThanARadian) {
    const TurningPoint wheel = ahead(1.3, 1000, 0.7); // 41 rad in the step
    const ArcContact c = meet_on_arcs(kGround, wheel, kUp, 1.0 / 24);
    EXPECT_LT(length(wheel.arm + c.shift - ahead(0.3, 1000, 0.7).arm), 3e-5);
}

// What turns with the inside of a ring is asked for half of its centripetal velocity, and what turns with the outside
// may fall behind by as much. What does not turn with it has nothing of that.
TEST(MeetOnArcs, WhatTurnsTogetherComesNearerOrPartsInTheMean) {
    constexpr double kRate = 2, kStep = 0.1, kArm = 0.7, kBlock = 0.1;
    const TurningPoint ring{{0, kRate, 0}, {0, 0, -kArm}}, block{{0, kRate, 0}, {0, 0, -kBlock}},
        against{{0, -kRate, 0}, {0, 0, -kBlock}};
    const double due = 0.5 * kStep * kRate * kRate * (kArm - kBlock);
    EXPECT_NEAR(meet_on_arcs(ring, block, kUp, kStep).together, due, 1e-15);
    EXPECT_NEAR(meet_on_arcs(block, ring, -kUp, kStep).together, due, 1e-15);
    EXPECT_NEAR(meet_on_arcs(ring, block, -kUp, kStep).together, -due, 1e-15);
    EXPECT_EQ(meet_on_arcs(ring, against, kUp, kStep).together, 0);
    EXPECT_EQ(meet_on_arcs(ring, against, -kUp, kStep).together, 0);
}

TEST(MeetOnArcs, OtherUnitsGiveTheSameBits) {
    constexpr double kLength = 0x1p-20, kTime = 0x1p-8;
    for (const double angle : {0.05, 0.29, 0.4, 0.9}) {
        TurningPoint wheel = ahead(angle, 3, 0.7);
        TurningPoint other{{0.3, -0.1, 0.7}, {0.2, 0.4, 0.1}};
        const ArcContact c = meet_on_arcs(other, wheel, kUp, 0.1);
        for (TurningPoint* p : {&wheel, &other}) p->omega = p->omega / kTime, p->arm = kLength * p->arm;
        const ArcContact scaled = meet_on_arcs(other, wheel, kUp, kTime * 0.1);
        EXPECT_EQ(scaled.closer, kLength * c.closer);
        EXPECT_EQ(scaled.approach, kLength / kTime * c.approach);
        EXPECT_EQ(scaled.shift, kLength * c.shift);
        EXPECT_EQ(scaled.apart, kLength / (kTime * kTime) * c.apart);
    }
}

TEST(ApproachOnArrival, IsThatOfAThrow) {
    EXPECT_DOUBLE_EQ(approach_on_arrival(5, 0.5, 9), 4);
    EXPECT_EQ(approach_on_arrival(2.9, 0.5, 9), 0);
}

TEST(ApproachOnArrival, IsTheApproachOfPointsThatHaveArrivedOrThatNothingBrakes) {
    EXPECT_EQ(approach_on_arrival(5, -1, 9), 5);
    EXPECT_EQ(approach_on_arrival(5, 1, -9), 5);
}

} // namespace
} // namespace flotilla
