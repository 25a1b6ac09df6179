// SPDX-License-Identifier: MIT
// A body's geometry as reference [15] of the paper has it (Guendelman, Bridson, Fedkiw 2003, "Nonconvex rigid bodies
// with stacking", section 3): points on the surface, and a signed distance. Theirs is sampled on a grid; this one is
// measured to the mesh itself, so it has no error of a grid: the choice in favour of the method.
#pragma once

#include <vector>

#include <flotilla/scene.hpp>

#include "base/vec3.hpp"

namespace flotilla::baseline {

/// Depth and outward unit normal at a point, in the solid's own axes. Metres; depth > 0 inside.
struct Depth {
    double depth = 0;
    Vec3 normal;
};

struct Solid {
    std::vector<Vec3> vertices; ///< m, from the centre of mass, mesh axes
    std::vector<Triangle> triangles;
    std::vector<Vec3> samples; ///< points on the surface: all vertices, and points along edges and on faces
    struct Plane {
        Vec3 normal;       ///< outwards
        double offset = 0; ///< m: inside is dot(normal, x) < offset
    };
    std::vector<Plane> planes; ///< of its faces where it is closed and convex; else empty
    bool closed = false;       ///< it has an inside; otherwise it is a shell thickened by `thickness` to either side
    double thickness = 0;      ///< m
    Vec3 low, high;            ///< m, bounds of its inside
    Vec3 center;               ///< m, the centre of mass (of the box where there is no mass), mesh coordinates
    double radius = 0;         ///< m, of the sphere around the centre that holds its inside
    double mass = 0;           ///< kg; 0 where the shape has none
    Mat3 inertia, inverse_inertia; ///< kg m^2 about the centre of mass, mesh axes, and its inverse
};

/// `samples_across`: points along the diagonal of the bounding box; 0 for vertices alone. `thickness` is used for open
/// meshes.
[[nodiscard]] Solid make_solid(const ShapeDescription& shape, int samples_across, double thickness);

/// Depth of a point (in the solid's axes, from its centre); depth <= 0 outside. Brute force over all triangles behind a
/// box test.
[[nodiscard]] Depth depth_at(const Solid& solid, const Vec3& point);

/// Inverse of a symmetric positive definite matrix.
[[nodiscard]] Mat3 inverse(const Mat3& a);

} // namespace flotilla::baseline
