// SPDX-License-Identifier: MIT
// The run of a frozen sweep (DESIGN section 5): the operations of a list in its order, side by side where they have no movable
// cluster in common.
//
// Why the bits are those of the plain loop. The list is fixed before the sweep. An operation (A, B) reads x^n, the settings, the
// model, the end states and velocities of the members of A and B and the records of their pairs; it writes only those, and nothing
// of a cluster of infinite mass, whose end state stands still during a sweep. Records of pairs between A and B belong to no other
// operation of the list, because a pair is listed once. So an operation is a pure function of data that only operations with a
// movable cluster in common write, and task_order.hpp applies. Candidate lists (PairCandidates) change cost and no answer. Scratch
// memory belongs to threads and is never read before it is written.
#pragma once

#include "pair/step_data.hpp"

namespace flotilla {

/// The cluster as a thing that tasks share: negative where it has infinite mass, which no operation changes.
[[nodiscard]] inline std::int32_t shared_cluster(const StepData& data, std::int32_t cluster) {
    return data.clusters[cluster].infinite() ? -1 : cluster;
}

/// Calls operate(i, worker) for the pairs of the list in order, from the end if `backwards`. An operation need not be run, and is
/// left out, where current(i) holds and no operation before it may change that: where none of those shares a movable
/// cluster with it. `pair_of(i)` gives the clusters. The list must not change meanwhile.
template <class PairOf, class Current, class Operate>
void run_in_order(StepData& data, const char* name, std::size_t n, bool backwards, PairOf&& pair_of, Current&& current,
                  Operate&& operate) {
    constexpr std::size_t kGrain = 256;
    ListBuffers& l = data.lists;
    const auto place = [&](std::size_t i) { return backwards ? n - 1 - i : i; };
    if (data.team.size() == 1 && data.team.recorder() == nullptr) {
        for (std::size_t i = 0; i < n; ++i)
            if (!current(place(i))) operate(place(i), data.worker(0));
        return;
    }
    l.flags.resize(n);
    data.team.for_each("stale pairs", n, kGrain, [&](std::size_t i, int) { l.flags[i] = current(i) ? 0 : 1; });
    l.touched.assign(data.model.size(), 0);
    l.tasks.clear();
    l.order.start(data.model.size());
    for (std::size_t i = 0; i < n; ++i) {
        const CandidatePair p = pair_of(place(i));
        const std::int32_t a = shared_cluster(data, p.a), b = shared_cluster(data, p.b);
        const auto touched = [&](std::int32_t c) { return c >= 0 && l.touched[static_cast<std::size_t>(c)] != 0; };
        if (l.flags[place(i)] == 0 && !touched(a) && !touched(b)) continue;
        if (a >= 0) l.touched[static_cast<std::size_t>(a)] = 1;
        if (b >= 0) l.touched[static_cast<std::size_t>(b)] = 1;
        l.tasks.push_back(static_cast<std::int32_t>(place(i)));
        l.order.add(a, b);
    }
    data.team.run(name, l.order, [&](std::size_t task, int thread) {
        const auto i = static_cast<std::size_t>(l.tasks[task]);
        if (!current(i)) operate(i, data.worker(thread));
    });
}

} // namespace flotilla
