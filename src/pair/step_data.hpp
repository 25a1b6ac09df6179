// SPDX-License-Identifier: MIT
// The data that the stages of one step share.
#pragma once

#include <atomic>
#include <memory>

#include "base/stopwatch.hpp"
#include "ccd/pair_query.hpp"
#include "pair/pair_table.hpp"
#include "proximity/contact_points.hpp"
#include "response/cluster.hpp"
#include "response/pair_manifold.hpp"
#include "state/candidate_pairs.hpp"
#include "state/savings.hpp"

namespace flotilla {

struct StageCounters {
    std::int64_t sweeps = 0;
    std::int64_t pairs = 0; ///< operations run
    std::int64_t impulses = 0;
    std::int64_t left = 0;                    ///< pairs left to a later stage
    double detection_ms = 0, response_ms = 0; ///< of all threads together
    bool limit = false;                       ///< ended by its iteration limit
};

/// A hit that a round over the pairs found (collision/accumulated.hpp).
struct FoundHit {
    PairRecord* record = nullptr;
    ContactPoint point{};
};

/// What one thread has to itself.
struct alignas(64) Worker {
    CcdScratch ccd;
    ProximityScratch proximity;
    std::vector<ProximityPoint> points;
    std::vector<FeaturePair> features;
    PairManifold manifold; ///< of the operation under way
    std::vector<PairManifold::Change> changes;
    std::vector<ContactPoint> hits; ///< at one time
    std::vector<Vec3> feet;
    std::vector<FoundHit> found;
    StageCounters counters;
    std::vector<std::int64_t> work;    ///< operations run, by round of a sweep
    std::vector<std::size_t> hitting;  ///< of these, those that applied an impulse
    std::vector<CandidatePair> pushed; ///< clusters that had an impulse in the step; equal ones may come again
};
using Workers = std::vector<std::unique_ptr<Worker>>;

/// A pair of bodies of a frozen list.
struct ListedPair {
    CandidatePair pair;
    PairRecord* record = nullptr;
    friend bool operator<(const ListedPair& p, const ListedPair& q) { return p.pair < q.pair; }
    friend bool operator==(const ListedPair& p, const ListedPair& q) { return p.pair == q.pair; }
};

/// Bounds on what a body does in the step: of most pairs only these and their record are read.
struct BodyBounds {
    double way = 0;   ///< m, displacement bound of its points along any axis, with room for arcs where it turns
    double speed = 0; ///< m/s, of any of its points
};

/// What the last list of candidate pairs was made from.
struct FrozenBounds {
    std::vector<std::uint64_t> version; ///< of the bodies' end states
    std::vector<std::int32_t> changed;  ///< bodies whose version is another one than in the list before
    bool with_proximity = false;
    const std::vector<CandidatePair>* pairs = nullptr; ///< null: other lists were made since
};

/// Buffers of the lists that a step makes.
struct ListBuffers {
    FrozenBounds frozen;
    std::vector<SweptBody> swept;
    std::vector<BodyBounds> bounds;  ///< by body, of the motion that the last list was made from
    std::uint64_t still_version = 1; ///< a new number where other bodies stand still than before, or elsewhere
    std::uint64_t still_placed = 0;  ///< the version that `swept` and `bounds` hold
    std::vector<double>
        stray; ///< by body: m, from where contacts were last searched for on its account (State::searched)
    std::vector<PairRecord*> record; ///< of each candidate pair; null: there is none yet
    std::vector<std::uint8_t> wanted;
    std::vector<std::size_t> chunk_places; ///< in `listed`, by chunk of candidate pairs
    std::vector<ListedPair> listed;
    std::size_t num_open = 0;       ///< of `listed`, those not proved yet, by bounds or early
    std::vector<ListedPair> active; ///< stage 1: pairs with an impulse in this step
    TaskOrder order;
    struct SweepTask {
        std::int32_t place, round; ///< in the list
    };
    std::vector<SweepTask> tasks;                    ///< in their order
    std::vector<std::array<std::int32_t, 2>> things; ///< movable clusters by place in the list, -1: infinite mass
    std::vector<std::uint64_t> used_colors;          ///< by cluster, a bit each
    std::vector<std::uint8_t> color;                 ///< by place in the list
    std::vector<std::int32_t> places;                ///< in the list, in the order of operations
    std::vector<std::uint8_t> touched;               ///< by cluster: some task before uses it
    std::vector<std::uint8_t> flags;                 ///< by place in the list
};

struct StepData {
    const Model& model;
    const State& state; ///< at x^n
    Trajectories& trajectories;
    Clusters& clusters;
    PairTable& pairs;
    PairFinder& broadphase;
    Team& team;
    Workers& workers; ///< by thread
    ListBuffers& lists;
    double dt;        ///< s
    double angle_cos; ///< of theta_proximity
    double approach;  ///< m/s, slower end proximities are left to static contact
    /// Off: every query traverses the hierarchies, whatever is known of the pair; the same answers.
    bool keep_candidates = true;
    Savings savings{};

