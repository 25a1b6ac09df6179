// SPDX-License-Identifier: MIT
// The interface between whoever asks for candidate body pairs and the broadphase that finds them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/box.hpp"
#include "parallel/team.hpp"

namespace flotilla {

struct CandidatePair {
    std::int32_t a, b; ///< a < b
    friend auto operator<=>(const CandidatePair&, const CandidatePair&) = default;
};

/// What a pair finder knows of a body in this sweep.
struct SweptBody {
    Box box;              ///< of the whole motion, not inflated
    double reach = 0;     ///< m, inflation of this body's box: its part of the pair's distance of interest
    bool movable = false; ///< two bodies of infinite mass never pair
};

class PairFinder {
  public:
    virtual ~PairFinder() = default;
    /// All pairs with at least one movable body whose inflated boxes overlap, sorted by (a, b).
    virtual const std::vector<CandidatePair>& find(Team& team, const std::vector<SweptBody>& bodies) = 0;
    /// The same where the last call was for the same bodies, of which those `changed` (ascending) are other ones now: for few.
    virtual const std::vector<CandidatePair>& update(Team& team, const std::vector<SweptBody>& bodies,
                                                     std::span<const std::int32_t> changed) = 0;
};

} // namespace flotilla
