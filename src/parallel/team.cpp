// SPDX-License-Identifier: MIT
#include "parallel/team.hpp"

#include <chrono>
#include <thread>

#include <pthread.h>
#include <sched.h>

#include "parallel/first_error.hpp"
#include "parallel/parallel_for.hpp"

namespace flotilla {
namespace {

// Turns of a waiting loop before the thread gives way or sleeps: some tens of microseconds, longer than most serial stretches
// between the sections of a step.
constexpr int kSpins = 20000;
constexpr int kSpinsInSection = 2000;

void pause_briefly() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

std::int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// Restricts the calling thread to the k-th of the cores that the process may use. Where that fails the thread stays free.
void pin_to_core(int k) {
    cpu_set_t usable;
    CPU_ZERO(&usable);
    if (sched_getaffinity(0, sizeof usable, &usable) != 0) return;
    int left = k % std::max(CPU_COUNT(&usable), 1);
    for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
        if (!CPU_ISSET(cpu, &usable) || left-- > 0) continue;
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(cpu, &one);
        pthread_setaffinity_np(pthread_self(), sizeof one, &one);
        return;
    }
}

/// Waits in a section; `turn` counts the turns of one wait.
void idle(int& turn, bool crowded) {
    if (crowded || ++turn > kSpinsInSection)
        std::this_thread::yield();
    else
        pause_briefly();
}

} // namespace

void SpinBarrier::wait() {
    if (threads_ == 1) return;
    const std::uint32_t round = round_.load(std::memory_order_relaxed);
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == threads_) {
        arrived_.store(0, std::memory_order_relaxed);
        round_.store(round + 1, std::memory_order_release);
        return;
    }
    int turn = 0;
    while (round_.load(std::memory_order_acquire) == round) idle(turn, crowded_);
}

struct alignas(64) Team::Seat {
    enum State : int { idle, called, running };
    std::atomic<int> state = idle;
    ThreadTimes times;
    std::thread thread;
};

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

/// Memory of ordered runs, kept.
struct Team::OrderedMemory {
    /// Tasks that are ready, of one thread. Its owner takes the oldest, others the youngest.
    struct alignas(64) Ready {
        std::atomic_flag lock = ATOMIC_FLAG_INIT;
        std::vector<std::int32_t> tasks;
        std::size_t head = 0;

        void acquire() {
            int turn = 0;
            while (lock.test_and_set(std::memory_order_acquire)) idle(turn, false);
        }
        void release() { lock.clear(std::memory_order_release); }
        void push(std::int32_t task) { push(std::span(&task, 1)); }
        void push(std::span<const std::int32_t> ready) {
            acquire();
            tasks.insert(tasks.end(), ready.begin(), ready.end());
            count.store(tasks.size() - head, std::memory_order_relaxed);
            release();
        }
        std::int32_t take(bool own) {
            if (count.load(std::memory_order_relaxed) == 0) return -1;
            acquire();
            std::int32_t task = -1;
            if (head < tasks.size()) {
                if (own)
                    task = tasks[head++];
                else
                    task = tasks.back(), tasks.pop_back();
            }
            if (head == tasks.size()) tasks.clear(), head = 0;
            count.store(tasks.size() - head, std::memory_order_relaxed);
            release();
            return task;
        }
        std::atomic<std::size_t> count = 0; ///< a hint
    };

    explicit OrderedMemory(int threads) : ready(static_cast<std::size_t>(threads)) {}

    std::vector<Ready> ready;
    std::vector<std::uint8_t> waits; ///< by task, counted down
};

/// One ordered run.
class Team::Ordered {
  public:
    Ordered(Team& team, const TaskOrder& order, const Call& work, int threads, std::int32_t region)
        : team_(team),
          memory_(*team.ordered_),
          order_(order),
          work_(work),
          threads_(static_cast<std::size_t>(threads)),
          region_(region),
          left_(order.size()) {
        memory_.waits.assign(order.waits().begin(), order.waits().end());
        // Neighbours in the list, which often share a body, go to one thread.
        const std::span<const std::int32_t> first = order.first();
        for (std::size_t k = 0; k < threads_; ++k) {
            const std::size_t begin = k * first.size() / threads_, end = (k + 1) * first.size() / threads_;
            memory_.ready[k].push(first.subspan(begin, end - begin));
        }
    }

