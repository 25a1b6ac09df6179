// SPDX-License-Identifier: MIT
#include "collision/collisions.hpp"

#include <algorithm>

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

/// The nearest contact point at the end of the step that approaches too fast to be left to static contact, with rigid
/// velocities and arms at the end (section 3.2). Closer than the rest distance that is faster than the threshold. Farther away,
/// up to the proximity distance, it is also fast enough to come below the rest distance within one more step: stage 7 would cut
/// exactly these approaches to (d_rest - d)/dt, and a fast body that happens to end a step there would lose its rebound.
std::optional<ContactPoint> end_proximity(StepData& data, const CandidatePair& pair, PairRecord& record,
                                          StageCounters& counters) {
    const Stopwatch watch(counters.detection_ms);
    const BodyMotion a = data.trajectories.at_end(at(pair.a)), b = data.trajectories.at_end(at(pair.b));
    const Impulsive body_a = data.clusters.impulsive(pair.a), body_b = data.clusters.impulsive(pair.b);
    const CandidateList* list = end_candidates(data, record);
    const double reach = record.lengths.proximity;
    if (!may_approach(body_a, body_b, a.shape->radius, b.shape->radius, data.approach)) {
        record.processed = record.processed || any_proximity(a, b, reach, list, data.proximity);
        return std::nullopt;
    }
    record.processed = find_proximities(a, b, reach, data.angle_cos, list, data.proximity).near || record.processed;
    data.points.clear();
    const auto contact = [&](const ProximityPoint& p) {
        const Vec3 arm_a = p.a - a.at1.pose->com, arm_b = p.b - b.at1.pose->com;
        const Vec3 relative = point_velocity(body_b, arm_b) - point_velocity(body_a, arm_a);
        return ContactPoint{p.normal, arm_a, arm_b, relative, pair_friction(data.model, pair.a, pair.b)};
    };
    for (const ProximityPoint& p : data.proximity.found) {
        const double allowed = std::max(data.approach, (p.distance - record.lengths.rest) / data.dt);
        if (dot(contact(p).relative_velocity, p.normal) < -allowed) data.points.push_back(p);
    }
    std::stable_sort(data.points.begin(), data.points.end(),
                     [](const ProximityPoint& p, const ProximityPoint& q) { return p.distance < q.distance; });
    for (const ProximityPoint& p : data.points)
        if (admissible(a, b, p, data.angle_cos, data.proximity)) return contact(p);
    return std::nullopt;
}

/// Resolves the hits of one pair in consecutive order, then its fast end proximities.
void collide(StepData& data, const CandidatePair& pair, StageCounters& counters) {
    PairRecord& record = data.pairs.get(data.model, data.state, pair.a, pair.b);
    ++counters.pairs;
    for (int i = 0; i < data.model.settings.collision_pair_iterations; ++i) {
        const PairHit hit = query_collision(data, pair.a, pair.b, counters);
        std::optional<ContactPoint> point;
        if (hit.hit) {
            record.processed = true;
            point = swept_contact(data, {hit, pair.a, pair.b}).point;
        } else {
            point = end_proximity(data, pair, record, counters);
            if (!point) return;
        }
        const auto impulse = elastic_impulse(data, pair, *point);
        if (!impulse) { // a separating hit, or one that only energy could resolve: stage 5 takes it
            record.left_a = data.trajectories.version(at(pair.a));
            record.left_b = data.trajectories.version(at(pair.b));
            ++counters.left;
            return;
        }
        record.active = true;
        push(data, pair.a, pair.b, *point, *impulse, counters);
    }
}

/// Adds the pairs of a list that had an impulse in this step to those of earlier lists, sorted.
void merge_active(const StepData& data, const std::vector<CandidatePair>& list, std::vector<CandidatePair>& active) {
    for (const CandidatePair& p : list)
        if (data.pairs.find(p.a, p.b)->active) active.push_back(p);
    std::sort(active.begin(), active.end());
    active.erase(std::unique(active.begin(), active.end()), active.end());
}

/// Runs the stale pairs of a frozen list in order, backwards in odd sweeps. Returns how many there were.
std::int64_t sweep(StepData& data, const std::vector<CandidatePair>& list, StageCounters& counters) {
    std::int64_t work = 0;
    const auto run = [&](const CandidatePair& pair) {
        if (proved(data, pair.a, pair.b) || missed(data, pair.a, pair.b) || left(data, pair.a, pair.b)) return;
        collide(data, pair, counters);
        ++work;
    };
    if (counters.sweeps % 2 == 0)
        for (std::size_t i = 0; i < list.size(); ++i) run(list[i]);
    else
        for (std::size_t i = list.size(); i-- > 0;) run(list[i]);
    counters.sweeps += work > 0 ? 1 : 0;
    return work;
}

} // namespace

StageCounters handle_collisions(StepData& data) {
    StageCounters counters;
    std::vector<CandidatePair> list, active;
    const int limit = data.model.settings.collision_iterations;
    while (counters.sweeps < limit) {
        list = freeze(data, true); // a copy: operations use the buffers of the next freeze
        if (sweep(data, list, counters) == 0) return counters;
        merge_active(data, list, active);
        for (int i = 0; i < kActiveSweeps && counters.sweeps < limit; ++i)
            if (sweep(data, active, counters) == 0) break;
    }
    counters.limit = true;
    return counters;
}

} // namespace flotilla
