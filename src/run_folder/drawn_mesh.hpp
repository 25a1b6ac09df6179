// SPDX-License-Identifier: MIT
// Segments and points as something that one can see.
#pragma once

#include "mesh/triangle_mesh.hpp"

namespace flotilla::io {

/// The mesh with tubes for its segments and balls for its points and where segments meet, m thick from the middle.
/// Vertices and triangles that were there keep their numbers, segments and points among them too.
[[nodiscard]] TriangleMesh drawn_mesh(const TriangleMesh& mesh, double radius);

/// The radius for a shape whose bounding sphere has `size` as diameter, m: the distance at which bodies of that size
/// rest, so that what rests on each other seems to touch.
[[nodiscard]] double drawn_radius(double size);

/// Whether there is anything of that kind.
[[nodiscard]] bool has_thin_elements(const TriangleMesh& mesh);

/// Triangles alone, for formats and viewers that have no others: the mesh itself, or drawn_mesh() at the radius of its
/// size without segments and points.
[[nodiscard]] TriangleMesh drawn_triangles(const TriangleMesh& mesh);

} // namespace flotilla::io
