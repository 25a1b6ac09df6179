// SPDX-License-Identifier: MIT
#include <cmath>

#include "base/rotation.hpp"
#include "extremes/cells.hpp"
#include "mesh/primitives.hpp"
#include "scene/library.hpp"
#include "step/scene_parts.hpp"

namespace flotilla::extremes {
namespace {

using scenario::add_body;
using scenario::add_shape;
using scenario::empty_scene;
using scenario::kPi;

SceneDescription still_scene(const Vec3& gravity = {0, 0, -9.8}) {
    SceneDescription scene = empty_scene();
    scene.gravity = gravity;
    return scene;
}

void add_floor(SceneDescription& scene, double size) {
    add_body(scene, add_shape(scene, make_plate(size, size)), BodyType::fixed, {});
}

/// Boxes one above the other of which the one on top weighs `ratio` times as much as each below.
SceneDescription stack(int boxes, double ratio) {
    SceneDescription scene = still_scene();
    const std::int32_t light = add_shape(scene, make_box(1, 1, 1), 1), top = add_shape(scene, make_box(1, 1, 1), ratio);
    for (int i = 0; i < boxes; ++i)
        add_body(scene, i + 1 < boxes ? light : top, BodyType::dynamic, {0, 0, 0.51 + 1.01 * i}, 0.5, 0);
    add_floor(scene, 20);
    return scene;
}

SceneDescription sheets(int count) {
    SceneDescription scene = still_scene();
    const std::int32_t sheet = add_shape(scene, make_plate(1, 0.8), 1);
    for (int i = 0; i < count; ++i) add_body(scene, sheet, BodyType::dynamic, {0, 0, 1e-3 * (i + 1)});
    add_floor(scene, 20);
    return scene;
}

/// Cubes side by side and one above the other, `pitch` m apart.
void add_cubes(SceneDescription& scene, int nx, int ny, int nz, const Vec3& pitch, const Vec3& first,
               const Vec3& velocity = {}) {
    const std::int32_t cube = add_shape(scene, make_box(1, 1, 1), 100);
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x)
                add_body(scene, cube, BodyType::dynamic, first + Vec3{x * pitch.x, y * pitch.y, z * pitch.z}).velocity =
                    velocity;
}

/// A thousand cubes between six scripted walls that close farther than there is room.
SceneDescription shrinking_box() {
    SceneDescription scene = still_scene();
    constexpr double kOpen = 6.2, kClosed = 4.5; // m from the middle; the cubes touch at 5
    add_cubes(scene, 10, 10, 10, {1.1, 1.1, 1.1}, {-4.95, -4.95, -4.95});
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            Vec3 size{14, 14, 14}, way;
            (axis == 0 ? size.x : axis == 1 ? size.y : size.z) = 0.5;
            (axis == 0 ? way.x : axis == 1 ? way.y : way.z) = side;
            auto& wall = add_body(scene, add_shape(scene, make_box(size.x, size.y, size.z)), BodyType::kinematic, {});
            wall.keyframes = {{0, (kOpen + 2 * axis) * way, {}}, {0.4, (kClosed + 2 * axis) * way, {}}};
        }
    return scene;
}

/// A helix about the z axis: the radius grows and falls by `depth` over one pitch and over one turn, and is wider by
/// `play`.
TriangleMesh make_thread(double radius, double depth, double pitch, double height, double play) {
    constexpr int kSides = 32, kRowsPerPitch = 8;
    const int rows = static_cast<int>(std::lround(height / pitch * kRowsPerPitch));
    TriangleMesh mesh;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i < kSides; ++i) {
            const double z = height * j / rows, angle = 2 * kPi * i / kSides;
            const double r = radius + depth * std::cos(2 * kPi * z / pitch - angle) + play;
            mesh.vertices.push_back({r * std::cos(angle), r * std::sin(angle), z});
        }
    for (std::int32_t j = 0; j < rows; ++j)
        for (std::int32_t i = 0; i < kSides; ++i) {
            const std::int32_t a = j * kSides + i, b = j * kSides + (i + 1) % kSides;
            mesh.triangles.push_back({a, b, b + kSides});
            mesh.triangles.push_back({a, b + kSides, a + kSides});
        }
    return mesh;
}

