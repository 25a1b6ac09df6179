// SPDX-License-Identifier: MIT
#include "dynamic_contact/resolve_together.hpp"

#include <algorithm>
#include <atomic>

#include "base/index.hpp"
#include "pair/cluster_query.hpp"
#include "pair/examine.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kPairGrain = 16; // pairs of a task

/// Of an island. Cups in each other hit at more and more points until they stay: twelve at more than 128.
constexpr std::ptrdiff_t kMostHits = 512;

/// Of bodies that are not left, the first hit of each pair, in the order of the pairs.
struct Found {
    std::vector<ClusterHit> hits;
    bool passed_over = false; ///< a pair of bodies that are left may hit
};

Found look(const StepView& view, PairBook& book, Workers& workers, const JointHits& joint, StageCounters& counters) {
    ClusterPairs clusters;
    const FrozenList frozen = freeze_clusters(view, book, workers.team, clusters);
    std::vector<ClusterHit> hits(clusters.pairs.size());
    std::atomic<bool> passed_over = false;
    workers.team.for_each("look for hits", hits.size(), kPairGrain, [&](std::size_t i, int thread) {
        const CandidatePair& pair = clusters.pairs[i];
        if (apart(view.trajectories, *frozen.pairs[i].record)) return;
        if (joint.is_left(pair.a) || joint.is_left(pair.b)) {
            passed_over.store(true, std::memory_order_relaxed);
            return;
        }
        Worker& worker = workers[thread];
        ++worker.counters.pairs;
        hits[i] = query_clusters(view, book.table, worker, pair.a, pair.b);
    });
    collect(workers, counters);
    std::erase_if(hits, [](const ClusterHit& hit) { return !hit.hit.hit; });
    return {hits, passed_over};
}

/// In terms of the bodies' velocities: its points go on chords, and are seen from where the bodies are then.
MetHit met_hit(const StepView& view, const ClusterHit& found, int tries, int most) {
    const Impulsive a = view.clusters.impulsive(found.a), b = view.clusters.impulsive(found.b);
    const SweptContact swept = swept_contact(view, found);
    const PairLengths lengths = pair_lengths(view.model, view.state, found.a, found.b);
    const Vec3& n = swept.point.normal;
    const HitAnswer answer = answer_to(view.dt, swept, dot(n, b.velocity - a.velocity), lengths, tries, most);
    MetHit out;
    if (!answer.on_centres && !turns_far(a.angular_velocity, view.dt)) out.arm_a = swept.point.arm_a;
    if (!answer.on_centres && !turns_far(b.angular_velocity, view.dt)) out.arm_b = swept.point.arm_b;
    const Vec3 chords = swept.point.relative_velocity - (point_velocity(b, out.arm_b) - point_velocity(a, out.arm_a));
    Contact& c = out.contact;
    c.a = found.a, c.b = found.b;
    c.normal = n;
    c.distance = swept.start_gap;
    c.target = answer.target - dot(n, chords);
    c.slip = dot(n, chords) * n - chords;
    c.friction = swept.point.friction;
    c.feature_key = static_cast<std::uint64_t>(tries);
    c.tolerance = kUndoneTogether * lengths.rest / view.dt;
    return out;
}

bool stays(const StepView& view, const ClusterHit& found) {
    return found.hit.by_turn && turns_stay(view.clusters.impulsive(found.a), view.clusters.impulsive(found.b), view.dt);
}

} // namespace

bool resolve_together(const StepView& view, Movers movers, PairBook& book, Workers& workers, JointSolve& joint_solve,
                      StageCounters& counters) {
    JointHits joint(view, movers, workers, joint_solve, kMostHits, counters);
    const int most = std::min(view.model.settings.dynamic_pair_iterations, kMostRoundsTogether);
    for (int round = 0;; ++round) {
        const Found found = look(view, book, workers, joint, counters);
        if (found.hits.empty()) return !found.passed_over;
        // Left are bodies of a pair that has had all its tries, and in the last rounds those of all pairs.
        for (const ClusterHit& hit : found.hits) {
            const int tries = joint.tries(hit.a, hit.b);
            if (round >= kMostRoundsTogether || tries >= most || stays(view, hit))
                joint.leave(hit.a, hit.b);
            else
                joint.add(met_hit(view, hit, tries, most));
        }
        joint.solve();
    }
}

} // namespace flotilla
