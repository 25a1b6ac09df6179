// SPDX-License-Identifier: MIT
#include "mesh/convexity.hpp"

#include <gtest/gtest.h>

#include "mesh/primitives.hpp"

namespace flotilla {
namespace {

TEST(Convexity, SolidsAndFlatThingsAreConvex) {
    EXPECT_TRUE(is_convex(make_box(1, 2, 3)));
    EXPECT_TRUE(is_convex(make_box(1, 2, 3, 4))); // faces of many triangles
    EXPECT_TRUE(is_convex(make_cylinder(1, 2, 32)));
    EXPECT_TRUE(is_convex(make_plate(84, 84)));
    EXPECT_TRUE(is_convex({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}));
}

TEST(Convexity, FacingInwardsOrMovedFarAwayIsAsGood) {
    TriangleMesh box = make_box(1, 2, 3);
    for (Triangle& t : box.triangles) std::swap(t[1], t[2]);
    for (Vec3& v : box.vertices) v = {v.x / 3 + 1e4, v.y / 3, v.z / 3};
    EXPECT_TRUE(is_convex(box));
}

TEST(Convexity, HollowAndOpenThingsAreNot) {
    EXPECT_FALSE(is_convex(make_tube(1, 2, 16))); // open at the ends
    EXPECT_FALSE(is_convex(make_ring(3, 1, 8, 6)));
    TriangleMesh dented = make_box(1, 1, 1);
    dented.vertices[0] = {};
    EXPECT_FALSE(is_convex(dented));
    TriangleMesh open = make_box(1, 1, 1);
    open.triangles.pop_back();
    EXPECT_FALSE(is_convex(open));
    EXPECT_FALSE(is_convex({}));
}

TEST(Convexity, OfWiresOnlyStraightOnesAre) {
    TriangleMesh wire{{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}, {{0, 0, 1}, {1, 2, 1}}};
    EXPECT_TRUE(is_convex(wire));
    wire.vertices[1].y = 1;
    EXPECT_FALSE(is_convex(wire));
    EXPECT_TRUE(is_convex({{{1, 2, 3}}, {{0, 0, 0}}}));
}

TEST(Convexity, LargeMeshesAreNotAsked) { EXPECT_FALSE(is_convex(make_sphere(1, 4))); }

} // namespace
} // namespace flotilla
