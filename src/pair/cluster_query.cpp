// SPDX-License-Identifier: MIT
#include "pair/cluster_query.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "pair/examine.hpp"
#include "pair/pair_lists.hpp"

namespace flotilla {
namespace {

/// Of a pair that has no record.
PairRecord passing_record(const StepView& view, std::int32_t a, std::int32_t b) {
    PairRecord pair;
    pair.a = a;
    pair.b = b;
    pair.lengths = pair_lengths(view.model, view.state, a, b);
    return pair;
}

} // namespace

ClusterHit query_clusters(const StepView& view, PairTable& pairs, Worker& worker, std::int32_t a, std::int32_t b) {
    ClusterHit best;
    const auto look = [&](PairRecord& pair) {
        if (apart(view.trajectories, pair)) return;
        const PairHit hit = query(view, worker, pair);
        if (hit.hit && (!best.hit.hit || hit.toi < best.hit.toi)) best = {hit, pair.a, pair.b};
    };
    const auto reach = [&](std::int32_t body) { return list_reach(view.model, at(body), ListReach::separation); };
    for (std::int32_t i : view.clusters[a].members) {
        const Box box_i = view.trajectories.motion(at(i)).swept();
        for (std::int32_t j : view.clusters[b].members) {
            const Box box_j = view.trajectories.motion(at(j)).swept();
            if (!boxes_overlap(box_i, box_j, reach(i) + reach(j))) continue; // way a
            const std::int32_t low = std::min(i, j), high = std::max(i, j);
            if (PairRecord* pair = pairs.find(low, high)) {
                look(*pair);
            } else {
                PairRecord forgotten = passing_record(view, low, high);
                look(forgotten);
            }
        }
    }
    return best;
}

SweptContact swept_contact(const StepView& view, const ClusterHit& h) {
    const FeaturePoints p =
        closest_points(view.trajectories.motion(at(h.a)), view.trajectories.motion(at(h.b)), h.hit.features, h.hit.toi);
    const auto arm = [&](std::int32_t body, const Vec3& point) {
        const Cluster& c = view.clusters[view.clusters.of(at(body))];
        const Vec3 com = c.infinite() ? view.trajectories.start_pose(at(body)).com
                                      : c.com0 + (h.hit.toi * view.dt) * c.way_velocity();
        return point - com;
    };
    const Vec3 relative = ((p.b1 - p.b0) - (p.a1 - p.a0)) / view.dt;
    return {{h.hit.normal, arm(h.a, p.a), arm(h.b, p.b), relative, pair_friction(view.model, h.a, h.b)},
            dot(h.hit.normal, p.b0 - p.a0)};
}

} // namespace flotilla
