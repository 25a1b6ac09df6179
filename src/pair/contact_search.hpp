// SPDX-License-Identifier: MIT
// The contact search: contact points (proximity/contact_points.hpp) of all pairs near each other at the end poses. It
// reads bodies and what is known of pairs, and keeps the distances that it finds in their records.
#pragma once

#include <functional>

#include "pair/step_data.hpp"
#include "proximity/contact_set.hpp"

namespace flotilla {

struct ContactSearchScratch {
    /// By body: m, from where contacts were last searched for on its account (State::searched).
    std::vector<double> stray;
    std::vector<ContactSet> parts; ///< what the tasks of a search found
    std::vector<std::size_t> places;
};

/// Fills `out` with the contacts at the end poses, where `step` ends or ended.
void find_contacts(StepData& data, std::int64_t step, ContactSearchScratch& scratch, ContactSet& out);
/// The same of the pairs that are wanted alone; `out.near` has all.
void find_contacts_of(StepData& data, std::int64_t step, const std::function<bool(const CandidatePair&)>& wanted,
                      ContactSearchScratch& scratch, ContactSet& out);

} // namespace flotilla
