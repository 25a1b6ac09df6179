// SPDX-License-Identifier: MIT
#include "geometry/closest.hpp"

#include <gtest/gtest.h>

namespace flotilla {
namespace {

TEST(ClosestVertexTriangle, FindsFaceEdgeAndVertexRegions) {
    const Vec3 f0{0, 0, 0}, f1{1, 0, 0}, f2{0, 1, 0};
    EXPECT_DOUBLE_EQ(closest_vertex_triangle({0.25, 0.25, 2}, f0, f1, f2).distance_sq, 4);
    EXPECT_DOUBLE_EQ(closest_vertex_triangle({0.5, -3, 0}, f0, f1, f2).distance_sq, 9);
    EXPECT_DOUBLE_EQ(closest_vertex_triangle({-3, -4, 0}, f0, f1, f2).distance_sq, 25);
}

} // namespace
} // namespace flotilla
