// SPDX-License-Identifier: MIT
// The normals along which hits on the borders of faces act.
#include <gtest/gtest.h>

#include "collision/stage.hpp"

namespace flotilla {
namespace {

using scenario::add_body;
using scenario::add_shape;
using test::collide;
using test::StageWorld;

/// Two bodies of one shape, the second one `place` from the first, which it meets with 2 m/s along `way`.
SceneDescription meeting(const TriangleMesh& mesh, const Vec3& place, const Vec3& way) {
    SceneDescription scene = test::weightless_scene();
    const std::int32_t shape = add_shape(scene, mesh, 1);
    add_body(scene, shape, BodyType::dynamic, {}, 0, 1);
    add_body(scene, shape, BodyType::dynamic, place, 0, 1).velocity = -2 * way;
    return scene;
}

/// They change velocities and do not turn.
void expect_straight_blow(const SceneDescription& scene, const Vec3& way, double tolerance) {
    StageWorld world(scene);
    EXPECT_FALSE(collide(world).limit);
    EXPECT_LT(length(world.velocity(0) + 2 * way), tolerance);
    EXPECT_LT(length(world.velocity(1)), tolerance);
    for (const std::int32_t body : {0, 1}) EXPECT_LT(length(world.spin(body)), 10 * tolerance);
}

// The directions of their faces are 2 to 20 degrees off.
TEST(FaceOfHit, BallsMeetAtTheirPolesAlongTheLineOfCentres) {
    for (const int subdivisions : {1, 2, 3, 4})
        for (const Vec3& way : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
            expect_straight_blow(meeting(make_sphere(0.5, subdivisions), 1.01 * way, way), way, 1e-6);
}

// Boxes whose edges lie aside of each other by less than a separation.
TEST(FaceOfHit, EdgesAlongEachOtherMeetAlongTheFace) {
    const TriangleMesh box = make_box(0.5, 0.4, 0.2);
    const StageWorld world(meeting(box, {0, 0, 0.21}, {0, 0, 1}));
    const double separation = world.lengths(0, 1).separation;
    for (const double x : {-0.1, -0.03, 0.0, 0.05, 0.1})
        for (const double y : {-0.08, 0.0, 0.02}) {
            SCOPED_TRACE(testing::Message() << x << ", " << y << " of the separation aside");
            expect_straight_blow(meeting(box, {x * separation, y * separation, 0.21}, {0, 0, 1}), {0, 0, 1}, 1e-3);
        }
}

} // namespace
} // namespace flotilla
