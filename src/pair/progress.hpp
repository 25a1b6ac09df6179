// SPDX-License-Identifier: MIT
// Whether sweep after sweep over pairs still gets anywhere.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

namespace flotilla {

/// Counts the pairs that hit in each sweep of a stage. A blow goes on by one pair a sweep at least, so after as many
/// sweeps as there are pairs it has been through all of them, and after as many again it is back. What ends gets
/// fewer hits geometrically; where in all of these sweeps they are more than half of what they were and reach no pair
/// that was not reached before, bodies hand on to each other what no blow ends, such as shells within shells that
/// turn. That goes on for ever, and more sweeps gain nothing. The counts must follow from the state alone, not from
/// what is known of pairs.
class Progress {
  public:
    /// `hits`: pairs that hit in a sweep, of `all` that a blow goes through. Where none did, what hits next is another
    /// blow.
    void add(std::size_t hits, std::size_t all) {
        ++sweeps_;
        if (all <= all_ && hits > fewest_ / 2) return;
        all_ = std::max(all_, all);
        fewest_ = hits > 0 ? hits : kNone;
        since_ = sweeps_;
    }
    [[nodiscard]] bool stalled() const { return sweeps_ - since_ > kThereAndBack * all_; }

  private:
    static constexpr std::size_t kThereAndBack = 2, kNone = std::numeric_limits<std::size_t>::max();
    std::size_t sweeps_ = 0, since_ = 0, all_ = 0, fewest_ = kNone;
};

} // namespace flotilla
