// SPDX-License-Identifier: MIT
#include "solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mesh/topology.hpp"
#include "scene/scene.hpp"

namespace flotilla::baseline {
namespace {

using Corners = std::array<Vec3, 3>;

Corners corners(const Solid& solid, const Triangle& t) {
    const auto at = [&](int k) { return solid.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])]; };
    return {at(0), at(1), at(2)};
}

/// The point of a triangle closest to p, by the Voronoi region of its features.
Vec3 closest_point(const Corners& t, const Vec3& p) {
    const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return t[0];
    const Vec3 bp = p - t[1];
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return t[1];
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return t[0] + (d1 / (d1 - d3)) * ab;
    const Vec3 cp = p - t[2];
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return t[2];
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return t[0] + (d2 / (d2 - d6)) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return t[1] + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (t[2] - t[1]);
    const double denominator = va + vb + vc;
    return denominator > 0 ? t[0] + (vb / denominator) * ab + (vc / denominator) * ac : t[0];
}

/// The solid angle of a triangle seen from p, signed (van Oosterom and Strackee 1983).
double solid_angle(const Corners& t, const Vec3& p) {
    const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
    const double la = length(a), lb = length(b), lc = length(c);
    return 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

struct Nearest {
    double distance_sq = std::numeric_limits<double>::infinity();
    Vec3 point, face_normal;
};

Nearest nearest(const Solid& solid, const Vec3& p) {
    Nearest out;
    for (const Triangle& triangle : solid.triangles) {
        const Corners t = corners(solid, triangle);
        const Vec3 q = closest_point(t, p);
        if (const double d = length_sq(q - p); d < out.distance_sq)
            out = {d, q, normalized(cross(t[1] - t[0], t[2] - t[0]))};
    }
    return out;
}

/// Winding number about p, of either orientation of the mesh.
bool is_inside(const Solid& solid, const Vec3& p) {
    double angle = 0;
    for (const Triangle& triangle : solid.triangles) angle += solid_angle(corners(solid, triangle), p);
    return std::abs(angle) > 2 * 3.14159265358979;
}

void add_edge_samples(Solid& solid, double spacing) {
    for (const Edge& edge : build_topology({solid.vertices, solid.triangles}).edges) {
        const Vec3 a = solid.vertices[static_cast<std::size_t>(edge[0])];
        const Vec3 b = solid.vertices[static_cast<std::size_t>(edge[1])];
        const int parts = static_cast<int>(std::ceil(length(b - a) / spacing));
        for (int k = 1; k < parts; ++k) solid.samples.push_back(a + (1.0 * k / parts) * (b - a));
    }
}

/// Inside of triangles; slivers have enough with their edges.
void add_face_samples(Solid& solid, double spacing) {
    for (const Triangle& triangle : solid.triangles) {
        const Corners t = corners(solid, triangle);
        if (length(cross(t[1] - t[0], t[2] - t[0])) < spacing * spacing) continue;
        const double longest = std::max({length(t[1] - t[0]), length(t[2] - t[1]), length(t[0] - t[2])});
        const int parts = static_cast<int>(std::ceil(longest / spacing));
        for (int i = 1; i < parts; ++i)
            for (int j = 1; i + j < parts; ++j)
                solid.samples.push_back(t[0] + (1.0 * i / parts) * (t[1] - t[0]) + (1.0 * j / parts) * (t[2] - t[0]));
    }
}

/// The planes of a closed mesh, or none where it is not convex. All of its faces turn outwards or all inwards.
std::vector<Solid::Plane> convex_planes(const Solid& solid) {
    std::vector<Solid::Plane> planes;
    for (const Triangle& triangle : solid.triangles) {
        const Corners t = corners(solid, triangle);
        const Vec3 n = normalized(cross(t[1] - t[0], t[2] - t[0]));
        if (length_sq(n) == 0) continue;
        double low = 0, high = 0;
        for (const Vec3& v : solid.vertices)
            low = std::min(low, dot(n, v - t[0])), high = std::max(high, dot(n, v - t[0]));
        const double tolerance = 1e-12 * solid.radius; // rounding of coplanar vertices
        if (low < -tolerance && high > tolerance) return {};
        const Vec3 out = high > tolerance ? -n : n;
        planes.push_back({out, dot(out, t[0])});
    }
    return planes;
}

/// The nearest face of a convex solid is the nearest point of its surface for every point inside.
Depth depth_in_convex(const std::vector<Solid::Plane>& planes, const Vec3& p) {
    Depth out{std::numeric_limits<double>::infinity(), {}};
    for (const Solid::Plane& plane : planes) {
        const double depth = plane.offset - dot(plane.normal, p);
        if (depth <= 0) return {};
        if (depth < out.depth) out = {depth, plane.normal};
    }
    return out;
}

void set_mass(Solid& solid, const ShapeDescription& shape) {
    if (const auto mass = shape_mass_properties(shape)) {
        solid.mass = mass->mass;
        solid.center = mass->center_of_mass;
        solid.inertia = mass->inertia;
        solid.inverse_inertia = inverse(mass->inertia);
    }
}

} // namespace

Mat3 inverse(const Mat3& a) {
    const Vec3 x = row(a, 0), y = row(a, 1), z = row(a, 2);
    const Vec3 p = cross(y, z), q = cross(z, x), r = cross(x, y);
    return 1 / dot(x, p) * Mat3{{p.x, q.x, r.x, p.y, q.y, r.y, p.z, q.z, r.z}};
}

Solid make_solid(const ShapeDescription& shape, int samples_across, double thickness) {
    Solid solid;
    solid.triangles = shape.triangles;
    solid.closed = closedness({shape.vertices, shape.triangles}).oriented;
    solid.thickness = solid.closed ? 0 : thickness;
    Vec3 low = shape.vertices[0], high = low;
    for (const Vec3& v : shape.vertices) low = min(low, v), high = max(high, v);
    solid.center = 0.5 * (low + high);
    set_mass(solid, shape);
    const Vec3 margin{solid.thickness, solid.thickness, solid.thickness};
    solid.low = low - solid.center - margin, solid.high = high - solid.center + margin;
    for (const Vec3& v : shape.vertices) {
        solid.vertices.push_back(v - solid.center);
        solid.radius = std::max(solid.radius, length(solid.vertices.back()) + solid.thickness);
    }
    if (solid.closed) solid.planes = convex_planes(solid);
    solid.samples = solid.vertices;
    if (samples_across > 0) {
        const double spacing = length(high - low) / samples_across;
        add_edge_samples(solid, spacing);
        add_face_samples(solid, spacing);
    }
    return solid;
}

Depth depth_at(const Solid& solid, const Vec3& p) {
    const Vec3 &low = solid.low, &high = solid.high;
    if (p.x <= low.x || p.y <= low.y || p.z <= low.z || p.x >= high.x || p.y >= high.y || p.z >= high.z) return {};
    if (!solid.planes.empty()) return depth_in_convex(solid.planes, p);
    if (solid.closed && !is_inside(solid, p)) return {};
    const Nearest near = nearest(solid, p);
    const double distance = std::sqrt(near.distance_sq);
    if (!solid.closed && distance >= solid.thickness) return {};
    // On the surface itself the gradient does not exist; the face's normal takes its place.
    const Vec3 away = distance > 1e-12 ? (1 / distance) * (p - near.point) : near.face_normal;
    return solid.closed ? Depth{distance, distance > 1e-12 ? -away : away} : Depth{solid.thickness - distance, away};
}

} // namespace flotilla::baseline
