// SPDX-License-Identifier: MIT
// Edges and ownership of features in a triangle soup, closedness, bounding spheres.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec3.hpp"
#include "geometry/box.hpp"
#include "mesh/triangle_mesh.hpp"

namespace flotilla {

using Edge = std::array<std::int32_t, 2>; ///< vertex indices, low one first

/// The features of a soup and who owns them. Each referenced vertex and each edge is owned by exactly one of the
/// triangles that have it, the one with the lowest index. A traversal of overlapping triangle pairs that tests only
/// owned features
///   owned vertices of A x triangle B, triangle A x owned vertices of B, owned edges of A x owned edges of B
/// meets each vertex-face and edge-edge pair of two bodies exactly once, and loses none: a feature lies inside the
/// bounds of its owner. Edges are named by vertex index: vertices that merely coincide make different edges.
struct Topology {
    std::vector<Edge> edges; ///< sorted, each once; a triangle with an index twice has an edge (i, i)
    std::vector<std::array<std::int32_t, 3>> triangle_edges; ///< edge k joins corners k and (k + 1) mod 3
    std::vector<std::int32_t> vertex_owner;                  ///< triangle, or -1 for a vertex no triangle uses
    std::vector<std::int32_t> edge_owner;                    ///< triangle
    std::vector<std::uint8_t> owned; ///< per triangle: bit k = owns its corner k, bit 3 + k = owns its edge k
    std::vector<std::int32_t> place; ///< of vertices, the same for those at equal positions, in order of appearance
    std::vector<std::int32_t> first_around; ///< by place, and one more: where its triangles begin in `around`
    std::vector<std::int32_t> around;       ///< the triangles that have a corner there, ascending, each once
    /// By vertex and by edge, 0 where contacts of the others say all that it could: it lies within a flat face, or
    /// another one of a lower number is at the same place. A plane's distance over a flat face is least at a corner of
    /// where two faces lie over each other, which is a corner of one of them or a crossing of their rims.
    std::vector<std::uint8_t> salient_vertex, salient_edge;

    /// The triangles around the place of a vertex.
    [[nodiscard]] std::span<const std::int32_t> around_vertex(std::int32_t vertex) const {
        const std::int32_t* const first =
            &first_around[static_cast<std::size_t>(place[static_cast<std::size_t>(vertex)])];
        return std::span(around).subspan(static_cast<std::size_t>(first[0]),
                                         static_cast<std::size_t>(first[1] - first[0]));
    }
};
[[nodiscard]] Topology build_topology(const TriangleMesh& mesh);

inline bool owns_corner(std::uint8_t owned, int corner) { return ((owned >> corner) & 1) != 0; }
inline bool owns_edge(std::uint8_t owned, int edge) { return ((owned >> (3 + edge)) & 1) != 0; }

/// Whether the surface bounds a volume, decided after merging vertices at equal positions: closed where every edge has
/// an even number of triangles, oriented where as many run along it one way as the other. Triangles with two corners at
/// one place do not count. Other zero-area triangles may fill a T-junction or lie about as waste, so the mesh passes if
/// it does so either with or without them.
struct Closedness {
    bool closed = false;
    bool oriented = false; ///< implies closed
};
[[nodiscard]] Closedness closedness(const TriangleMesh& mesh);

/// |(b - a) x (c - a)| below 2^-80 |b - a| |c - a|: no area, to far beyond the rounding of any coordinates.
[[nodiscard]] bool is_zero_area(const Vec3& a, const Vec3& b, const Vec3& c);

struct BoundingSphere {
    Vec3 center;
    double radius = 0; ///< m, rounded up: holds every used vertex
};
/// The largest distance of a used vertex from `center`, m, rounded up.
[[nodiscard]] double bounding_radius(const TriangleMesh& mesh, const Vec3& center);
/// A sphere around all used vertices, usually within 1 % of the smallest.
[[nodiscard]] BoundingSphere bounding_sphere(const TriangleMesh& mesh);
/// The box of all used vertices.
[[nodiscard]] Box bounding_box(const TriangleMesh& mesh);

struct MeshStatistics {
    std::int64_t vertices = 0, triangles = 0, edges = 0;
    std::int64_t unused_vertices = 0;
    std::int64_t zero_area_triangles = 0; ///< see is_zero_area
    std::int64_t duplicate_triangles = 0; ///< same corners as an earlier one, whatever the order
    std::int64_t boundary_edges = 0;      ///< one triangle; counted, like the next two, after merging equal vertices
    std::int64_t non_manifold_edges = 0;  ///< three or more triangles
    std::int64_t misoriented_edges = 0;   ///< two triangles running the same way
    double min_edge = 0, max_edge = 0;    ///< m
    double area = 0;                      ///< m^2
    Box box;
    Closedness closedness;
};
[[nodiscard]] MeshStatistics mesh_statistics(const TriangleMesh& mesh);

} // namespace flotilla
