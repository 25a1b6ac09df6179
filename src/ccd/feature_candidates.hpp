// SPDX-License-Identifier: MIT
// Feature pairs of two bodies that move: their corners, closest points and boxes.
#pragma once

#include "geometry/ccd.hpp"
#include "state/feature_pair.hpp"
#include "state/trajectories.hpp"

namespace flotilla {

[[nodiscard]] constexpr CcdKind ccd_kind(FeatureKind kind) {
    return kind == FeatureKind::edge_edge ? CcdKind::edge_edge : CcdKind::vertex_face;
}

/// Corners at both ends, as if they moved straight. The query's first feature is the vertex, or the edge of body a.
[[nodiscard]] CcdQuery ccd_query(const BodyMotion& a, const BodyMotion& b, const FeaturePair& f);

/// Where the corners of the queries of a kind stand.
[[nodiscard]] CcdPoints ccd_points(const BodyMotion& a, const BodyMotion& b, FeatureKind kind);
/// The corners of a query, in those arrays.
[[nodiscard]] inline CcdCorners ccd_corners(const BodyMotion& a, const BodyMotion& b, const FeaturePair& f) {
    const auto i = static_cast<std::size_t>(f.a), j = static_cast<std::size_t>(f.b);
    if (f.kind == FeatureKind::edge_edge) {
        const Edge &p = a.shape->topology.edges[i], &q = b.shape->topology.edges[j];
        return {p[0], p[1], q[0], q[1]};
    }
    const bool vertex_first = f.kind == FeatureKind::vertex_face;
    const Triangle& t = vertex_first ? b.shape->mesh.triangles[j] : a.shape->mesh.triangles[i];
    return {vertex_first ? f.a : f.b, t[0], t[1], t[2]};
}

/// Turns a direction of a query (second feature to first) into one from a to b.
[[nodiscard]] constexpr Vec3 from_a_to_b(FeatureKind kind, const Vec3& direction) {
    return kind == FeatureKind::face_vertex ? direction : -direction;
}

/// The closest points of a feature pair at time t of the motion, and how they move.
struct FeaturePoints {
    Vec3 a0, a1, b0, b1; ///< the material points at t = 0 and t = 1; of a turning body by its velocity at t
    Vec3 a, b;           ///< at time t
    double distance_sq = 0;
    bool interior = true; ///< edge_edge: neither point is an end of its edge
};
[[nodiscard]] FeaturePoints closest_points(const BodyMotion& a, const BodyMotion& b, const FeaturePair& f, double t);
/// The direction from the one in a to the one in b; zero where they are one point.
[[nodiscard]] Vec3 closest_direction(const BodyMotion& a, const BodyMotion& b, const FeaturePair& f, double t);

/// Coarse boxes of a vertex, an edge and a triangle along the motion.
[[nodiscard]] inline MovingCoarseBox coarse_vertex(const BodyMotion& body, std::int32_t v) {
    const auto i = static_cast<std::size_t>(v);
    return {body.at0.points[i], body.at1.points[i]};
}
[[nodiscard]] inline MovingCoarseBox coarse_edge(const BodyMotion& body, const Edge& e) {
    const MovingCoarseBox p = coarse_vertex(body, e[0]), q = coarse_vertex(body, e[1]);
    return {merged(p.at0, q.at0), merged(p.at1, q.at1)};
}
[[nodiscard]] inline MovingCoarseBox coarse_triangle(const BodyMotion& body, const Triangle& t) {
    const MovingCoarseBox e = coarse_edge(body, {t[0], t[1]}), p = coarse_vertex(body, t[2]);
    return {merged(e.at0, p.at0), merged(e.at1, p.at1)};
}
/// Of a node of the body's hierarchy.
[[nodiscard]] inline MovingCoarseBox coarse_node(const BodyMotion& body, std::int32_t node) {
    const auto i = static_cast<std::size_t>(node);
    return {body.at0.nodes[i], body.at1.nodes[i]};
}

} // namespace flotilla
