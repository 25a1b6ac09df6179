// SPDX-License-Identifier: MIT
// Whether sweep after sweep over pairs still gets anywhere.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

namespace flotilla {

/// Counts the pairs that hit in each sweep of a stage, and how hard. A blow goes on by one pair a sweep at least, so
/// after as many sweeps as there are pairs it has been through all of them, and after as many again it is back. What
/// ends gets fewer hits geometrically, or weaker ones: along a tight chain, in a small tower all pairs hit to the end.
/// Where in all of these sweeps neither fell to half of what it was, and no pair was reached that was not reached
/// before, bodies hand on to each other what no blow ends, such as shells within shells that turn. That goes on for
/// ever, and more sweeps gain nothing. What is counted must follow from the state alone, not from what is known of
/// pairs.
class Progress {
  public:
    /// `least_trips`: there and back, in which nothing may have fallen. `halves`: wait for impulses to halve. Along a
    /// tight chain those of sweep after sweep spread as heat does, and halve in a time that goes with the square of its
    /// pairs.
    explicit Progress(std::size_t least_trips = 1, bool halves = false) : least_trips_(least_trips), halves_(halves) {}

    /// `hits`: pairs that hit in a sweep, of `all` that a blow goes through. Where none did, what hits next is another
    /// blow. `pushed`: the largest impulse, N s.
    void add(std::size_t hits, std::size_t all, double pushed) {
        ++sweeps_;
        if (all <= all_ && hits > fewest_ / 2 && !(pushed < weakest_ / 2)) return;
        all_ = std::max(all_, all);
        fewest_ = hits > 0 ? hits : kNone;
        weakest_ = hits > 0 ? pushed : kNoPush;
        since_ = sweeps_;
    }
    [[nodiscard]] bool stalled() const { return sweeps_ - since_ > patience(); }

  private:
    [[nodiscard]] std::size_t patience() const {
        const std::size_t trips = least_trips_ * kThereAndBack;
        return (halves_ ? std::max(trips, all_) : trips) * all_;
    }

    static constexpr double kNoPush = std::numeric_limits<double>::infinity();
    static constexpr std::size_t kThereAndBack = 2, kNone = std::numeric_limits<std::size_t>::max();
    std::size_t least_trips_;
    bool halves_;
    std::size_t sweeps_ = 0, since_ = 0, all_ = 0, fewest_ = kNone;
    double weakest_ = kNoPush; ///< N s
};

} // namespace flotilla
