// SPDX-License-Identifier: MIT
// What the stages of a step read.
#pragma once

#include <vector>

#include "response/cluster.hpp"
#include "state/savings.hpp"

namespace flotilla {

/// Bounds on what a body does in the step: of most pairs only these and their record are read.
struct BodyBounds {
    double displacement = 0; ///< m, of any of its points along any axis, with room for arcs where it turns
    double speed = 0;        ///< m/s, of any of its points
};

/// What all code of a step reads; nothing is written through it. Who writes one of these things is handed it by itself:
/// Movers, PairBook or one of its records, Workers or one of its workers.
struct StepView {
    const Model& model;
    const State& state;                    ///< at x^n
    const Trajectories& trajectories;      ///< x^n and the candidate end states
    const Clusters& clusters;              ///< and their velocities
    const std::vector<BodyBounds>& bounds; ///< by body, of the motions that the last list of pairs was made from
    double dt;                             ///< s
    double angle_cos;                      ///< of theta_proximity
    double approach;                       ///< m/s, slower end proximities are left to static contact
    /// Off: every query traverses the hierarchies, whatever is known of the pair; the same answers.
    bool keep_candidates = true;
    Savings savings{};
};

} // namespace flotilla
