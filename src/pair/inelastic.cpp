// SPDX-License-Identifier: MIT
#include "pair/inelastic.hpp"

#include <algorithm>

namespace flotilla {
namespace {

// The exact-rest target may lie below the present velocity when the bodies turn: the hit would stay. Then the approach is
// halved, later stopped, and if the points do not even approach they are pushed apart at this many separations per step.
constexpr double kPushSeparations = 4;

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
        if (!out.found) out.first_a = hit.a, out.first_b = hit.b;
        out.found = true;
        if (i == iterations) return out;
        const SweptContact contact = swept_contact(data, hit);
        const PairLengths lengths = pair_lengths(data.model, data.state, hit.a, hit.b);
        const std::int32_t ca = data.clusters.of(static_cast<std::size_t>(hit.a));
        const std::int32_t cb = data.clusters.of(static_cast<std::size_t>(hit.b));
        const auto impulse = contact_impulse(data.clusters.impulsive(ca), data.clusters.impulsive(cb), contact.point,
                                             inelastic_target(data, contact, lengths, i, iterations));
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
