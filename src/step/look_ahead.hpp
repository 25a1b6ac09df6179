// SPDX-License-Identifier: MIT
// Contacts that bodies do not have yet and would pass in the step.
//
// The contact search sees what is nearer than the proximity distance, and of what is there the points that face each
// other to within the proximity angle. A small body, or one in a long step, falls farther and turns more in one step:
// of a cube that stands on a corner it sees that corner alone, stage 3 lets the cube turn about it as far as it will,
// and stage 5 stops it where the next corner meets the ground. So it goes in every step, and the cube never rests.
//
// After a solve, bodies near each other that its velocities move that far are therefore searched again, as far as
// gravity alone may move and turn them in one step. Points that come below their rest distance on their paths become
// contacts, and the solve is done once more: equation 16 lets each approach by its gap. Stage 3 does so twice, as the
// second solve turns bodies about what the first round found; what the last solve sends elsewhere is left to stage 5
// and to the next step. Bodies that gravity moves by less than their proximity distance in a step are left alone: at
// 1/24 s compact ones of more than 1.4 m.
#pragma once

#include <vector>

#include "pair/pair_lists.hpp"
#include "pair/worker.hpp"
#include "proximity/contact_set.hpp"
#include "static_contact/velocity_arrays.hpp"

namespace flotilla {

/// Whether gravity moves some body farther, or turns it more, in one step than the contact search sees.
[[nodiscard]] bool may_look_ahead(const Model& model);
/// Whether it is this body that does.
[[nodiscard]] bool may_look_ahead(const Model& model, std::size_t body);

struct LookAheadScratch {
    struct Pair {
        const PairRecord* record;
        std::size_t begin, end; ///< its contacts in the set
        double distance, angle_cos;
        double time; ///< s
    };
    std::vector<Pair> pairs;
    std::vector<ContactSet> found; ///< by pair
    ContactSet merged;
};

/// The poses at which contacts are searched for.
enum class StepEnd { start, end };

/// What a solve left, and the poses of its contacts.
struct SolvedAt {
    StepEnd poses;
    const VelocityArrays& velocities;
};

/// Adds to the set, which was searched at the same poses, what its pairs pass at the velocities. Whether there was
/// anything.
bool add_contacts_ahead(const StepView& view, const PairTable& pairs, Workers& workers, const SolvedAt& solved,
                        LookAheadScratch& scratch, ContactSet& set);

} // namespace flotilla
