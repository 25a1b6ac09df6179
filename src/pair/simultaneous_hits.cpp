// SPDX-License-Identifier: MIT
#include "pair/simultaneous_hits.hpp"

#include <algorithm>
#include <array>

#include "geometry/closest.hpp"

namespace flotilla {
namespace {

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

Vec3 vertex_at(const BodyMotion& body, std::int32_t v, double t) {
    return body.at0.x[at(v)] + t * (body.at1.x[at(v)] - body.at0.x[at(v)]);
}

/// Holds what the node holds at time t, but for rounding.
Box node_at(const BodyMotion& body, std::size_t node, double t) {
    const Box b0 = to_box(body.at0.nodes[node]), b1 = to_box(body.at1.nodes[node]);
    return {b0.lower + t * (b1.lower - b0.lower), b0.upper + t * (b1.upper - b0.upper)};
}

/// Whether the body is within `reach` (m) of x at time t.
bool touches(const BodyMotion& body, const Vec3& x, double t, double reach) {
    const Bvh& bvh = body.shape->bvh;
    const Vec3 room{reach, reach, reach};
    const Box around{x - room, x + room};
    const auto corner = [&](std::int32_t v) { return vertex_at(body, v, t); };
    const auto near = [&](std::int32_t triangle) {
        const Triangle& f = body.shape->mesh.triangles[at(triangle)];
        return closest_vertex_triangle(x, corner(f[0]), corner(f[1]), corner(f[2])).distance_sq <= reach * reach;
    };
    std::array<std::int32_t, kMaxBvhDepth + 2> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const std::int32_t i = stack[--size];
        if (!boxes_overlap(node_at(body, at(i), t), around, 0)) continue;
        const BvhNode node = bvh.nodes[at(i)];
        if (node.count > 0) {
            const auto triangles = bvh.leaf_triangles(node);
            if (std::any_of(triangles.begin(), triangles.end(), near)) return true;
        } else {
            stack[size++] = node.first;
            stack[size++] = i + 1;
        }
    }
    return false;
}

/// x . normal = offset; what stands on the plane is on the side of `normal`.
struct Plane {
    Vec3 normal;
    double offset;
};

/// The vertices of a body that stands on the plane which are within `reach` of it. None where the body does not stand on the plane but
/// reaches through it, as most bodies that hit each other do. All vertices are looked at: an impulse has moved all of them before.
void find_feet(const BodyMotion& body, double t, const Plane& plane, double reach, std::vector<Vec3>& feet) {
    feet.clear();
    for (std::size_t v = 0; v < body.at0.x.size(); ++v) {
        const Vec3 x = body.at0.x[v] + t * (body.at1.x[v] - body.at0.x[v]);
        const double height = dot(plane.normal, x) - plane.offset;
        if (height > reach || body.shape->topology.vertex_owner[v] < 0) continue;
        if (height < -reach) return feet.clear();
        feet.push_back(x);
    }
}

} // namespace

void find_simultaneous_hits(const StepData& data, Worker& worker, const ClusterHit& hit, const ContactPoint& first,
                            double reach, std::vector<ContactPoint>& out) {
    const double t = hit.hit.toi;
    const BodyMotion a = data.trajectories.motion(at(hit.a)), b = data.trajectories.motion(at(hit.b));
    const Vec3 com_a = a.pose(t).com, com_b = b.pose(t).com, point_a = com_a + first.arm_a, point = com_b + first.arm_b;
    const double gap = length(point - point_a);
    const Impulsive body_a = data.clusters.impulsive(data.clusters.of(at(hit.a)));
    const Impulsive body_b = data.clusters.impulsive(data.clusters.of(at(hit.b)));
    const std::size_t before = out.size();
    const auto known = [&](const Vec3& x) {
        return std::any_of(out.begin() + static_cast<std::ptrdiff_t>(before), out.end(),
                           [&](const ContactPoint& p) { return length_sq(p.arm_b - (x - com_b)) <= reach * reach; });
    };
    const auto add_feet = [&](const BodyMotion& body, const BodyMotion& other, const Plane& plane) {
        const double room = gap + reach;
        find_feet(body, t, plane, reach, worker.feet);
        for (const Vec3& x : worker.feet) {
            ContactPoint p{first.normal, x - com_a, x - com_b, {}, first.friction};
            p.relative_velocity = point_velocity(body_b, p.arm_b) - point_velocity(body_a, p.arm_a);
            if (!(dot(p.relative_velocity, p.normal) < 0) || length_sq(x - point) <= 4 * reach * reach) continue;
            if (!known(x) && touches(other, x, t, room)) out.push_back(p);
        }
    };
    if (body_a.inverse_mass > 0) add_feet(a, b, {-first.normal, -dot(first.normal, point_a)});
    if (body_b.inverse_mass > 0) add_feet(b, a, {first.normal, dot(first.normal, point)});
}

} // namespace flotilla
