// SPDX-License-Identifier: MIT
// Feature pairs of two bodies, a vertex of one and a face of the other or an edge of each, and the keys by which a
// state names them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "state/rigid_shape.hpp"

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

/// Whether a number is the key of features that two shapes have.
[[nodiscard]] inline bool is_feature_key(std::uint64_t key, const RigidShape& a, const RigidShape& b) {
    const FeaturePair f = features_of(key);
    const auto i = static_cast<std::size_t>(f.a), j = static_cast<std::size_t>(f.b);
    switch (f.kind) {
    case FeatureKind::vertex_face: return i < a.mesh.vertices.size() && j < b.mesh.triangles.size();
    case FeatureKind::face_vertex: return i < a.mesh.triangles.size() && j < b.mesh.vertices.size();
    case FeatureKind::edge_edge: return i < a.topology.edges.size() && j < b.topology.edges.size();
    }
    return false;
}

} // namespace flotilla
