// SPDX-License-Identifier: MIT
// Which round or flat solid a mesh stands for, so that engines which have such solids collide those and not its
// triangles.
#pragma once

#include <vector>

#include <flotilla/scene.hpp>

#include "mesh/mass_properties.hpp"

namespace flotilla::baseline {

struct Primitive {
    enum class Kind {
        mesh,     ///< none of the others
        plate,    ///< flat, four corners, in the plane z = 0
        box,      ///< along the axes
        sphere,   ///< around its centre
        cylinder, ///< around an axis along z, with caps or without
        convex,   ///< closed, and every vertex on its hull
    } kind = Kind::mesh;
    Vec3 center; ///< m, mesh coordinates
    Vec3 size;   ///< m, along x, y, z
};

/// Vertices must be the solid's to rounding (1e-9 of its size).
[[nodiscard]] Primitive recognize(const ShapeDescription& shape);

/// Mass in the frame of the solid: about its centre, along the axes of the mesh. Round solids of a density get the
/// inertia of what they stand for with the mass of the mesh.
[[nodiscard]] MassProperties primitive_mass(const Primitive& primitive, const ShapeDescription& shape,
                                            const MassProperties& mass);

/// A face of a convex solid, seen from outside its corners run counter-clockwise.
struct Face {
    Vec3 normal; ///< unit, outwards
    std::vector<std::int32_t> corners;
};
/// Coplanar triangles as one face.
[[nodiscard]] std::vector<Face> convex_faces(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);

} // namespace flotilla::baseline
