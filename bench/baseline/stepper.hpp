// SPDX-License-Identifier: MIT
// The step of Guendelman, Bridson, Fedkiw 2003, section 4: collisions, then velocities, then contact, then positions.
#pragma once

#include "bodies.hpp"

namespace flotilla::baseline {

/// Iterations. The publication says "five" for collisions and "ten" for contact and leaves those per pair open.
struct StepOptions {
    int collision_sweeps = 5;      ///< section 5
    int contact_sweeps = 10;       ///< section 6: restitution -1 + k/10 in the k-th
    int level_sweeps = 2;          ///< over the pairs of a level, in each contact sweep
    int pair_iterations = 20;      ///< impulses at a pair before it is left to the next sweep
    bool shock_propagation = true; ///< section 6.2
};

/// Advances by dt seconds.
void step(Bodies& bodies, double dt, const StepOptions& options);

} // namespace flotilla::baseline
