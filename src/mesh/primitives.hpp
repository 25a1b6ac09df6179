// SPDX-License-Identifier: MIT
// Tessellated shapes, centred at the origin, triangles facing outwards. Corners lie on the smooth surface. Lengths in
// metres; arguments must be positive (counts: as noted), which is asserted. The same bits on every system.
#pragma once

#include "mesh/triangle_mesh.hpp"

namespace flotilla {

/// A flat rectangle in the plane z = 0, nx by ny cells of two triangles, facing +z. Open.
[[nodiscard]] TriangleMesh make_plate(double size_x, double size_y, int nx = 1, int ny = 1);
/// A box, each face n by n cells of two triangles. Closed.
[[nodiscard]] TriangleMesh make_box(double size_x, double size_y, double size_z, int n = 1);
/// A sphere from an icosahedron whose triangles are divided in four `subdivisions` (>= 0) times: 20 * 4^s triangles.
/// Closed.
[[nodiscard]] TriangleMesh make_sphere(double radius, int subdivisions);
/// A cylinder around the z axis with caps: `segments` (>= 3) around, `rings` along, caps as fans. Closed.
[[nodiscard]] TriangleMesh make_cylinder(double radius, double height, int segments, int rings = 1);
/// The side of a cylinder around the z axis without caps, zero thickness. Open.
[[nodiscard]] TriangleMesh make_tube(double radius, double height, int segments, int rings = 1);
/// A flat disc in the plane z = 0, a fan of `segments` (>= 3) triangles facing +z. Open.
[[nodiscard]] TriangleMesh make_disc(double radius, int segments);
/// A torus around the z axis: `segments` (>= 3) around the axis, `tube_segments` (>= 3) around the tube, tube_radius <
/// ring_radius (measured to the middle of the tube). Closed.
[[nodiscard]] TriangleMesh make_ring(double ring_radius, double tube_radius, int segments, int tube_segments);

} // namespace flotilla
