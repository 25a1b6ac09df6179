// SPDX-License-Identifier: MIT
#include "pair/simultaneous_hits.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/index.hpp"
#include "geometry/closest.hpp"
#include "geometry/rounding.hpp"
#include "pair/body_at.hpp"

namespace flotilla {
namespace {

/// The box of the node at time t on the straight ways of its vertices, but for rounding by a few units of the largest
/// coordinate, for which CoarseReach has room. Vertices of a body that turns are within arc_gap(1) of these ways.
CoarseBox node_at(const BodyMotion& body, std::size_t node, Float4 t) {
    const CoarseBox &at0 = body.at0.nodes[node], &at1 = body.at1.nodes[node];
    const auto between = [&](const float* x0, const float* x1) { return load4(x0) + t * (load4(x1) - load4(x0)); };
    CoarseBox box;
    store(box.lower, between(at0.lower, at1.lower));
    store(box.neg_upper, between(at0.neg_upper, at1.neg_upper));
    return box;
}

/// Whether the body is within `reach` (m) of x.
bool touches(const BodyAt& body, const Vec3& x, double reach) {
    const BodyMotion& motion = body.motion();
    const Bvh& bvh = body.shape().bvh;
    const CoarseBox point = coarse_box(x);
    const CoarseReach room(reach + motion.arc_gap(1), std::max(motion.max_abs(), max_component(abs(x))));
    const Float4 time = both4(static_cast<float>(body.time()));
    const auto near = [&](std::int32_t triangle) {
        const Triangle& f = body.shape().mesh.triangles[at(triangle)];
        return closest_vertex_triangle(x, body.vertex(f[0]), body.vertex(f[1]), body.vertex(f[2])).distance_sq <=
               reach * reach;
    };
    std::array<std::int32_t, kMaxBvhDepth + 2> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const std::int32_t i = stack[--size];
        if (!coarse_overlap(node_at(motion, at(i), time), point, room)) continue;
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

/// Heights above a plane by mesh coordinates, for a third of the work of the exact ones.
struct Heights {
    Vec3 slope;
    double start, error; ///< m; the error is far more than the rounding of either

    Heights(const BodyAt& body, const Plane& plane) {
        const MatrixPose map = body.map();
        slope = transpose(map.rotation) * plane.normal;
        start = dot(plane.normal, map.origin) - plane.offset;
        error = place_rounding(body.motion().max_abs() + body.shape().radius + max_component(abs(map.origin)) +
                               std::abs(plane.offset));
    }
    [[nodiscard]] double at_least(const Vec3& local) const { return (dot(slope, local) + start) - error; }
};

/// The vertices of a body that stands on the plane which are within `reach` of it. None where the body does not stand
/// on the plane but reaches through it, and through what is `gap` (m) beyond it. All vertices are tested: an impulse
/// has moved all of them before.
void find_feet(const BodyAt& body, const Plane& plane, double reach, double gap, std::vector<Vec3>& feet) {
    feet.clear();
    const Heights heights(body, plane);
    const std::vector<Vec3>& local = body.shape().mesh.vertices;
    for (std::size_t v = 0; v < local.size(); ++v) {
        if (heights.at_least(local[v]) > reach || body.shape().topology.vertex_owner[v] < 0) continue;
        const Vec3 x = body.vertex(static_cast<std::int32_t>(v));
        const double height = dot(plane.normal, x) - plane.offset;
        if (height > reach) continue;
        if (height < -(gap + reach)) return feet.clear();
        feet.push_back(x);
    }
}

} // namespace

void find_simultaneous_hits(const StepView& view, std::vector<Vec3>& feet, const ClusterHit& hit,
                            const ContactPoint& first, double reach, std::vector<ContactPoint>& out) {
    const double t = hit.hit.toi;
    const BodyMotion a = view.trajectories.motion(at(hit.a)), b = view.trajectories.motion(at(hit.b));
    const BodyAt a_then(a, t), b_then(b, t);
    const auto center = [&](const BodyMotion& body, std::int32_t id) { // from which the arms of the hit are
        const bool stays = hit.hit.hit && view.clusters[view.clusters.of(at(id))].infinite();
        return stays ? view.trajectories.start_pose(at(id)).com : body.pose(t).com;
    };
    const Vec3 com_a = center(a, hit.a), com_b = center(b, hit.b), point_a = com_a + first.arm_a,
               point = com_b + first.arm_b;
    const double gap = length(point - point_a);
    const Impulsive body_a = view.clusters.impulsive(view.clusters.of(at(hit.a)));
    const Impulsive body_b = view.clusters.impulsive(view.clusters.of(at(hit.b)));
    const std::size_t before = out.size();
    const auto known = [&](const Vec3& x) {
        return std::any_of(out.begin() + static_cast<std::ptrdiff_t>(before), out.end(),
                           [&](const ContactPoint& p) { return length_sq(p.arm_b - (x - com_b)) <= reach * reach; });
    };
    const auto add_feet = [&](const BodyAt& body, const BodyAt& other, const Plane& plane) {
        const double room = gap + reach;
        find_feet(body, plane, reach, gap, feet);
        for (const Vec3& x : feet) {
            ContactPoint p{first.normal, x - com_a, x - com_b, {}, first.friction};
            p.relative_velocity = point_velocity(body_b, p.arm_b) - point_velocity(body_a, p.arm_a);
            if (!(dot(p.relative_velocity, p.normal) < 0) || length_sq(x - point) <= 4 * reach * reach) continue;
            if (!known(x) && touches(other, x, room)) out.push_back(p);
        }
    };
    if (body_a.inverse_mass > 0) add_feet(a_then, b_then, {-first.normal, -dot(first.normal, point_a)});
    if (body_b.inverse_mass > 0) add_feet(b_then, a_then, {first.normal, dot(first.normal, point)});
}

} // namespace flotilla