    void serve(int thread) {
        ThreadTimes& times = team_.seats_[static_cast<std::size_t>(thread)]->times;
        std::int64_t mark = now_ns();
        std::int64_t done = 0; // not yet taken off left_
        int turn = 0;
        std::int32_t task = -1;
        bool waiting = false;
        for (;;) {
            if (task < 0) {
                bool stolen = false;
                task = find(thread, stolen);
                if (task < 0) {
                    if (!waiting) {
                        waiting = true;
                        const std::int64_t now = now_ns();
                        times.busy_ms += 1e-6 * static_cast<double>(now - mark);
                        mark = now;
                    }
                    if (done > 0) left_.fetch_sub(static_cast<std::size_t>(done), std::memory_order_acq_rel), done = 0;
                    if (left_.load(std::memory_order_acquire) == 0) break;
                    idle(turn, team_.crowded_);
                    continue;
                }
                times.stolen += stolen ? 1 : 0;
            }
            turn = 0;
            if (waiting) {
                waiting = false;
                const std::int64_t now = now_ns();
                times.waiting_ms += 1e-6 * static_cast<double>(now - mark);
                mark = now;
            }
            run(task, thread);
            ++times.tasks;
            ++done;
            task = release(task, thread);
        }
        times.waiting_ms += 1e-6 * static_cast<double>(now_ns() - mark);
    }
    void rethrow() const { error_.rethrow(); }

  private:
    std::int32_t find(int thread, bool& stolen) {
        for (std::size_t k = 0; k < threads_; ++k) {
            const std::size_t whose = (static_cast<std::size_t>(thread) + k) % threads_;
            if (const std::int32_t task = memory_.ready[whose].take(k == 0); task >= 0) {
                stolen = k > 0;
                return task;
            }
        }
        return -1;
    }

    void run(std::int32_t task, int thread) {
        TaskRecorder* recorder = team_.recorder();
        const std::int64_t begin = recorder != nullptr ? recorder->now() : 0;
        if (!error_.any()) {
            try {
                work_(static_cast<std::size_t>(task), thread);
            } catch (...) {
                error_.keep(static_cast<std::size_t>(task));
            }
        }
        if (recorder != nullptr) recorder->add_task(thread, {begin, recorder->now(), region_, task});
    }

    /// Tells the tasks that wait for this one. Returns the first of those that are ready now, to be run next.
    std::int32_t release(std::int32_t task, int thread) {
        const Successors& next = order_.successors()[static_cast<std::size_t>(task)];
        std::int32_t ready[2] = {-1, -1};
        for (std::size_t k = 0; k < 2; ++k)
            if (next[k] >= 0 && std::atomic_ref(memory_.waits[static_cast<std::size_t>(next[k])])
                                        .fetch_sub(1, std::memory_order_acq_rel) == 1)
                ready[k] = next[k];
        if (ready[0] < 0) return ready[1];
        if (ready[1] < 0) return ready[0];
        memory_.ready[static_cast<std::size_t>(thread)].push(std::max(ready[0], ready[1]));
        return std::min(ready[0], ready[1]);
    }

    Team& team_;
    OrderedMemory& memory_;
    const TaskOrder& order_;
    const Call& work_;
    std::size_t threads_;
    std::int32_t region_;
    FirstError error_;
    alignas(64) std::atomic<std::size_t> left_;
};

Team::Team(const TeamOptions& options)
    : size_(std::max(options.threads, 1)),
      crowded_(size_ > usable_cores()),
      ordered_(std::make_unique<OrderedMemory>(size_)),
      chunks_(std::make_unique<Chunks>(size_)) {
    for (int k = 0; k < size_; ++k) seats_.push_back(std::make_unique<Seat>());
    try {
        for (int k = 1; k < size_; ++k)
            seats_[static_cast<std::size_t>(k)]->thread = std::thread([this, k, pin = options.pin] {
                if (pin) pin_to_core(k);
                serve(k);
            });
    } catch (...) { // the system has no more threads
        dismiss();
        throw;
    }
    // Last: threads inherit the cores of the one that makes them.
    if (!options.pin) return;
    caller_cores_ = std::make_unique<cpu_set_t>();
    CPU_ZERO(caller_cores_.get());
    if (sched_getaffinity(0, sizeof(cpu_set_t), caller_cores_.get()) != 0) caller_cores_.reset();
    pin_to_core(0);
}

Team::~Team() {
    dismiss();
    if (caller_cores_) sched_setaffinity(0, sizeof(cpu_set_t), caller_cores_.get());
}

void Team::dismiss() {
    leaving_.store(true, std::memory_order_relaxed);
    for (std::size_t k = 1; k < seats_.size(); ++k) {
        if (!seats_[k]->thread.joinable()) continue;
        seats_[k]->state.store(Seat::called, std::memory_order_release);
        seats_[k]->state.notify_one();
        seats_[k]->thread.join();
    }
}

std::vector<ThreadTimes> Team::times() const {
    std::vector<ThreadTimes> out;
    for (const auto& seat : seats_) out.push_back(seat->times);
    return out;
}

void Team::serve(int k) {
    Seat& seat = *seats_[static_cast<std::size_t>(k)];
    for (;;) {
        for (int turn = 0; !crowded_ && turn < kSpins && seat.state.load(std::memory_order_relaxed) == Seat::idle;
             ++turn)
            pause_briefly();
        seat.state.wait(Seat::idle, std::memory_order_relaxed);
        int expected = Seat::called;
        if (!seat.state.compare_exchange_strong(expected, Seat::running, std::memory_order_acquire)) continue;
        if (leaving_.load(std::memory_order_relaxed)) return;
        section_(0, k);
        seat.state.store(Seat::idle, std::memory_order_relaxed); // ordered by what follows
        if (working_.fetch_sub(1, std::memory_order_acq_rel) == 1) working_.notify_one();
    }
}