/// A nut that is screwed down by its weight, in the thread of a fixed screw.
SceneDescription screw_and_nut() {
    constexpr double kRadius = 0.5, kDepth = 0.1, kPitch = 0.5, kPlay = 0.02;
    SceneDescription scene = still_scene();
    add_body(scene, add_shape(scene, make_thread(kRadius, kDepth, kPitch, 4, 0)), BodyType::fixed, {}, 0, 0);
    add_body(scene, add_shape(scene, make_thread(kRadius, kDepth, kPitch, 1, kPlay), 100), BodyType::dynamic,
             {0, 0, 4 * kPitch}, 0, 0)
        .angular_velocity = {0, 0, -2};
    return scene;
}

SceneDescription boat_in_sphere() {
    SceneDescription scene = library::falling_boats(2, 1);
    scene.settings.sleeping = false;
    scene.bodies.resize(1);
    BodyDescription& boat = scene.bodies[0];
    boat.position = {0, 0, 2.6};
    boat.velocity = {1, 2, 0}, boat.angular_velocity = {3, 1, 2};
    add_body(scene, add_shape(scene, make_sphere(2.5, 3), 500), BodyType::dynamic, {0, 0, 2.6});
    add_floor(scene, 40);
    return scene;
}

SceneDescription nested_shells() {
    SceneDescription scene = still_scene();
    for (int i = 1; i <= 6; ++i)
        add_body(scene, add_shape(scene, make_sphere(0.3 * i, 2), 10.0 * i), BodyType::dynamic, {0, 0, 2})
            .angular_velocity = {1.0 * i, 2, -1.0 * i};
    add_floor(scene, 40);
    return scene;
}

SceneDescription convoy() {
    SceneDescription scene = still_scene({});
    add_cubes(scene, 100, 10, 10, {1.2, 1.2, 1.2}, {}, {100, 30, 10});
    return scene;
}

SceneDescription field(int side) {
    SceneDescription scene = still_scene();
    add_cubes(scene, side, side, 1, {2, 2, 0}, {-side + 1.0, -side + 1.0, 0.51});
    add_floor(scene, 3.0 * side);
    return scene;
}

SceneDescription fine_sphere() {
    SceneDescription scene = still_scene();
    add_body(scene, add_shape(scene, make_sphere(1, 8), 100), BodyType::dynamic, {0, 0, 1.01});
    add_floor(scene, 20);
    return scene;
}

} // namespace

std::vector<Cell> large_cells() {
    std::vector<Cell> cells;
    const auto add = [&](const std::string& name, std::function<SceneDescription()> scene) {
        cells.push_back({Situation::pile, {{"large", name, {}}}, std::move(scene)});
    };
    for (const int boxes : {2, 10, 100})
        for (const double ratio : {1e-9, 1.0, 1e9})
            add("stack of " + std::to_string(boxes) + ", on top " +
                    (ratio < 1   ? "1e-9"
                     : ratio > 1 ? "1e9"
                                 : "1") +
                    " of a weight",
                [=] { return stack(boxes, ratio); });
    add("1,000 sheets 1 mm apart", [] { return sheets(1000); });
    add("1,000 cubes in a shrinking box", shrinking_box);
    add("10,000 cubes of one speed", convoy);
    add("100,000 cubes on a floor", [] { return field(317); });
    add("1,310,720 triangles", fine_sphere);
    add("screw and nut", screw_and_nut);
    add("boat in a closed sphere", boat_in_sphere);
    add("six nested shells", nested_shells);
    return cells;
}

} // namespace flotilla::extremes
