// SPDX-License-Identifier: MIT
#include "scene/separate_overlaps.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include <flotilla/scene_library.hpp>

#include "base/random.hpp"
#include "base/rotation.hpp"
#include "mesh/primitives.hpp"
#include "scene/initial_overlap.hpp"

namespace flotilla {
namespace {

std::int32_t add_shape(SceneDescription& scene, const TriangleMesh& mesh) {
    ShapeDescription s;
    s.name = std::to_string(scene.shapes.size());
    s.vertices = mesh.vertices;
    s.triangles = mesh.triangles;
    s.mass_kind = MassKind::mass;
    s.mass_value = 1;
    scene.shapes.push_back(std::move(s));
    return static_cast<std::int32_t>(scene.shapes.size()) - 1;
}

void add_body(SceneDescription& scene, std::int32_t shape, const Vec3& position, BodyType type = BodyType::dynamic,
              const Quat& rotation = {}) {
    BodyDescription b;
    b.name = std::to_string(scene.bodies.size());
    b.shape = shape;
    b.type = type;
    b.position = position;
    b.rotation = rotation;
    scene.bodies.push_back(std::move(b));
}

/// The rest distance of a shape's bodies.
double rest_of(const Scene& scene, std::size_t shape) {
    return 2 * scene.shapes[shape].sphere.radius / kSizePerRestDistance;
}

TEST(SeparateOverlaps, LeavesAFreeStartAlone) {
    Scene scene = build_scene(make_scene("boats-in-bowl", 12, 1));
    const SeparatedStart start = separate_overlaps(scene);
    EXPECT_TRUE(start.moves.empty());
    EXPECT_TRUE(start.not_freed.empty());
}

TEST(SeparateOverlaps, MovesABoxOutOfTheFloorTheShortWay) {
    SceneDescription description;
    const auto floor = add_shape(description, make_box(10, 10, 0.5)),
               box = add_shape(description, make_box(0.5, 0.5, 0.5));
    add_body(description, floor, {0, 0, -0.25}, BodyType::fixed);
    add_body(description, box, {1, 2, 0.15}); // 0.1 deep
    Scene scene = build_scene(description);
    const SeparatedStart start = separate_overlaps(scene);
    ASSERT_EQ(start.moves.size(), 1u);
    EXPECT_EQ(start.moves[0].body, 1);
    const double rest = rest_of(scene, 1);
    EXPECT_NEAR(start.moves[0].by.z, 0.1 + rest, 0.03 * rest);
    EXPECT_NEAR(std::hypot(start.moves[0].by.x, start.moves[0].by.y), 0, 1e-9);
    EXPECT_TRUE(find_initial_overlaps(scene).movable.empty());
}

TEST(SeparateOverlaps, LeavesLockedBodiesWhereTheyArePut) {
    SceneDescription description;
    const auto box = add_shape(description, make_box(0.5, 0.5, 0.5));
    add_body(description, box, {});
    add_body(description, box, {0, 0, 0.45}); // 0.05 deep
    description.bodies[0].locked_translation[1] = true;
    Scene scene = build_scene(description);
    const SeparatedStart start = separate_overlaps(scene);
    ASSERT_EQ(start.moves.size(), 1u);
    EXPECT_EQ(start.moves[0].body, 1);
    EXPECT_TRUE(start.not_freed.empty());
    description.bodies[1].locked_translation[0] = true;
    Scene stuck = build_scene(description);
    EXPECT_EQ(separate_overlaps(stuck).not_freed, (std::vector<std::int32_t>{0, 1}));
}

// Two thin plates that cross near an edge: the move that draws one out along the other's normal is long, the one that
// draws its edge back is short.
TEST(SeparateOverlaps, FindsTheShortWayOutOfAThinShell) {
    SceneDescription description;
    const auto plate = add_shape(description, make_plate(2, 2));
    add_body(description, plate, {0, 0, 0}, BodyType::fixed);
    add_body(description, plate, {0, 0, 0.95}, BodyType::dynamic, rotation_from_vector({1.5707963267948966, 0, 0}));
    Scene scene = build_scene(description);
    ASSERT_EQ(find_initial_overlaps(scene).movable.size(), 1u) << "the upright plate reaches through the other";
    const SeparatedStart start = separate_overlaps(scene);
    ASSERT_EQ(start.moves.size(), 1u);
    const Vec3& by = start.moves[0].by;
    EXPECT_NEAR(by.z, 0.05 + rest_of(scene, 0), 0.03 * rest_of(scene, 0));
    EXPECT_NEAR(std::hypot(by.x, by.y), 0, 0.02 * by.z);
    EXPECT_TRUE(find_initial_overlaps(scene).movable.empty());
}

TEST(SeparateOverlaps, FreesACrowdAndCatchesNothingNew) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        SceneDescription description;
        const auto box = add_shape(description, make_box(0.3, 0.2, 0.1)),
                   plate = add_shape(description, make_plate(0.5, 0.4));
        std::uint64_t drawn = 0;
        const auto uniform = [&](double low, double high) {
            return low + (high - low) * unit_interval(random_bits(seed, drawn++));
        };
        for (int i = 0; i < 24; ++i)
            add_body(description, i % 2 == 0 ? box : plate,
                     {uniform(-0.8, 0.8), uniform(-0.8, 0.8), uniform(-0.8, 0.8)}, BodyType::dynamic,
                     rotation_from_vector({uniform(-2, 2), uniform(-2, 2), uniform(-2, 2)}));
        Scene scene = build_scene(description);
        const Scene before = scene;
        const std::size_t overlaps = find_initial_overlaps(scene).movable.size();
        ASSERT_GT(overlaps, 2u);
        const SeparatedStart start = separate_overlaps(scene);
        EXPECT_TRUE(start.not_freed.empty());
        EXPECT_TRUE(find_initial_overlaps(scene).movable.empty());
        EXPECT_LE(start.moves.size(), overlaps);
        std::vector<int> moved(scene.bodies.size());
        for (const InitialMove& m : start.moves) ++moved[static_cast<std::size_t>(m.body)];
        for (std::size_t i = 0; i < moved.size(); ++i) {
            EXPECT_LE(moved[i], 1);
            EXPECT_EQ(moved[i] == 0, scene.bodies[i].position == before.bodies[i].position) << i;
            EXPECT_EQ(scene.bodies[i].rotation, before.bodies[i].rotation);
        }
    }
}

