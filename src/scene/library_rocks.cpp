// SPDX-License-Identifier: MIT
// A bed of convex stones that a slow cylinder ploughs.
#include <cmath>
#include <numbers>

#include "base/index.hpp"
#include "base/rotation.hpp"
#include "mesh/primitives.hpp"
#include "scene/library.hpp"

namespace flotilla::library {
namespace {

constexpr double kPi = std::numbers::pi;

/// Points on the sphere, evenly spread: equal steps of height, golden angles around it.
std::vector<Vec3> fibonacci_sphere(int points, double radius) {
    const double golden = kPi * (3 - std::sqrt(5.0));
    std::vector<Vec3> out;
    for (int i = 0; i < points; ++i) {
        const double z = 1 - (2.0 * i + 1) / points, r = std::sqrt(1 - z * z);
        const SinCos around = sin_cos(golden * i);
        out.push_back(radius * Vec3{r * around.cos, r * around.sin, z});
    }
    return out;
}

/// The convex hull of a few points in general position, by every three of them: those with all others on one side.
TriangleMesh hull_of(std::vector<Vec3> points) {
    TriangleMesh mesh;
    const int n = static_cast<int>(points.size());
    const auto outside = [&](int a, int b, int c) { // points on the side that (a, b, c) faces
        const Vec3& p = points[at(a)];
        const Vec3 normal = cross(points[at(b)] - p, points[at(c)] - p);
        int count = 0;
        for (int i = 0; i < n; ++i)
            if (i != a && i != b && i != c && dot(normal, points[at(i)] - p) > 0) ++count;
        return count;
    };
    for (int a = 0; a < n; ++a)
        for (int b = a + 1; b < n; ++b)
            for (int c = b + 1; c < n; ++c) {
                const int count = outside(a, b, c);
                if (count == 0) mesh.triangles.push_back({a, b, c});
                if (count == n - 3) mesh.triangles.push_back({a, c, b});
            }
    mesh.vertices = std::move(points);
    return mesh;
}

} // namespace

SceneDescription rocks(int bodies, std::uint64_t seed) {
    constexpr double kRadius = 1.5, kSpacing = 4, kPlough = 4, kPloughHeight = 6, kDegreesPerSecond = 6;
    constexpr int kSlices = 120, kPloughSegments = 32;
    constexpr int kLayers = 3, kMostInARow = 21; // a bed of more rocks than these has more layers
    const int rocks = bodies - 6;                // floor, four walls, plough
    const int row = std::min(kMostInARow, static_cast<int>(std::ceil(std::sqrt(rocks / double{kLayers}))));
    const double half = 0.5 * kSpacing * row, gap = 0.01;
    const double height = kPloughHeight + kSpacing * (rocks / (row * row) + 2); // of the walls
    const double circle = half * 35 / 42;                                       // radius of the plough's way

    SceneDescription scene;
    scene.settings.time_step = 1.0 / 60;
    scene.settings.friction = 0.6;
    ShapeDescription rock = shape_of("rock", hull_of(fibonacci_sphere(10, kRadius)));
    rock.mass_kind = MassKind::density;
    rock.mass_value = 2600;
    const double plough = std::min(kPlough, 0.1 * half);
    scene.shapes = {rock, shape_of("floor", make_plate(2 * half, 2 * half)),
                    shape_of("wall", make_plate(2 * half, height)),
                    shape_of("plough", make_cylinder(plough, kPloughHeight, kPloughSegments))};
    for (int i = 0; i < rocks; ++i) {
        const int layer = i / (row * row), column = i % row, line = i / row % row;
        const Vec3 place{kSpacing * (column - 0.5 * (row - 1)), kSpacing * (line - 0.5 * (row - 1)),
                         kPloughHeight + kSpacing * (layer + 0.5)};
        scene.bodies.push_back(body_of("rock" + std::to_string(i), 0, BodyType::dynamic, place));
        scene.bodies.back().rotation = random_rotation(seed, at(i));
    }
    scene.bodies.push_back(body_of("floor", 1, BodyType::fixed, {}));
    for (int k = 0; k < 4; ++k) { // upright, not quite touching the floor or each other
        const SinCos side = sin_cos(k * kPi / 2);
        const double away = half + gap;
        BodyDescription wall = body_of("wall" + std::to_string(k), 2, BodyType::fixed,
                                       {away * side.cos, away * side.sin, 0.5 * height + gap});
        wall.rotation = rotation_from_vector({0, 0, k * kPi / 2 + kPi / 2}) * rotation_from_vector({kPi / 2, 0, 0});
        scene.bodies.push_back(std::move(wall));
    }
    BodyDescription scripted = body_of("plough", 3, BodyType::kinematic, {circle, 0, 0.5 * kPloughHeight + gap});
    for (int k = 0; k <= kSlices; ++k) {
        const SinCos around = sin_cos(2 * kPi * k / kSlices);
        scripted.keyframes.push_back({k * 360.0 / kSlices / kDegreesPerSecond,
                                      {circle * around.cos, circle * around.sin, 0.5 * kPloughHeight + gap},
                                      {}});
    }
    scene.bodies.push_back(std::move(scripted));
    for (BodyDescription& body : scene.bodies) body.friction = scene.settings.friction;
    return scene;
}

} // namespace flotilla::library
