// SPDX-License-Identifier: MIT
// The kinetic energy of an island, by which solves that add energy are told.
#pragma once

#include "static_contact/solver_state.hpp"

namespace flotilla {

/// Whether every body of prescribed velocity in the island stands still: impulses then do work on nothing outside it.
[[nodiscard]] bool prescribed_at_rest(const ContactScratch::Island& island, const ContactScratch& scratch);

/// J, with the velocities in `scratch`, summed over the island's movable bodies, ascending.
[[nodiscard]] double kinetic_energy(const ContactScratch::Island& island, const ContactBodies& bodies,
                                    const ContactScratch& scratch);

/// Takes back what an island got from nowhere. 1/2 l W l + l (u - target), J, with u the velocities before the solve, is zero without
/// impulses and lower at a solution. Where unsolved impulses are above zero, which those that grew without bound are, the island is left
/// with what is best along their ray, in their cones as they are: less of all of them. Where they are no numbers, with none of them.
void take_back_gain(const ContactScratch::Island& island, ContactScratch& scratch);

} // namespace flotilla
