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

} // namespace flotilla
