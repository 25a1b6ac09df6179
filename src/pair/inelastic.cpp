// SPDX-License-Identifier: MIT
#include "pair/inelastic.hpp"

#include <algorithm>

namespace flotilla {
namespace {

// The exact-rest target may lie below the present velocity when the bodies turn: the hit would stay. Then the approach
// is halved, later stopped, and if the points do not even approach they are pushed apart at this many separations per
// step.
constexpr double kPushSeparations = 4;

// A contact's impulse turns a body by dt I^-1 (r x l), and its point then moves by that turn times r: as long as the
// turn is small. A thin body that is hit on an edge would turn many times instead, its point would be anywhere, and the
// next impulse would push again. Beyond this angle an impulse acts on the centre of mass alone, which moves the point
// by just as much as is asked for.
constexpr double kLargestTurn = 1; // radians

bool turns_far(const Vec3& angular_velocity, double dt) {
    return length_sq(angular_velocity) * dt * dt > kLargestTurn * kLargestTurn;
}

/// The impulse for the target; sets the arms of bodies that it, or their own spin, would turn too far to zero.
std::optional<Vec3> displacing_impulse(const Impulsive& a, const Impulsive& b, double dt, double target,
                                       ContactPoint& point) {
    auto impulse = contact_impulse(a, b, point, target);
    if (!impulse) return impulse;
    const auto turned_far = [&](const Impulsive& body, const Vec3& arm) {
        if (!(body.inverse_mass > 0)) return false;
        return turns_far(body.angular_velocity, dt) || turns_far(body.inverse_inertia * cross(arm, *impulse), dt);
    };
    const bool far_a = turned_far(a, point.arm_a), far_b = turned_far(b, point.arm_b);
    if (!far_a && !far_b) return impulse;
    if (far_a) point.arm_a = {};
    if (far_b) point.arm_b = {};
    return contact_impulse(a, b, point, target);
}

/// Whether displacing impulses leave the turns of both bodies as they are, however many they are: then a hit by turn
/// stays.
bool turns_stay(const Impulsive& a, const Impulsive& b, double dt) {
    const auto stays = [&](const Impulsive& body) {
        return !(body.inverse_mass > 0) || turns_far(body.angular_velocity, dt);
    };
    return stays(a) && stays(b);
}

double inelastic_target(const StepData& data, const SweptContact& contact, const PairLengths& lengths, int iteration,
                        int iterations) {
    const double vn = dot(contact.point.normal, contact.point.relative_velocity);
    const double exact = (lengths.rest - contact.start_gap) / data.dt;
    if (exact > vn && iteration < iterations / 2) return exact;
    if (vn < 0 && exact <= vn && iteration < iterations / 4) return 0.5 * vn;
    return std::max({exact, 0.0, vn + kPushSeparations * lengths.separation / data.dt});
}

} // namespace

Resolution resolve_inelastic(const StepData& data, Worker& worker, std::int32_t a, std::int32_t b, int iterations) {
    Resolution out;
    for (int i = 0;; ++i) {
        const ClusterHit hit = query_clusters(data, worker, a, b);
        if (!hit.hit.hit) {
            out.resolved = true;
            return out;
        }
        if (!out.found) out.first_a = hit.a, out.first_b = hit.b, out.toi = hit.hit.toi;
        out.found = true;
        if (i == iterations) return out;
        const std::int32_t ca = data.clusters.of(static_cast<std::size_t>(hit.a));
        const std::int32_t cb = data.clusters.of(static_cast<std::size_t>(hit.b));
        const Impulsive body_a = data.clusters.impulsive(ca), body_b = data.clusters.impulsive(cb);
        if (hit.hit.by_turn && turns_stay(body_a, body_b, data.dt)) return out;
        SweptContact contact = swept_contact(data, hit);
        const PairLengths lengths = pair_lengths(data.model, data.state, hit.a, hit.b);
        const double target = inelastic_target(data, contact, lengths, i, iterations);
        const auto impulse = displacing_impulse(body_a, body_b, data.dt, target, contact.point);
        if (!impulse) return out;
        push(data, worker, ca, cb, contact.point, *impulse);
    }
}

const std::vector<CandidatePair>& freeze_clusters(StepData& data, std::vector<CandidatePair>& list) {
    list.clear();
    for (const ListedPair& p : freeze(data, false)) {
        const std::int32_t a = data.clusters.of(static_cast<std::size_t>(p.pair.a));
        const std::int32_t b = data.clusters.of(static_cast<std::size_t>(p.pair.b));
        list.push_back({std::min(a, b), std::max(a, b)});
    }
    if (!std::is_sorted(list.begin(), list.end()))
        std::sort(list.begin(), list.end()); // sorted where no clusters were merged
    list.erase(std::unique(list.begin(), list.end()), list.end());
    return list;
}

} // namespace flotilla
