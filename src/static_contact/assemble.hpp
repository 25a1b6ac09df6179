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
    return options.tangents == Tangents::random ? Cone::pyramid : Cone::disc;
}

/// Fills velocity, blocks, rows (with W, tangents and the cut warm impulses, none applied yet), their packets and
/// islands. Returns the number of colours.
int assemble(std::span<const Contact> contacts, const ContactBodies& bodies, const ContactSolveOptions& options,
             std::span<const Vec3> impulses, ContactScratch& scratch);

} // namespace flotilla
