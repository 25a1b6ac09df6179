// SPDX-License-Identifier: MIT
#include "collision/collisions.hpp"

#include <algorithm>

namespace flotilla {
namespace {

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

/// The nearest contact point at the end of the step that approaches too fast to be left to static contact, with rigid
/// velocities and arms at the end (section 3.2). Closer than the rest distance that is faster than the threshold. Farther away,
/// up to the proximity distance, it is also fast enough to come below the rest distance within one more step: stage 7 would cut
/// exactly these approaches to (d_rest - d)/dt, and a fast body that happens to end a step there would lose its rebound.
std::optional<ContactPoint> end_proximity(StepData& data, const CandidatePair& pair, PairRecord& record,
                                          StageCounters& counters) {
    const Stopwatch watch(counters.detection_ms);
    const auto &a = pair.a, &b = pair.b;
    data.points.clear();
    const auto result = find_contact_points(data.trajectories.at_end(at(a)), data.trajectories.at_end(at(b)),
                                            record.lengths.proximity, data.angle_cos, data.proximity, data.points);
    record.processed = record.processed || result.near;
    const Impulsive body_a = data.clusters.impulsive(a), body_b = data.clusters.impulsive(b);
    std::optional<ContactPoint> best;
    double best_distance = record.lengths.proximity;
    for (const ProximityPoint& p : data.points) {
        if (!(p.distance < best_distance)) continue;
        const Vec3 arm_a = p.a - data.trajectories.end_pose(at(a)).com,
                   arm_b = p.b - data.trajectories.end_pose(at(b)).com;
        const Vec3 relative = point_velocity(body_b, arm_b) - point_velocity(body_a, arm_a);
        const double allowed = std::max(data.approach, (p.distance - record.lengths.rest) / data.dt);
        if (!(dot(relative, p.normal) < -allowed)) continue;
        best = ContactPoint{p.normal, arm_a, arm_b, relative, pair_friction(data.model, a, b)};
        best_distance = p.distance;
    }
    return best;
}

/// Resolves the hits of one pair in consecutive order, then its fast end proximities.
void collide(StepData& data, const CandidatePair& pair, StageCounters& counters) {
    PairRecord& record = data.pairs.get(data.model, data.state, pair.a, pair.b);
    ++counters.pairs;
    for (int i = 0; i < data.model.settings.collision_pair_iterations; ++i) {
        const PairHit hit = query(data, pair.a, pair.b, counters);
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
        push(data, pair.a, pair.b, *point, *impulse, counters);
    }
}

} // namespace

StageCounters handle_collisions(StepData& data) {
    StageCounters counters;
    for (int sweep = 0; sweep < data.model.settings.collision_iterations; ++sweep) {
        const auto list = freeze(data, true); // a copy: operations use the buffers of the next freeze
        std::int64_t work = 0;
        const auto run = [&](const CandidatePair& pair) {
            if (proved(data, pair.a, pair.b) || left(data, pair.a, pair.b)) return;
            collide(data, pair, counters);
            ++work;
        };
        if (sweep % 2 == 0)
            for (std::size_t i = 0; i < list.size(); ++i) run(list[i]);
        else
            for (std::size_t i = list.size(); i-- > 0;) run(list[i]);
        if (work == 0) return counters;
        ++counters.sweeps;
    }
    counters.limit = true;
    return counters;
}

} // namespace flotilla
