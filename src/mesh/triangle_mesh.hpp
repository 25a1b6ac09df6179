// SPDX-License-Identifier: MIT
// Triangle soup: open, non-manifold and degenerate surfaces are all valid.
#pragma once

#include <vector>

#include <flotilla/types.hpp>

namespace flotilla {

struct TriangleMesh {
    std::vector<Vec3> vertices;      ///< m, finite
    std::vector<Triangle> triangles; ///< indices into vertices
};

} // namespace flotilla