TEST(SeparateOverlaps, LeavesNothingBelowAThinFloor) {
    for (const double z : {0.05, 0.3, 0.5, 0.6}) {
        SceneDescription description;
        const auto floor = add_shape(description, make_plate(10, 10)), box = add_shape(description, make_box(1, 1, 1));
        add_body(description, floor, {}, BodyType::fixed);
        for (int i = 0; i < 6; ++i) add_body(description, box, {0, 0, z});
        Scene scene = build_scene(description);
        EXPECT_TRUE(separate_overlaps(scene).not_freed.empty()) << z;
        EXPECT_TRUE(find_initial_overlaps(scene).movable.empty()) << z;
        for (std::size_t i = 1; i < scene.bodies.size(); ++i) EXPECT_GE(scene.bodies[i].position.z, 0.5) << z;
    }
}

TEST(SeparateOverlaps, RefusesABodyThatCannotGetOut) {
    SceneDescription description;
    const auto ball = add_shape(description, make_sphere(0.3, 2));
    add_body(description, ball, {0, 0, 0});
    // Plates much closer together than the ball is wide, in all directions and far beyond its own size.
    const auto plate = add_shape(description, make_plate(8, 8));
    for (int i = -8; i <= 8; ++i) add_body(description, plate, {0, 0, 0.25 * i}, BodyType::fixed);
    Scene scene = build_scene(description);
    const Scene before = scene;
    const SeparatedStart start = separate_overlaps(scene);
    EXPECT_TRUE(start.moves.empty());
    ASSERT_EQ(start.not_freed.size(), 1u);
    EXPECT_EQ(start.not_freed[0], 0);
    EXPECT_EQ(scene.bodies[0].position, before.bodies[0].position);
}

} // namespace
} // namespace flotilla
