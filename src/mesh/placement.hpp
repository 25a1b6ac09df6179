// SPDX-License-Identifier: MIT
// The one function that computes world vertices. The state IS the doubles it returns: collision detection, proximity,
// the certificate and the audit all call it, so that they speak of the same points.
#pragma once

#include <span>

#include "base/rotation.hpp"
#include "geometry/ccd.hpp"
#include "geometry/coarse_box.hpp"

namespace flotilla {

/// world[i] = R(rotation) local[i] + position, each coordinate as ((r0 x + r1 y) + r2 z) + p. `position` is that of the
/// mesh's own origin, `rotation` a unit quaternion. Sizes must agree.
void world_vertices(std::span<const Vec3> local, const Vec3& position, const Quat& rotation, std::span<Vec3> world);

/// The same with a coarse box of each vertex; returns the box of all.
Box world_vertices(std::span<const Vec3> local, const Vec3& position, const Quat& rotation, std::span<Vec3> world,
                   std::span<CoarseBox> points, Isa isa = best_isa());

} // namespace flotilla
