// SPDX-License-Identifier: MIT
#include "run_folder/drawn_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "base/vec3.hpp"
#include "mesh/building.hpp"
#include "mesh/primitives.hpp"
#include "mesh/topology.hpp"
#include "scene/scene.hpp"

namespace flotilla::io {
namespace {

constexpr int kSides = 8; // of a tube

/// Any unit vector across a unit vector.
Vec3 across(const Vec3& n) {
    const Vec3 a = abs(n);
    return normalized(cross(n, a.x <= a.y && a.x <= a.z ? Vec3{1, 0, 0} : a.y <= a.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1}));
}

void add_tube(TriangleMesh& out, const Vec3& from, const Vec3& to, double radius) {
    const Vec3 axis = normalized(to - from);
    if (axis == Vec3{}) return;
    const Vec3 u = across(axis), v = cross(axis, u);
    const auto first = static_cast<std::int32_t>(out.vertices.size());
    for (int k = 0; k < kSides; ++k) {
        const SinCos angle = fraction_of_turn(k, kSides);
        const Vec3 r = radius * (angle.cos * u + angle.sin * v);
        out.vertices.push_back(from + r);
        out.vertices.push_back(to + r);
    }
    for (int k = 0; k < kSides; ++k) {
        const std::int32_t a = first + 2 * k, b = first + 2 * ((k + 1) % kSides);
        add_quad(out, a, b, b + 1, a + 1);
    }
}

void add_ball(TriangleMesh& out, const Vec3& center, const TriangleMesh& ball) {
    const auto first = static_cast<std::int32_t>(out.vertices.size());
    for (const Vec3& v : ball.vertices) out.vertices.push_back(center + v);
    for (const Triangle& t : ball.triangles) out.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

} // namespace

bool has_thin_elements(const TriangleMesh& mesh) {
    return std::any_of(mesh.triangles.begin(), mesh.triangles.end(),
                       [](const Triangle& t) { return element_of(t) != ElementKind::triangle; });
}

double drawn_radius(double size) { return size / kSizePerRestDistance; }

TriangleMesh drawn_triangles(const TriangleMesh& mesh) {
    if (!has_thin_elements(mesh)) return mesh;
    TriangleMesh out = drawn_mesh(mesh, drawn_radius(2 * bounding_sphere(mesh).radius));
    std::erase_if(out.triangles, [](const Triangle& t) { return element_of(t) != ElementKind::triangle; });
    return out;
}

TriangleMesh drawn_mesh(const TriangleMesh& mesh, double radius) {
    const auto vertex = [&](std::int32_t i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
    TriangleMesh out = mesh;
    std::vector<double> ball(mesh.vertices.size()); // its radius
    for (const Triangle& t : mesh.triangles) {
        if (element_of(t) == ElementKind::triangle) continue;
        const auto [a, b] = segment_ends(t);
        if (a != b) add_tube(out, vertex(a), vertex(b), radius);
        for (const std::int32_t i : {a, b}) {
            double& r = ball[static_cast<std::size_t>(i)];
            r = std::max(r, a == b ? 2 * radius : radius); // a point alone is easily overlooked
        }
    }
    for (std::size_t i = 0; i < ball.size(); ++i)
        if (ball[i] > 0) add_ball(out, mesh.vertices[i], make_sphere(ball[i], 1));
    return out;
}

} // namespace flotilla::io