void Team::dispatch(int threads, const Call& section, Join join) {
    section_ = section;
    working_.store(threads - 1, std::memory_order_relaxed);
    for (int k = 1; k < threads; ++k) {
        Seat& seat = *seats_[static_cast<std::size_t>(k)];
        seat.state.store(Seat::called, std::memory_order_release);
        seat.state.notify_one();
    }
    section(0, 0);
    for (int k = 1; k < threads && join == Join::those_who_came; ++k) {
        int expected = Seat::called;
        if (seats_[static_cast<std::size_t>(k)]->state.compare_exchange_strong(expected, Seat::idle,
                                                                               std::memory_order_relaxed))
            working_.fetch_sub(1, std::memory_order_relaxed);
    }
    int working = working_.load(std::memory_order_acquire);
    for (int turn = 0; working != 0; working = working_.load(std::memory_order_acquire)) {
        if (crowded_ || ++turn > kSpins)
            working_.wait(working, std::memory_order_acquire);
        else
            pause_briefly();
    }
}

void Team::run_chunks(const char* name, std::size_t chunks, const Call& work) {
    TaskRecorder* recorder = this->recorder();
    const int threads = width(chunks);
    const std::int32_t region =
        recorder != nullptr ? recorder->begin_region(name, RegionKind::loop, static_cast<std::int32_t>(chunks), nullptr)
                            : -1;
    const auto run_one = [&](std::size_t chunk, int thread) {
        const std::int64_t begin = recorder != nullptr ? recorder->now() : 0;
        work(chunk, thread);
        if (recorder != nullptr)
            recorder->add_task(thread, {begin, recorder->now(), region, static_cast<std::int32_t>(chunk)});
    };
    if (threads == 1) {
        const std::int64_t begin = now_ns();
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) run_one(chunk, 0);
        seats_[0]->times.tasks += static_cast<std::int64_t>(chunks);
        seats_[0]->times.busy_ms += 1e-6 * static_cast<double>(now_ns() - begin);
    } else {
        FirstError error;
        chunks_->start(chunks, threads);
        const auto section = [&](std::size_t, int thread) {
            ThreadTimes& times = seats_[static_cast<std::size_t>(thread)]->times;
            const std::int64_t begin = now_ns();
            chunks_->take(static_cast<std::size_t>(thread), [&](std::size_t chunk, std::size_t whose) {
                ++times.tasks;
                times.stolen += whose != static_cast<std::size_t>(thread) ? 1 : 0;
                if (error.any()) return;
                try {
                    run_one(chunk, thread);
                } catch (...) {
                    error.keep(chunk);
                }
            });
            times.busy_ms += 1e-6 * static_cast<double>(now_ns() - begin);
        };
        dispatch(threads, Call::of(section), Join::those_who_came);
        error.rethrow();
    }
    if (recorder != nullptr) recorder->end_region(region);
}

void Team::run_order(const char* name, const TaskOrder& order, const Call& work) {
    if (order.size() == 0) return;
    TaskRecorder* recorder = this->recorder();
    const auto tasks = static_cast<std::int32_t>(order.size());
    const std::int32_t region =
        recorder != nullptr ? recorder->begin_region(name, RegionKind::ordered, tasks, order.successors().data()) : -1;
    const int threads = width(order.size());
    if (threads == 1) {
        const std::int64_t begin = now_ns();
        for (std::int32_t task = 0; task < tasks; ++task) {
            const std::int64_t from = recorder != nullptr ? recorder->now() : 0;
            work(static_cast<std::size_t>(task), 0);
            if (recorder != nullptr) recorder->add_task(0, {from, recorder->now(), region, task});
        }
        seats_[0]->times.tasks += tasks;
        seats_[0]->times.busy_ms += 1e-6 * static_cast<double>(now_ns() - begin);
    } else {
        Ordered run(*this, order, work, threads, region);
        const auto section = [&](std::size_t, int thread) { run.serve(thread); };
        dispatch(threads, Call::of(section), Join::those_who_came);
        run.rethrow();
    }
    if (recorder != nullptr) recorder->end_region(region);
}

void Team::run_together(int threads, const Call& work) {
    const auto section = [&](std::size_t, int thread) {
        const std::int64_t begin = now_ns();
        work(0, thread);
        seats_[static_cast<std::size_t>(thread)]->times.busy_ms += 1e-6 * static_cast<double>(now_ns() - begin);
    };
    if (threads == 1)
        section(0, 0);
    else
        dispatch(threads, Call::of(section), Join::all);
}

} // namespace flotilla
