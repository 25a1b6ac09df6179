// SPDX-License-Identifier: MIT
// Segment-triangle test for the occlusion rule of contact points (paper, section 4.3.1).
#pragma once

#include <optional>

#include "base/vec3.hpp"

namespace flotilla {

/// The parameter t in [0, 1] at which the segment p + t (q - p) crosses the triangle, boundary included; nothing where it does not
/// or where segment and triangle are parallel (a coplanar segment does not count). Not exact: it decides whether a contact is
/// kept, never whether bodies are apart.
[[nodiscard]] std::optional<double> segment_triangle(const Vec3& p, const Vec3& q, const Vec3& f0, const Vec3& f1,
                                                     const Vec3& f2);

} // namespace flotilla
