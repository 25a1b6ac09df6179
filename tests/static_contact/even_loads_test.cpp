// SPDX-License-Identifier: MIT
// How the contacts of a flat side share what it carries.
#include "static_contact/even_loads.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace flotilla {
namespace {

constexpr double kFriction = 0.5, kTolerance = 1e-6, kRounding = 1e-12;

/// Contacts of one pair at the points, on the side of that normal, which touch; impulses by contact.
struct Sides {
    std::vector<Contact> contacts;
    std::vector<Vec3> impulses;

    void add(const Vec3& point, const Vec3& normal, const Vec3& impulse, double target = 0) {
        Contact& c = contacts.emplace_back();
        c.a = 0, c.b = 1;
        c.point = point, c.normal = normal;
        c.target = target, c.tolerance = kTolerance;
        c.friction = kFriction;
        c.feature_key = contacts.size();
        impulses.push_back(impulse);
    }
    /// Corners of a square of 2 m at height 0.
    void add_square(const std::vector<Vec3>& loads) {
        const Vec3 corners[] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
        for (std::size_t i = 0; i < 4; ++i) add(corners[i], {0, 0, 1}, loads[i]);
    }
    void share() {
        Team team;
        std::vector<std::vector<SharedLoad>> scratch;
        even_loads(&team, contacts, {}, impulses, scratch);
    }
    [[nodiscard]] Vec3 force() const {
        Vec3 sum;
        for (const Vec3& l : impulses) sum += l;
        return sum;
    }
    [[nodiscard]] Vec3 torque() const {
        Vec3 sum;
        for (std::size_t i = 0; i < impulses.size(); ++i) sum += cross(contacts[i].point, impulses[i]);
        return sum;
    }
    [[nodiscard]] bool within_cones() const {
        for (std::size_t i = 0; i < impulses.size(); ++i) {
            const double n = dot(impulses[i], contacts[i].normal);
            if (n < 0 || length(impulses[i] - n * contacts[i].normal) > kFriction * n + kRounding) return false;
        }
        return true;
    }
};

void expect_near(const Vec3& value, const Vec3& due) {
    EXPECT_LT(length(value - due), kRounding) << value.x << " " << value.y << " " << value.z;
}

TEST(EvenLoads, ALoadInTheMiddleIsTheSameAtEveryCorner) {
    Sides sides;
    sides.add_square({{0, 0, 3}, {0, 0, 1}, {0, 0, 3}, {0, 0, 1}});
    sides.share();
    for (const Vec3& l : sides.impulses) expect_near(l, {0, 0, 2});
}

TEST(EvenLoads, ALoadBesideTheMiddleIsAffineInThePlace) {
    Sides sides;
    sides.add_square({{0, 0, 5}, {0, 0, 3}, {0, 0, 4}, {0, 0, 0}}); // torque: that of 1 + 1 at the middles of two sides
    const Vec3 force = sides.force(), torque = sides.torque();
    sides.share();
    expect_near(sides.force(), force);
    expect_near(sides.torque(), torque);
    EXPECT_NEAR(sides.impulses[0].z + sides.impulses[2].z, sides.impulses[1].z + sides.impulses[3].z, kRounding);
}

TEST(EvenLoads, NoContactPulls) {
    Sides sides;
    sides.add_square({{0, 0, 8}, {0, 0, 0}, {0, 0, 0.5}, {0, 0, 0}}); // evenly it would be -1.625 at the third
    const Vec3 force = sides.force(), torque = sides.torque();
    sides.share();
    expect_near(sides.force(), force);
    expect_near(sides.torque(), torque);
    EXPECT_TRUE(sides.within_cones());
    EXPECT_GT(sides.impulses[1].z, 0.1); // as far as it goes
}

TEST(EvenLoads, FrictionOfASideThatHoldsStaysWithinItsCones) {
    Sides sides;
    sides.add_square({{3.8, 0, 8}, {0.1, 0.2, 1}, {0.2, 0, 8}, {-0.1, 0, 1}});
    const Vec3 force = sides.force(), torque = sides.torque();
    sides.share();
    expect_near(sides.force(), force);
    expect_near(sides.torque(), torque);
    EXPECT_TRUE(sides.within_cones());
    EXPECT_LT(std::abs(sides.impulses[0].z - sides.impulses[1].z), 1e-3);
}

TEST(EvenLoads, WhereOneCornerSlidesForceAndTorqueStay) {
    Sides sides;
    sides.add_square({{1.5, 0, 3}, {0.1, 0, 1}, {0.1, 0, 3}, {0.1, 0, 1}});
    const Vec3 force = sides.force(), torque = sides.torque();
    sides.share();
    expect_near(sides.force(), force);
    expect_near(sides.torque(), torque);
    EXPECT_TRUE(sides.within_cones());
}

TEST(EvenLoads, WhatSlidesInOneDirectionGoesOnSo) {
    Sides sides;
    sides.add_square({{1.5, 0, 3}, {0.5, 0, 1}, {1.5, 0, 3}, {0.5, 0, 1}});
    const Vec3 torque = sides.torque();
    sides.share();
    for (const Vec3& l : sides.impulses) expect_near(l, {1, 0, 2});
    expect_near(sides.torque(), torque);
}

TEST(EvenLoads, FrictionOutsideItsConeDoesNotGrow) {
    for (const double load : {1e-8, 1e-310, 0.0}) {
        Sides sides;
        sides.add_square({{5, 0, 3}, {5, 0, load}, {5, 0, 3}, {5, 0, 1}});
        sides.share();
        for (const Vec3& l : sides.impulses) EXPECT_LE(length(l), 6) << load;
    }
}

TEST(EvenLoads, TheOrderOfContactsIsNoMatter) {
    Sides sides;
    sides.add_square({{}, {0, 0, 4}, {}, {0, 0, 4}});
    sides.share();
    for (const Vec3& l : sides.impulses) expect_near(l, {0, 0, 2});
}

TEST(EvenLoads, EachSideOfABodySharesItsOwn) {
    Sides sides;
    sides.add_square({{0, 0, 3}, {0, 0, 1}, {0, 0, 3}, {0, 0, 1}});
    for (const double y : {-1.0, 1.0})
        for (const double z : {0.5, 2.5}) sides.add({-1, y, z}, {1, 0, 0}, {y * (z - 1.5) > 0 ? 6.0 : 2.0, 0, 0});
    sides.share();
    for (std::size_t i = 0; i < 4; ++i) expect_near(sides.impulses[i], {0, 0, 2});
    for (std::size_t i = 4; i < 8; ++i) expect_near(sides.impulses[i], {4, 0, 0});
}

TEST(EvenLoads, WhatDoesNotTouchCarriesNothing) {
    Sides sides;
    sides.add_square({{0, 0, 3}, {0, 0, 1}, {0, 0, 3}, {0, 0, 1}});
    sides.add({0, 0, 0}, {0, 0, 1}, {}, -1); // far enough to approach at 1 m/s
    sides.add({0, 0, 0}, {0, 0, 1}, {}, 0);
    sides.share();
    expect_near(sides.impulses[4], {});
    expect_near(sides.impulses[5], {0, 0, 1.6});
}

TEST(EvenLoads, ALineOfPointsSharesAlongIt) {
    Sides sides;
    for (const double x : {-1.5, -0.5, 0.5, 1.5}) sides.add({x, 0, 0}, {0, 0, 1}, {0, 0, x < -1 || x > 1 ? 4.0 : 0.0});
    sides.share();
    for (const Vec3& l : sides.impulses) expect_near(l, {0, 0, 2});
}

TEST(EvenLoads, PointsOfACurvedSideAndThreePointsKeepWhatTheyHave) {
    Sides curved, three;
    for (const double x : {-0.2, -0.1, 0.1, 0.2})
        curved.add({x, 0, 1 - std::sqrt(1 - x * x)}, normalized(Vec3{-x, 0, std::sqrt(1 - x * x)}), {0, 0, 1 + x});
    three.add_square({{0, 0, 3}, {0, 0, 1}, {0, 0, 3}, {0, 0, 1}});
    three.contacts.pop_back();
    three.impulses.pop_back();
    const auto before_curved = curved.impulses, before_three = three.impulses;
    curved.share();
    three.share();
    EXPECT_EQ(curved.impulses, before_curved);
    EXPECT_EQ(three.impulses, before_three);
}

} // namespace
} // namespace flotilla
