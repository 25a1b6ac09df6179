// SPDX-License-Identifier: MIT
// The threads of a solver: loops, ordered tasks and phases on the threads of a parallel region (OpenMP's; threads.hpp).
//
// A region is as long as a step. Within it sections follow one another, with plain code of the caller between them;
// crew.hpp says how the threads share a section out, and why nothing waits for one that has no core. That is our own
// because a step has hundreds of sections, many of them of some microseconds: on two cores an `omp parallel` takes 0.7
// us, a section here 0.25 us and a phase 0.2 us; and an `omp barrier`, 0.27 us where both threads spin, waits for every
// thread, also for one without a core.
//
// No bit of a result may depend on which thread does what: items write to slots of their own, and what is collected by
// thread is only used where order does not matter (sums of integers, minima, maxima).
//
// A team of one thread needs no region and goes in order. A call from within a task of the same team is not allowed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "parallel/crew.hpp"
#include "parallel/task_order.hpp"
#include "parallel/task_recorder.hpp"
#include "parallel/threads.hpp"
#include "parallel/ticks.hpp"

namespace flotilla {

class Division;

struct TeamOptions {
    int threads = 1;
    /// Regions take fewer threads where others work: one among the workers of another parallel region, and at most what
    /// regions of other teams leave. Otherwise the number is what somebody asked for.
    bool yields = false;
    /// More threads than cores are kept awake, for tests: they meet in more ways.
    bool crowds = false;
};

/// What a thread did since the team was made.
struct ThreadTimes {
    double busy_ms = 0;      ///< in tasks
    double waiting_ms = 0;   ///< in parallel sections, without a task
    std::int64_t tasks = 0;  ///< chunks and ordered tasks
    std::int64_t stolen = 0; ///< of them, those given to another thread at first
};

class Team {
  public:
    explicit Team(const TeamOptions& options = {});
    ~Team();
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    [[nodiscard]] int size() const { return size_; }
    [[nodiscard]] std::vector<ThreadTimes> times() const;

    /// Null: nothing is recorded.
    void record_to(TaskRecorder* recorder) { recorder_ = recorder; }
    [[nodiscard]] TaskRecorder* recorder() const {
        return recorder_ != nullptr && recorder_->active() ? recorder_ : nullptr;
    }

    /// Among whose ranks the expensive loops are divided. Null, as at first: this process does all.
    void divide(Division* division) { division_ = division; }
    [[nodiscard]] Division* division() const { return division_; }

    /// Calls work() in a parallel region; sections called outside of one open one each. Throws what work throws.
    template <class Work>
    void region(Work&& work) {
        run_region(CallRef<>::of(work));
    }
    /// Ends sections on several threads until the region's end, which has to wait for the threads: best called some
    /// time before.
    void dismiss();
    /// Whether sections run on the caller alone, so that their order of tasks need not be prepared.
    [[nodiscard]] bool alone() const { return present_ == 1; }
    /// Threads of sections at present, at most size().
    [[nodiscard]] int present() const { return present_; }

    /// Calls work(begin, end, thread) for the chunks [k grain, (k+1) grain) of [0, n). Every thread begins with its own
    /// stretch of neighbouring chunks, the same in every loop of as many, and then helps others. Of several exceptions
    /// that of the lowest chunk is thrown.
    template <class Work>
    void for_chunks(const char* name, std::size_t n, std::size_t grain, Work&& work) {
        if (n == 0) return;
        const std::size_t chunks = (n + grain - 1) / grain;
        const auto one = [&](std::size_t chunk, int thread) {
            work(chunk * grain, std::min(n, (chunk + 1) * grain), thread);
        };
        run_chunks(name, chunks, Task::of(one));
    }

    /// Calls work(i, thread) for all i in [0, n), in chunks of `grain`.
    template <class Work>
    void for_each(const char* name, std::size_t n, std::size_t grain, Work&& work) {
        for_chunks(name, n, grain, [&](std::size_t begin, std::size_t end, int thread) {
            for (std::size_t i = begin; i < end; ++i) work(i, thread);
        });
    }

    /// Calls work(task, thread) once for every task, none before those it waits for. One thread takes them in list
    /// order.
    template <class Work>
    void run(const char* name, const TaskOrder& order, Work&& work) {
        run_order(name, order, Task::of(work));
    }

    /// How many threads a section takes whose work is worth `tasks` shares.
    [[nodiscard]] int width(std::size_t tasks) const {
        return static_cast<int>(std::clamp<std::size_t>(tasks, 1, static_cast<std::size_t>(present_)));
    }
    /// Calls work(phase, share) once for each of `shares` shares (at most size()) of each phase; a phase begins when
    /// all shares of the one before are done, or where both are of the chain its neighbours. No exceptions.
    template <class Work>
    void phases(int shares, std::size_t phases, Work&& work, const PhaseChain* chain = nullptr) {
        run_phases(shares, phases, chain, CallRef<std::size_t, int>::of(work));
    }

  private:
    using Task = CallRef<std::size_t, int>;
    class Chunks;
    class Ordered;
    struct OrderedMemory;

    [[nodiscard]] int wanted() const;
    void run_region(const CallRef<>& work);
    void enter(const CallRef<>& work, int threads);
    void run_chunks(const char* name, std::size_t chunks, const Task& work);
    void run_order(const char* name, const TaskOrder& order, const Task& work);
    void run_phases(int shares, std::size_t phases, const PhaseChain* chain, const CallRef<std::size_t, int>& work);
    [[nodiscard]] ThreadTimes& times_of(int thread) { return times_[static_cast<std::size_t>(thread)].value; }
    [[nodiscard]] std::int64_t& ticks_of(int thread) { return times_[static_cast<std::size_t>(thread)].busy; }

    TeamOptions options_;
    int size_;
    int present_; ///< threads at hand: of the region, or that a region would have
    bool in_region_ = false;
    int rest_ = 0, rest_left_ = 0; ///< regions without helpers: of the next rest, and of the present one
    TaskRecorder* recorder_ = nullptr;
    Division* division_ = nullptr;
    struct alignas(64) PaddedTimes {
        ThreadTimes value;
        std::int64_t busy = 0; ///< ticks in tasks, beside value.busy_ms
    };
    std::vector<PaddedTimes> times_; ///< by share
    TickRate rate_;
    Crew crew_;
    std::unique_ptr<OrderedMemory> ordered_;
    std::unique_ptr<Chunks> chunks_;
};

/// Calls work(i) for all i in [0, n): on the team, or where there is none or one task alone in a plain loop.
template <class Work>
void for_each(Team* team, const char* name, std::size_t n, std::size_t grain, Work&& work) {
    if (team != nullptr && n > grain)
        team->for_each(name, n, grain, [&](std::size_t i, int) { work(i); });
    else
        for (std::size_t i = 0; i < n; ++i) work(i);
}

/// Calls work(phase, share) for all shares of phase 0, then of phase 1 and so on; several shares need a team.
template <class Work>
void for_phases(Team* team, int shares, std::size_t phases, Work&& work, const PhaseChain* chain = nullptr) {
    if (shares > 1) return team->phases(shares, phases, work, chain);
    for (std::size_t phase = 0; phase < phases; ++phase) work(phase, 0);
}

} // namespace flotilla
