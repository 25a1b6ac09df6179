// SPDX-License-Identifier: MIT
// Slices of convex bodies at a plane: a query finds in them what it finds without, bit for bit.
#include <gtest/gtest.h>

#include "ccd/pair_query.hpp"
#include "support/convex_pair.hpp"

namespace flotilla {
namespace {

using test::ConvexPair;
using test::Random;

/// Whether there is a hit, the same in slices along any direction.
bool compare(const ConvexPair& pair, double separation, const Vec3& direction) {
    CcdScratch general, sliced;
    const BodyMotion a = pair.motion(0), b = pair.motion(1);
    const PairHit expected = earliest_hit(a, b, {separation}, {}, general);
    const PairHit hit = earliest_hit(a, b, {separation}, QueryAid(direction), sliced);
    EXPECT_EQ(hit.hit, expected.hit);
    EXPECT_EQ(hit.toi, expected.toi);
    EXPECT_TRUE(hit.features == expected.features);
    EXPECT_TRUE(hit.normal == expected.normal);
    return hit.hit;
}

TEST(PlaneFeatures, HoldTheEarliestHit) {
    Random random(1);
    int hits = 0, misses = 0;
    for (int i = 0; i < 3000; ++i) {
        const double separation = std::pow(10, random.uniform(-6, -3)), far = std::pow(10, random.uniform(-4, 0));
        ConvexPair pair(random, separation + random.uniform(0, 1) * far);
        pair.move(random, far);
        ++(compare(pair, separation, pair.direction()) ? hits : misses);
        ASSERT_FALSE(HasFailure()) << "pair " << i;
    }
    EXPECT_GT(hits, 500);
    EXPECT_GT(misses, 500);
}

TEST(PlaneFeatures, HoldItWhicheverPlaneIsGiven) {
    Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const double separation = std::pow(10, random.uniform(-6, -3)), far = std::pow(10, random.uniform(-3, 0));
        ConvexPair pair(random, separation + random.uniform(0, 1) * far);
        pair.move(random, far);
        compare(pair, separation, normalized(pair.direction() + random.vec(std::pow(10, random.uniform(-3, 1)))));
        ASSERT_FALSE(HasFailure()) << "pair " << i;
    }
}

TEST(PlaneFeatures, NeedAPlaneThatHelps) {
    Random random(3);
    const ConvexPair pair(random, 0.1);
    SliceScratch scratch;
    for (const FeatureTest test : {FeatureTest::near, FeatureTest::swept}) {
        EXPECT_TRUE(slice_features(test, pair.a(), pair.b(), pair.direction(), 0.2, scratch));
        EXPECT_FALSE(scratch.found().empty());
        EXPECT_TRUE(slice_features(test, pair.a(), pair.b(), pair.direction(), 0.01, scratch));
        EXPECT_TRUE(scratch.found().empty());
        EXPECT_FALSE(slice_features(test, pair.a(), pair.b(), -pair.direction(), 0.01, scratch));
        EXPECT_TRUE(scratch.found().empty());
    }
}

TEST(PlaneFeatures, OfBodiesOfManyVerticesOrNoConvexOnesAreLeftToLists) {
    const auto worth = [](const TriangleMesh& mesh) {
        Model model;
        model.shapes.push_back(test::shape_of(mesh));
        model.bodies.resize(2);
        Trajectories trajectories;
        trajectories.start(model, std::array<Pose, 2>{});
        return worth_slicing(trajectories.at_start(0), trajectories.at_start(1));
    };
    EXPECT_TRUE(worth(make_box(1, 1, 1)));
    EXPECT_TRUE(worth(make_plate(1, 1)));
    EXPECT_FALSE(worth(make_sphere(1, 2)));
    EXPECT_FALSE(worth(make_ring(1, 0.2, 4, 3)));
}

} // namespace
} // namespace flotilla
