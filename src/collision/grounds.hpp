// SPDX-License-Identifier: MIT
// What several bodies that stand still carry together.
//
// A crate that lands flat across the seam of two tiles hits both at one time. Resolved pair by pair the first tile's
// impulse turns it, and it leaves the second one with spin and height from nothing. Bodies that stand still and have
// infinite mass are one to what lands on them: what a body's hit on one of them has at the same time on the others is
// resolved with it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pair/pair_lists.hpp"
#include "pair/step_view.hpp"
#include "parallel/team.hpp"

namespace flotilla {

class Grounds {
  public:
    /// Forgets all, for another step.
    void start() { supports_.clear(); }
    /// Adds those of the pairs of a list; later lists of a step leave out what is apart by then. `chunks`: scratch.
    void add(const StepView& view, std::span<const ListedPair> pairs, Team& team, std::vector<std::size_t>& chunks);
    /// What the one of two bodies that moves may land on besides the other, which stands still, with the same
    /// restitution; ascending. None where neither stands still.
    void beside(const StepView& view, std::int32_t a, std::int32_t b, std::vector<std::int32_t>& out) const;

  private:
    struct Support {
        std::int32_t body, ground;
        friend auto operator<=>(const Support&, const Support&) = default;
    };
    std::vector<Support> supports_; ///< ascending
};

} // namespace flotilla
