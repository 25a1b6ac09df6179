// SPDX-License-Identifier: MIT
// Lists of pairs: what the broadphase finds for the step's motions, and of that what a sweep freezes (README.md). Made
// on one thread; loops inside write slots by item.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pair/pair_table.hpp"
#include "pair/step_view.hpp"
#include "parallel/task_order.hpp"
#include "state/candidate_pairs.hpp"

namespace flotilla {

/// How near each other the boxes of a pair come that a list is to have.
enum class ListReach {
    separation, ///< what may hit: stage 5 and the certificate
    proximity,  ///< what may hit or be in contact: stage 1
    fall,       ///< what may be in contact, or fall there in a step: the contact search
};
/// Of a body, m: the sum of both is never less than the pair's, since a pair's lengths are those of its smaller movable
/// body.
[[nodiscard]] double list_reach(const Model& model, std::size_t body, ListReach reach);

/// A pair of bodies of a list.
struct ListedPair {
    CandidatePair pair;
    PairRecord* record = nullptr;
    friend bool operator<(const ListedPair& p, const ListedPair& q) { return p.pair < q.pair; }
    friend bool operator==(const ListedPair& p, const ListedPair& q) { return p.pair == q.pair; }
};

/// The list of a sweep: fixed, sorted, until the next list is made. Pairs that were proved apart ahead of their turn
/// stay in it, because an operation before their turn may move one of the bodies.
struct FrozenList {
    std::span<const ListedPair> pairs;
    std::size_t num_open = 0; ///< of these, those that are not closed

    /// Of these, those of which it is known that their operation has nothing to do at the present end states.
    [[nodiscard]] std::size_t num_closed() const { return pairs.size() - num_open; }
};

/// What the last list of candidate pairs was made from, so that the next one goes over what changed alone.
struct SweptMotions {
    std::vector<std::uint64_t> version; ///< of the bodies' end states
    std::vector<std::int32_t> changed;  ///< bodies whose version is another one than in the list before
    std::vector<std::uint8_t> differs;  ///< the same by active body, as flags
    ListReach reach = ListReach::separation;
    const std::vector<CandidatePair>* pairs = nullptr; ///< null: other lists were made since
};

/// Buffers of the order of a sweep (ordered_sweep.hpp).
struct SweepBuffers {
    struct SweepTask {
        std::int32_t place, round; ///< in the list
    };
    TaskOrder order;
    std::vector<SweepTask> tasks;                    ///< in their order
    std::vector<std::array<std::int32_t, 2>> things; ///< movable clusters by place in the list, -1: infinite mass
    std::vector<std::uint64_t> used_colors;          ///< by cluster, a bit each
    std::vector<std::uint8_t> color;                 ///< by place in the list
    std::vector<std::int32_t> places;                ///< in the list, in the order of operations
    std::vector<std::int32_t> color_begin;           ///< in `places`, and where the last colour ends
    std::vector<std::uint8_t> touched;               ///< by cluster: some task before uses it
    std::vector<std::uint8_t> open;                  ///< by place in the list, as flags
    /// What the order of tasks is found by side by side: by place in the plan, round after round, but for `last`.
    struct Links {
        std::vector<std::uint8_t> is_task, waits;
        std::vector<Successors> successors; ///< places in the plan
        std::vector<std::int32_t> number;   ///< of the task
        std::vector<std::int32_t> last;     ///< by cluster, as TaskOrder has it
        std::vector<std::size_t> places;
    };
    Links links;
};

/// Buffers of the lists that a step makes.
struct ListBuffers {
    SweptMotions frozen;
    std::vector<SweptBody> swept;
    std::vector<BodyBounds> bounds;  ///< see StepView
    std::uint64_t still_version = 1; ///< a new number where other bodies stand still than before, or elsewhere
    std::uint64_t still_placed = 0;  ///< the version that `swept` and `bounds` hold
    std::vector<PairRecord*> record; ///< of each candidate pair; null: there is none yet
    std::vector<std::uint8_t> wanted;
    std::vector<std::size_t> chunk_places; ///< in `listed`, by chunk of candidate pairs
    std::vector<ListedPair> listed;
    std::vector<std::uint8_t> certified; ///< by candidate pair, as flags
    SweepBuffers sweep;

    /// The next list is made from all motions.
    void forget_motions() { frozen.pairs = nullptr; }
};

/// What is known of pairs, and the lists made of them.
class PairBook {
  public:
    PairTable table;
    ListBuffers lists;

    /// `finder`: who finds pairs whose boxes meet.
    explicit PairBook(PairFinder& finder) : finder_(finder) {}
    [[nodiscard]] PairFinder& finder() { return finder_; }

  private:
    PairFinder& finder_;
};

/// All pairs whose swept boxes come within the reach, sorted. Of a pair that is not among them with
/// ListReach::separation this is the proof (way a).
const std::vector<CandidatePair>& swept_pairs(const StepView& view, PairBook& book, Team& team, ListReach reach);

/// Pairs of an active body with a sleeping one whose swept boxes come within the proximity distance, among others;
/// sorted.
const std::vector<CandidatePair>& waking_pairs(const StepView& view, PairBook& book, Team& team);

/// The frozen list of a sweep: pairs of bodies of different clusters whose swept boxes come within the reach and that
/// are not proved apart.
///
/// Of most pairs at rest the bounds of both bodies say that the operation would prove them apart and do nothing else.
/// Those are proved here, side by side. `reach`: proximity in stage 1, whose operations look for proximities that
/// approach as well; separation in stage 5.
[[nodiscard]] FrozenList freeze(const StepView& view, PairBook& book, Team& team, ListReach reach);

/// All pairs whose boxes at the end poses come within ListReach::fall, sorted.
const std::vector<ListedPair>& end_pairs(const StepView& view, PairBook& book, Team& team);

} // namespace flotilla
