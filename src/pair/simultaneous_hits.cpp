// SPDX-License-Identifier: MIT
#include "pair/simultaneous_hits.hpp"

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

/// Calls leaf(triangle) for the triangles of nodes that near(box) lets pass.
template <class Near, class Leaf>
void descend(const BodyMotion& body, double t, Near&& near, Leaf&& leaf) {
    const Bvh& bvh = body.shape->bvh;
    std::array<std::int32_t, kMaxBvhDepth + 2> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const std::int32_t i = stack[--size];
        if (!near(node_at(body, at(i), t))) continue;
        const BvhNode node = bvh.nodes[at(i)];
        if (node.count > 0) {
            for (const std::int32_t triangle : bvh.leaf_triangles(node)) leaf(triangle);
        } else {
            stack[size++] = node.first;
            stack[size++] = i + 1;
        }
    }
}

bool touches(const BodyMotion& body, const Vec3& x, double t, double reach) {
    bool found = false;
    const Vec3 room{reach, reach, reach};
    descend(
        body, t,
        [&](const Box& box) {
            return !found && boxes_overlap(box, {x - room, x + room}, 0);
        },
        [&](std::int32_t triangle) {
            if (found) return;
            const Triangle& f = body.shape->mesh.triangles[at(triangle)];
            const auto corner = [&](int k) { return vertex_at(body, f[static_cast<std::size_t>(k)], t); };
            found = closest_vertex_triangle(x, corner(0), corner(1), corner(2)).distance_sq <= reach * reach;
        });
    return found;
}

/// The vertices of a body that stands on a plane, within `reach` of it: x . normal = offset, the body on the side of `normal`. None where
/// it does not stand on the plane but reaches through it, which most bodies that hit each other do.
void find_feet(const BodyMotion& body, double t, const Vec3& normal, double offset, double reach,
               std::vector<Vec3>& feet) {
    feet.clear();
    bool through = false;
    descend(
        body, t,
        [&](const Box& box) {
            const double center = dot(normal, 0.5 * (box.lower + box.upper)) - offset;
            const double half = dot(abs(normal), 0.5 * (box.upper - box.lower));
            through = through || center + half < -reach;
            return !through && center - half <= reach;
        },
        [&](std::int32_t triangle) {
            for (const std::int32_t v : body.shape->mesh.triangles[at(triangle)]) {
                const Vec3 x = vertex_at(body, v, t);
                const double height = dot(normal, x) - offset;
                through = through || height < -reach;
                if (height <= reach) feet.push_back(x);
            }
        });
    if (through) feet.clear();
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
    const auto add = [&](const Vec3& x) {
        ContactPoint p{first.normal, x - com_a, x - com_b, {}, first.friction};
        p.relative_velocity = point_velocity(body_b, p.arm_b) - point_velocity(body_a, p.arm_a);
        if (!(dot(p.relative_velocity, p.normal) < 0) || length_sq(x - point) <= 4 * reach * reach) return;
        for (std::size_t i = before; i < out.size(); ++i) // a corner of several triangles
            if (length_sq(out[i].arm_b - p.arm_b) <= reach * reach) return;
        out.push_back(p);
    };
    const auto add_feet = [&](const BodyMotion& body, const BodyMotion& other, const Vec3& normal, const Vec3& foot) {
        find_feet(body, t, normal, dot(normal, foot), reach, worker.feet);
        for (const Vec3& x : worker.feet)
            if (touches(other, x, t, gap + reach)) add(x);
    };
    if (body_a.inverse_mass > 0) add_feet(a, b, -first.normal, point_a);
    if (body_b.inverse_mass > 0) add_feet(b, a, first.normal, point);
}

} // namespace flotilla
