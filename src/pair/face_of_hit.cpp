// SPDX-License-Identifier: MIT
#include "pair/face_of_hit.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "base/index.hpp"
#include "ccd/separation.hpp"
#include "geometry/closest.hpp"
#include "pair/body_at.hpp"

namespace flotilla {
namespace {

/// The vertices of the feature of a body that is nearest to the other one: one of a corner, two of an edge, three of
/// the inside of a face.
struct Touching {
    std::array<std::int32_t, 3> vertices{};
    std::size_t size = 0;

    void add(std::int32_t vertex, double weight) {
        if (weight != 0) vertices[size++] = vertex;
    }
};
struct TouchingFeatures {
    Touching a, b;
};

TouchingFeatures touching_features(const BodyAt& a, const BodyAt& b, const FeaturePair& f) {
    TouchingFeatures out;
    if (f.kind == FeatureKind::edge_edge) {
        const Edge &e = a.shape().topology.edges[at(f.a)], &g = b.shape().topology.edges[at(f.b)];
        const auto c = closest_edge_edge(a.vertex(e[0]), a.vertex(e[1]), b.vertex(g[0]), b.vertex(g[1]));
        out.a.add(e[0], 1 - c.s), out.a.add(e[1], c.s);
        out.b.add(g[0], 1 - c.t), out.b.add(g[1], c.t);
        return out;
    }
    const bool corner_of_a = f.kind == FeatureKind::vertex_face;
    const BodyAt &body = corner_of_a ? a : b, &other = corner_of_a ? b : a;
    const std::int32_t vertex = corner_of_a ? f.a : f.b;
    const Triangle& face = other.shape().mesh.triangles[at(corner_of_a ? f.b : f.a)];
    const auto c = closest_vertex_triangle(body.vertex(vertex), other.vertex(face[0]), other.vertex(face[1]),
                                           other.vertex(face[2]));
    (corner_of_a ? out.a : out.b).add(vertex, 1);
    for (std::size_t k = 0; k < 3; ++k) (corner_of_a ? out.b : out.a).add(face[k], c.barycentric[k]);
    return out;
}

/// Calls visit(corners) for the triangles of a body around what touches, with their corners.
template <class Visit>
void for_each_face(const BodyAt& body, const Touching& touching, Visit&& visit) {
    const Topology& topology = body.shape().topology;
    for (const std::int32_t i : topology.around_vertex(touching.vertices[0])) {
        const Triangle& face = body.shape().mesh.triangles[at(i)];
        const auto has = [&](std::int32_t v) {
            return std::any_of(face.begin(), face.end(),
                               [&](std::int32_t w) { return topology.place[at(w)] == topology.place[at(v)]; });
        };
        if (touching.size > 1 && !has(touching.vertices[1])) continue;
        visit(std::array{body.vertex(face[0]), body.vertex(face[1]), body.vertex(face[2])});
    }
}

} // namespace

std::optional<Vec3> face_of_hit(const StepView& view, const ClusterHit& h) {
    const BodyMotion motion_a = view.trajectories.motion(at(h.a)), motion_b = view.trajectories.motion(at(h.b));
    const BodyAt a(motion_a, h.hit.toi), b(motion_b, h.hit.toi);
    const TouchingFeatures touching = touching_features(a, b, h.hit.features);
    if (touching.a.size == 3 || touching.b.size == 3) return std::nullopt;

    const auto parts = [&](const Vec3& normal) {
        double most_a = -std::numeric_limits<double>::infinity(), least_b = -most_a;
        for_each_face(a, touching.a, [&](const std::array<Vec3, 3>& x) {
            for (const Vec3& corner : x) most_a = std::max(most_a, dot(normal, corner));
        });
        for_each_face(b, touching.b, [&](const std::array<Vec3, 3>& x) {
            for (const Vec3& corner : x) least_b = std::min(least_b, dot(normal, corner));
        });
        return most_a <= least_b;
    };
    if (parts(h.hit.normal)) return std::nullopt;
    std::optional<Vec3> best;
    double nearest = 1 / kHitReach; // cosine of the angle to the hit's normal
    const auto offer = [&](const std::array<Vec3, 3>& x) {
        const Vec3 across = cross(x[1] - x[0], x[2] - x[0]);
        const double size = length(across), along = dot(across, h.hit.normal);
        if (!(size > 0) || !(std::abs(along) >= nearest * size) || (best && std::abs(along) == nearest * size)) return;
        const Vec3 normal = (along > 0 ? 1 / size : -1 / size) * across;
        if (!parts(normal)) return;
        nearest = std::abs(along) / size;
        best = normal;
    };
    for_each_face(a, touching.a, offer);
    for_each_face(b, touching.b, offer);
    return best;
}

} // namespace flotilla
