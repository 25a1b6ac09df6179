// SPDX-License-Identifier: MIT
#include "primitives.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/rotation.hpp"
#include "base/vec3.hpp"

namespace flotilla::baseline {
namespace {

constexpr double kSame = 1e-9; // of the size
/// A ball of fewer vertices is meant as a polyhedron: the icosahedron's first subdivision has 42.
constexpr std::size_t kRoundVertices = 42, kRoundSides = 16;

bool same(double a, double b, double size) { return std::abs(a - b) <= kSame * size; }

bool is_box(const std::vector<Vec3>& vertices, const Primitive& p, double size) {
    return vertices.size() == 8 && std::all_of(vertices.begin(), vertices.end(), [&](const Vec3& v) {
               const Vec3 arm = abs(v - p.center);
               return same(arm.x, p.size.x / 2, size) && same(arm.y, p.size.y / 2, size) &&
                      same(arm.z, p.size.z / 2, size);
           });
}

bool is_sphere(const std::vector<Vec3>& vertices, const Primitive& p, double size) {
    const double radius = length(vertices.front() - p.center);
    return vertices.size() >= kRoundVertices && std::all_of(vertices.begin(), vertices.end(), [&](const Vec3& v) {
               return same(length(v - p.center), radius, size);
           });
}

bool is_cylinder(const std::vector<Vec3>& vertices, const Primitive& p, double size) {
    const double radius = p.size.x / 2;
    std::size_t around = 0;
    for (const Vec3& v : vertices) {
        const Vec3 arm = v - p.center;
        const double r = std::hypot(arm.x, arm.y);
        const bool rim = same(r, radius, size), cap = same(r, 0, size) && same(std::abs(arm.z), p.size.z / 2, size);
        if (!rim && !cap) return false;
        if (rim && same(arm.z, p.size.z / 2, size)) ++around;
    }
    return around >= kRoundSides;
}

/// Every triangle has all vertices behind it: then the surface is closed and convex.
bool is_convex(const ShapeDescription& shape, double size) {
    return std::all_of(shape.triangles.begin(), shape.triangles.end(), [&](const Triangle& t) {
        const auto at = [&](std::size_t k) { return shape.vertices[static_cast<std::size_t>(t[k])]; };
        const Vec3 normal = normalized(cross(at(1) - at(0), at(2) - at(0)));
        return std::all_of(shape.vertices.begin(), shape.vertices.end(),
                           [&](const Vec3& v) { return dot(normal, v - at(0)) <= kSame * size; });
    });
}

} // namespace

Primitive recognize(const ShapeDescription& shape) {
    const std::vector<Vec3>& vertices = shape.vertices;
    Primitive p;
    Vec3 low = vertices.front(), high = low;
    for (const Vec3& v : vertices) low = min(low, v), high = max(high, v);
    p.center = 0.5 * (low + high), p.size = high - low;
    const double size = length(p.size);
    using enum Primitive::Kind;
    if (p.size.z == 0 && p.center.z == 0)
        p.kind = vertices.size() == 4 ? plate : mesh;
    else if (is_box(vertices, p, size))
        p.kind = box;
    else if (is_cylinder(vertices, p, size)) // its two rims lie on a sphere as well
        p.kind = cylinder;
    else if (is_sphere(vertices, p, size))
        p.kind = sphere;
    else if (is_convex(shape, size))
        p.kind = convex;
    return p;
}

MassProperties primitive_mass(const Primitive& p, const ShapeDescription& shape, const MassProperties& mass) {
    MassProperties out = mass;
    out.center_of_mass = p.center;
    out.principal_axes = {};
    out.principal_inertia = {mass.inertia.m[0], mass.inertia.m[4], mass.inertia.m[8]};
    if (shape.mass_kind != MassKind::density) return out;
    const double r = p.size.x / 2, h = p.size.z;
    if (p.kind == Primitive::Kind::sphere) {
        const double i = 0.4 * mass.mass * r * r;
        out.principal_inertia = {i, i, i};
    }
    if (p.kind == Primitive::Kind::cylinder) {
        const double across = mass.mass * (3 * r * r + h * h) / 12;
        out.principal_inertia = {across, across, mass.mass * r * r / 2};
    }
    return out;
}

std::vector<Face> convex_faces(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) {
    constexpr double kSameNormal = 1e-9;
    std::vector<Face> faces;
    std::vector<std::set<std::int32_t>> members;
    for (const Triangle& t : triangles) {
        const auto at = [&](std::size_t k) { return vertices[static_cast<std::size_t>(t[k])]; };
        const Vec3 normal = normalized(cross(at(1) - at(0), at(2) - at(0)));
        std::size_t f = 0;
        while (f < faces.size() && dot(faces[f].normal, normal) < 1 - kSameNormal) ++f;
        if (f == faces.size()) faces.push_back({normal, {}}), members.emplace_back();
        members[f].insert(t.begin(), t.end());
    }
    for (std::size_t f = 0; f < faces.size(); ++f) {
        std::vector<std::int32_t>& corners = faces[f].corners;
        corners.assign(members[f].begin(), members[f].end());
        Vec3 middle;
        for (const std::int32_t c : corners) middle += vertices[static_cast<std::size_t>(c)];
        middle = middle / static_cast<double>(corners.size());
        const Vec3 u = normalized(vertices[static_cast<std::size_t>(corners[0])] - middle),
                   v = cross(faces[f].normal, u);
        const auto angle = [&](std::int32_t c) {
            const Vec3 arm = vertices[static_cast<std::size_t>(c)] - middle;
            return std::atan2(dot(arm, v), dot(arm, u));
        };
        std::sort(corners.begin(), corners.end(), [&](std::int32_t a, std::int32_t b) { return angle(a) < angle(b); });
    }
    return faces;
}

} // namespace flotilla::baseline
