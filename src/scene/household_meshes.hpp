// SPDX-License-Identifier: MIT
// Everyday things as meshes: surfaces of revolution, prisms, swept tubes. Lengths in metres, triangles facing
// outwards (up, where the surface is open). Things of several closed parts touch without overlapping, so that their
// volumes add up.
#pragma once

#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace flotilla::library {

/// A point of an outline, m: (r, z) where it turns about the z axis, (x, y) where it is drawn out along it.
struct OutlinePoint {
    double u = 0, v = 0;
};

/// Turns an outline about the z axis in `segments` (>= 3) parts. Points have r >= 0; those with r = 0 become one
/// vertex, two in a row are not allowed. One that runs from axis to axis, counter-clockwise in the (r, z) half-plane,
/// gives a closed surface facing outwards.
[[nodiscard]] TriangleMesh revolve(const std::vector<OutlinePoint>& outline, int segments);
/// The prism between two outlines of equally many points, counter-clockwise, `inner` within `outer`: point i of one
/// sees point i of the other. From z = -height / 2 to height / 2. Closed.
[[nodiscard]] TriangleMesh extrude(const std::vector<OutlinePoint>& outer, const std::vector<OutlinePoint>& inner,
                                   double height);
/// A tube of `sides` (>= 3) along a path in the (x, z) plane that bends less than 90 degrees at a point; flat ends.
/// Closed.
[[nodiscard]] TriangleMesh sweep(const std::vector<OutlinePoint>& path, double radius, int sides);

/// 10 cm high, without thickness, with a solid handle. Open; its opening is up (+z), its handle on the +x side, its
/// foot at z = 0.
[[nodiscard]] TriangleMesh mug_mesh();
/// 18 cm wide, without thickness. Open, foot at z = 0.
[[nodiscard]] TriangleMesh soup_bowl_mesh();
/// 26 cm wide, without thickness. Open, foot at z = 0.
[[nodiscard]] TriangleMesh dinner_plate_mesh();
/// 30 cm high: a round seat on three splayed legs, feet at z = 0. Closed.
[[nodiscard]] TriangleMesh stool_mesh();
/// 40 by 30 cm, 7 cm high: boards on three bearers, about the origin. Closed.
[[nodiscard]] TriangleMesh pallet_mesh();
/// 18 cm wide, 3 cm thick, ten teeth and a bore, about the origin. Closed.
[[nodiscard]] TriangleMesh gear_mesh();

} // namespace flotilla::library
