// SPDX-License-Identifier: MIT
// Whether a mesh is the surface of a convex body of few corners: a stone, a crate, a floor.
#pragma once

#include "mesh/triangle_mesh.hpp"

namespace flotilla {

/// Whether the mesh is flat, straight, or closed with all vertices behind the plane of every triangle, to a share of
/// its size that is far more than rounding: nothing that is proved rests on it. Meshes of more than a few hundred
/// vertices are not asked.
[[nodiscard]] bool is_convex(const TriangleMesh& mesh);

} // namespace flotilla
