// SPDX-License-Identifier: MIT
#include "dynamic_contact/dynamic_contact.hpp"

#include <algorithm>
#include <limits>

#include "pair/ordered_sweep.hpp"
#include "pair/progress.hpp"

namespace flotilla {
namespace {

/// When Algorithm 2 is given up. The hits left get fewer geometrically, and what a sweep costs with them; a deep pile
/// in an impact may have some left of a hundred thousand at the limit. The failsafe would merge those into clusters,
/// and these with all that they push, a body a sweep. So from the limit on it is given up when the list of pairs was
/// never shorter than before for half as many sweeps.
class Patience {
  public:
    explicit Patience(int limit) : limit_(limit) {}

    /// Whether a sweep may follow `sweeps` of them, the last of which left `size` pairs.
    bool allows(int sweeps, std::size_t size) {
        if (size < shortest_) {
            shortest_ = size;
            since_ = sweeps;
        }
        return sweeps < limit_ || (sweeps - since_ < limit_ / 2 && sweeps / kMostLimits < limit_);
    }

  private:
    static constexpr int kMostLimits = 10;
    int limit_;     ///< sweeps
    int since_ = 0; ///< sweeps after which the list was shortest
    std::size_t shortest_ = std::numeric_limits<std::size_t>::max();
};

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
    Patience patience(data.model.settings.dynamic_iterations);
    Progress progress;
    for (int sweep = 0;; ++sweep) {
        freeze_clusters(data, list);
        if (list.empty()) return stats;
        if (!patience.allows(sweep, list.size()) || progress.stalled()) {
            stats.counters.limit = true;
            return stats;
        }
        const bool single = stats.merges == 0; // all clusters are single bodies: the pairs listed are the clusters'
        if (single)
            prove_early(data, [&](PairRecord& record, Worker& worker) { return !query(data, worker, record).hit; });
        const std::vector<ListedPair>& listed = data.lists.listed;
        stats.counters.pairs += static_cast<std::int64_t>(listed.size() - data.lists.num_open);
        if (data.lists.num_open == 0) return stats;
        const bool backwards = sweep % 2 != 0;
        resolutions.assign(list.size(), {.resolved = true});
        const auto pair_of = [&](std::size_t i) { return list[i]; };
        const std::span<const std::int32_t> order = order_by_color(data, list.size(), pair_of);
        run_in_order(
            data, "dynamic contact", {order, backwards},
            [&](std::size_t i) { return single && proved(data, *listed[i].record); },
            [&](std::size_t i) {
                if (single) fetch_record(*listed[i].record);
            },
            [&](std::size_t i, int, Worker& worker) {
                ++worker.counters.pairs;
                resolutions[i] =
                    resolve_inelastic(data, worker, list[i].a, list[i].b, data.model.settings.dynamic_pair_iterations);
            });
        collect(data, stats.counters);
        const auto hits = std::count_if(resolutions.begin(), resolutions.end(), [](const auto& r) { return r.found; });
        progress.add(static_cast<std::size_t>(hits), list.size());
        requests.clear();
        for (std::size_t i = 0; i < list.size(); ++i) {
            const auto k = static_cast<std::size_t>(order[backwards ? list.size() - 1 - i : i]);
            const Resolution& r = resolutions[k];
            if (!r.resolved) requests.push_back({list[k].a, list[k].b, r.first_a, r.first_b});
        }
        close(data, requests, stats);
        ++stats.counters.sweeps;
    }
}

} // namespace flotilla
