// SPDX-License-Identifier: MIT
// Cuts a surface without thickness into few thin convex panels, for engines that collide convex hulls only.
//
// A panel is a set of triangles joined by edges that may be replaced by its convex hull: all of its corners lie in a
// thin slab, and the hull, seen along the slab's normal, covers hardly more than the triangles do. The second condition
// keeps the shape: without it a flat ring would become a disc, and a bent strip would be filled between its ends.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace flotilla::baseline {

struct PanelLimits {
    double thickness =
        0; ///< m, of a panel's slab, so that its hull bulges from the surface by no more; 0: nothing is merged
    /// Area that the hull may cover beyond the triangles' own, as a part of theirs, both seen along the normal.
    double overhang = 0.05;
};

/// The slab `low <= normal . x <= high` holds every corner of the triangles.
struct Panel {
    std::vector<std::int32_t> triangles; ///< ascending
    Vec3 normal;                         ///< unit length: their mean, weighted by area; zero where they have no area
    double low = 0, high = 0;            ///< m
};

/// Every triangle is in exactly one panel. A panel of several triangles keeps both limits and faces the same way
/// everywhere; one triangle alone always may be a panel. Panels grow from every triangle and the one of most triangles
/// is taken first: not the least number possible.
[[nodiscard]] std::vector<Panel> merge_into_panels(const TriangleMesh& mesh, const PanelLimits& limits);

/// The vertices of a panel's triangles, ascending, each once.
[[nodiscard]] std::vector<std::int32_t> panel_vertices(const TriangleMesh& mesh, const Panel& panel);

} // namespace flotilla::baseline
