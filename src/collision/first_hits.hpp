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
    void start();
    /// Of all ranks.
    struct Looked {
        std::size_t examined = 0, closed = 0; ///< pairs
    };
    /// Looks at the open pairs of a list, side by side, and closes those in which nothing calls for an impulse.
    Looked look(const StepView& view, Workers& workers, std::span<const ListedPair> list);
    /// The pairs that were seen to hit, in the order of the list.
    [[nodiscard]] std::span<const ListedPair> hitting() const { return hitting_; }
    /// Whether one of these waits for the next list. Bodies are never nearer than a separation: what comes within the
    /// time in which they go as far does not lie behind the other.
    [[nodiscard]] bool waits(const StepView& view, std::size_t hit) const;
    /// What was seen of it; null where one of its bodies moved since, and where another rank looked.
    [[nodiscard]] const CollisionFinding* found(const StepView& view, std::size_t hit) const;

  private:
    static constexpr double kNever = 2;
    struct Seen {
        double time = kNever, room = 0; ///< shares of the step: until the hit, and in which others are of its time
        std::int32_t thread = -1, number = -1; ///< in hits_; negative: another rank's
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
    struct alignas(64) OfThread {
        std::vector<Hit> hits;
        Looked looked;
    };

    bool look_at_pair(const StepView& view, Worker& worker, int thread, const ListedPair& listed, std::size_t place);
    Looked share(const Division& division, std::size_t examined, std::size_t closed);
    void find_first(const StepView& view, Workers& workers, std::span<const ListedPair> list);
    /// What the look before found, where neither body has moved since.
    [[nodiscard]] const CollisionFinding* known(const StepView& view, const CandidatePair& pair) const;

    std::vector<Seen> seen_;                       ///< by place in the list
    std::vector<ListedPair> hitting_, before_;     ///< the latter of the look before
    std::vector<Seen> seen_hitting_, seen_before_; ///< of these
    std::vector<OfThread> by_thread_, by_thread_before_;
    std::vector<First> first_; ///< by body; of those that hit alone it is of this look
    std::vector<std::size_t> places_;
};

} // namespace flotilla
