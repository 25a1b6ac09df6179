// SPDX-License-Identifier: MIT
#include "scene/scene.hpp"

#include <gtest/gtest.h>

#include <limits>

#include <flotilla/error.hpp>

#include "mesh/primitives.hpp"

namespace flotilla {
namespace {

ShapeDescription shape(const std::string& name, const TriangleMesh& mesh, MassKind kind = MassKind::none,
                       double value = 0) {
    ShapeDescription s;
    s.name = name;
    s.vertices = mesh.vertices;
    s.triangles = mesh.triangles;
    s.mass_kind = kind;
    s.mass_value = value;
    return s;
}
BodyDescription body(const std::string& name, std::int32_t shape_index, const Vec3& position = {}) {
    BodyDescription b;
    b.name = name;
    b.shape = shape_index;
    b.position = position;
    return b;
}
std::string refusal(const SceneDescription& scene) {
    try {
        (void)build_scene(scene);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(BuildScene, DerivesMassSizeAndReachOfShapes) {
    SceneDescription d;
    d.shapes = {shape("box", make_box(2, 2, 2), MassKind::density, 500), shape("floor", make_plate(6, 8))};
    d.bodies = {body("a", 0, {1, 2, 3}), body("f", 1)};
    d.bodies[1].type = BodyType::fixed;
    const Scene scene = build_scene(d);
    EXPECT_NEAR(scene.shapes[0].mass->mass, 4000, 1e-9);
    EXPECT_NEAR(scene.shapes[0].radius, std::sqrt(3.0), 1e-12);
    EXPECT_EQ(scene.shapes[0].topology.triangle_edges.size(), scene.shapes[0].mesh.triangles.size());
    EXPECT_FALSE(scene.shapes[1].mass.has_value());
    EXPECT_NEAR(scene.shapes[1].sphere.radius, 5, 0.05);
    EXPECT_NEAR(scene.shapes[1].center.x, 0, 0.05);
    EXPECT_NEAR(world_center(scene, scene.bodies[0]).z, 3, 1e-12);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(BuildScene, TurnsAboutTheCentreOfMass) {
    SceneDescription d;
    TriangleMesh mesh = make_box(1, 1, 1);
    for (Vec3& v : mesh.vertices) v.x += 10;
    d.shapes = {shape("box", mesh, MassKind::mass, 1)};
    d.bodies = {body("a", 0)};
    d.bodies[0].rotation = {0, 0, 0, 1}; // half a turn about z
    const Scene scene = build_scene(d);
    EXPECT_NEAR(scene.shapes[0].center.x, 10, 1e-12);
    EXPECT_NEAR(world_center(scene, scene.bodies[0]).x, -10, 1e-12);
}

TEST(BuildScene, IdenticalShapesBecomeOne) {
    SceneDescription d;
    const TriangleMesh box = make_box(1, 1, 1);
    d.shapes = {shape("a", box, MassKind::mass, 1), shape("b", box, MassKind::mass, 2),
                shape("c", box, MassKind::mass, 1)};
    d.bodies = {body("x", 2), body("y", 1), body("z", 0)};
    const Scene scene = build_scene(d);
    ASSERT_EQ(scene.shapes.size(), 2U);
    EXPECT_EQ(scene.bodies[0].shape, scene.bodies[2].shape);
    EXPECT_NE(scene.bodies[0].shape, scene.bodies[1].shape);
    EXPECT_EQ(scene.shapes[static_cast<std::size_t>(scene.bodies[1].shape)].mass->mass, 2);
}

TEST(BuildScene, TakesInertiaAndCentreAsGiven) {
    SceneDescription d;
    d.shapes = {shape("s", make_plate(1, 1), MassKind::mass, 3)};
    d.shapes[0].inertia = Mat3{{1, 0, 0, 0, 2, 0, 0, 0, 2.5}};
    d.shapes[0].center_of_mass = Vec3{0.25, 0, 0};
    d.bodies = {body("a", 0)};
    const Scene scene = build_scene(d);
    EXPECT_EQ(scene.shapes[0].mass->inertia, *d.shapes[0].inertia);
    EXPECT_EQ(scene.shapes[0].center, (Vec3{0.25, 0, 0}));
}

TEST(BuildScene, ReportsWhatMassesCannotBe) {
    SceneDescription d;
    const TriangleMesh line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
    d.shapes = {shape("line", line, MassKind::mass, 1), shape("open", make_plate(1, 1), MassKind::density, 1),
                shape("odd", make_plate(1, 1), MassKind::mass, 1)};
    d.shapes[2].inertia = Mat3{{1, 0, 0, 0, 1, 0, 0, 0, 5}};
    d.bodies = {body("a", 0), body("b", 1), body("c", 2)};
    const std::string what = refusal(d);
    EXPECT_NE(what.find("scene: /shapes/0: shape 'line': "), std::string::npos) << what;
    EXPECT_NE(what.find("scene: /shapes/1: shape 'open': "), std::string::npos) << what;
    EXPECT_NE(what.find("scene: /shapes/2: shape 'odd': "), std::string::npos) << what;
}

TEST(BuildScene, RefusesLoadsThatNoStepCanTake) {
    SceneDescription d;
    d.shapes = {shape("box", make_box(1, 1, 1), MassKind::mass, 1e-3)};
    d.bodies = {body("a", 0)};
    d.bodies[0].force = {0, 0, 1e6};
    EXPECT_NE(refusal(d).find("/bodies/0/force: accelerates the body by"), std::string::npos) << refusal(d);
    d.bodies[0].force = {0, 0, 100};
    d.bodies[0].torque = {1e9, 0, 0};
    EXPECT_NE(refusal(d).find("/bodies/0/torque: may turn the body by"), std::string::npos) << refusal(d);
    d.bodies[0].torque = {0.1, 0, 0};
    EXPECT_EQ(refusal(d), "accepted");
}

TEST(BuildScene, RefusesDescriptionsMadeInMemory) {
    SceneDescription d;
    d.shapes = {shape("s", make_plate(1, 1), MassKind::mass, 1)};
    d.bodies = {body("a", 5), body("b", 0, {0, std::numeric_limits<double>::quiet_NaN(), 0})};
    d.bodies[1].velocity.x = std::numeric_limits<double>::infinity();
    d.settings.time_step = 0;
    EXPECT_EQ(refusal(d), "scene: /settings/time_step: must be in 1e-09 .. 10 s, got 0\n"
                          "scene: /bodies/0/shape: shape 5 does not exist; there are 1\n"
                          "scene: /bodies/1/position: must be finite\n"
                          "scene: /bodies/1/velocity: must be finite");
}

TEST(BuildScene, StopsAtMoreProblemsOfAScriptThanAMessageShows) {
    SceneDescription d;
    d.shapes = {shape("s", make_plate(1, 1), MassKind::mass, 1)};
    d.bodies = {body("a", 0), body("b", 7)};
    d.bodies[0].type = BodyType::kinematic;
    for (int k = 0; k < 5000; ++k) d.bodies[0].keyframes.push_back({1e10 * k, {}, {}});
    try {
        (void)build_scene(d);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.problems().size(), 1002u);
        EXPECT_EQ(error.problems().back().where, "/bodies/1/shape");
    }
}

TEST(BuildScene, WarnsOfUnusedShapesAndBodiesTooFarAway) {
    SceneDescription d;
    d.shapes = {shape("s", make_box(1e-3, 1e-3, 1e-3), MassKind::mass, 1), shape("t", make_plate(1, 1))};
    d.bodies = {body("near", 0), body("far", 0, {1e8, 0, 0})};
    const Scene scene = build_scene(d);
    ASSERT_EQ(scene.warnings.size(), 2U);
    EXPECT_EQ(scene.warnings[0], "no body has the shape \"t\"");
    EXPECT_TRUE(scene.warnings[1].starts_with("body \"far\" is too far from the origin for its size"))
        << scene.warnings[1];
}

TEST(BuildScene, AcceptsAnEmptyScene) { EXPECT_EQ(refusal({}), "accepted"); }

} // namespace
} // namespace flotilla
