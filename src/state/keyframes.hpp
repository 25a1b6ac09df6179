// SPDX-License-Identifier: MIT
// Where keyframes put a body: linear position, shortest-arc slerp; the last one holds.
#pragma once

#include <span>

#include <flotilla/scene.hpp>

namespace flotilla {

struct KeyframePlace {
    Vec3 position; ///< m, of the mesh's origin
    Quat rotation;
};

/// Precondition: there is a keyframe, and their times increase. Before the first one the body is where that says.
[[nodiscard]] KeyframePlace keyframe_place(std::span<const Keyframe> keyframes, double time);

} // namespace flotilla
