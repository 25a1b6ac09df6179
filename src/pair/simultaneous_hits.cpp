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

/// x . normal = offset; what stands on the plane is on the side of `normal`.
struct Plane {
    Vec3 normal;
    double offset;
};

double height(const Plane& plane, const Vec3& x) { return dot(plane.normal, x) - plane.offset; }

/// The vertices of a body that stands on the plane which are within `reach` of it and inside `region`, each once. None where the body does
/// not stand on the plane but reaches through it, as most bodies that hit each other do: of two nodes the lower one first, as a few of
/// them tell.
void find_feet(const BodyMotion& body, double t, const Plane& plane, double reach, const Box& region,
               std::vector<Vec3>& feet) {
    struct Open {
        std::int32_t node;
        double lowest, highest; ///< of its box, over the plane
        bool inside;            ///< of the region, in part
    };
    const auto open = [&](std::int32_t i) {
        const Box box = node_at(body, at(i), t);
        const double center = height(plane, 0.5 * (box.lower + box.upper));
        const double half = dot(abs(plane.normal), 0.5 * (box.upper - box.lower));
        return Open{i, center - half, center + half, boxes_overlap(box, region, 0)};
    };
    feet.clear();
    const Bvh& bvh = body.shape->bvh;
    std::array<Open, kMaxBvhDepth + 2> stack;
    std::size_t size = 0;
    const auto push = [&](const Open& n) {
        if (n.lowest < -reach || (n.inside && n.lowest <= reach)) stack[size++] = n;
    };
    push(open(0));
    while (size > 0) {
        const Open top = stack[--size];
        if (top.highest < -reach) return feet.clear();
        const BvhNode node = bvh.nodes[at(top.node)];
        if (node.count == 0) {
            const Open left = open(top.node + 1), right = open(node.first);
            const bool right_first = right.lowest < left.lowest;
            push(right_first ? left : right);
            push(right_first ? right : left);
            continue;
        }
        for (const std::int32_t triangle : bvh.leaf_triangles(node))
            for (const std::int32_t v : body.shape->mesh.triangles[at(triangle)]) {
                const Vec3 x = vertex_at(body, v, t);
                const double h = height(plane, x);
                if (h < -reach) return feet.clear();
                if (h <= reach && std::find(feet.begin(), feet.end(), x) == feet.end()) feet.push_back(x);
            }
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
        const Box box = node_at(other, 0, t);
        const Box region{box.lower - Vec3{room, room, room}, box.upper + Vec3{room, room, room}};
        find_feet(body, t, plane, reach, region, worker.feet);
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
