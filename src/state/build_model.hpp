// SPDX-License-Identifier: MIT
// From a validated scene to what the solver works on.
#pragma once

#include "scene/scene.hpp"
#include "state/model.hpp"

namespace flotilla {

[[nodiscard]] Model make_model(const Scene& scene);
/// The state at time 0: poses and velocities of the scene's bodies.
[[nodiscard]] State initial_state(const Scene& scene, const Model& model);

} // namespace flotilla
