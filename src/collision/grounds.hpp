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
    /// From the pairs of a sweep. `chunks`: scratch.
    void list(const StepView& view, std::span<const ListedPair> pairs, Team& team, std::vector<std::size_t>& chunks);
    /// What a body may land on besides `ground`, which it hit, with the same restitution; ascending. None where that
    /// does not stand still.
    void beside(const StepView& view, std::int32_t body, std::int32_t ground, std::vector<std::int32_t>& out) const;

  private:
    struct Landing {
        std::int32_t body, ground;
        friend auto operator<=>(const Landing&, const Landing&) = default;
    };
    std::vector<Landing> landings_; ///< ascending
};

} // namespace flotilla
