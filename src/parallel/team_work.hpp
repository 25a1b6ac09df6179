// SPDX-License-Identifier: MIT
// Chunks of loops and ordered tasks, as the threads of a team hand them out; included by team.cpp alone.
#pragma once

#include <algorithm>
#include <atomic>
#include <span>
#include <vector>

#include "parallel/first_error.hpp"
#include "parallel/team.hpp"

namespace flotilla {

inline constexpr std::int64_t kShortSpin = 1000; // ns

/// Chunks handed out: each thread has a stretch of its own, and takes from others' when it is through.
class Team::Chunks {
  public:
    explicit Chunks(int threads) : next_(static_cast<std::size_t>(threads)) {}

    void start(std::size_t chunks, int threads) {
        threads_ = static_cast<std::size_t>(threads);
        chunks_ = chunks;
        for (std::size_t t = 0; t < threads_; ++t) next_[t].value.store(first(t), std::memory_order_relaxed);
    }
    /// Calls f(chunk, whose) until none is left.
    template <class F>
    void take(std::size_t thread, F&& f) {
        for (std::size_t k = 0; k < threads_; ++k) {
            const std::size_t whose = (thread + k) % threads_;
            for (;;) {
                if (next_[whose].value.load(std::memory_order_relaxed) >= first(whose + 1)) break;
                const std::size_t chunk = next_[whose].value.fetch_add(1, std::memory_order_relaxed);
                if (chunk >= first(whose + 1)) break;
                f(chunk, whose);
            }
        }
    }

  private:
    struct alignas(64) Counter {
        std::atomic<std::size_t> value = 0;
    };
    [[nodiscard]] std::size_t first(std::size_t thread) const { return thread * chunks_ / threads_; }

    std::vector<Counter> next_;
    std::size_t threads_ = 1, chunks_ = 0;
};

/// Memory of ordered runs, kept. Only start() asks for more: what helpers throw nobody would catch.
struct Team::OrderedMemory {
    /// The tasks beside one in its queue; -1: none.
    struct Neighbours {
        std::int32_t older, younger;
    };
    /// Tasks that are ready, of one thread. Its owner takes the oldest, others the youngest.
    struct alignas(64) Ready {
        std::atomic_flag lock = ATOMIC_FLAG_INIT;
        std::int32_t oldest = -1, youngest = -1;
        std::atomic<std::size_t> count = 0; ///< a hint for threads that search; sleepers checked after the last push

        /// Held for the time of a few loads and stores, or until its holder has a core again: then the core is given
        /// away.
        void acquire() {
            while (lock.test_and_set(std::memory_order_acquire))
                if (!spin(kShortSpin, [&] { return !lock.test(std::memory_order_relaxed); })) lock.wait(true);
        }
        void release() {
            lock.clear(std::memory_order_release);
            lock.notify_one();
        }
    };

    explicit OrderedMemory(int threads) : ready(static_cast<std::size_t>(threads)) {}

    void start(const TaskOrder& order) {
        waits.assign(order.waits().begin(), order.waits().end());
        neighbours.resize(order.size());
    }
    void push(std::size_t queue, std::int32_t task) { push(queue, std::span(&task, 1)); }
    void push(std::size_t queue, std::span<const std::int32_t> tasks) {
        Ready& q = ready[queue];
        q.acquire();
        for (const std::int32_t task : tasks) {
            beside(task) = {q.youngest, -1};
            (q.youngest < 0 ? q.oldest : beside(q.youngest).younger) = task;
            q.youngest = task;
        }
        q.count.store(q.count.load(std::memory_order_relaxed) + tasks.size());
        q.release();
    }
    /// -1: there is none.
    std::int32_t take(std::size_t queue, bool own) {
        Ready& q = ready[queue];
        if (q.count.load(std::memory_order_relaxed) == 0) return -1;
        q.acquire();
        const std::int32_t task = own ? q.oldest : q.youngest;
        if (task >= 0) {
            const auto [older, younger] = beside(task);
            (older < 0 ? q.oldest : beside(older).younger) = younger;
            (younger < 0 ? q.youngest : beside(younger).older) = older;
            q.count.store(q.count.load(std::memory_order_relaxed) - 1, std::memory_order_relaxed);
        }
        q.release();
        return task;
    }

    std::vector<Ready> ready;
    std::vector<std::uint8_t> waits; ///< by task, counted down

  private:
    [[nodiscard]] Neighbours& beside(std::int32_t task) { return neighbours[static_cast<std::size_t>(task)]; }

