// SPDX-License-Identifier: MIT
// The part of an island that is not solved yet, swept alone. In a large pile at rest all but a few of ten thousand contacts hold after
// some tens of sweeps; those few, beside a body that slides for example, may take hundreds more. Alone they cost next to nothing,
// and what they change at the border of their part shows in the next look at the whole island.
#pragma once

#include <span>

#include "parallel/team.hpp"
#include "static_contact/solve_contacts.hpp"

namespace flotilla {

/// Room for the parts of the island, so that no later call allocates.
void reserve_unsolved(const ContactScratch::Island& island, ContactScratch& scratch);

/// Copies to scratch.unsolved the packets of the island with a pair that shares a movable body with a violated pair, according to the
/// bits in scratch.violated (see find_violated()); unless `anew`, also those chosen for earlier bits, or two neighbouring parts
/// would hand the same load to and fro. False where there are none, or too many of the island's.
bool choose_unsolved(const ContactScratch::Island& island, bool anew, ContactScratch& scratch);

/// Who sweeps.
struct Sweeper {
    Team* team;
    int threads = 1;
    std::span<ContactScratch::Seen> seen; ///< by share
    TaskRecorder* recorder = nullptr;
    std::span<std::int64_t> busy; ///< ns, of share k at k * busy_stride; counted where there is a recorder
    std::size_t busy_stride = 0;
};

/// Sweeps them, without momentum or with a sequence of their own, until a sweep meets no violation above the tolerance, `most` times or
/// a hundred times. `view` says what violations are let off. Returns the number of sweeps. The number of threads changes no bit. The
/// next sweep of the island must do without momentum.
int sweep_unsolved(const Sweeper& sweeper, Cone cone, const ContactSolveOptions& options, bool momentum,
                   std::int64_t most, const SweepView& view, ContactScratch& scratch);

/// That a sweep of the packet visits.
[[nodiscard]] std::int64_t num_contacts(const ContactScratch& scratch, std::size_t packet);

} // namespace flotilla
