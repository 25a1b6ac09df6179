// SPDX-License-Identifier: MIT
#include "collision/collisions.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "collision/pair_hits.hpp"
#include "pair/ordered_sweep.hpp"
#include "pair/progress.hpp"
#include "parallel/compact.hpp"

namespace flotilla {
namespace {

constexpr int kActiveSweeps = 8;

/// The impulse of a contact with restitution, cut so that no energy is gained; nothing where it would do nothing.
std::optional<Vec3> elastic_impulse(const StepData& data, const CandidatePair& pair, const ContactPoint& point) {
    const double vn = dot(point.normal, point.relative_velocity);
    if (!(vn < 0)) return std::nullopt;
    const Impulsive a = data.clusters.impulsive(pair.a), b = data.clusters.impulsive(pair.b);
    const auto impulse = contact_impulse(a, b, point, -pair_restitution(data.model, pair.a, pair.b) * vn);
    if (!impulse) return std::nullopt;
    const double share = energy_clamp(a, b, point.arm_a, point.arm_b, *impulse);
    if (!(share > 0)) return std::nullopt;
    return share * *impulse;
}

/// What collide() would do, if that applies no impulse; nothing otherwise.
bool examine(const StepData& data, Worker& worker, PairRecord& record) {
    if (missed(data, record) || left(data, record)) return false;
    const bool processed = record.processed;
    if (!query_collision(data, worker, record).hit && !end_proximity(data, worker, record)) {
        record.assumed = record.processed && !processed;
        return true;
    }
    record.processed = processed;
    record.proved_a = record.proved_b = record.missed_a = record.missed_b = 0; // no version has that number
    return false;
}

/// Applies what the manifold changes.
void push_all(const StepData& data, Worker& worker, const CandidatePair& pair) {
    const Stopwatch watch(worker.counters.response_ms);
    for (const PairManifold::Change& c : worker.changes)
        apply_impulse(data, worker, pair.a, pair.b, c.point, c.impulse);
    data.clusters.evolve(pair.a, data.dt, data.trajectories);
    data.clusters.evolve(pair.b, data.dt, data.trajectories);
}

/// Resolves the hits of one pair in consecutive order, then its fast end proximities. Whether it applied an impulse.
bool collide(const StepData& data, Worker& worker, const ListedPair& listed) {
    PairRecord& record = *listed.record;
    const CandidatePair& pair = listed.pair;
    ++worker.counters.pairs;
    if (record.assumed) record.assumed = record.processed = false; // of an end state that is no more
    const double restitution = pair_restitution(data.model, pair.a, pair.b);
    worker.manifold.start(data.clusters.impulsive(pair.a), data.clusters.impulsive(pair.b));
    for (int i = 0; i < data.model.settings.collision_pair_iterations; ++i) {
        if (!find_hits(data, worker, record)) return i > 0;
        const ContactPoint point = worker.hits[0];
        const bool alone = worker.manifold.empty() && worker.hits.size() == 1;
        if (!alone && worker.manifold.resolve(worker.hits, restitution, worker.changes)) {
            record.active = true;
            push_all(data, worker, pair);
            continue;
        }
        const auto impulse = elastic_impulse(data, pair, point);
        if (!impulse) { // a separating hit, or one that only energy could resolve: stage 5 takes it
            record.left_a = data.trajectories.version(at(pair.a));
            record.left_b = data.trajectories.version(at(pair.b));
            ++worker.counters.left;
            return i > 0;
        }
        record.active = true;
        worker.manifold.add(point, restitution, *impulse);
        push(data, worker, pair.a, pair.b, point, *impulse);
    }
    return data.model.settings.collision_pair_iterations > 0;
}

/// Adds the pairs of a list that had an impulse in this step to those of earlier lists, sorted.
void merge_active(StepData& data, const std::vector<ListedPair>& list, std::vector<ListedPair>& active) {
    constexpr std::size_t kGrain = 512;
    const std::size_t before = active.size();
    const auto kept = [&](std::size_t i) { return list[i].record->active; };
    const auto item = [&](std::size_t i) { return list[i]; };
    compact_if({&data.team, "active pairs", kGrain, data.lists.chunk_places}, list.size(), kept, active, before, item);
    const auto middle = static_cast<std::ptrdiff_t>(before);
    std::inplace_merge(active.begin(), active.begin() + middle, active.end());
    active.erase(std::unique(active.begin(), active.end()), active.end());
}

/// Runs the stale pairs of a list, `rounds` times or until none is left; odd sweeps go backwards. Returns the number of
/// sweeps that found any, and in `hitting` how many pairs hit in each of them.
std::size_t sweep(StepData& data, const std::vector<ListedPair>& list, int rounds, StageCounters& counters,
                  std::vector<std::size_t>& hitting) {
    const auto current = [&](std::size_t i) {
        const PairRecord& r = *list[i].record;
        return proved(data, r) || missed(data, r) || left(data, r);
    };
    const auto fetch = [&](std::size_t i) { fetch_record(*list[i].record); };
    const auto count = static_cast<std::size_t>(rounds);
    for (const auto& worker : data.workers) {
        worker->work.assign(count, 0);
        worker->hitting.assign(count, 0);
    }
    const auto pair_of = [&](std::size_t i) { return list[i].pair; };
    run_in_order(data, "collide", {order_by_color(data, list.size(), pair_of), counters.sweeps % 2 != 0, rounds},
                 current, fetch, [&](std::size_t i, int round, Worker& worker) {
                     if (collide(data, worker, list[i])) ++worker.hitting[at(round)];
                     ++worker.work[at(round)];
                 });
    collect(data, counters);
    hitting.clear();
    for (std::size_t r = 0; r < count; ++r) {
        if (std::none_of(data.workers.begin(), data.workers.end(), [&](const auto& w) { return w->work[r] > 0; }))
            continue;
        hitting.push_back(0);
        for (const auto& worker : data.workers) hitting.back() += worker->hitting[r];
    }
    counters.sweeps += static_cast<std::int64_t>(hitting.size());
    return hitting.size();
}

} // namespace

StageCounters handle_collisions(StepData& data, const KnownContacts& known, HitLists& lists) {
    if (data.model.settings.collisions == Collisions::accumulated) return accumulate_collisions(data, known, lists);
    StageCounters counters;
    std::vector<ListedPair>& active = data.lists.active;
    active.clear();
    const int limit = data.model.settings.collision_iterations;
    const auto left = [&] { return limit - static_cast<int>(counters.sweeps); };
    Progress progress;
    std::vector<std::size_t> hitting;
    const auto add_sweeps = [&] {
        for (const std::size_t pairs : hitting) progress.add(pairs, active.size());
    };
    while (left() > 0 && !progress.stalled()) {
        const std::vector<ListedPair>& list = freeze(data, true);
        if (data.savings.calm_pairs)
            prove_early(data, [&](PairRecord& record, Worker& worker) { return examine(data, worker, record); });
        const std::size_t proved_early = list.size() - data.lists.num_open;
        counters.pairs += static_cast<std::int64_t>(proved_early);
        if (data.lists.num_open == 0 || sweep(data, list, 1, counters, hitting) == 0) {
            // What was known of pairs, a cache, must not decide how many sweeps count: proving pairs in turn would have
            // been one.
            if (proved_early > 0) ++counters.sweeps;
            counters.limit = left() <= 0;
            return counters;
        }
        merge_active(data, list, active);
        add_sweeps();
        if (left() <= 0) break;
        sweep(data, active, std::min(kActiveSweeps, left()), counters, hitting);
        add_sweeps();
    }
    counters.limit = true;
    return counters;
}

} // namespace flotilla
