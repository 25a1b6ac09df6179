// SPDX-License-Identifier: MIT
// The part of an island that is not solved yet, swept alone. In a pile at rest all but a few of ten thousand
// contacts hold after some tens of sweeps; those few, beside a body that slides for example, may take hundreds more.
// Alone they cost next to nothing, and what they change at the border of their part shows in the next evaluation of the
// whole island.
#pragma once

#include "static_contact/sweep_engine.hpp"

namespace flotilla {

using UnsolvedPart = ContactScratch::Unsolved;

/// Room for the parts of the island, so that no later call allocates.
void reserve_unsolved(const ContactScratch::Island& island, const ContactTuning& tuning, const ContactScratch& scratch,
                      UnsolvedPart& part);

/// Marks the movable bodies of violated pairs, by the bits in scratch.violated (see find_violated()); unless `anew`,
/// those of earlier bits stay marked, or two neighbouring parts would hand the same load to and fro. False where that
/// are too many batches of the island's.
bool mark_unsolved(const ContactScratch::Island& island, const ContactTuning& tuning, bool anew,
                   const ContactScratch& scratch, UnsolvedPart& part);
/// How an island moves.
struct IslandMotion {
    bool any = false; ///< whether a body was marked
    double mean = 0;  ///< m/s, the speed at which the island's mass has its energy
};
/// Marks the movable bodies of the island that move by more than ContactTuning::settle_above of its tolerances, by
/// their energy with the harmonic mean of their principal inertias.
IslandMotion mark_moving(const ContactScratch::Island& island, const ContactTuning& tuning,
                         const ContactScratch& scratch, UnsolvedPart& part);
/// Finds those of the packets [first, end) that have a marked body.
void find_touching(std::size_t first, std::size_t end, const ContactScratch& scratch, UnsolvedPart& part);
/// Copies to the part those that were found in the island. False where there are none, or too many.
bool choose_unsolved(const ContactScratch::Island& island, const ContactTuning& tuning, const ContactScratch& scratch,
                     UnsolvedPart& part);

/// Sweeps them by the crew of the whole island's engine, without momentum or with a sequence of their own, until a
/// sweep meets no violation above the tolerance of the options, `most` times or ContactTuning::part_sweeps times.
/// Returns the number of sweeps. The number of threads changes no bit. The next sweep of the island must do without
/// momentum.
int sweep_unsolved(const SweepEngine& whole, bool momentum, std::int64_t most, const ContactSolveOptions& options,
                   ContactScratch& scratch, UnsolvedPart& part);

/// Groups of an island's record behind those of its batches: the loops over bodies, a task per sum of them; evaluations
/// of the residual; the choice of parts; their sweeps.
[[nodiscard]] inline std::size_t choice_group(const SweepEngine& whole) { return whole.num_groups() + 2; }
[[nodiscard]] inline std::size_t part_group(const SweepEngine& whole) { return whole.num_groups() + 3; }
inline constexpr std::size_t kGroupsOfWhole = 4;

/// Calls work(body) for the movable bodies of the batch's pairs whose bits are set.
template <class Work>
void for_bodies(const ContactPacket& packet, unsigned pairs, const ContactScratch& scratch, Work&& work) {
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(packet.num_pairs); ++lane) {
        if ((pairs >> lane & 1U) == 0) continue;
        for (const std::int32_t body : {packet.a[lane], packet.b[lane]})
            if (scratch.movable[static_cast<std::size_t>(body)] != 0) work(body);
    }
}

/// Contacts that a sweep of the batch visits.
[[nodiscard]] std::int64_t num_contacts(const ContactScratch& scratch, std::size_t packet);

} // namespace flotilla
