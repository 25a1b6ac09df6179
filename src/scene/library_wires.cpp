// SPDX-License-Identifier: MIT
// Bodies without any surface: of segments and points alone.
#include <array>
#include <cmath>
#include <numbers>

#include "base/rotation.hpp"
#include "mesh/building.hpp"
#include "scene/library.hpp"

namespace flotilla::library {

namespace {

constexpr double kLength = 0.3; // m, of a rod; what else falls is about as large

TriangleMesh rod() { return {{{-kLength / 2, 0, 0}, {kLength / 2, 0, 0}}, {segment_element(0, 1)}}; }

TriangleMesh hoop() {
    constexpr int kSegments = 24;
    TriangleMesh mesh;
    for (int k = 0; k < kSegments; ++k) {
        const SinCos a = fraction_of_turn(k, kSegments);
        add_vertex(mesh, {0.4 * kLength * a.cos, 0.4 * kLength * a.sin, 0});
        mesh.triangles.push_back(segment_element(k, (k + 1) % kSegments));
    }
    return mesh;
}

/// Four corners of a cube with side `side`, no two of them on an edge.
TriangleMesh tetrahedron_corners(double side) {
    const double h = side / 2;
    return {{{h, h, h}, {h, -h, -h}, {-h, h, -h}, {-h, -h, h}}, {}};
}

/// The edges of a tetrahedron.
TriangleMesh frame() {
    TriangleMesh mesh = tetrahedron_corners(kLength / std::numbers::sqrt2);
    for (std::int32_t i = 0; i < 4; ++i)
        for (std::int32_t k = i + 1; k < 4; ++k) mesh.triangles.push_back(segment_element(i, k));
    return mesh;
}

/// The corners of an icosahedron, and no more.
TriangleMesh cloud() {
    constexpr double kGolden = std::numbers::phi;
    TriangleMesh mesh;
    const double scale = 0.4 * kLength / std::sqrt(1 + kGolden * kGolden);
    for (const double a : {-scale, scale})
        for (const double b : {-kGolden * scale, kGolden * scale})
            for (const Vec3& v : {Vec3{0, a, b}, Vec3{a, b, 0}, Vec3{b, 0, a}})
                mesh.triangles.push_back(point_element(add_vertex(mesh, v)));
    return mesh;
}

} // namespace

// Wire of 0.1 kg/m, as steel 4 mm thick is; a cloud weighs as much as a hoop. Nothing holds clouds off wires, so that
// only what lies on the bowl shows where they end.
SceneDescription wires(int bodies, std::uint64_t seed) {
    constexpr double kLineDensity = 0.1, kRim = 75 * std::numbers::pi / 180, kLeast = 0.5;
    constexpr double kVolumePerBody = 0.012;  // m^3, of the bowl: a heap of hoops and frames is mostly air
    constexpr double kReach = 0.62 * kLength; // of a frame, the largest
    const double depth = 1 - sin_cos(kRim).cos;
    const double unit_volume = std::numbers::pi * depth * depth * (3 - depth) / 3;
    const double radius = std::max(kLeast, std::cbrt((bodies - 1) * kVolumePerBody / unit_volume));

    SceneDescription scene;
    scene.settings.friction = 0.4;
    const auto add = [&](const char* name, TriangleMesh mesh, MassKind kind, double value) {
        scene.shapes.push_back(shape_of(name, std::move(mesh)));
        scene.shapes.back().mass_kind = kind;
        scene.shapes.back().mass_value = value;
    };
    add("rod", rod(), MassKind::line_density, kLineDensity);
    add("hoop", hoop(), MassKind::line_density, kLineDensity);
    add("frame", frame(), MassKind::line_density, kLineDensity);
    add("cloud", cloud(), MassKind::mass, 2 * std::numbers::pi * 0.4 * kLength * kLineDensity);
    const auto count = static_cast<std::size_t>(bodies - 1);
    if (count < scene.shapes.size()) scene.shapes.resize(count);
    const double column = std::max(0.8 * radius * sin_cos(kRim).sin - kReach, 0.0);
    const std::vector<Vec3> places = packed_column(count, kReach, column, radius * depth + kReach, seed);
    const auto kinds = scene.shapes.size();
    for (std::size_t i = 0; i < count; ++i) {
        scene.bodies.push_back(body_of(scene.shapes[i % kinds].name + std::to_string(i),
                                       static_cast<std::int32_t>(i % kinds), BodyType::dynamic, places[i]));
        scene.bodies.back().rotation = random_rotation(seed, i);
    }
    scene.shapes.push_back(shape_of("bowl", bowl_mesh(radius, kRim, 16, 48)));
    scene.bodies.push_back(body_of("bowl", static_cast<std::int32_t>(kinds), BodyType::fixed, {}));
    for (BodyDescription& body : scene.bodies) body.friction = scene.settings.friction;
    return scene;
}

} // namespace flotilla::library
