// SPDX-License-Identifier: MIT
#include "physics/problems/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/scene.hpp"

namespace flotilla::physics {

Settings Run::settings() const {
    Settings s = flotilla::preset(preset);
    s.time_step = dt();
    s.sleeping = false;
    return s;
}

SceneDescription make_scene_with(const Settings& settings, const Vec3& gravity) {
    SceneDescription scene;
    scene.settings = settings;
    scene.gravity = gravity;
    return scene;
}

std::int32_t add_solid(SceneDescription& scene, TriangleMesh mesh, double density) {
    const std::int32_t shape = add_shape(scene, std::move(mesh));
    scene.shapes.back().mass_kind = MassKind::density;
    scene.shapes.back().mass_value = density;
    return shape;
}

BodyDescription& add_ground(SceneDescription& scene, double size, double friction, double restitution) {
    return add_body(scene, add_shape(scene, make_plate(size, size)), BodyType::fixed, {}, friction, restitution);
}

double rest_gap(const TriangleMesh& mesh) {
    Vec3 low = mesh.vertices.front(), high = low;
    for (const Vec3& v : mesh.vertices) low = min(low, v), high = max(high, v);
    double radius = 0;
    for (const Vec3& v : mesh.vertices) radius = std::max(radius, length(v - 0.5 * (low + high)));
    return 1.0001 * 2 * radius / kSizePerRestDistance;
}

TriangleMesh make_hoop(double radius, double thickness, double height, int sides) {
    TriangleMesh mesh;
    const double inner = radius / std::cos(kPi / sides);
    const std::array<std::pair<double, double>, 4> profile{{{inner, -0.5 * height},
                                                            {inner + thickness, -0.5 * height},
                                                            {inner + thickness, 0.5 * height},
                                                            {inner, 0.5 * height}}};
    for (const auto& [r, z] : profile)
        for (int k = 0; k < sides; ++k)
            mesh.vertices.push_back(
                {r * std::cos(kPi * (2 * k + 1) / sides), r * std::sin(kPi * (2 * k + 1) / sides), z});
    for (int l = 0; l < 4; ++l)
        for (int k = 0; k < sides; ++k) {
            const int next = (l + 1) % 4, j = (k + 1) % sides;
            mesh.triangles.push_back({l * sides + k, l * sides + j, next * sides + j});
            mesh.triangles.push_back({l * sides + k, next * sides + j, next * sides + k});
        }
    return mesh;
}

TriangleMesh make_hexahedron(const std::array<Vec3, 8>& corners) {
    TriangleMesh mesh;
    mesh.vertices.assign(corners.begin(), corners.end());
    const auto face = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
    };
    face(3, 2, 1, 0), face(4, 5, 6, 7);
    for (std::int32_t i = 0; i < 4; ++i) face(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i);
    return mesh;
}

TriangleMesh make_annulus(double inner, double outer, int segments) {
    TriangleMesh mesh;
    for (int i = 0; i < segments; ++i) {
        const SinCos s = sin_cos(2 * kPi * i / segments);
        mesh.vertices.push_back({inner * s.cos, inner * s.sin, 0});
        mesh.vertices.push_back({outer * s.cos, outer * s.sin, 0});
        const std::int32_t a = 2 * i, b = 2 * ((i + 1) % segments);
        mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, b + 1}, {a, b + 1, b}});
    }
    return mesh;
}

SceneDescription scaled(SceneDescription scene, double factor) {
    const double root = std::sqrt(factor);
    for (ShapeDescription& shape : scene.shapes)
        for (Vec3& v : shape.vertices) v *= factor;
    for (BodyDescription& body : scene.bodies) {
        body.position *= factor;
        body.velocity *= root;
        body.angular_velocity = body.angular_velocity / root;
        for (Keyframe& key : body.keyframes) key.position *= factor, key.time *= root;
    }
    return scene;
}

double Numbers::next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
}

} // namespace flotilla::physics
