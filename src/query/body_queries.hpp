// SPDX-License-Identifier: MIT
// Questions about bodies where they stand: overlap, distance, rays, boxes.
#pragma once

#include <optional>

#include "geometry/box.hpp"
#include "state/trajectories.hpp"

namespace flotilla {

/// A shape at a pose. What `at` points to belongs to somebody else.
struct PlacedShape {
    const RigidShape* shape = nullptr;
    BodyPlacement at;
};

/// Whether two bodies intersect, touch, or are too near for double precision to certify a motion: exactly what refuses
/// bodies at the start of a scene (scene/initial_overlap.hpp).
[[nodiscard]] bool bodies_overlap(const PlacedShape& a, const PlacedShape& b);

struct ShapeRayHit {
    double distance = 0;        ///< m
    std::int32_t triangle = -1; ///< of the shape
    Vec3 normal;                ///< unit, against the ray
};
/// Whether a ray may come to what is in a box nearer than `reach`, m. `direction`: unit.
[[nodiscard]] bool may_meet_ray(const Box& box, const Vec3& origin, const Vec3& direction, double reach);

/// The first triangle on a ray, of those nearer than `reach` (m); the lowest of equally near ones. `direction`: unit.
[[nodiscard]] std::optional<ShapeRayHit> first_on_ray(const PlacedShape& body, const Vec3& origin,
                                                      const Vec3& direction, double reach);

struct ShapeDistance {
    double distance = 0; ///< m
    Vec3 a, b;           ///< m
    std::int32_t triangle_a = -1, triangle_b = -1;
};
/// The closest points of two bodies.
[[nodiscard]] ShapeDistance body_distance(const PlacedShape& a, const PlacedShape& b);

/// Whether some point of the surface is in the box, boundary included. Exact.
[[nodiscard]] bool meets_box(const PlacedShape& body, const Box& box);

} // namespace flotilla
