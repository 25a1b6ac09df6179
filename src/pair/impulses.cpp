// SPDX-License-Identifier: MIT
#include "pair/impulses.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "base/stopwatch.hpp"

namespace flotilla {

void apply_impulse(Clusters& clusters, Worker& worker, std::int32_t a, std::int32_t b, const ContactPoint& point,
                   const Vec3& impulse) {
    ++worker.counters.impulses;
    worker.largest_push = std::max(worker.largest_push, length(impulse));
    if (worker.pushed.empty() || worker.pushed.back() != CandidatePair{a, b}) worker.pushed.push_back({a, b});
    if (clusters[a].infinite()) clusters.add_work(b, dot(impulse, clusters.velocity_at(a, point.arm_a)));
    if (clusters[b].infinite()) clusters.add_work(a, -dot(impulse, clusters.velocity_at(b, point.arm_b)));
    // Operations side by side share bodies of infinite mass, which none of them writes.
    if (clusters[a].infinite()) {
        if (!clusters[b].infinite()) clusters.note_infinite(b);
    } else if (clusters[b].infinite()) {
        clusters.note_infinite(a);
    } else {
        clusters.note_exchanged(a, point.arm_a, -impulse);
        clusters.note_exchanged(b, point.arm_b, impulse);
    }
    clusters.apply(a, point.arm_a, -impulse);
    clusters.apply(b, point.arm_b, impulse);
}

void push(Movers& movers, Worker& worker, std::int32_t a, std::int32_t b, const ContactPoint& point,
          const Vec3& impulse) {
    const Stopwatch watch(worker.counters.response_ms);
    apply_impulse(movers.clusters(), worker, a, b, point, impulse);
    movers.evolve(a);
    movers.evolve(b);
}

} // namespace flotilla
