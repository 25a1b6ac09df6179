// SPDX-License-Identifier: MIT
// The hits of one pair resolved together: a crate lands flat.
#include "response/pair_manifold.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace flotilla {
namespace {

constexpr Vec3 kUp{0, 0, 1};
constexpr double kGap = 0.05;    // m, of the first hit at the start of the step
constexpr double kSolved = 1e-5; // m/s and rad/s: the sweeps stop at 2^-20 of 3 m/s

Impulsive make_body(double mass, const Vec3& inertia, const Vec3& velocity, const Vec3& spin = {}) {
    return {1 / mass, diagonal({1 / inertia.x, 1 / inertia.y, 1 / inertia.z}), velocity, spin};
}

double energy(const Impulsive& b) {
    const auto& i = b.inverse_inertia.m;
    const Vec3 w = b.angular_velocity;
    if (!(b.inverse_mass > 0)) return 0;
    return 0.5 * (length_sq(b.velocity) / b.inverse_mass + w.x * w.x / i[0] + w.y * w.y / i[4] + w.z * w.z / i[8]);
}

/// A pair whose hits are resolved as in Algorithm 1.
struct Pair {
    Impulsive a, b;
    PairManifold manifold{};
    std::vector<PairManifold::Change> changes{};

    void push(const ContactPoint& p, const Vec3& impulse) {
        a.velocity -= a.inverse_mass * impulse;
        a.angular_velocity -= a.inverse_inertia * cross(p.arm_a, impulse);
        b.velocity += b.inverse_mass * impulse;
        b.angular_velocity += b.inverse_inertia * cross(p.arm_b, impulse);
    }
    Vec3 relative(const ContactPoint& p) const { return point_velocity(b, p.arm_b) - point_velocity(a, p.arm_a); }
    bool resolve(std::vector<ContactPoint> points, double restitution) {
        for (ContactPoint& p : points) p.relative_velocity = relative(p);
        if (!manifold.resolve(points, restitution, false, changes)) return false;
        for (const PairManifold::Change& c : changes) push(c.point, c.impulse);
        return true;
    }
};

/// Four corners of the lower face of a crate of edge 1, of unit mass, on one like it or on the ground.
std::vector<ContactPoint> corners(double friction) {
    std::vector<ContactPoint> points;
    for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5}) points.push_back({kUp, {x, y, 0.5}, {x, y, -0.5}, {}, friction});
    return points;
}

TEST(PairManifold, ACrateThatLandsFlatReboundsWithoutSpin) {
    for (const double ground_mass : {0.0, 1.0})
        for (const double e : {0.0, 0.5, 1.0})
            for (const double friction : {0.0, 0.3}) {
                Pair p{ground_mass > 0 ? make_body(1, {0.2, 0.2, 0.2}, {}) : Impulsive{},
                       make_body(1, {0.2, 0.3, 0.4}, {0, 0, -3})};
                p.manifold.start(p.a, p.b, kGap);
                const std::vector<ContactPoint> points = corners(friction);
                ASSERT_TRUE(p.resolve(points, e));
                EXPECT_EQ(p.changes.size(), 4u);
                for (const ContactPoint& c : points) EXPECT_NEAR(p.relative(c).z, e * 3, kSolved);
                EXPECT_LT(length(p.b.angular_velocity), kSolved);
                EXPECT_LT(length(p.a.angular_velocity), kSolved);
                EXPECT_NEAR(p.b.velocity.z - p.a.velocity.z, e * 3, kSolved);
                EXPECT_NEAR(p.b.velocity.z + ground_mass * p.a.velocity.z, ground_mass > 0 ? -3 : e * 3, kSolved);
            }
}

// Resolved alone, the first corner turns the crate; found afterwards, the others turn it back.
TEST(PairManifold, CornersFoundOneAfterAnotherAreResolvedTogether) {
    Pair p{{}, make_body(1, {1.0 / 6, 1.0 / 6, 1.0 / 6}, {0, 0, -3})};
    p.manifold.start(p.a, p.b, kGap);
    std::vector<ContactPoint> points = corners(0);
    points[0].relative_velocity = p.relative(points[0]);
    const Vec3 alone = contact_impulse(p.a, p.b, points[0], 0.5 * 3).value();
    p.manifold.add(points[0], 0.5, alone);
    p.push(points[0], alone);
    EXPECT_GT(length(p.b.angular_velocity), 1);
    for (const std::size_t k : {3u, 1u, 2u}) (void)p.resolve({points[k]}, 0.5);
    for (const ContactPoint& c : points) EXPECT_NEAR(p.relative(c).z, 1.5, kSolved);
    EXPECT_LT(length(p.b.angular_velocity), kSolved);
}

TEST(PairManifold, FrictionIsCoulombs) {
    for (const double slip : {0.5, 4.0}) { // the crate's mass times what friction of 0.3 changes: 0.3 * 4.5 m/s
        Pair p{{}, make_body(1, {1e9, 1e9, 1e9}, {slip, 0, -3})}; // hardly turns
        p.manifold.start(p.a, p.b, kGap);
        ASSERT_TRUE(p.resolve(corners(0.3), 0.5));
        EXPECT_NEAR(p.b.velocity.x, std::max(0.0, slip - 0.3 * 4.5), kSolved);
        EXPECT_NEAR(p.b.velocity.z, 1.5, kSolved);
    }
}

