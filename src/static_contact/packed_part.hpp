// SPDX-License-Identifier: MIT
// The part of a large island in motion that is farthest from solved, packed anew and swept alone. A pile that is
// stirred in one place is one island, and moves as a whole though most of it rests: what that needs the first sweeps
// find, and the others go on where it is stirred. Unlike in a pile at rest (unsolved_part.hpp) that is many pairs, and
// they lie scattered: a third of the pairs is in nearly all of the batches. Packing costs as much as sweeping them
// once or twice.
#pragma once

#include "static_contact/sweep_engine.hpp"

namespace flotilla {

/// Marks the movable bodies of violated pairs, by the bits in scratch.violated (see find_violated()).
void mark_near(const ContactScratch::Island& island, ContactScratch& scratch);
/// Finds the pairs of the packets [first, end) that have a marked body.
void find_near_pairs(std::size_t first, std::size_t end, ContactScratch& scratch);
/// Copies to scratch.packed_part those that were found in the island. False where there are none, or more than the
/// island's pairs divided by ContactTuning::packed_divisor.
bool choose_near(const ContactScratch::Island& island, const ContactTuning& tuning, ContactScratch& scratch);
/// Packs them with their present impulses.
void pack_part(Team* team, ContactScratch& scratch);

/// Sweeps them by the crew of the whole island's engine, without momentum or with a sequence of their own, until a
/// sweep meets no violation above `enough` (m/s), `most` times or ContactTuning::packed_sweeps times; then writes their
/// impulses back. Returns the number of sweeps. The number of threads changes no bit. The next sweep of the island must
/// do without momentum.
int sweep_packed_part(const SweepEngine& whole, bool momentum, std::int64_t most, double enough,
                      ContactScratch& scratch);

} // namespace flotilla
