// SPDX-License-Identifier: MIT
// The run of a frozen sweep (ordered_sweep.hpp) divided among ranks.
//
// All ranks have the same list, the same tasks in the same order, and know the owner of each. Tasks of one round and
// colour, which share no movable cluster, are a wave. A rank runs its own tasks of a wave and then hands every cluster
// of theirs whose next task is another rank's on to that rank, which waits for it where that task comes: so each task
// finds its clusters as the plain loop would leave them, and nobody hears of clusters that are none of its own before
// the end. Then all are told where the clusters are, what is known of the pairs, and what was counted.
//
// Nobody waits for ever: a message is sent after the sender's tasks of a wave and waited for before those of a later
// one, so of the ranks that wait the one in the earliest wave has what it waits for under way.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pair/divided.hpp"
#include "pair/ordered_sweep.hpp"

namespace flotilla {

/// What a sweep writes, for ranks to tell one another.
struct SharedSweep {
    Movers& movers;
    std::function<PairRecord&(std::size_t)> record; ///< of the i-th pair of the list
    /// What was found of the i-th pair, of the same size for all; none where it is empty.
    std::function<std::span<std::byte>(std::size_t)> result = {};
};

class DividedSweep {
  public:
    /// Of the tasks in the buffers (order_tasks).
    DividedSweep(const Division& division, const SweepBuffers& buffers, const SharedSweep& shared);

    [[nodiscard]] std::size_t num_waves() const { return waves_.size(); }
    /// This rank's tasks of a wave.
    [[nodiscard]] std::span<const std::int32_t> tasks(std::size_t wave) const {
        return std::span(own_).subspan(waves_[wave].first_own, waves_[wave].end_own - waves_[wave].first_own);
    }
    /// Takes what this rank's tasks of the wave need from others.
    void take(std::size_t wave);
    /// Hands on what they leave to others.
    void hand_on(std::size_t wave);
    /// After the last wave.
    void share(Workers& workers, const CountedWork& before);
    /// Where something is logged: a task, and after share() all of them.
    void log_task(std::int32_t task);
    void log() const;

  private:
    struct Wave {
        std::size_t first_own = 0, end_own = 0;
    };
    /// A cluster on its way between this rank and another one, after a wave, for a later one.
    struct Transfer {
        std::size_t wave = 0, needed = 0;
        int partner = 0;
        std::int32_t cluster = 0;
    };
    /// Those to or from one partner after one wave.
    struct Message {
        std::span<const Transfer> transfers;
        std::size_t needed = 0; ///< the first wave that needs one
        std::vector<std::byte> bytes;
        std::unique_ptr<RankExchange> exchange;
    };

    void find_waves();
    void find_transfers(const std::vector<std::size_t>& wave_of);
    [[nodiscard]] static std::vector<Message> messages_of(std::span<const Transfer> transfers);
    void receive(Message& message);
    void begin_log(const std::vector<std::size_t>& wave_of);
    void write_own(ByteWriter& out) const;
    void read_other(std::span<const std::byte> bytes, CountedWork& counted);

    const Division& division_;
    const SweepBuffers& buffers_;
    const SharedSweep& shared_;
    std::vector<Wave> waves_;
    std::vector<std::int32_t> own_;  ///< tasks of this rank, in their order
    std::vector<Transfer> out_, in_; ///< by wave, partner, cluster
    std::vector<Message> sent_, received_;
    std::size_t next_sent_ = 0, next_received_ = 0;
    std::vector<std::int32_t> last_; ///< clusters that this rank was the last to have
    std::vector<LoggedSweep::Task> logged_;
    std::vector<std::uint64_t> versions_; ///< of the first members of last_, before the sweep; where that is logged
    std::size_t told_ = 0;                ///< bytes, in share()
    std::vector<std::int32_t> pairs_;     ///< places in the list of this rank's tasks, each once
};

/// As run_here(), by all ranks.
template <class Operation>
void run_divided(Workers& workers, SweepBuffers& buffers, const SweepPlan& plan, const Operation& operation,
                 const SharedSweep& shared) {
    Division& division = *workers.team.division();
    const CountedWork before(workers);
    buffers.open.resize(plan.size());
    for (std::size_t i = 0; i < plan.size(); ++i) buffers.open[i] = operation.closed(i) ? 0 : 1;
    order_tasks(plan, workers.team, buffers);
    DividedSweep sweep(division, buffers, shared);
    for (std::size_t wave = 0; wave < sweep.num_waves(); ++wave) {
        const std::span<const std::int32_t> tasks = sweep.tasks(wave);
        sweep.take(wave);
        workers.team.for_each(operation.name, tasks.size(), 1, [&](std::size_t k, int thread) {
            const auto [place, round] = buffers.tasks[static_cast<std::size_t>(tasks[k])];
            const auto i = static_cast<std::size_t>(place);
            if (operation.closed(i)) return;
            {
                const CostOf cost(division, Division::payer(buffers.things[i][0], buffers.things[i][1]));
                operation.operate(i, round, workers[thread]);
            }
            if (division.log() != nullptr) sweep.log_task(tasks[k]);
        });
        sweep.hand_on(wave);
    }
    sweep.share(workers, before);
    if (division.log() != nullptr) sweep.log();
}

/// Runs a sweep that sweep_order() planned, wherever it is to be run. The list must not change meanwhile.
template <class Operation>
void run_sweep(Workers& workers, SweepBuffers& buffers, const SweepPlan& plan, const Operation& operation,
               const SharedSweep& shared) {
    if (workers.team.division() != nullptr)
        run_divided(workers, buffers, plan, operation, shared);
    else
        run_here(workers, buffers, plan, operation);
}

} // namespace flotilla
