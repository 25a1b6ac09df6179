// SPDX-License-Identifier: MIT
// Feature pairs of two bodies: a vertex of one and a face of the other, or an edge of each.
#pragma once

#include "geometry/ccd.hpp"
#include "state/trajectories.hpp"

namespace flotilla {

enum class FeatureKind : std::uint8_t { vertex_face, face_vertex, edge_edge }; ///< of body a, of body b

struct FeaturePair {
    FeatureKind kind = FeatureKind::vertex_face;
    std::int32_t a = 0, b = 0; ///< vertex, triangle or edge number in each body's mesh

    friend bool operator==(const FeaturePair&, const FeaturePair&) = default;
};

/// Distinct for distinct feature pairs of two bodies; orders them.
[[nodiscard]] constexpr std::uint64_t feature_key(const FeaturePair& f) {
    return (static_cast<std::uint64_t>(f.kind) << 62) |
           (static_cast<std::uint64_t>(static_cast<std::uint32_t>(f.a)) << 31) |
           static_cast<std::uint64_t>(static_cast<std::uint32_t>(f.b));
}

/// Whose key it is.
[[nodiscard]] constexpr FeaturePair features_of(std::uint64_t key) {
    constexpr std::uint64_t kIndex = (std::uint64_t{1} << 31) - 1;
    return {static_cast<FeatureKind>(key >> 62), static_cast<std::int32_t>((key >> 31) & kIndex),
            static_cast<std::int32_t>(key & kIndex)};
}

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
