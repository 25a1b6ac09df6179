// SPDX-License-Identifier: MIT
// Contact points of convex bodies, found in the slices at a plane: those of the general search, bit for bit, whichever
// plane is given.
#include <gtest/gtest.h>

#include "support/convex_pair.hpp"

namespace flotilla {
namespace {

using test::ConvexPair;
using test::Random;

const double kAngleCos = std::cos(3 * std::numbers::pi / 180);

bool same(const ProximityPoint& p, const ProximityPoint& q) {
    return p.features == q.features && p.a == q.a && p.b == q.b && p.normal == q.normal && p.distance == q.distance;
}

void expect_same(const std::vector<ProximityPoint>& points, const std::vector<ProximityPoint>& expected) {
    ASSERT_EQ(points.size(), expected.size());
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_TRUE(same(points[i], expected[i]));
}

void expect_same(const PruneCounters& c, const PruneCounters& expected) {
    EXPECT_EQ(c.proximities, expected.proximities);
    EXPECT_EQ(c.same_direction, expected.same_direction);
    EXPECT_EQ(c.angle, expected.angle);
    EXPECT_EQ(c.occluded, expected.occluded);
    EXPECT_EQ(c.end_points, expected.end_points);
}

/// A gap that makes contacts, or nearly none.
double random_gap(Random& random, double proximity) { return proximity * std::max(1e-3, random.uniform(-0.2, 1.1)); }

/// Compares the general search, which knows nothing of convexity, with what is found by a plane along any direction.
/// How many contact points there are.
std::size_t compare(ConvexPair& pair, double proximity, const Vec3& direction) {
    ProximityScratch general, sliced;
    std::vector<ProximityPoint> expected, points;
    pair.set_convex(false);
    const auto known = find_contact_points(pair.a(), pair.b(), proximity, kAngleCos, {}, general, expected);
    pair.set_convex(true);
    const QueryAid aid(direction);
    const auto result = find_contact_points(pair.a(), pair.b(), proximity, kAngleCos, aid, sliced, points);
    EXPECT_EQ(result.near, known.near);
    EXPECT_EQ(result.distance, known.distance);
    expect_same(points, expected);
    expect_same(sliced.found, general.found);
    expect_same(sliced.counters, general.counters);
    EXPECT_EQ(any_proximity(pair.a(), pair.b(), proximity, aid, sliced), known.near);
    return points.size();
}

TEST(ConvexContactPoints, AreThoseOfTheGeneralSearch) {
    Random random(1);
    int one = 0, many = 0, none = 0;
    for (int i = 0; i < 4000; ++i) {
        const double proximity = std::pow(10, random.uniform(-4, 0)); // up to the size of the bodies
        ConvexPair pair(random, random_gap(random, proximity));
        ASSERT_TRUE(worth_slicing(pair.a(), pair.b()));
        const std::size_t points = compare(pair, proximity, pair.direction());
        ++(points == 0 ? none : points == 1 ? one : many);
        ASSERT_FALSE(HasFailure()) << "pair " << i;
    }
    EXPECT_GT(none, 300);
    EXPECT_GT(one, 1000);
    EXPECT_GT(many, 300);
}

TEST(ConvexContactPoints, DoNotDependOnThePlane) {
    Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const double proximity = std::pow(10, random.uniform(-3, -1));
        ConvexPair pair(random, random_gap(random, proximity));
        const double off = std::pow(10, random.uniform(-3, 1));
        compare(pair, proximity, normalized(pair.direction() + random.vec(off)));
        ASSERT_FALSE(HasFailure()) << "pair " << i;
    }
}

TEST(PassingPoints, AreTheSameWhateverDirectionIsKnown) {
    Random random(3);
    int passing = 0;
    for (int i = 0; i < 2000; ++i) {
        const double proximity = std::pow(10, random.uniform(-3, 0)), rest = random.uniform(0.1, 1) * proximity;
        const ConvexPair pair(random, random_gap(random, proximity));
        const auto ways = [&] {
            return PointWays{pair.a().at0.x[0], proximity * random.vec(2), proximity * random.vec(2)};
        };
        const PassingBodies bodies{ways(), ways(), rest};
        const auto found = [&](const Vec3& across, ProximityScratch& scratch) {
            PassingBodies known = bodies;
            known.across = across;
            std::vector<ProximityPoint> points;
            find_passing_points(pair.a(), pair.b(), known, proximity, kAngleCos, scratch, points);
            return points;
        };
        ProximityScratch scratch;
        const auto expected = found({}, scratch);
        passing += expected.empty() ? 0 : 1;
        for (const double off : {0.0, 1e-9, 0.1, 10.0}) {
            ProximityScratch with;
            expect_same(found(normalized(pair.direction() + random.vec(off)), with), expected);
            expect_same(with.counters, scratch.counters);
        }
        ASSERT_FALSE(HasFailure()) << "pair " << i;
    }
    EXPECT_GT(passing, 500);
}

} // namespace
} // namespace flotilla
