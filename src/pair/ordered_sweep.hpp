// SPDX-License-Identifier: MIT
// The run of a frozen sweep (README.md): the operations of a list in its order, side by side where they have no movable
// cluster in common.
//
// Why the bits are those of the plain loop. The list is fixed before the sweep. An operation (A, B) reads x^n, the
// settings, the model, the end states and velocities of the members of A and B and the records of their pairs; it
// writes only those, and nothing of a cluster of infinite mass, whose end state stands still during a sweep. Records of
// pairs between A and B belong to no other operation of the list, because a pair is listed once. So an operation is a
// pure function of data that only operations with a movable cluster in common write, and task_order.hpp applies.
// Neighbour lists (PairCandidates) change cost and no answer. Scratch memory belongs to threads and is never read
// before it is written.
#pragma once

#include <array>
#include <bit>
#include <span>

#include "pair/step_data.hpp"

namespace flotilla {

/// The cluster as a thing that tasks share: negative where it has infinite mass, which no operation changes.
[[nodiscard]] inline std::int32_t shared_cluster(const StepData& data, std::int32_t cluster) {
    return data.clusters[cluster].infinite() ? -1 : cluster;
}

/// A list run once or several times over, the first time in order or, `backwards`, from its end, then in turn the other
/// way.
struct SweepPlan {
    std::span<const std::int32_t> order; ///< places in the list
    bool backwards = false;
    int rounds = 1;

    [[nodiscard]] std::size_t size() const { return order.size(); }
    [[nodiscard]] std::size_t place(int round, std::size_t i) const {
        return static_cast<std::size_t>(order[backwards != (round % 2 != 0) ? size() - 1 - i : i]);
    }
};

/// The order of a frozen list: by colours, and in a colour as listed. No two pairs of a colour share a movable cluster,
/// so that as many operations wait for one another as there are colours, some tens; in the order of the list itself
/// chains of waiting operations go through the whole pile. Greedy, in list order: a pure function of the list. Valid
/// until the next call.
template <class PairOf>
[[nodiscard]] std::span<const std::int32_t> order_by_color(StepData& data, std::size_t size, PairOf&& pair_of) {
    constexpr int kColors = 64; // the last takes all that find none free: a chain again
    ListBuffers& l = data.lists;
    constexpr std::size_t kGrain = 512;
    l.things.resize(size);
    data.team.for_each("movable clusters", size, kGrain, [&](std::size_t i, int) {
        const CandidatePair p = pair_of(i);
        l.things[i] = {shared_cluster(data, p.a), shared_cluster(data, p.b)};
    });
    l.used_colors.assign(data.model.size(), 0);
    l.color.resize(size);
    std::array<std::int32_t, kColors + 1> begin{};
    for (std::size_t i = 0; i < size; ++i) {
        const auto [a, b] = l.things[i];
        std::uint64_t none = 0;
        std::uint64_t& used_a = a >= 0 ? l.used_colors[static_cast<std::size_t>(a)] : none;
        std::uint64_t& used_b = b >= 0 ? l.used_colors[static_cast<std::size_t>(b)] : none;
        const int color = std::min(std::countr_one(used_a | used_b), kColors - 1);
        used_a |= std::uint64_t{1} << color;
        used_b |= std::uint64_t{1} << color;
        l.color[i] = static_cast<std::uint8_t>(color);
        ++begin[static_cast<std::size_t>(color) + 1];
    }
    for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
    l.places.resize(size);
    for (std::size_t i = 0; i < size; ++i)
        l.places[static_cast<std::size_t>(begin[l.color[i]]++)] = static_cast<std::int32_t>(i);
    return l.places;
}

/// Operations between asking for the memory of one and running it.
constexpr std::size_t kFetchAhead = 8;

/// Fills the order of tasks of a plan made by order_by_color. An operation is left out where its pair is current and no
/// operation before it may change that: where none of those shares a movable cluster with it.
template <class Current, class Fetch>
void order_tasks(StepData& data, const SweepPlan& plan, Current&& current, Fetch&& fetch) {
    constexpr std::size_t kGrain = 256;
    ListBuffers& l = data.lists;
    l.flags.resize(plan.size());
    data.team.for_each("stale pairs", plan.size(), kGrain, [&](std::size_t i, int) {
        if (i + kFetchAhead < plan.size()) fetch(i + kFetchAhead);
        l.flags[i] = current(i) ? 0 : 1;
    });
    l.touched.assign(data.model.size(), 0);
    l.tasks.clear();
    l.order.start(data.model.size());
    for (int round = 0; round < plan.rounds; ++round)
        for (std::size_t i = 0; i < plan.size(); ++i) {
            const std::size_t k = plan.place(round, i);
            const auto [a, b] = l.things[k];
            const auto touched = [&](std::int32_t c) { return c >= 0 && l.touched[static_cast<std::size_t>(c)] != 0; };
            if (l.flags[k] == 0 && !touched(a) && !touched(b)) continue;
            if (a >= 0) l.touched[static_cast<std::size_t>(a)] = 1;
            if (b >= 0) l.touched[static_cast<std::size_t>(b)] = 1;
            l.tasks.push_back({static_cast<std::int32_t>(k), round});
            l.order.add(a, b);
        }
}

/// Calls operate(i, round, worker) for the pairs of the list in order, round after round, except where current(i)
/// holds: a certificate that an operation leaves alone. The list must not change meanwhile. fetch(i) asks for the
/// memory that they begin with.
///
/// Rounds are one run: nothing waits for the end of a round but what shares a cluster with it. A round in which all
/// pairs are current leaves all of them so, and with it all later rounds do nothing, as if they had not been run.
template <class Current, class Fetch, class Operate>
void run_in_order(StepData& data, const char* name, const SweepPlan& plan, Current&& current, Fetch&& fetch,
                  Operate&& operate) {
    if (data.team.alone() && data.team.recorder() == nullptr) {
        for (int round = 0; round < plan.rounds; ++round) {
            bool any = false;
            for (std::size_t i = 0; i < plan.size(); ++i) {
                const std::size_t k = plan.place(round, i);
                if (i + kFetchAhead < plan.size()) fetch(plan.place(round, i + kFetchAhead));
                if (current(k)) continue;
                operate(k, round, data.worker(0));
                any = true;
            }
            if (!any) return;
        }
        return;
    }
    ListBuffers& l = data.lists;
    order_tasks(data, plan, current, fetch);
    data.team.run(name, l.order, [&](std::size_t task, int thread) {
        if (task + kFetchAhead < l.tasks.size()) fetch(static_cast<std::size_t>(l.tasks[task + kFetchAhead].place));
        const auto i = static_cast<std::size_t>(l.tasks[task].place);
        if (!current(i)) operate(i, l.tasks[task].round, data.worker(thread));
    });
}

} // namespace flotilla
