// SPDX-License-Identifier: MIT
// The kinetic energy of an island, by which solves that add energy are recognised.
#pragma once

#include "static_contact/solver_state.hpp"

namespace flotilla {

/// Whether every body of prescribed velocity in the island stands still: impulses then do work on nothing outside it.
[[nodiscard]] bool prescribed_at_rest(const ContactScratch::Island& island, const ContactScratch& scratch);

/// J, with the velocities in `scratch`, of the island's movable bodies. Islands solved side by side have no team.
[[nodiscard]] double kinetic_energy(const ContactScratch::Island& island, const ContactBodies& bodies, Team* team,
                                    ContactScratch& scratch);
/// m/s, at which the island's mass has its kinetic energy, with the velocities in `scratch`, less that of the rigid
/// motion with its momenta; inertias count by their traces.
[[nodiscard]] double inner_speed(const ContactScratch::Island& island, const ContactBodies& bodies,
                                 const ContactScratch& scratch);
/// J, what normal impulses do at the speeds that the targets ask for.
[[nodiscard]] double work_of_targets(const ContactScratch::Island& island, Team* team, ContactScratch& scratch);

/// Takes back energy that an unsolved island gained from nothing. 1/2 l W l + l (u - target), J, with u the velocities
/// before the solve, is zero without impulses and negative at a solution. Where it is positive, as it is for impulses
/// that grew without bound, all impulses are scaled by one factor to the minimum along their ray, which stays in their
/// cones. Where they are not numbers they are dropped.
void take_back_gain(const ContactScratch::Island& island, Team* team, ContactScratch& scratch);

} // namespace flotilla
