// SPDX-License-Identifier: MIT
// The warm start of a contact solve: impulses of the step before, found again by feature pair, and those of this one,
// stored for the next.
#pragma once

#include <span>
#include <vector>

#include "parallel/team.hpp"
#include "state/contact.hpp"
#include "state/model.hpp"

namespace flotilla {

/// What is known from the solves before.
struct KnownImpulses {
    std::span<const WarmImpulse> own;   ///< of the same stage, a step ago
    std::span<const WarmImpulse> other; ///< of the stage in between: for contacts that are new to this one
    double other_factor = 1;            ///< of impulses taken over from that
};

/// N s, on b, by contact.
void load_warm(Team* team, std::span<const Contact> contacts, const KnownImpulses& known, std::vector<Vec3>& impulses);

/// Solved contacts, in the order of their bodies.
struct SolvedContacts {
    std::span<const Contact> contacts;
    std::span<const Vec3> impulses;         ///< N s, on b
    std::span<const std::uint8_t> left_out; ///< as flags, those not to be stored; may be empty: none
};

/// Also where a shock pass went over the velocities: these are still the impulses of projected Gauss-Seidel, and with
/// them the next solve goes on where this one had to stop. Open contacts are stored too: they are not new. `places` is
/// scratch.
void store_warm(Team* team, const SolvedContacts& solved, std::vector<std::int32_t>& places,
                std::vector<WarmImpulse>& warm);

/// Adds `factor` times `more` to the sums by feature pair; both are lists sorted by bodies. `scratch` is any list.
void add_impulses(std::span<const WarmImpulse> more, double factor, std::vector<WarmImpulse>& sums,
                  std::vector<WarmImpulse>& scratch);

} // namespace flotilla
