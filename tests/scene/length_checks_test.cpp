// SPDX-License-Identifier: MIT
// Every setting with a length is refused where the scene's sizes or places do not allow it, with what would be allowed.
#include <gtest/gtest.h>

#include <functional>

#include <flotilla/error.hpp>
#include <flotilla/world.hpp>

#include "mesh/primitives.hpp"
#include "scene/scene.hpp"

namespace flotilla {
namespace {

void add_cube(SceneDescription& scene, double size, const Vec3& position, BodyType type = BodyType::dynamic) {
    const std::string name = std::to_string(scene.bodies.size());
    const TriangleMesh mesh = make_box(size, size, size);
    ShapeDescription shape;
    shape.name = name;
    shape.vertices = mesh.vertices;
    shape.triangles = mesh.triangles;
    shape.mass_kind = MassKind::mass;
    shape.mass_value = 1;
    scene.shapes.push_back(shape);
    BodyDescription body;
    body.name = name;
    body.shape = static_cast<std::int32_t>(scene.shapes.size()) - 1;
    body.type = type;
    body.position = position;
    scene.bodies.push_back(body);
}

/// Cubes of 1 m and 0.1 m, 3 m and 1 m above a floor of 10 m.
SceneDescription cubes(const std::function<void(SceneDescription&)>& change) {
    SceneDescription scene;
    add_cube(scene, 10, {0, 0, -5}, BodyType::fixed);
    add_cube(scene, 1, {0, 0, 3});
    add_cube(scene, 0.1, {0, 0, 1});
    change(scene);
    return scene;
}

std::string refusal(const SceneDescription& scene) {
    try {
        (void)build_scene(scene);
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

void expect_refused(const std::string& text, std::initializer_list<const char*> parts) {
    for (const char* part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

TEST(LengthChecks, SeparationIsBelowTheSmallestRestDistance) {
    const auto with = [](double s) { return cubes([&](SceneDescription& d) { d.settings.separation = s; }); };
    EXPECT_EQ(refusal(with(5e-4)), ""); // size / 330 of the small cube is 5.2e-4
    expect_refused(refusal(with(6e-4)), {"/settings/separation", "must be below", "body \"2\"", "0.00052", "6e-04"});
    for (const double s : {5.0, 1e6}) expect_refused(refusal(with(s)), {"/settings/separation"});
}

TEST(LengthChecks, ProximityIsAboveTheLargestRestDistanceAndBelowTheSmallestSize) {
    const auto with = [](double p) { return cubes([&](SceneDescription& d) { d.settings.proximity_distance = p; }); };
    EXPECT_EQ(refusal(with(0.006)), ""); // 5.2e-3 of the large cube
    expect_refused(refusal(with(0.005)), {"/settings/proximity_distance", "must exceed", "body \"1\"", "0.00524"});
    EXPECT_EQ(refusal(with(0.17)), ""); // the small cube's diagonal is 0.173
    expect_refused(refusal(with(0.18)), {"/settings/proximity_distance", "must be below", "body \"2\"", "0.173"});
}

TEST(LengthChecks, RestDistanceIsBelowHalfTheSmallestSize) {
    const auto with = [](double r) { return cubes([&](SceneDescription& d) { d.settings.rest_distance = r; }); };
    EXPECT_EQ(refusal(with(0.08)), "");
    expect_refused(refusal(with(0.09)), {"/settings/rest_distance", "must be below 0.0866", "body \"2\""});
}

TEST(LengthChecks, RestDistanceIsResolvedWhereTheBodiesStand) {
    const auto at = [](double x) { return cubes([&](SceneDescription& d) { d.bodies[2].position.x = x; }); };
    EXPECT_EQ(refusal(at(1e9)), "");
    const auto fine = [](double x) {
        return cubes([&](SceneDescription& d) { d.bodies[2].position.x = x, d.settings.rest_distance = 1e-7; });
    };
    EXPECT_EQ(refusal(fine(1e7)), "");
    expect_refused(refusal(fine(1e8)), {"/settings/rest_distance", "body \"2\"", "nearer to its origin"});
    SceneDescription small;
    add_cube(small, 1e-4, {1e9, 0, 0});
    expect_refused(refusal(small), {"/bodies/0", "nearer to its origin"});
}

TEST(LengthChecks, RestDistanceIsResolvedWhereTheFirstStepLeads) {
    SceneDescription speck; // falls 17 mm in a step, where doubles are 3e-18 m apart
    add_cube(speck, 1e-16, {0, 0, 0});
    expect_refused(refusal(speck), {"/bodies/0", "first step"});
    speck.settings.time_step = 1e-6;
    EXPECT_EQ(refusal(speck), "");
    speck.bodies[0].velocity = {1e5, 0, 0};
    expect_refused(refusal(speck), {"/bodies/0", "first step"});
}

TEST(LengthChecks, RestDistanceIsResolvedBesideTheLargestTriangles) {
    SceneDescription scene;
    add_cube(scene, 1e6, {0, 0, -5e5}, BodyType::fixed);
    add_cube(scene, 1e-6, {0, 0, 1});
    expect_refused(refusal(scene), {"/bodies/1", "triangles of body \"0\"", "smaller ones"});
    scene.bodies.pop_back(), scene.shapes.pop_back();
    add_cube(scene, 1e-3, {0, 0, 1});
    EXPECT_EQ(refusal(scene), "");
}

} // namespace
} // namespace flotilla
