// SPDX-License-Identifier: MIT
// The threads of a solver: one team, kept for its whole life, that runs loops, ordered tasks and sweeps.
//
// Why not two runtimes (loops by OpenMP, task graphs by TBB): a step has hundreds of short parallel sections of both kinds, and the
// idle threads of one runtime spin while the other works. One team has one wait policy, runs all kinds, records itself, and is
// seen whole by ThreadSanitizer.
//
// No bit of a result may depend on which thread does what: items write to slots of their own, and what is collected by thread is
// only used where order does not matter (sums of integers, minima, maxima).
//
// A team of one thread spawns nothing and goes in order. A call from within a task of the same team is not allowed.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include <sched.h>

#include "parallel/task_order.hpp"
#include "parallel/task_recorder.hpp"

namespace flotilla {

struct TeamOptions {
    int threads = 1;
    bool pin = false; ///< each thread stays on one core; the caller until the team is gone
};

/// What a thread did since the team was made.
struct ThreadTimes {
    double busy_ms = 0;      ///< in tasks
    double waiting_ms = 0;   ///< in parallel sections, without a task
    std::int64_t tasks = 0;  ///< chunks and ordered tasks
    std::int64_t stolen = 0; ///< of them, those given to another thread at first
};

/// A barrier for the threads of one parallel section; spins, then gives way.
class SpinBarrier {
  public:
    SpinBarrier(int threads, bool crowded) : threads_(threads), crowded_(crowded) {}
    SpinBarrier(const SpinBarrier&) = delete;
    SpinBarrier& operator=(const SpinBarrier&) = delete;
    void wait();

  private:
    int threads_;
    bool crowded_; ///< more threads than cores: give way at once
    alignas(64) std::atomic<int> arrived_ = 0;
    alignas(64) std::atomic<std::uint32_t> round_ = 0;
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

    /// Calls work(begin, end, thread) for the chunks [k grain, (k+1) grain) of [0, n). Every thread begins with its own stretch of
    /// neighbouring chunks, the same in every loop of as many, and then helps others. Of several exceptions that of the lowest
    /// chunk is thrown.
    template <class Work>
    void for_chunks(const char* name, std::size_t n, std::size_t grain, Work&& work) {
        if (n == 0) return;
        const std::size_t chunks = (n + grain - 1) / grain;
        run_chunks(name, chunks, Call::of([&](std::size_t chunk, int thread) {
                       work(chunk * grain, std::min(n, (chunk + 1) * grain), thread);
                   }));
    }

    /// Calls work(i, thread) for all i in [0, n), in chunks of `grain`.
    template <class Work>
    void for_each(const char* name, std::size_t n, std::size_t grain, Work&& work) {
        for_chunks(name, n, grain, [&](std::size_t begin, std::size_t end, int thread) {
            for (std::size_t i = begin; i < end; ++i) work(i, thread);
        });
    }

    /// Calls work(task, thread) once for every task, none before those it waits for. One thread takes them in list order.
    template <class Work>
    void run(const char* name, const TaskOrder& order, Work&& work) {
        run_order(name, order, Call::of([&](std::size_t task, int thread) { work(task, thread); }));
    }

    /// How many threads a section takes whose work is worth `tasks` shares.
    [[nodiscard]] int width(std::size_t tasks) const {
        return static_cast<int>(std::clamp<std::size_t>(tasks, 1, static_cast<std::size_t>(size_)));
    }
    /// Calls work(thread, barrier) once on each of `threads` threads (at most size()), side by side. No exceptions.
    template <class Work>
    void together(int threads, Work&& work) {
        SpinBarrier barrier(threads, crowded_);
        run_together(threads, Call::of([&](std::size_t, int thread) { work(thread, barrier); }));
    }

  private:
    /// A reference to a callable, without allocation.
    struct Call {
        void (*function)(void*, std::size_t, int) = nullptr;
        void* object = nullptr;
        template <class F>
        static Call of(F&& f) {
            return {[](void* object, std::size_t i, int thread) {
                        (*static_cast<std::remove_reference_t<F>*>(object))(i, thread);
                    },
                    const_cast<void*>(static_cast<const void*>(&f))};
        }
        void operator()(std::size_t i, int thread) const { function(object, i, thread); }
    };
    struct Seat;
    class Chunks;
    class Ordered;

    void run_chunks(const char* name, std::size_t chunks, const Call& work);
    void run_order(const char* name, const TaskOrder& order, const Call& work);
    void run_together(int threads, const Call& work);
    /// Whom the caller waits for when it is through: where sections share work out, a thread that found no free core and never
    /// came is not needed.
    enum class Join { all, those_who_came };
    /// Calls section(0, thread) on `threads` threads, the caller being thread 0; returns when they have.
    void dispatch(int threads, const Call& section, Join join);
    void serve(int seat);
    void dismiss(); ///< ends the helpers

    int size_;
    bool crowded_; ///< more threads than cores
    TaskRecorder* recorder_ = nullptr;
    std::vector<std::unique_ptr<Seat>> seats_;
    Call section_;
    std::atomic<bool> leaving_ = false;
    alignas(64) std::atomic<int> working_ = 0; ///< helpers that have not finished the section
    struct OrderedMemory;
    std::unique_ptr<OrderedMemory> ordered_;
    std::unique_ptr<Chunks> chunks_;
    std::unique_ptr<cpu_set_t> caller_cores_; ///< of the calling thread before it was pinned
};

/// Calls work(i) for all i in [0, n): on the team, or where there is none in a plain loop.
template <class Work>
void for_each(Team* team, const char* name, std::size_t n, std::size_t grain, Work&& work) {
    if (team != nullptr)
        team->for_each(name, n, grain, [&](std::size_t i, int) { work(i); });
    else
        for (std::size_t i = 0; i < n; ++i) work(i);
}

} // namespace flotilla
