// SPDX-License-Identifier: MIT
// From a validated scene to what the solver works on.
#pragma once

#include "scene/scene.hpp"
#include "state/model.hpp"

namespace flotilla {

[[nodiscard]] RigidShape make_shape(const Shape& shape);
/// Of a shape that the model has.
[[nodiscard]] Body make_body(const Model& model, const BodyDescription& description);
/// What stands at the place of a body that was removed.
[[nodiscard]] Body absent_body(const Model& model, std::int32_t shape);
/// Of a body with the given velocities, m/s and rad/s, in world axes; at rest where they are not its own.
[[nodiscard]] Motion make_motion(const Model& model, std::size_t body, const Quat& rotation, const Vec3& velocity,
                                 const Vec3& angular_velocity);
[[nodiscard]] Model make_model(const Scene& scene);
/// The state at time 0: poses and velocities of the scene's bodies.
[[nodiscard]] State initial_state(const Scene& scene, const Model& model);

} // namespace flotilla
