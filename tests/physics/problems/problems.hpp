// SPDX-License-Identifier: MIT
// The regular problems of the tests of physics as a list: scenes whose motion has a closed form, and one number each
// that says how far a motion is from it, whichever engine made it. bench/accuracy measures all of them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "physics/problems/history.hpp"

namespace flotilla::physics {

struct Problem {
    std::string name;  ///< of a word, for commands
    std::string about; ///< the scene, a line
    std::string error; ///< what its error is a share of
    double bound;      ///< what the tests grant `error`, or what decides: below it a motion is right
    double time;       ///< s
    /// What moves is a box, a ball, a cylinder, a thin card or a convex solid, and what is fixed are planes.
    bool solids;
    std::function<SceneDescription(const Start&)> scene;
    std::function<double(const History&)> error_of;
    /// m, between surfaces at rest at the start for engines whose solids touch: half of it is a convex solid's margin,
    /// all of it the thickness of a card. 0: there they touch from the start.
    double others_gap = 0;
    /// Of the error, what the flat sides of a round body's mesh may account for: below it that from a round body says
    /// nothing of a run.
    double sides = 0;
};

/// In the order of a table.
[[nodiscard]] const std::vector<Problem>& problems();
/// Null where there is none of that name.
[[nodiscard]] const Problem* find_problem(const std::string& name);

} // namespace flotilla::physics
