// SPDX-License-Identifier: MIT
// What is known of body pairs (README.md): verdicts, by the end states that they are about, and caches.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/slab_list.hpp"
#include "ccd/candidate_list.hpp"
#include "parallel/large_vector.hpp"
#include "parallel/team.hpp"
#include "state/candidate_pairs.hpp"

namespace flotilla {

/// What is known of a pair at the candidate end states that its bodies have. The greater one says more.
enum class Verdict : std::uint8_t {
    open,    ///< nothing
    settled, ///< stage 1 finds nothing that it could resolve. No proof
    apart,   ///< proved apart, on the whole way (way b)
};

/// A verdict and the end states that it is about. It lapses by itself when a body gets another end state, because
/// versions are never used again.
class VersionedVerdict {
  public:
    /// Of the end states with these versions.
    [[nodiscard]] Verdict at(std::uint64_t version_a, std::uint64_t version_b) const {
        return version_a_ == version_a && version_b_ == version_b ? verdict_ : Verdict::open;
    }
    /// A lesser one of the same end states changes nothing.
    void commit(Verdict verdict, std::uint64_t version_a, std::uint64_t version_b) {
        verdict_ = std::max(verdict, at(version_a, version_b));
        version_a_ = version_a;
        version_b_ = version_b;
    }

  private:
    std::uint64_t version_a_ = 0, version_b_ = 0; ///< no end state has version 0
    Verdict verdict_ = Verdict::open;
};

/// Whether stage 1 examined a pair in the step and found it hitting, or near at its end. Where it is examined ahead of
/// its turn that is only expected, until its turn or the next list: operations may still move the bodies.
class Processed {
  public:
    void set() { state_ = State::yes; }
    /// Found ahead of the turn.
    void expect() { state_ = std::max(state_, State::expected); }
    /// The turn has come, with other end states than those that were examined.
    void withdraw() {
        if (state_ == State::expected) state_ = State::no;
    }
    /// The turn has come and gone, with the end states that were examined.
    void confirm() {
        if (state_ == State::expected) state_ = State::yes;
    }
    operator bool() const { return state_ != State::no; } // NOLINT(google-explicit-constructor): it reads as a flag

  private:
    enum class State : std::uint8_t { no, expected, yes };
    State state_ = State::no;
};

/// A plane between the bodies of a pair, its neighbour list, and whether keeping one pays. What is known of the plane
/// stands in one cache line: pairs of convex bodies ask for little else.
struct alignas(64) PairCandidates {
    /// Along which a plane was last found between the hulls; zero: none was, and so many times none is searched for.
    Vec3 plane_normal{};
    std::int32_t no_plane = 0;
    std::int32_t uses = 0; ///< queries that the list has answered
    /// Versions at whose ends the hulls are farther apart than the proximity distance, by `far_gap`, m.
    std::uint64_t far_a = 0, far_b = 0;
    double far_gap = 0;
    /// At the last search for contacts: the distance of the bodies, m, < 0: there was none; and the poses.
    double searched_distance = -1;
    MatrixPose searched_a, searched_b;
    CandidateList list;
    bool paid = true;         ///< the last list answered more queries than the one that made it
    std::int64_t step = -1;   ///< of the last query
    std::int32_t queries = 0; ///< in that step
    bool busy = false;        ///< there were several in the step before
    double last_strayed = 0;  ///< m, at the end of the step, when the last list no longer covered the motion
};

/// What saves queries of a pair. Without any of it a step has the same bits.
struct PairCache {
    double start_distance = -1;                 ///< m, at x^n; infinite beyond the proximity distance, < 0: not known
    double end_distance = -1;                   ///< the same at the end of the step
    double slack = -1;                          ///< m, see stays_by_bounds()
    std::unique_ptr<PairCandidates> candidates; ///< null until a query asks for it
    float doubt = 0;                            ///< m, by how much less the known distance may be
};

[[nodiscard]] inline PairCandidates& candidates_of(PairCache& cache) {
    if (cache.candidates == nullptr) cache.candidates = std::make_unique<PairCandidates>();
    return *cache.candidates;
}

/// Two cache lines: what every step reads of every pair, then what it reads of some.
struct alignas(64) PairRecord {
    std::int32_t a = -1, b = -1;
    std::int64_t step = -1;                         ///< of the last use
    [[no_unique_address]] VersionedVerdict verdict; ///< what follows stands in its padding
    Processed processed;                            ///< stage 7 acts on it
    bool active = false;                            ///< stage 1 applied an impulse to it in this step
    PairCache cache;
    PairLengths lengths{}; ///< m
};
static_assert(sizeof(PairRecord) == 128 && sizeof(PairCache) == 40, "the distances of the cache end the first line");

/// What is known of the pair at its present end states. Of verdicts, apart alone is a proof: way b of four (README.md).
[[nodiscard]] inline Verdict verdict(const Trajectories& trajectories, const PairRecord& pair) {
    const auto version = [&](std::int32_t body) { return trajectories.version(static_cast<std::size_t>(body)); };
    return pair.verdict.at(version(pair.a), version(pair.b));
}
[[nodiscard]] inline bool apart(const Trajectories& trajectories, const PairRecord& pair) {
    return verdict(trajectories, pair) == Verdict::apart;
}
/// Records what was found at the present end states.
inline void commit(const Trajectories& trajectories, PairRecord& pair, Verdict found) {
    const auto version = [&](std::int32_t body) { return trajectories.version(static_cast<std::size_t>(body)); };
    pair.verdict.commit(found, version(pair.a), version(pair.b));
}

/// Asks for a record, both lines.
void fetch_record(const PairRecord& record);

/// Open addressing by (a, b). Nothing that decides ever iterates over it: order comes from sorted lists of pairs.
/// Records live as long as each step uses them, and stay where they are.
///
/// Several threads may find records side by side; whoever makes some must be alone.
class PairTable {
  public:
    /// Begins a step: forgets pairs that the last step did not use, and what stage 1 processed.
    void start_step(Team& team, std::int64_t step);
    /// Forgets what stage 1 did in the step so far.
    void restart_step(Team& team);
    /// Forgets everything.
    void clear();
    /// Forgets all pairs of bodies that are marked, as flags by body.
    void forget(std::span<const std::uint8_t> marked);
    /// The record of a pair, made on first use.
    PairRecord& get(const Model& model, const State& state, std::int32_t a, std::int32_t b);
    /// Null: there is none.
    [[nodiscard]] PairRecord* find(std::int32_t a, std::int32_t b);
    [[nodiscard]] const PairRecord* find(std::int32_t a, std::int32_t b) const;
    /// The records of some pairs, some hundreds at most: all of them asked for, then looked up, so that the waits for
    /// memory overlap. `out` has their number of places.
    void find(std::span<const CandidatePair> pairs, std::span<PairRecord*> out);
    /// Bytes, of records, their index and the neighbour lists.
    [[nodiscard]] std::size_t memory() const;
    /// Keeps a record for this step.
    void use(PairRecord& record) { record.step = step_; }

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