    std::vector<Neighbours> neighbours; ///< by task; a task is in one queue, once
};

/// One ordered run. A thread without a task waits for one to become ready or for the end. One of both comes: of the
/// tasks left the first in list order waits for nothing, so it is ready, runs, or ran on a thread that has yet to say
/// so; and the thread that makes a task ready which it does not run itself at once, or ends the last one, wakes
/// sleepers afterwards (wait.hpp).
class Team::Ordered {
  public:
    Ordered(Team& team, const TaskOrder& order, const Task& work, int threads, std::int32_t region)
        : team_(team),
          memory_(*team.ordered_),
          order_(order),
          work_(work),
          threads_(static_cast<std::size_t>(threads)),
          region_(region),
          left_(order.size()) {
        memory_.start(order);
        // Neighbours in the list, which often share a body, go to one thread.
        const std::span<const std::int32_t> first = order.first();
        for (std::size_t k = 0; k < threads_; ++k) {
            const std::size_t begin = k * first.size() / threads_, end = (k + 1) * first.size() / threads_;
            memory_.push(k, first.subspan(begin, end - begin));
        }
    }

    /// `share` says whose queue and memory, `thread` who does it.
    void serve(int share, int thread) {
        ThreadTimes& times = team_.times_of(share);
        std::int64_t mark = now_ns();
        std::int64_t done = 0; // not yet taken off left_
        std::int32_t task = -1;
        bool waiting = false;
        const auto change = [&](bool to_waiting) {
            const std::int64_t now = now_ns();
            (waiting ? times.waiting_ms : times.busy_ms) += 1e-6 * static_cast<double>(now - mark);
            mark = now;
            waiting = to_waiting;
        };
        for (;;) {
            if (task < 0) {
                bool stolen = false;
                task = find(share, stolen);
                if (task < 0) {
                    if (!waiting) change(true);
                    take_off(done);
                    if (left_.load() == 0) break;
                    wait(thread);
                    continue;
                }
                times.stolen += stolen ? 1 : 0;
            }
            if (waiting) change(false);
            run(task, share);
            ++times.tasks;
            ++done;
            task = release(task, share);
        }
        change(false);
    }
    void rethrow() const { error_.rethrow(); }

  private:
    std::int32_t find(int share, bool& stolen) {
        for (std::size_t k = 0; k < threads_; ++k) {
            const std::size_t whose = (static_cast<std::size_t>(share) + k) % threads_;
            if (const std::int32_t task = memory_.take(whose, k == 0); task >= 0) {
                stolen = k > 0;
                return task;
            }
        }
        return -1;
    }

    void take_off(std::int64_t& done) {
        if (done == 0) return;
        const auto n = static_cast<std::size_t>(done);
        if (left_.fetch_sub(n) == n && sleepers_.load() > 0) team_.crew_.wake_all_in_run();
        done = 0;
    }

    void wait(int thread) {
        const auto something = [&] {
            const auto has_tasks = [](const OrderedMemory::Ready& r) { return r.count.load() > 0; };
            return left_.load() == 0 ||
                   std::any_of(memory_.ready.begin(), memory_.ready.begin() + static_cast<std::ptrdiff_t>(threads_),
                               has_tasks);
        };
        if (spin(team_.crew_.spin_time(), something)) return;
        sleepers_.fetch_add(1);
        team_.crew_.sleep_in_run(thread, something);
        sleepers_.fetch_sub(1);
    }

    void run(std::int32_t task, int share) {
        if (error_.before(static_cast<std::size_t>(task))) return;
        try {
            TaskRecorder* recorder = team_.recorder();
            const std::int64_t begin = recorder != nullptr ? recorder->now() : 0;
            work_(static_cast<std::size_t>(task), share);
            if (recorder != nullptr) recorder->add_task(share, {begin, recorder->now(), region_, task});
        } catch (...) {
            error_.keep(static_cast<std::size_t>(task));
        }
    }

    /// Tells the tasks that wait for this one. Returns the first of those that are ready now, to be run next.
    std::int32_t release(std::int32_t task, int share) {
        const Successors& next = order_.successors()[static_cast<std::size_t>(task)];
        std::int32_t ready[2] = {-1, -1};
        for (std::size_t k = 0; k < 2; ++k)
            if (next[k] >= 0 && std::atomic_ref(memory_.waits[static_cast<std::size_t>(next[k])])
                                        .fetch_sub(1, std::memory_order_acq_rel) == 1)
                ready[k] = next[k];
        if (ready[0] < 0) return ready[1];
        if (ready[1] < 0) return ready[0];
        memory_.push(static_cast<std::size_t>(share), std::max(ready[0], ready[1]));
        if (sleepers_.load() > 0) team_.crew_.wake_one();
        return std::min(ready[0], ready[1]);
    }

    Team& team_;
    OrderedMemory& memory_;
    const TaskOrder& order_;
    const Task& work_;
    std::size_t threads_;
    std::int32_t region_;
    FirstError error_;
    alignas(64) std::atomic<std::size_t> left_; ///< tasks
    alignas(64) std::atomic<int> sleepers_ = 0;
};

} // namespace flotilla