TEST(PairManifold, RefusesAHitThatGetsNoImpulseAndForgetsIt) {
    Pair p{{}, make_body(1, {0.2, 0.2, 0.2}, {0, 0, -3})};
    p.manifold.start(p.a, p.b, kGap);
    ASSERT_TRUE(p.resolve({{kUp, {}, {}, {}, 0}}, 0));
    const Vec3 before = p.b.velocity;
    EXPECT_FALSE(p.resolve({{kUp, {}, {}, {}, 0}}, 0)) << "the same point, at rest by now";
    EXPECT_EQ(p.b.velocity, before);
    Pair ground{{}, {}};
    ground.manifold.start(ground.a, ground.b, kGap);
    EXPECT_FALSE(ground.resolve(corners(0.3), 1)) << "two of infinite mass";
    EXPECT_TRUE(ground.manifold.empty());
}

TEST(PairManifold, NoEnergyIsGainedAndImpulsesStayInTheirCones) {
    std::mt19937_64 rng(11);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit;
    const auto vec = [&] { return Vec3{normal(rng), normal(rng), normal(rng)}; };
    const auto some_body = [&] {
        const double mass = std::exp(2 * normal(rng));
        return make_body(mass, mass * Vec3{0.01 + unit(rng), 0.01 + unit(rng), 0.01 + unit(rng)}, vec(), 3.0 * vec());
    };
    int resolved = 0;
    for (int i = 0; i < 10000; ++i) {
        Pair p{i % 3 == 0 ? Impulsive{} : some_body(), some_body()};
        const double before = energy(p.a) + energy(p.b), e = unit(rng);
        p.manifold.start(p.a, p.b, kGap);
        const Vec3 n = normalized(vec());
        for (int batch = 0; batch < 1 + i % 3; ++batch) {
            std::vector<ContactPoint> points;
            const int count = 1 + static_cast<int>(rng() % 5);
            for (int k = 0; k < count; ++k)
                points.push_back({i % 2 ? n : normalized(vec()), vec(), vec(), {}, i % 5 ? unit(rng) : 0.0});
            std::vector<Vec3> total;
            if (!p.resolve(points, e)) continue;
            ++resolved;
            EXPECT_LE(energy(p.a) + energy(p.b), before * (1 + 1e-12)) << i;
            if (batch > 0) continue; // the changes are all there is
            for (const PairManifold::Change& c : p.changes) {
                const double along = dot(c.impulse, c.point.normal);
                EXPECT_GE(along, 0);
                EXPECT_LE(length(c.impulse - along * c.point.normal), c.point.friction * along + 1e-12 * along);
            }
        }
    }
    EXPECT_GT(resolved, 5000);
}

// With 3 m/s the first corner meets at 1/60 s; what decides are the velocities before its impulse, which stops it.
TEST(PairManifold, AHitIsSimultaneousWhereItMeetsAtThatTimeWithoutTheFirst) {
    constexpr double kReach = 0.002;
    Pair p{Impulsive{}, make_body(1, {0.2, 0.3, 0.4}, {0, 0, -3})};
    p.manifold.start(p.a, p.b, kGap);
    std::vector<ContactPoint> points = corners(0.3);
    ASSERT_TRUE(p.resolve({points[0]}, 0));
    ContactPoint& next = points[3];
    next.relative_velocity = p.relative(next);
    EXPECT_LT(next.relative_velocity.z, -3.1) << "faster than before";
    EXPECT_TRUE(p.manifold.simultaneous(next, kGap, kReach));
    EXPECT_TRUE(p.manifold.simultaneous(next, kGap + 0.9 * kReach, kReach));
    EXPECT_TRUE(p.manifold.simultaneous(next, kGap - 0.9 * kReach, kReach));
    EXPECT_FALSE(p.manifold.simultaneous(next, kGap + 1.1 * kReach, kReach));
    EXPECT_FALSE(p.manifold.simultaneous(next, kGap - 1.1 * kReach, kReach));
}

// A corner that only touches, and that the other one's blow drives into the ground, is hit after that.
TEST(PairManifold, APointThatWouldNotMeetIsHitLater) {
    Pair p{Impulsive{}, make_body(1, {0.2, 0.3, 0.4}, {0, 0, -3}, {0, 6, 0})};
    p.manifold.start(p.a, p.b, 1e-4);
    std::vector<ContactPoint> points = corners(0);
    ContactPoint touching = points[0], landing = points[3];
    EXPECT_NEAR(p.relative(touching).z, 0, 1e-15);
    ASSERT_TRUE(p.resolve({landing}, 0));
    touching.relative_velocity = p.relative(touching);
    EXPECT_LT(touching.relative_velocity.z, -1);
    for (const double noise : {-1e-15, 0.0, 1e-15}) {
        ContactPoint point = touching;
        point.relative_velocity.z += noise;
        EXPECT_FALSE(p.manifold.simultaneous(point, 0, 0.002)) << noise;
    }
    touching.relative_velocity.z -= 0.1;
    EXPECT_TRUE(p.manifold.simultaneous(touching, 0, 0.002)) << "had it come nearer, it would have met";
}

} // namespace
} // namespace flotilla