    [[nodiscard]] Worker& worker(int thread) const { return *workers[static_cast<std::size_t>(thread)]; }
};

/// Adds what all workers counted to `counters` and sets theirs to zero.
void collect(StepData& data, StageCounters& counters);

/// Marks of the pair that are current: a certificate, a miss of stage 1's own test (no proof), a hit that stage 1
/// leaves to stage 5. README.md has these and all other questions.
[[nodiscard]] bool proved(const StepData& data, const PairRecord& record);
[[nodiscard]] bool missed(const StepData& data, const PairRecord& record);
[[nodiscard]] bool left(const StepData& data, const PairRecord& record);

/// The distance of the bodies at x^n, m, from the last contact search where that searched the pair; infinite beyond the
/// proximity distance.
double start_distance(const StepData& data, Worker& worker, PairRecord& record);

/// All pairs whose swept bounds come within the separation, or within the proximity distance, sorted.
const std::vector<CandidatePair>& swept_pairs(StepData& data, bool with_proximity);

/// Pairs of an active body with a sleeping one whose swept bounds come within the proximity distance, among others;
/// sorted.
const std::vector<CandidatePair>& waking_pairs(StepData& data);

/// The frozen list of a sweep: pairs of bodies of different clusters whose swept bounds overlap and that have no
/// current proof, sorted. Stage 1 also wants pairs within the proximity distance (`with_proximity`), stage 5 only those
/// within the separation.
///
/// Of most pairs at rest the bounds of both bodies say that the operation would prove them apart and do nothing else.
/// Those get their proof here, side by side; they stay in the list, because an operation before their turn may move one
/// of the bodies.
const std::vector<ListedPair>& freeze(StepData& data, bool with_proximity);

/// Where bounds left few pairs of the list open, most of those have nothing to resolve either. Calls examine(record,
/// worker) for them, side by side, which does what the operation would do at once if that applies no impulse and says
/// whether it did so. An operation before their turn may still move one of the bodies: then the pair is no longer
/// proved, and its turn comes as ever.
template <class Examine>
void prove_early(StepData& data, Examine&& examine) {
    constexpr std::size_t kFew = 8, kGrain = 64; // one pair in so many is open; pairs of a task
    ListBuffers& l = data.lists;
    if (l.num_open == 0 || l.num_open * kFew > l.listed.size()) return;
    std::atomic<std::size_t> examined = 0;
    data.team.for_each("examine", l.listed.size(), kGrain, [&](std::size_t i, int thread) {
        PairRecord& record = *l.listed[i].record;
        if (!proved(data, record) && examine(record, data.worker(thread)))
            examined.fetch_add(1, std::memory_order_relaxed);
    });
    l.num_open -= examined;
}

/// All pairs whose boxes at the end poses come within the proximity distance, or the distance that a body falls in a
/// step, sorted; uses the freeze's buffers.
const std::vector<ListedPair>& end_pairs(StepData& data);

/// Keeps what the contact search found of the pair, for the next step.
void record_distance(const StepData& data, PairRecord& record, const ProximityResult& found, const CoveringList& list);
/// The same where there was no search: the bodies are at most `distance` (m) apart, which is within the proximity
/// distance.
void record_renewed_distance(const StepData& data, PairRecord& record, double distance);

/// Whether bodies that were beyond the proximity distance at x^n still are at the end of the step, by bounds alone.
/// Then there is nothing to search for, and this has recorded it.
[[nodiscard]] bool far_by_bounds(const StepData& data, PairRecord& record);

/// Whether a plane is known to keep the bodies beyond the proximity distance at the end of the step.
[[nodiscard]] bool far_at_end(const StepData& data, const PairRecord& record);
/// Whether there is such a plane, known or found now: then there is nothing to search for, and this has recorded it.
[[nodiscard]] bool far_by_plane(const StepData& data, PairRecord& record);

/// The pair's neighbour list where it covers the present end poses: for queries of the proximity distance at the end of
/// the step. Null otherwise.
[[nodiscard]] CoveringList end_candidates(const StepData& data, const PairRecord& record);

/// The same; where there is no such list one is made if that seems to pay.
[[nodiscard]] CoveringList kept_candidates(const StepData& data, Worker& worker, PairRecord& record);

/// Whether features of the bodies come within the proximity distance at the end of the step.
[[nodiscard]] bool near_at_end(const StepData& data, Worker& worker, const PairRecord& record);

/// Runs the CCD on a pair of bodies and records a proof where there is one.
PairHit query(const StepData& data, Worker& worker, PairRecord& record);

/// The same for stage 1, by the setting `ccd`. What only the cubic takes for a miss is not proved: stage 5 queries it
/// again.
PairHit query_collision(const StepData& data, Worker& worker, PairRecord& record);

/// The earliest hit between two clusters; pairs of members with a current proof are not queried again, nor those whose
/// swept boxes are too far apart for the list of a sweep. What is found of a pair without a record, which operations
/// cannot make, is forgotten: if its boxes stay that near, the next list has it.
struct ClusterHit {
    PairHit hit;
    std::int32_t a = -1, b = -1; ///< bodies, of the first and of the second cluster
};
[[nodiscard]] ClusterHit query_clusters(const StepData& data, Worker& worker, std::int32_t a, std::int32_t b);

/// The contact of a swept hit in terms of the clusters: effective velocity and arms at the time of impact (section
/// 3.2).
struct SweptContact {
    ContactPoint point;
    double start_gap = 0; ///< m, along the normal at t = 0
};
[[nodiscard]] SweptContact swept_contact(const StepData& data, const ClusterHit& hit);

/// Pair friction is the geometric mean, pair restitution the maximum (src/state/README.md).
[[nodiscard]] double pair_friction(const Model& model, std::int32_t a, std::int32_t b);
[[nodiscard]] double pair_restitution(const Model& model, std::int32_t a, std::int32_t b);

/// Applies an impulse to two clusters.
void apply_impulse(const StepData& data, Worker& worker, std::int32_t a, std::int32_t b, const ContactPoint& point,
                   const Vec3& impulse);
/// The same, and re-evolves them.
void push(const StepData& data, Worker& worker, std::int32_t a, std::int32_t b, const ContactPoint& point,
          const Vec3& impulse);

} // namespace flotilla
