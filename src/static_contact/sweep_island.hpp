// SPDX-License-Identifier: MIT
// The sweeps of a whole island (sweep_engine.hpp), and what goes on between them: evaluations of the residual, which
// activate violated contacts that were parked. In an island at rest most contacts hold after some tens of sweeps,
// and where the others are a small part, that part is swept alone in between (unsolved_part.hpp).
#pragma once

#include "static_contact/solver_state.hpp"

namespace flotilla {

/// Lists the movable bodies of every island, ascending, with their weights: the order of sums is the island's own,
/// whatever the order of its blocks.
void list_island_bodies(const ContactBodies& bodies, ContactScratch& scratch);

struct SweepStart {
    bool apply_impulses = false; ///< first add the effect of the impulses that the rows hold: the warm start
    bool momentum = true;
    int thread = 0; ///< whose memory of parts it has
};
/// Sweeps until the tolerance holds, the limit is reached or, with options.patience, the residual falls no more. Sets
/// the island's residual and whether it is solved, and adds to its iterations and visits.
void sweep_island(ContactScratch::Island& island, const ContactSolveOptions& options, const SweepStart& start,
                  ContactScratch& scratch);

/// Whether several threads may sweep the island together; a property of the island, whatever the team.
[[nodiscard]] bool is_large(const ContactScratch::Island& island, const ContactScratch& scratch);

} // namespace flotilla
