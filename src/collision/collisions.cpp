// SPDX-License-Identifier: MIT
#include "collision/collisions.hpp"

#include <algorithm>

#include "pair/ordered_sweep.hpp"
#include "pair/simultaneous_hits.hpp"
#include "parallel/compact.hpp"
#include "response/arc.hpp"

namespace flotilla {
namespace {

constexpr int kActiveSweeps = 8;

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

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

/// Whether some points of two bodies may approach each other faster than `speed` (m/s), by their motions and radii alone.
bool may_approach(const Impulsive& a, const Impulsive& b, double radius_a, double radius_b, double speed) {
    return length(b.velocity - a.velocity) + length(a.angular_velocity) * radius_a +
               length(b.angular_velocity) * radius_b >
           speed * (1 - 0x1p-20); // far more than the rounding of either side
}

/// m/s: what approaches slower is left to static contact. Without gravity that is what brings the bodies no nearer in a step than static
/// contact leaves undone (Settings::static_tolerance), or bodies that slide in a joint would hit each other at the speed of rounding.
double least_approach(const StepData& data, const PairRecord& record) {
    constexpr double kOfRest = 1.0 / 1024;
    if (data.model.settings.approach_threshold >= 0) return data.approach;
    return std::max(data.approach, kOfRest * record.lengths.rest / data.dt);
}

/// The nearest contact point at the end of the step that approaches too fast to be left to static contact, with rigid
/// velocities and arms at the end (section 3.2). Closer than the rest distance that is faster than the threshold. Farther away,
/// up to the proximity distance, it is also fast enough to come below the rest distance within one more step: stage 7 would cut
/// exactly these approaches to (d_rest - d)/dt, and a fast body that happens to end a step there would lose its rebound. Of a point on its
/// way down an arc (arc.hpp) the speed counts with which it arrives: those ahead of the contact of a wheel come down fast, and a wheel
/// that sinks by the little that a facet makes it sink would collide with the ground at all of them.
std::optional<ContactPoint> end_proximity(const StepData& data, Worker& worker, PairRecord& record) {
    const BodyMotion a = data.trajectories.at_end(at(record.a)), b = data.trajectories.at_end(at(record.b));
    const Impulsive body_a = data.clusters.impulsive(record.a), body_b = data.clusters.impulsive(record.b);
    if (!may_approach(body_a, body_b, a.shape->radius, b.shape->radius, data.approach)) {
        record.processed = record.processed || near_at_end(data, worker, record);
        return std::nullopt;
    }
    const Stopwatch watch(worker.counters.detection_ms);
    const CoveringList list = end_candidates(data, record);
    record.processed = find_proximities(a, b, record.lengths.proximity, data.angle_cos, list, worker.proximity).near ||
                       record.processed;
    worker.points.clear();
    const double least = least_approach(data, record);
    const auto contact = [&](const ProximityPoint& p) {
        const Vec3 arm_a = p.a - a.at1.pose->com, arm_b = p.b - b.at1.pose->com;
        const Vec3 relative = point_velocity(body_b, arm_b) - point_velocity(body_a, arm_a);
        return ContactPoint{p.normal, arm_a, arm_b, relative, pair_friction(data.model, record.a, record.b)};
    };
    for (const ProximityPoint& p : worker.proximity.found) {
        const ContactPoint c = contact(p);
        const double approach = -dot(c.relative_velocity, p.normal);
        const double gap = p.distance - record.lengths.rest;
        if (!(approach > std::max(least, gap / data.dt))) continue;
        const double apart = dot(p.normal, arc_acceleration(body_b.angular_velocity, c.arm_b) -
                                               arc_acceleration(body_a.angular_velocity, c.arm_a));
        if (approach_on_arrival(approach, gap, apart) > least) worker.points.push_back(p);
    }
    std::stable_sort(worker.points.begin(), worker.points.end(),
                     [](const ProximityPoint& p, const ProximityPoint& q) { return p.distance < q.distance; });
    for (const ProximityPoint& p : worker.points)
        if (admissible(a, b, p, data.angle_cos, worker.proximity)) return contact(p);
    return std::nullopt;
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

/// The contact of a swept hit with rigid velocities where these approach as well. Effective ones, of straight paths, are what makes sure
/// that it does (section 3.2), but a rebound at their speed takes energy where they are slower than the bodies, and gives none where
/// they are faster, for that is cut: 27 cubes in a box lose 6 % in 4 s at 1/240 s.
ContactPoint rebounding(const StepData& data, const CandidatePair& pair, ContactPoint point) {
    const Vec3 rigid = point_velocity(data.clusters.impulsive(pair.b), point.arm_b) -
                       point_velocity(data.clusters.impulsive(pair.a), point.arm_a);
    if (dot(rigid, point.normal) < 0) point.relative_velocity = rigid;
    return point;
}

/// Applies what the manifold changes.
void push_all(const StepData& data, Worker& worker, const CandidatePair& pair) {
    const Stopwatch watch(worker.counters.response_ms);
    for (const PairManifold::Change& c : worker.changes)
        apply_impulse(data, worker, pair.a, pair.b, c.point, c.impulse);
    data.clusters.evolve(pair.a, data.dt, data.trajectories);
    data.clusters.evolve(pair.b, data.dt, data.trajectories);
}

/// Resolves the hits of one pair in consecutive order, then its fast end proximities.
void collide(const StepData& data, Worker& worker, const ListedPair& listed) {
    PairRecord& record = *listed.record;
    const CandidatePair& pair = listed.pair;
    ++worker.counters.pairs;
    if (record.assumed) record.assumed = record.processed = false; // of an end state that is no more
    const double restitution = pair_restitution(data.model, pair.a, pair.b);
    worker.manifold.start(data.clusters.impulsive(pair.a), data.clusters.impulsive(pair.b));
    for (int i = 0; i < data.model.settings.collision_pair_iterations; ++i) {
        const PairHit hit = query_collision(data, worker, record);
        std::optional<ContactPoint> point;
        worker.hits.clear();
        if (hit.hit) {
            record.processed = true;
            point = rebounding(data, pair, swept_contact(data, {hit, pair.a, pair.b}).point);
            worker.hits.push_back(*point);
            find_simultaneous_hits(data, worker, {hit, pair.a, pair.b}, *point, record.lengths.rest, worker.hits);
        } else {
            point = end_proximity(data, worker, record);
            if (!point) return;
            worker.hits.push_back(*point);
            find_simultaneous_hits(data, worker, {PairHit{}, pair.a, pair.b}, *point, record.lengths.rest, worker.hits);
        }
        const bool alone = worker.manifold.empty() && worker.hits.size() == 1;
        if (!alone && worker.manifold.resolve(worker.hits, restitution, worker.changes)) {
            record.active = true;
            push_all(data, worker, pair);
            continue;
        }
        const auto impulse = elastic_impulse(data, pair, *point);
        if (!impulse) { // a separating hit, or one that only energy could resolve: stage 5 takes it
            record.left_a = data.trajectories.version(at(pair.a));
            record.left_b = data.trajectories.version(at(pair.b));
            ++worker.counters.left;
            return;
        }
        record.active = true;
        worker.manifold.add(*point, restitution, *impulse);
        push(data, worker, pair.a, pair.b, *point, *impulse);
    }
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

/// Runs the stale pairs of a list, `rounds` times or until none is left; odd sweeps go backwards. Returns the number of sweeps
/// that found any.
int sweep(StepData& data, const std::vector<ListedPair>& list, int rounds, StageCounters& counters) {
    const auto current = [&](std::size_t i) {
        const PairRecord& r = *list[i].record;
        return proved(data, r) || missed(data, r) || left(data, r);
    };
    const auto fetch = [&](std::size_t i) { fetch_record(*list[i].record); };
    const auto count = static_cast<std::size_t>(rounds);
    for (const auto& worker : data.workers) worker->work.assign(count, 0);
    const auto pair_of = [&](std::size_t i) { return list[i].pair; };
    run_in_order(data, "collide", {order_by_color(data, list.size(), pair_of), counters.sweeps % 2 != 0, rounds},
                 current, fetch, [&](std::size_t i, int round, Worker& worker) {
                     collide(data, worker, list[i]);
                     ++worker.work[static_cast<std::size_t>(round)];
                 });
    collect(data, counters);
    int sweeps = 0;
    for (std::size_t r = 0; r < count; ++r)
        sweeps += std::any_of(data.workers.begin(), data.workers.end(), [&](const auto& w) { return w->work[r] > 0; });
    counters.sweeps += sweeps;
    return sweeps;
}

} // namespace

StageCounters handle_collisions(StepData& data) {
    StageCounters counters;
    std::vector<ListedPair>& active = data.lists.active;
    active.clear();
    const int limit = data.model.settings.collision_iterations;
    const auto left = [&] { return limit - static_cast<int>(counters.sweeps); };
    while (left() > 0) {
        const std::vector<ListedPair>& list = freeze(data, true);
        if (data.savings.calm_pairs)
            prove_early(data, [&](PairRecord& record, Worker& worker) { return examine(data, worker, record); });
        const std::size_t proved_early = list.size() - data.lists.num_open;
        counters.pairs += static_cast<std::int64_t>(proved_early);
        if (data.lists.num_open == 0 || sweep(data, list, 1, counters) == 0) {
            // What was known of pairs, a cache, must not decide how many sweeps count: proving pairs in turn would have been one.
            if (proved_early > 0) ++counters.sweeps;
            counters.limit = left() <= 0;
            return counters;
        }
        merge_active(data, list, active);
        if (left() > 0) sweep(data, active, std::min(kActiveSweeps, left()), counters);
    }
    counters.limit = true;
    return counters;
}

} // namespace flotilla
