// SPDX-License-Identifier: MIT
// From a pair of triangles to the feature pairs that it owns.
#pragma once

#include "ccd/feature_candidates.hpp"

namespace flotilla {

/// Coarse boxes of the features of a triangle, at both times.
struct TriangleFeatures {
    const Triangle& corners;
    const std::array<std::int32_t, 3>& edges;
    std::uint8_t owned;
    std::array<MovingCoarseBox, 3> edge;
    MovingCoarseBox box;

    TriangleFeatures(const BodyMotion& body, std::int32_t t)
        : corners(body.shape->mesh.triangles[static_cast<std::size_t>(t)]),
          edges(body.shape->topology.triangle_edges[static_cast<std::size_t>(t)]),
          owned(body.shape->topology.owned[static_cast<std::size_t>(t)]) {
        for (std::size_t k = 0; k < 3; ++k) edge[k] = coarse_edge(body, {corners[k], corners[(k + 1) % 3]});
        box = {merged(edge[0].at0, edge[1].at0), merged(edge[0].at1, edge[1].at1)};
    }
};

/// Calls emit(FeaturePair) for the owned feature pairs of two triangles whose boxes `meet`.
template <class Meet, class Emit>
void for_each_feature_pair(const BodyMotion& body_a, const BodyMotion& body_b, std::int32_t i, std::int32_t j,
                           const Meet& meet, const Emit& emit) {
    const auto box = [](const BodyMotion& body, std::int32_t t) {
        return coarse_triangle(body, body.shape->mesh.triangles[static_cast<std::size_t>(t)]);
    };
    if (!meet(box(body_a, i), box(body_b, j))) return;
    const TriangleFeatures a(body_a, i), b(body_b, j);
    for (int k = 0; k < 3; ++k) {
        const std::int32_t v = a.corners[static_cast<std::size_t>(k)], w = b.corners[static_cast<std::size_t>(k)];
        if (owns_corner(a.owned, k) && meet(coarse_vertex(body_a, v), b.box))
            emit(FeaturePair{FeatureKind::vertex_face, v, j});
        if (owns_corner(b.owned, k) && meet(a.box, coarse_vertex(body_b, w)))
            emit(FeaturePair{FeatureKind::face_vertex, i, w});
    }
    for (int k = 0; k < 3; ++k) {
        const auto ek = static_cast<std::size_t>(k);
        if (!owns_edge(a.owned, k) || !meet(a.edge[ek], b.box)) continue;
        for (int l = 0; l < 3; ++l) {
            const auto el = static_cast<std::size_t>(l);
            if (owns_edge(b.owned, l) && meet(a.edge[ek], b.edge[el]))
                emit(FeaturePair{FeatureKind::edge_edge, a.edges[ek], b.edges[el]});
        }
    }
}

} // namespace flotilla
