// SPDX-License-Identifier: MIT
// What pulls on a body apart from contacts: gravity, and a force and a torque of its own. Locked axes carry their part.
#pragma once

#include "state/model.hpp"

namespace flotilla {

/// m/s^2, of the centre of mass.
[[nodiscard]] Vec3 acceleration(const Model& model, std::size_t body);
/// N m, what turns the body.
[[nodiscard]] Vec3 turning_torque(const Model& model, std::size_t body);

/// m/s^2, what loads alone may give any point of the body from rest: |gravity| but for bodies with loads of their own.
[[nodiscard]] double most_acceleration(const Model& model, std::size_t body);
/// Of both bodies of a pair.
[[nodiscard]] double most_acceleration(const Model& model, std::int32_t a, std::int32_t b);
/// m/s^2, the least that a load gives the body which gives it any.
[[nodiscard]] double least_acceleration(const Model& model, std::size_t body);

/// J, of the body's own force and torque in a step that took its centre of mass along `way` (m) and turned it by `turn`
/// (rad). `motion`: at the start pose, before they acted.
///
/// A force is worth force . way, to rounding. A torque is worth torque . turn, and what the scheme adds to that where a
/// body turns freely about changing axes: an O(dt^3) discretisation term, not spurious energy: the mean angular
/// velocity times dt differs from the turn.
[[nodiscard]] double work_of_loads(const Model& model, std::size_t body, const Quat& rotation, const Motion& motion,
                                   const Vec3& way, const Vec3& turn);

} // namespace flotilla
