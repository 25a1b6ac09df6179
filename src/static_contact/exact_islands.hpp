// SPDX-License-Identifier: MIT
// Small islands that the sweeps leave unsolved are solved exactly (interior_point.hpp): sweeps converge slowly where bodies of
// different masses stand on one another, in chains, in long stacks and with thin bodies, and those are small.
#pragma once

#include "static_contact/solve_contacts.hpp"

namespace flotilla {

/// Whether the island may be solved so: friction by the cone, and few enough contacts.
[[nodiscard]] bool may_solve_exactly(const ContactScratch::Island& island, const ContactSolveOptions& options,
                                     const ContactScratch& scratch);

/// Solves those of the islands that are unsolved and may be, side by side. Their rows hold the impulses of the sweeps, and then the
/// exact ones; velocities follow.
void solve_exactly(const ContactBodies& bodies, const ContactSolveOptions& options, ContactScratch& scratch);

} // namespace flotilla
