// SPDX-License-Identifier: MIT
// Candidate body pairs by a list that is kept: of boxes with a margin, and right for as long as every body stays inside
// its own. A search then goes over that list and over the bodies once; only those that left theirs are sorted in again.
//
// All searches of a step ask for nearly the same boxes, and bodies at rest for the same ones in every step. What a
// search answers is the same with any list.
#pragma once

#include "broadphase/pairs.hpp"

namespace flotilla {

class KeptPairs : public PairFinder {
  public:
    const std::vector<CandidatePair>& find(Team& team, const PairSearch& search) override;
    const std::vector<CandidatePair>& update(Team& team, const PairSearch& search,
                                             std::span<const std::int32_t> changed) override;
    /// Movable bodies of `active` without a pair in the kept list; 0 where there is none.
    [[nodiscard]] std::size_t lone_bodies(std::span<const std::int32_t> active) const;
    [[nodiscard]] const Broadphase& grids() const { return grids_; }

  private:
    /// Makes wide_ hold all pairs of the search, of whose bodies only those `changed` may be elsewhere than before.
    void cover(Team& team, const PairSearch& search, std::span<const std::int32_t> changed);
    /// Lists those of the bodies that are not inside their wide boxes.
    void list_strays(Team& team, const PairSearch& search, std::span<const std::int32_t> bodies);
    void widen_all(Team& team, const PairSearch& search);
    const std::vector<CandidatePair>& near_ones(Team& team, const PairSearch& search);
    /// Those that the search's filter does not leave out.
    const std::vector<CandidatePair>& without_ignored(const PairSearch& search,
                                                      const std::vector<CandidatePair>& pairs);

    Broadphase grids_;
    std::vector<SweptBody> boxes_; ///< with their margin
    std::uint64_t still_version_ = 0;
    const std::vector<CandidatePair>* wide_ = nullptr; ///< pairs of boxes_; null: there are none yet
    std::vector<std::uint8_t> out_, near_;             ///< by body that is looked at; by pair of wide_
    std::vector<std::int32_t> strays_;
    std::vector<std::size_t> places_;
    std::vector<CandidatePair> pairs_;
};

} // namespace flotilla
