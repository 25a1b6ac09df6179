// SPDX-License-Identifier: MIT
// The nearest points of two features.
#pragma once

#include <array>

#include "base/index.hpp"
#include "base/rotation.hpp"
#include "geometry/closest.hpp"
#include "state/feature_pair.hpp"
#include "state/model.hpp"

namespace flotilla {

/// A body's shape at a pose.
struct PosedShape {
    const RigidShape& shape;
    const Pose& pose;

    [[nodiscard]] Vec3 vertex(std::int32_t v) const { // world, m
        return pose.origin + rotate(pose.rotation, shape.mesh.vertices[at(v)]);
    }
};

/// World, m.
struct ClosestPoints {
    Vec3 a, b;
    double distance_sq;
    bool interior; ///< not at the end of an edge of an edge-edge pair
    Vec3 e, f;     ///< edges of the face, or both edges
};

/// `A` and `B` have a shape and vertex(), as PosedShape does.
template <class A, class B>
[[nodiscard]] ClosestPoints closest_points(const FeaturePair& features, const A& a, const B& b) {
    const auto edge = [](const auto& body, std::int32_t e) {
        const Edge& ends = body.shape.topology.edges[at(e)];
        return std::array{body.vertex(ends[0]), body.vertex(ends[1])};
    };
    const auto face = [](const auto& body, std::int32_t t) {
        const Triangle& corners = body.shape.mesh.triangles[at(t)];
        return std::array{body.vertex(corners[0]), body.vertex(corners[1]), body.vertex(corners[2])};
    };
    if (features.kind == FeatureKind::edge_edge) {
        const auto p = edge(a, features.a), q = edge(b, features.b);
        const auto c = closest_edge_edge(p[0], p[1], q[0], q[1]);
        return {c.p, c.q, c.distance_sq, c.s > 0 && c.s < 1 && c.t > 0 && c.t < 1, p[1] - p[0], q[1] - q[0]};
    }
    const bool vertex_first = features.kind == FeatureKind::vertex_face;
    const Vec3 v = vertex_first ? a.vertex(features.a) : b.vertex(features.b);
    const auto t = vertex_first ? face(b, features.b) : face(a, features.a);
    const auto c = closest_vertex_triangle(v, t[0], t[1], t[2]);
    return {vertex_first ? v : c.point, vertex_first ? c.point : v, c.distance_sq, true, t[1] - t[0], t[2] - t[0]};
}

} // namespace flotilla
