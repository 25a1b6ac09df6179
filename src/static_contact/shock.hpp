// SPDX-License-Identifier: MIT
// Shock propagation over the contact graph (paper, section 4.3.2, after [29] and [15]): the answer to a pile that
// Gauss-Seidel cannot finish (a stack of N bodies needs about 5 N^2 sweeps).
//
// Levels are solved from the ground up, each on bodies below that are frozen: their velocities are prescribed. A
// contact belongs to the higher of its bodies' levels. Differences from [29]: the pass goes on from the velocities and
// impulses of PGS instead of adding impulses from zero, so it also takes back what PGS pushed too much; and friction
// keeps the bounds of PGS, because a frozen body feels no weight and its contacts' new normal impulses are too small.
#pragma once

#include "static_contact/solver_state.hpp"

namespace flotilla {

/// Runs the pass on one island whose PGS state is in `scratch`. Does nothing and returns false where no body of
/// infinite mass touches the island. The pass is not a solution of the contact law, so it is undone (false as well) in
/// three cases:
///  - a level of a resting island ended above the tolerance. Bodies jammed between frozen ones have no solution at all;
///    in a resting pile of 10,000 boats levels ended at up to twelve times what PGS had left, and with such passes it
///    never came to rest: 0.7 J for ever, where PGS alone leaves 0.003 J. A stack's levels end below the tolerance.
///    In motion passes stand, where they are asked for (ContactSolveOptions::shock_in_motion).
///  - it took or gave momentum that no impulses of the contacts with bodies of infinite mass could.
///  - every prescribed body rests, and the kinetic energy came out above both that of PGS and that before the solve.
/// Adds to the island's visits; sets its residual where the pass stands: that of the contacts with the pass's impulses
/// and PGS's bounds of friction.
/// Precondition: scratch.level holds contact_levels of all pairs, before_shock a copy of velocity.
bool propagate_shock(ContactScratch::Island& island, const ContactBodies& bodies, const ContactSolveOptions& options,
                     ContactScratch& scratch);

} // namespace flotilla
