// SPDX-License-Identifier: MIT
// Small bodies at a frame rate: what gravity moves by more than the contact search sees in one step.
#include "step/look_ahead.hpp"

#include "base/rotation.hpp"
#include "scene/scene.hpp"
#include "state/build_model.hpp"
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

SceneDescription cube_on_ground(double edge, double tilt) {
    SceneDescription scene = empty_scene();
    const double size = std::sqrt(3.0) * edge, rest = size / 330;
    const double height = rest + 0.5 * edge * (std::cos(tilt) + std::sin(tilt));
    add_body(scene, add_shape(scene, make_box(edge, edge, edge), 1), BodyType::dynamic, {0, 0, height}, 0.5, 0)
        .rotation = rotation_from_vector({0, tilt, 0});
    add_body(scene, add_shape(scene, make_plate(100 * edge, 100 * edge)), BodyType::fixed, {}, 0.5, 0);
    return scene;
}

bool looks_ahead(const SceneDescription& scene) { return may_look_ahead(make_model(build_scene(scene))); }

TEST(LookAhead, IsForBodiesThatGravityMovesByMoreThanTheirProximityDistance) {
    EXPECT_FALSE(looks_ahead(make_scene("boats-in-bowl", 5)));
    EXPECT_FALSE(looks_ahead(cube_on_ground(1, 0)));
    EXPECT_TRUE(looks_ahead(cube_on_ground(0.1, 0)));
    SceneDescription scene = cube_on_ground(0.1, 0);
    scene.settings.time_step = 1.0 / 480;
    EXPECT_FALSE(looks_ahead(scene));
    scene = cube_on_ground(0.1, 0);
    scene.gravity = {};
    EXPECT_FALSE(looks_ahead(scene));
}

// The contact search sees two of the corners that it falls on. The smallest one falls over, by two radians in a step,
// and may be held once where a turn would raise it by more than its energy.
TEST(LookAhead, ATiltedCubeLiesDownAndRests) {
    for (const double edge : {0.03, 0.01, 0.003, 0.001}) {
        const SceneDescription scene = cube_on_ground(edge, 20 * kPi / 180);
        World world(scene);
        std::int64_t held = 0;
        for (int n = 0; n < 24; ++n) held += world.step().held;
        EXPECT_LE(held, edge < 0.003 ? 1 : 0) << edge;
        const BodyState s = world.body(0);
        EXPECT_LT(length(s.velocity), 1e-4 * edge) << edge;
        EXPECT_LT(length(s.angular_velocity), 1e-4) << edge;
        EXPECT_NEAR(s.center_of_mass.z / edge, 0.5 + std::sqrt(3.0) / 330, 0.01) << edge;
    }
}

// Corners above the corners of the one that lies there come down on it: pairs that do not touch yet look ahead as well.
TEST(LookAhead, SmallCubesPileUpAndRest) {
    constexpr double kEdge = 0.01;
    SceneDescription scene = cube_on_ground(kEdge, 0);
    for (int i = 1; i < 3; ++i)
        add_body(scene, 0, BodyType::dynamic, {0.001 * i, 0, kEdge * (0.6 + 1.1 * i)}, 0.5, 0).rotation =
            rotation_from_vector({0.05 * i, 0.03, 0});
    World world(scene);
    for (int n = 0; n < 48; ++n) EXPECT_EQ(world.step().held, 0) << n;
    for (const std::size_t i : {0u, 2u, 3u}) EXPECT_LT(length(world.body(i).velocity), 1e-4 * kEdge) << i;
    EXPECT_NEAR(world.body(3).center_of_mass.z, 2.5 * kEdge, 0.1 * kEdge);
}

// What is found ahead counts wherever its pair stands in the list of contacts: another body changes nothing.
TEST(LookAhead, DoesNotDependOnOtherBodies) {
    const auto height_after = [](bool other, int steps) {
        SceneDescription scene = cube_on_ground(0.01, 20 * kPi / 180);
        scene.bodies[0].position.z += 0.003;
        if (other) add_body(scene, 0, BodyType::dynamic, {0.3, 0.3, 0.005 + 0.01 * std::sqrt(3.0) / 330}, 0.5, 0);
        World world(scene);
        for (int n = 0; n < steps; ++n) world.step();
        return world.body(0).center_of_mass.z;
    };
    for (int steps = 1; steps < 8; ++steps) EXPECT_EQ(height_after(false, steps), height_after(true, steps)) << steps;
}

// Bars rest at a share of their thickness, other bodies at one of their size; what has no thickness to speak of is no
// bar.
TEST(LookAhead, LengthsOfThinBodiesGoByTheirThickness) {
    const auto rest_of = [](TriangleMesh mesh) {
        SceneDescription scene = empty_scene();
        add_body(scene, add_shape(scene, std::move(mesh), 1), BodyType::dynamic, {});
        const Model model = make_model(build_scene(scene));
        return body_lengths(model, 0).rest;
    };
    EXPECT_NEAR(rest_of(make_box(1, 1, 1)), std::sqrt(3.0) / 330, 1e-12);
    EXPECT_NEAR(rest_of(make_box(1, 0.12, 0.12)), std::sqrt(1 + 2 * 0.12 * 0.12) / 330, 1e-12);
    EXPECT_NEAR(rest_of(make_box(1, 2e-3, 2e-3)), 2e-2 / 330, 1e-12);
    EXPECT_NEAR(rest_of(make_box(1, 1e-4, 1e-4)), 1e-2 / 330, 1e-12);
    EXPECT_NEAR(rest_of(make_box(1, 1e-5, 1e-5)), 1.0 / 330, 1e-12);
    TriangleMesh turned = make_box(1, 2e-3, 3e-3), plate = make_plate(1, 1);
    const Quat turn = rotation_from_vector({0.3, 0.5, 0.7});
    for (TriangleMesh* mesh : {&turned, &plate})
        for (Vec3& v : mesh->vertices) v = rotate(turn, v);
    EXPECT_NEAR(rest_of(turned), 2e-2 / 330, 1e-12);
    EXPECT_NEAR(rest_of(plate), std::sqrt(2.0) / 330, 1e-12);
}

} // namespace
} // namespace flotilla::scenario
