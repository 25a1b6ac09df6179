// SPDX-License-Identifier: MIT
// From contacts to rows in solving order: the set-up of solve_contacts.
#pragma once

#include <span>

#include "static_contact/solver_state.hpp"

namespace flotilla {

/// Sorts items by a small key, keeping the order of equal ones: `order` holds item numbers, key[item] is in
/// [0, num_keys). counts and sorted are scratch.
void stable_sort_by_key(std::span<const std::int32_t> key, int num_keys, std::vector<std::int32_t>& order,
                        std::vector<std::int32_t>& counts, std::vector<std::int32_t>& sorted);

/// The friction bound that goes with the options' tangents; none where no contact has friction.
inline Cone cone_of(const ContactSolveOptions& options, const ContactScratch& scratch) {
    if (scratch.packed.frictionless) return Cone::none;
    if (options.tangents == Tangents::random) return Cone::pyramid;
    return !options.bounds.empty() ? Cone::bounded : Cone::disc;
}

/// Fills velocity, blocks, rows (with W, tangents and the cut warm impulses, none applied yet), their packets and
/// islands.
///
/// A step solves the contacts of stage 7 again in stage 3 of the next one, mostly twice, and what rests hardly moves.
/// So what the solve before assembled in the same scratch stays where all that it depends on is the same to the bit:
/// colours and islands of the same pairs, the order of pairs with as many active contacts each, frames and masses of
/// contacts whose points, normals, friction and bodies are the same. Nobody has to say what changed.
void assemble(std::span<const Contact> contacts, const ContactBodies& bodies, const ContactSolveOptions& options,
              std::span<const Vec3> impulses, ContactScratch& scratch);

} // namespace flotilla
