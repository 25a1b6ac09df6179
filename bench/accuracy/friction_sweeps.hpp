// SPDX-License-Identifier: MIT
// Sweeps over a problem given by its matrix: the library's projection of a contact and its sequence of momentum
// (sweep_island.hpp), but velocities from W in place of bodies.
#pragma once

#include "static_contact/friction_problem.hpp"

namespace flotilla::survey {

struct FrictionGoal {
    double natural_map = 0; ///< infinite: any
    double residual = 0;    ///< m/s
};

/// Sweeps with the exact cone until the goal or the limit; their number. With momentum every sweep also takes a product
/// with W for the turn of the way, and every tenth a look at the residual for its rise.
int sweep_disc(FrictionProblem& problem, const FrictionGoal& goal, int limit, bool momentum);

/// With the paper's pyramid and without momentum.
int sweep_pyramid(FrictionProblem& problem, const FrictionGoal& goal, int limit);

} // namespace flotilla::survey
