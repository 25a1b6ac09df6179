// SPDX-License-Identifier: MIT
// The contact search: contact points (proximity/contact_points.hpp) of all pairs near each other at the end poses. It
// keeps the distances that it finds in the records of pairs, and moves nothing.
#pragma once

#include <functional>

#include "pair/pair_lists.hpp"
#include "pair/worker.hpp"
#include "proximity/contact_set.hpp"

namespace flotilla {

/// What is searched for.
struct ContactSearch {
    std::int64_t step; ///< that ends, or ended, at the end poses
    /// The pairs that are wanted; empty: all.
    std::function<bool(const CandidatePair&)> wanted = {};
};

struct ContactSearchScratch {
    /// By body: m, from where contacts were last searched for on its account (State::searched).
    std::vector<double> stray;
    std::vector<ContactSet> parts; ///< what the tasks of a search found
    std::vector<std::size_t> places;
};

/// Fills `out` with the contacts of the wanted pairs; `out.near` has all pairs.
void find_contacts(const StepView& view, PairBook& book, Workers& workers, const ContactSearch& search,
                   ContactSearchScratch& scratch, ContactSet& out);

} // namespace flotilla
