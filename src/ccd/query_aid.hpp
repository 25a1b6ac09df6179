// SPDX-License-Identifier: MIT
// What is known of a pair of bodies that makes its queries cost less. It changes no answer.
#pragma once

#include "ccd/candidate_list.hpp"

namespace flotilla {

struct QueryAid {
    CoveringList list; ///< covers the motion and reaches the distance that is asked for
    Vec3 direction{};  ///< unit, from a to b, of a plane between them (plane_features.hpp); zero: none is known

    QueryAid() = default;
    QueryAid(const CoveringList& l) : list(l) {} // NOLINT(google-explicit-constructor): all that most pairs have
    explicit QueryAid(const Vec3& d) : direction(d) {}
};

} // namespace flotilla
