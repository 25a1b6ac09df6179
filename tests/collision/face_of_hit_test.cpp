// SPDX-License-Identifier: MIT
// The normals along which hits on the borders of faces act.
#include <cmath>

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

// With 3 and 4 subdivisions the normals of the faces there are within 7 degrees of it.
TEST(FaceOfHit, BallsMeetAtTheirPolesAlongTheLineOfCentres) {
    for (const int subdivisions : {1, 2, 3, 4})
        for (const Vec3& way : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
            expect_straight_blow(meeting(make_sphere(0.5, subdivisions), 1.01 * way, way), way, 1e-6);
}

// A box that lands with one edge first, which lies aside of the other one's edge by less than a separation.
TEST(FaceOfHit, EdgesAlongEachOtherMeetAlongTheFace) {
    const TriangleMesh box = make_box(0.5, 0.4, 0.2);
    const Vec3 down{0, 0, 1};
    const double separation = StageWorld(meeting(box, {0, 0, 0.21}, down)).lengths(0, 1).separation;
    for (const double tilt : {-1e-3, 1e-3})
        for (const double aside : {0.02, 0.05, 0.1}) {
            SCOPED_TRACE(testing::Message() << tilt << " rad, " << aside << " of the separation aside");
            const Quat turned = rotation_from_vector({0, tilt, 0});
            const double side = tilt > 0 ? 1 : -1; // of the lower edge
            const Vec3 corner = rotate(turned, {side * 0.25, 0.2, -0.1});
            SceneDescription scene =
                meeting(box, {side * (0.25 + aside * separation) - corner.x, 0, 0.1 + 0.01 - corner.z}, down);
            scene.bodies[1].rotation = turned;
            StageWorld world(scene);
            EXPECT_FALSE(collide(world).limit);
            EXPECT_LT(world.velocity(0).z, -0.1);
            EXPECT_LT(std::hypot(world.velocity(0).x, world.velocity(0).y), 5e-3);
        }
}

} // namespace
} // namespace flotilla
