// SPDX-License-Identifier: MIT
// Scripted bodies: keyframes with linear position and shortest-arc slerp; the last one holds (DESIGN 4.6).
#pragma once

#include "state/model.hpp"

namespace flotilla {

/// Pose of a scripted body when its own clock shows `time` (s).
[[nodiscard]] Pose scripted_pose(const RigidShape& shape, const Body& body, double time);

} // namespace flotilla
