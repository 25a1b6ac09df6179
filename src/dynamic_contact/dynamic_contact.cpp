// SPDX-License-Identifier: MIT
#include "dynamic_contact/dynamic_contact.hpp"

#include "pair/ordered_sweep.hpp"

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
    std::vector<Resolution> resolutions;
    std::vector<Request> requests;
    for (int sweep = 0; sweep < data.model.settings.dynamic_iterations; ++sweep) {
        freeze_clusters(data, list);
        if (list.empty()) return stats;
        const bool backwards = sweep % 2 != 0;
        resolutions.assign(list.size(), {});
        const auto pair_of = [&](std::size_t i) { return list[i]; };
        const std::span<const std::int32_t> order = order_by_color(data, list.size(), pair_of);
        run_in_order(
            data, "dynamic contact", {order, backwards}, [](std::size_t) { return false; }, [](std::size_t) {},
            [&](std::size_t i, int, Worker& worker) {
                ++worker.counters.pairs;
                resolutions[i] =
                    resolve_inelastic(data, worker, list[i].a, list[i].b, data.model.settings.dynamic_pair_iterations);
            });
        collect(data, stats.counters);
        requests.clear();
        for (std::size_t i = 0; i < list.size(); ++i) {
            const auto k = static_cast<std::size_t>(order[backwards ? list.size() - 1 - i : i]);
            const Resolution& r = resolutions[k];
            if (!r.resolved) requests.push_back({list[k].a, list[k].b, r.first_a, r.first_b});
        }
        close(data, requests, stats);
        ++stats.counters.sweeps;
    }
    stats.counters.limit = !freeze_clusters(data, list).empty();
    return stats;
}

} // namespace flotilla
