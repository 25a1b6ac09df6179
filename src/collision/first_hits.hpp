// SPDX-License-Identifier: MIT
// Which hits of a list come first (README.md). A sweep goes over pairs in an order that knows nothing of time: a body
// would hand its momentum to whatever it meets on its way in this step, beyond what stops it before: a cube thrown at a
// wall moved what stands behind it. So all open pairs of a list are looked at before any has its turn, at one state of
// all bodies, and a hit waits for the next list where one of its bodies has an earlier one.
//
// A pair whose bodies moved since the look has its turn all the same if it was seen to hit: a pile would need as many
// lists as a blow has to go through layers. What was not seen to hit waits: the list says nothing of what lies before
// it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collision/pair_hits.hpp"
#include "pair/pair_lists.hpp"

namespace flotilla {

class FirstHits {
  public:
    /// Begins a step: what looks of the one before found is forgotten, as it is about other starts.
    void start() { hitting_.clear(); }
    /// Looks at the open pairs of a list, side by side, and closes those in which nothing calls for an impulse.
    void look(const StepView& view, Workers& workers, std::span<const ListedPair> list);
    /// Whether the pair at a place of that list was seen to hit.
    [[nodiscard]] bool hits(std::size_t place) const { return seen_[place].hits(); }
    /// Whether that, though it does, waits for the next list. Bodies are never nearer than a separation: what comes
    /// within the time in which they go as far does not lie behind the other.
    [[nodiscard]] bool waits(const StepView& view, const CandidatePair& pair, std::size_t place) const;
    /// What was seen of the pair; null where one of its bodies moved since, and where another rank looked.
    [[nodiscard]] const CollisionFinding* found(const StepView& view, const CandidatePair& pair,
                                                std::size_t place) const;

  private:
    static constexpr double kNever = 2;
    struct Seen {
        double time = kNever, room = 0; ///< shares of the step: until the hit, and in which others are of its time
        std::int32_t thread = -1, number = -1; ///< in hits_
        [[nodiscard]] bool hits() const { return time < kNever; }
    };
    struct Hit {
        CandidatePair pair;
        std::uint64_t version_a = 0, version_b = 0;
        CollisionFinding finding;
    };
    struct First {
        double time = kNever;
        std::uint64_t version = 0;
    };
    struct Place {
        CandidatePair pair;
        std::size_t place = 0;
        Seen seen;
    };
    using HitsByThread = std::vector<std::vector<Hit>>;

    bool look_at_pair(const StepView& view, Worker& worker, int thread, const ListedPair& listed, std::size_t place);
    void share_times(const Division& division, std::span<const ListedPair> list);
    void find_first(const StepView& view, Workers& workers, std::span<const ListedPair> list);
    /// What the look before found, where neither body has moved since.
    [[nodiscard]] const CollisionFinding* known(const StepView& view, const CandidatePair& pair) const;
    [[nodiscard]] static bool stands(const StepView& view, const Hit& hit);

    std::vector<Seen> seen_;     ///< by place in the list
    std::vector<Place> hitting_; ///< those that hit, in their order
    std::vector<First> first_;   ///< by body; those of hitting_ alone are those of this look
    HitsByThread hits_, hits_before_;
    std::vector<Place> before_; ///< hitting_ of the look before
    std::vector<std::size_t> places_;
};

} // namespace flotilla
