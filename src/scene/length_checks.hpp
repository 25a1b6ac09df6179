// SPDX-License-Identifier: MIT
// Lengths of the settings against the scene: what rests on what must be nearer than its own size, and farther than
// doubles resolve.
#pragma once

#include "base/error_list.hpp"
#include "scene/scene.hpp"

namespace flotilla {

/// Adds to `errors`, each with what would be allowed: a separation that is not below the rest distances, a proximity
/// distance that is not above them or reaches beyond a body, a rest distance as large as a body, or one that rounding
/// swallows where a body stands or its first step leads, or beside triangles as large as another's.
void check_lengths(const Scene& scene, ErrorList& errors);

} // namespace flotilla
