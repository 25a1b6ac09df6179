// SPDX-License-Identifier: MIT
// What is known of body pairs: proofs, by the versions that they are about, and neighbour lists (README.md).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/slab_list.hpp"
#include "ccd/candidate_list.hpp"
#include "parallel/large_vector.hpp"
#include "parallel/team.hpp"
#include "state/candidate_pairs.hpp"

namespace flotilla {

/// The neighbour list of a pair, a plane between its bodies, and whether keeping them pays.
struct PairCandidates {
    CandidateList list;
    std::int32_t uses = 0;    ///< queries that the list has answered
    bool paid = true;         ///< the last list answered more queries than the one that made it
    std::int64_t step = -1;   ///< of the last query
    std::int32_t queries = 0; ///< in that step
    bool busy = false;        ///< there were several in the step before
    double last_strayed = 0;  ///< m, at the end of the step, when the last list no longer covered the motion
    /// At the last search for contacts: the poses, and the distance of the bodies, m; < 0: there was none.
    MatrixPose searched_a, searched_b;
    double searched_distance = -1;
    /// Along which a plane was last found between the hulls; zero: none was, and so many times none is searched for.
    Vec3 apart{};
    std::int32_t no_plane = 0;
    /// Versions at whose ends the hulls are farther apart than the proximity distance, by `far_gap`, m.
    std::uint64_t far_a = 0, far_b = 0;
    double far_gap = 0;
};

/// Two cache lines: what every step reads of every pair, then what it reads of some.
struct alignas(64) PairRecord {
    std::int32_t a = -1, b = -1;
    std::uint64_t proved_a = 0, proved_b = 0; ///< versions for which the CCD found no hit (way b)
    std::int64_t step = -1;                   ///< of the last use
    bool active = false;                      ///< stage 1 applied an impulse to it in this step
    bool processed = false;                   ///< examined by stage 1 and found hitting or near: stage 7 acts on it
    bool assumed = false;                     ///< processed only by what stay_by_bounds() said of its present versions
    float doubt = 0;                          ///< m, by how much less the known distance below may be
    double start_distance = -1;               ///< m, at x^n; infinite beyond the proximity distance, < 0: not known
    double end_distance = -1;                 ///< the same at the end of the step
    double slack = -1;                        ///< m, see stay_by_bounds(); a cache: changes cost only
    std::unique_ptr<PairCandidates> candidates; ///< a cache; null until a query asks for it
    std::uint64_t missed_a = 0, missed_b = 0;   ///< versions for which stage 1's own CCD found no hit, proved or not
    std::uint64_t left_a = 0, left_b = 0;       ///< versions for which an operation changed nothing: left to stage 5
    PairLengths lengths{};                      ///< m
};
static_assert(sizeof(PairRecord) == 128);

/// Asks for a record, both lines.
void fetch_record(const PairRecord& record);

/// Open addressing by (a, b). Nothing that decides ever iterates over it: order comes from sorted lists of pairs.
/// Records live as long as each step uses them, and stay where they are. Proofs need no clearing, because versions are
/// never used again.
///
/// Several threads may find records side by side; whoever makes some must be alone.
class PairTable {
  public:
    /// Begins a step: forgets pairs that the last step did not use, and what stage 1 processed.
    void start_step(Team& team, std::int64_t step);
    /// Forgets everything.
    void clear();
    /// Forgets all pairs of bodies that are marked, as flags by body.
    void forget(std::span<const std::uint8_t> marked);
    /// The record of a pair, made on first use.
    PairRecord& get(const Model& model, const State& state, std::int32_t a, std::int32_t b);
    /// Null: there is none.
    [[nodiscard]] PairRecord* find(std::int32_t a, std::int32_t b) const;
    /// The records of some pairs, some hundreds at most: all of them asked for, then looked up, so that the waits for
    /// memory overlap. `out` has their number of places.
    void find(std::span<const CandidatePair> pairs, std::span<PairRecord*> out) const;
    /// Bytes, of records, their index and the neighbour lists.
    [[nodiscard]] std::size_t memory() const;
    /// Keeps a record for this step.
    void use(PairRecord& record) const { record.step = step_; }

  private:
    struct Slot {
        std::int32_t a = -1, b = -1;
        PairRecord* record = nullptr; ///< null: free
    };
    [[nodiscard]] std::size_t slot(std::int32_t a, std::int32_t b) const;
    void index(std::size_t slots);
    void erase(std::int32_t a, std::int32_t b);
    PairRecord& new_record();

    LargeVector<Slot> slots_; ///< a power of two of them
    SlabList<PairRecord, 256> records_;
    std::vector<PairRecord*> free_;   ///< records of no pair
    std::vector<std::size_t> places_; ///< scratch
    std::int64_t step_ = 0;
};

} // namespace flotilla
