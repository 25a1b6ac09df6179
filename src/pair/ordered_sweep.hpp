// SPDX-License-Identifier: MIT
// The run of a frozen sweep (README.md): the operations of a list in its order, side by side where they have no movable
// cluster in common. run_here() is the loop over the list; what else is here makes it fast.
//
// Why the bits are those of the plain loop. The list is fixed before the sweep. An operation (A, B) reads x^n, the
// settings, the model, the end states and velocities of the members of A and B and the records of their pairs; it
// writes only those, and nothing of a cluster of infinite mass, whose end state stands still during a sweep. Records of
// pairs between A and B belong to no other operation of the list, because a pair is listed once. So an operation is a
// pure function of data that only operations with a movable cluster in common write, and task_order.hpp applies.
// Neighbour lists (PairCandidates) change cost and no answer. Scratch memory belongs to threads and is never read
// before it is written.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <span>

#include "pair/divided.hpp"
#include "pair/pair_lists.hpp"
#include "pair/worker.hpp"

namespace flotilla {

/// The cluster as a thing that tasks share: negative where it has infinite mass, which no operation changes.
[[nodiscard]] inline std::int32_t shared_cluster(const Clusters& clusters, std::int32_t cluster) {
    return clusters[cluster].infinite() ? -1 : cluster;
}

/// Where bounds left few pairs of the list open, most of those have nothing to resolve either. Calls close(record,
/// worker) for them, side by side, which does what the operation would do at once if that applies no impulse and says
/// whether it did so. An operation before their turn may still move one of the bodies: then the pair is open again, and
/// its turn comes as ever.
template <class Close>
void close_early(const StepView& view, Workers& workers, FrozenList& list, Close&& close) {
    constexpr std::size_t kFew = 8, kGrain = 64; // one pair in so many is open; pairs of a task
    if (list.num_open == 0 || list.num_open * kFew > list.pairs.size()) return;
    const auto closes = [&](std::size_t i, int thread) {
        PairRecord& record = *list.pairs[i].record;
        return !apart(view.trajectories, record) && close(record, workers[thread]);
    };
    if (workers.team.division() != nullptr) {
        list.num_open -= close_divided(PairWork::queries, view, workers.team, list.pairs, closes);
        return;
    }
    std::atomic<std::size_t> closed = 0;
    workers.team.for_each("examine", list.pairs.size(), kGrain, [&](std::size_t i, int thread) {
        if (closes(i, thread)) closed.fetch_add(1, std::memory_order_relaxed);
    });
    list.num_open -= closed;
}

/// A list run once or several times over, the first time in order or, `backwards`, from its end, then in turn the other
/// way.
struct SweepPlan {
    std::span<const std::int32_t> order; ///< places in the list
    bool backwards = false;
    int rounds = 1;

    [[nodiscard]] std::size_t size() const { return order.size(); }
    [[nodiscard]] bool backwards_in(int round) const { return backwards != (round % 2 != 0); }
    [[nodiscard]] std::size_t place(int round, std::size_t i) const {
        return static_cast<std::size_t>(order[backwards_in(round) ? size() - 1 - i : i]);
    }
};

inline constexpr int kColors = 64; ///< the last takes all that find none free: a chain again

/// The order of a list whose `things` are in the buffers: by colours, and in a colour as listed. No two pairs of a
/// colour share a movable cluster, so that as many operations wait for one another as there are colours, some tens; in
/// the order of the list itself chains of waiting operations go through the whole pile. Greedy, in list order: a pure
/// function of the list. Valid until the next call.
[[nodiscard]] std::span<const std::int32_t> order_by_color(std::size_t num_clusters, SweepBuffers& buffers);

/// Fills the order of tasks of a plan made by order_by_color, whose pairs are flagged as `open` in the buffers or not.
/// An operation is left out where its pair is closed and no operation before it may change that: where none of those
/// shares a movable cluster with it.
void order_tasks(const SweepPlan& plan, Team& team, SweepBuffers& buffers);

/// The order of a frozen list of so many pairs, pair_of(i) being the clusters of the i-th.
template <class PairOf>
[[nodiscard]] std::span<const std::int32_t> sweep_order(const StepView& view, PairBook& book, Team& team,
                                                        std::size_t size, PairOf&& pair_of) {
    constexpr std::size_t kGrain = 512;
    SweepBuffers& buffers = book.lists.sweep;
    buffers.things.resize(size);
    team.for_each("movable clusters", size, kGrain, [&](std::size_t i, int) {
        const CandidatePair p = pair_of(i);
        buffers.things[i] = {shared_cluster(view.clusters, p.a), shared_cluster(view.clusters, p.b)};
    });
    return order_by_color(view.model.size(), buffers);
}

/// Operations between asking for the memory of one and running it.
constexpr std::size_t kFetchAhead = 8;

/// What a sweep does with the i-th pair of its list.
template <class Closed, class Fetch, class Operate>
struct SweepOperation {
    const char* name; ///< of the tasks, for records
    Closed closed;    ///< closed(i): it has nothing to do
    Fetch fetch;      ///< fetch(i) asks for the memory that the others begin with
    Operate operate;  ///< operate(i, round, worker)
};
template <class Closed, class Fetch, class Operate>
SweepOperation(const char*, Closed, Fetch, Operate) -> SweepOperation<Closed, Fetch, Operate>;

/// The sweep as the paper has it: the plain loop over the pairs of the list in order, round after round, except where
/// one is closed. A round that finds all pairs closed leaves them so, and with it all later rounds do nothing.
template <class Operation>
void run_plain(Worker& worker, const SweepPlan& plan, const Operation& operation) {
    for (int round = 0; round < plan.rounds; ++round) {
        bool any = false;
        for (std::size_t i = 0; i < plan.size(); ++i) {
            const std::size_t k = plan.place(round, i);
            if (i + kFetchAhead < plan.size()) operation.fetch(plan.place(round, i + kFetchAhead));
            if (operation.closed(k)) continue;
            operation.operate(k, round, worker);
            any = true;
        }
        if (!any) return;
    }
}

/// The same as a graph of tasks. Rounds are one run: nothing waits for the end of a round but what shares a cluster
/// with it.
template <class Operation>
void run_as_tasks(Workers& workers, SweepBuffers& buffers, const SweepPlan& plan, const Operation& operation) {
    constexpr std::size_t kGrain = 256;
    buffers.open.resize(plan.size());
    workers.team.for_each("stale pairs", plan.size(), kGrain, [&](std::size_t i, int) {
        if (i + kFetchAhead < plan.size()) operation.fetch(i + kFetchAhead);
        buffers.open[i] = operation.closed(i) ? 0 : 1;
    });
    order_tasks(plan, workers.team, buffers);
    const std::vector<SweepBuffers::SweepTask>& tasks = buffers.tasks;
    workers.team.run(operation.name, buffers.order, [&](std::size_t task, int thread) {
        if (task + kFetchAhead < tasks.size())
            operation.fetch(static_cast<std::size_t>(tasks[task + kFetchAhead].place));
        const auto i = static_cast<std::size_t>(tasks[task].place);
        if (!operation.closed(i)) operation.operate(i, tasks[task].round, workers[thread]);
    });
}

/// Runs a sweep that sweep_order() planned, all of it in this process. The list must not change meanwhile.
template <class Operation>
void run_here(Workers& workers, SweepBuffers& buffers, const SweepPlan& plan, const Operation& operation) {
    if (workers.team.alone() && workers.team.recorder() == nullptr)
        run_plain(workers[0], plan, operation);
    else
        run_as_tasks(workers, buffers, plan, operation);
}

} // namespace flotilla
