// SPDX-License-Identifier: MIT
// Projected Gauss-Seidel on one island (paper, section 4.3.2, eqs 15-22), carried on by Nesterov's momentum.
//
// One sweep maps impulses and velocities y to x(y). Plain Gauss-Seidel goes on from x. Here the next sweep starts from
//   y = x + m (x - x_before),  m = (theta - 1) / theta_next,  theta_next = (1 + sqrt(1 + 4 theta^2)) / 2,
// impulses and velocities alike, so that the velocities stay those of the impulses. m is at most kMostMomentum, which makes slow
// modes 1 / (1 - m) times faster and leaves the fast ones bounded, and starts anew at 0 (theta = 1) where the way
// turns back: (y - x) . (x - x_before) > 0 in the metric of kinetic energy (O'Donoghue and Candes 2015), or the residual
// rises. The sum runs over the island's bodies in one order. What a solve leaves behind is always some x: within the
// bounds of eqs 17-20.
//
// In a large island at rest most contacts hold after some tens of sweeps. Where what does not is a small part, that part is swept alone
// in between (unsolved_part.hpp).
//
// The law with friction is no minimum of anything, so nothing is proved about m > 0; a plain sweep after every restart and the
// residual at the end decide.
#pragma once

#include "static_contact/solve_contacts.hpp"

namespace flotilla {

/// Lists the movable bodies of every island, ascending, with their weights: the order of sums is the island's own, whatever the
/// order of its blocks.
void list_island_bodies(const ContactBodies& bodies, ContactScratch& scratch);

struct SweepStart {
    bool apply_impulses = false; ///< first add the effect of the impulses that the rows hold: the warm start
    bool momentum = true;
};
/// Sweeps until the tolerance holds, the limit is reached or, with options.patience, the residual falls no more. Sets the island's
/// residual and whether it is solved, and adds to its iterations and visits.
void sweep_island(ContactScratch::Island& island, const ContactSolveOptions& options, const SweepStart& start,
                  ContactScratch& scratch);

/// Whether several threads may sweep the island together; a property of the island, whatever the team.
[[nodiscard]] bool is_large(const ContactScratch::Island& island, const ContactScratch& scratch);

} // namespace flotilla
