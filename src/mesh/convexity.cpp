// SPDX-License-Identifier: MIT
#include "mesh/convexity.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "mesh/topology.hpp"

namespace flotilla {
namespace {

/// Looking along a direction goes through all vertices, and the test through all for every triangle.
constexpr std::size_t kMostVertices = 256;
/// Of the size: what tessellation, units and printed digits leave of faces that were meant to be flat.
constexpr double kFlat = 1e-6;

/// How far vertices are on either side of a triangle's plane, m.
struct Sides {
    double before = 0, behind = 0;
    bool known = true; ///< false: the triangle has no plane of its own
};

Sides sides_of(const TriangleMesh& mesh, const Triangle& t) {
    const Vec3& p = mesh.vertices[at(t[0])];
    const Vec3 normal = cross(mesh.vertices[at(t[1])] - p, mesh.vertices[at(t[2])] - p);
    const double size = length(normal);
    Sides sides;
    if (!(size > 0)) return {.known = false}; // lies in the plane of others, or is a line or a point
    for (const Vec3& v : mesh.vertices) {
        const double height = dot(normal, v - p) / size;
        sides.before = std::max(sides.before, height);
        sides.behind = std::max(sides.behind, -height);
    }
    return sides;
}

/// Whether all vertices lie on a line, to `room` (m).
bool is_straight(const TriangleMesh& mesh, double room) {
    const Vec3& p = mesh.vertices[0];
    const auto far = [&](const Vec3& v) { return length_sq(v - p); };
    const Vec3 line = normalized(*std::ranges::max_element(mesh.vertices, {}, far) - p);
    return std::ranges::all_of(mesh.vertices, [&](const Vec3& v) { return length(cross(v - p, line)) <= room; });
}

} // namespace

bool is_convex(const TriangleMesh& mesh) {
    if (mesh.triangles.empty() || mesh.vertices.size() > kMostVertices) return false;
    const Box box = bounding_box(mesh);
    const double room = kFlat * length(box.upper - box.lower);
    bool flat = true, known = false;
    for (const Triangle& t : mesh.triangles) {
        const Sides sides = sides_of(mesh, t);
        if (std::min(sides.before, sides.behind) > room) return false; // facing inwards is as good
        known = known || sides.known;
        flat = flat && std::max(sides.before, sides.behind) <= room;
    }
    if (!known) return is_straight(mesh, room); // a wire or points
    return flat || closedness(mesh).closed;
}

} // namespace flotilla
