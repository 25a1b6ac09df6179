// SPDX-License-Identifier: MIT
// What the solver will model of a scene, and why.
#pragma once

#include <string>
#include <vector>

#include <flotilla/scene.hpp>

namespace flotilla {

struct PlanLine {
    std::string topic; ///< one or two words
    std::string text;  ///< one line, SI units
};

/// Derived from the scene, with a line `saved` for each thing that it does not need and that steps leave out; of its
/// steps those are run in which nothing touches yet, 240 at most. Throws InputError with every problem of an invalid
/// scene; `source` starts each line.
[[nodiscard]] std::vector<PlanLine> plan_scene(const SceneDescription& scene, const std::string& source = "scene");

} // namespace flotilla
