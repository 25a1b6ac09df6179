// SPDX-License-Identifier: MIT
// The threads of a step: what each of them has to itself, and what the stages count.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "ccd/pair_query.hpp"
#include "pair/footprint.hpp"
#include "pair/pair_table.hpp"
#include "parallel/team.hpp"
#include "proximity/contact_points.hpp"
#include "response/pair_manifold.hpp"

namespace flotilla {

struct StageCounters {
    std::int64_t sweeps = 0;
    std::int64_t pairs = 0; ///< operations run
    std::int64_t impulses = 0;
    std::int64_t settled = 0;                 ///< pairs that hit and have no impulse: stage 5's
    double detection_ms = 0, response_ms = 0; ///< of all threads together
    bool limit = false;                       ///< ended by its iteration limit
    bool rebound_lost = false;                ///< of hits that have a restitution (collide_together)
};

/// How a pair of points comes to meet, along their normal.
struct Landing {
    Vec3 normal;         ///< unit, from a to b
    double approach = 0; ///< m/s, > 0, of what rebounds
    bool parts = false;  ///< nothing rebounds: the velocities part already, but some of them is late (Cluster::late)
    double way = 0;      ///< m/s, > 0, how fast they come nearer on their way in this step
    double gap = 0;      ///< m, at the start of the step, above the rest distance
    PairLengths lengths{};
    double time = 1; ///< [0, 1], share of the step after which they meet
};

/// A hit that a round over the pairs found (collision/accumulated.hpp).
struct FoundHit {
    PairRecord* record = nullptr;
    ContactPoint point{};
    std::optional<Landing> landing{};
    bool within = false; ///< Worker::first_within
};

/// What one thread has to itself.
struct alignas(64) Worker {
    CcdScratch ccd;
    ProximityScratch proximity;
    std::vector<ProximityPoint> points;
    std::vector<FeaturePair> features;
    PairManifold manifold; ///< of the operation under way
    std::vector<PairManifold::Change> changes;
    std::vector<ContactPoint> hits;        ///< at one time
    bool first_within = false;             ///< the first of them is within what the others span
    std::optional<Landing> landing{};      ///< of the first of them
    std::array<Footprint, 2> footprints{}; ///< of two bodies that hit
    std::vector<std::int32_t> grounds;     ///< on which one of them may land as well
    std::vector<FoundHit> found;
    StageCounters counters;
    std::vector<std::int64_t> work;    ///< operations run, by round of a sweep
    std::vector<std::size_t> hitting;  ///< of these, those that applied an impulse
    std::vector<double> hardest;       ///< N s, the largest impulse of these
    double largest_push = 0;           ///< N s, since it was last taken
    std::vector<CandidatePair> pushed; ///< clusters that had an impulse in the step; equal ones may come again
};

/// Those who run what a stage runs side by side.
struct Workers {
    Team team;
    std::vector<Worker> each; ///< by thread

    explicit Workers(const TeamOptions& options) : team(options), each(static_cast<std::size_t>(team.size())) {}
    [[nodiscard]] Worker& operator[](int thread) { return each[static_cast<std::size_t>(thread)]; }
};

/// N s, the largest impulse that these applied since it was last taken. A maximum: that of several threads does not
/// depend on who applied which.
double take_largest_push(Worker& worker);
double take_largest_push(Workers& workers);

/// Adds what all workers counted to `counters` and sets theirs to zero.
void collect(Workers& workers, StageCounters& counters);

} // namespace flotilla
