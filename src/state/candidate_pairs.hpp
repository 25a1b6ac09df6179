// SPDX-License-Identifier: MIT
// The interface between whoever asks for candidate body pairs and the broadphase that finds them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/box.hpp"
#include "parallel/team.hpp"
#include "state/model.hpp"
#include "state/savings.hpp"

namespace flotilla {

struct CandidatePair {
    std::int32_t a, b; ///< a < b
    friend auto operator<=>(const CandidatePair&, const CandidatePair&) = default;
};

/// What a pair finder knows of a body in this sweep.
struct SweptBody {
    Box box;                 ///< of the whole motion, not inflated
    double reach = 0;        ///< m, inflation of the box: its part of the distance of interest; 0 where it stands still
    bool movable = false;    ///< two bodies of infinite mass never pair
    double waking_reach = 0; ///< m, of a sleeping body, which stands still otherwise
    bool present = true;     ///< else it has no box, and no pairs
};

/// What a pair finder is asked. Bodies that are not active stand still: they pair with active ones only, and it is
/// enough to sort them in once.
struct PairSearch {
    std::span<const SweptBody> bodies;
    std::span<const std::int32_t> active; ///< ascending
    std::uint64_t still_version = 0;      ///< a new number where other bodies stand still than before, or elsewhere
    bool wakes = false;                   ///< sleeping bodies count as movable, with their waking reach
    Savings savings{};
    const Model* filters = nullptr; ///< whose filter leaves pairs out; null: none are
};

class PairFinder {
  public:
    virtual ~PairFinder() = default;
    /// All pairs of an active body with another where at least one is movable and whose inflated boxes overlap, sorted
    /// by (a, b).
    virtual const std::vector<CandidatePair>& find(Team& team, const PairSearch& search) = 0;
    /// The same where the last call was for the same bodies, of which those in `changed` (ascending, all active) have
    /// other boxes now. For few.
    virtual const std::vector<CandidatePair>& update(Team& team, const PairSearch& search,
                                                     std::span<const std::int32_t> changed) = 0;
};

} // namespace flotilla
