// SPDX-License-Identifier: MIT
#include "dynamic_contact/dynamic_contact.hpp"

namespace flotilla {
namespace {

struct Request {
    std::int32_t a, b;           ///< clusters
    std::int32_t body_a, body_b; ///< of the hit that was left
};

/// Rigidifies the pairs that were left, in list order; of requests that meet a cluster already taken the first counts.
void close(StepData& data, const std::vector<Request>& requests, DynamicContactStats& stats) {
    for (const Request& r : requests) {
        if (data.clusters[r.a].members.empty() || data.clusters[r.b].members.empty()) continue;
        if (data.clusters[r.a].infinite() || data.clusters[r.b].infinite()) continue;
        if (stats.merges++ == 0) stats.trigger_a = r.body_a, stats.trigger_b = r.body_b;
        const std::int32_t merged = data.clusters.merge(r.a, r.b, true, data.dt, data.trajectories);
        data.clusters.evolve(merged, data.dt, data.trajectories);
    }
}

} // namespace

DynamicContactStats handle_dynamic_contact(StepData& data) {
    DynamicContactStats stats;
    std::vector<CandidatePair> list;
    std::vector<Request> requests;
    for (int sweep = 0; sweep < data.model.settings.dynamic_iterations; ++sweep) {
        freeze_clusters(data, list);
        if (list.empty()) return stats;
        requests.clear();
        const auto run = [&](const CandidatePair& pair) {
            ++stats.counters.pairs;
            const Resolution r =
                resolve_inelastic(data, pair.a, pair.b, data.model.settings.dynamic_pair_iterations, stats.counters);
            if (!r.resolved) requests.push_back({pair.a, pair.b, r.first_a, r.first_b});
        };
        if (sweep % 2 == 0)
            for (std::size_t i = 0; i < list.size(); ++i) run(list[i]);
        else
            for (std::size_t i = list.size(); i-- > 0;) run(list[i]);
        close(data, requests, stats);
        ++stats.counters.sweeps;
    }
    stats.counters.limit = !freeze_clusters(data, list).empty();
    return stats;
}

} // namespace flotilla
