// SPDX-License-Identifier: MIT
// What all coarse work asks of oneTBB; included by *_tbb.cpp alone.
#pragma once

#include <algorithm>
#include <cstddef>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>

#include "parallel/threads.hpp"
#include "parallel/unbound.hpp"

namespace flotilla {

/// Threads that coarse work may take in this process. oneTBB's own limit, the cores that it sees, is lifted once: one that comes and goes
/// loses workers. A limit of the host's stands.
inline std::size_t most_coarse_threads() {
    static const auto most = static_cast<std::size_t>(std::max(usable_cores(), default_threads()));
    static const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, most);
    return most;
}

/// An arena of so many threads, where the process may take them; `callers` of them are the caller, 1 or 0.
class Arena {
  public:
    explicit Arena(std::size_t threads, unsigned callers = 1)
        : arena_(static_cast<int>(std::min(threads, most_coarse_threads())), callers), roaming_(arena_) {}

    tbb::task_arena* operator->() { return &arena_; }

  private:
    class Roaming : public tbb::task_scheduler_observer {
      public:
        explicit Roaming(tbb::task_arena& arena) : tbb::task_scheduler_observer(arena) { observe(true); }
        ~Roaming() override { observe(false); }
        void on_scheduler_entry(bool is_worker) override {
            if (is_worker) Unbound().stay();
        }
    };

    tbb::task_arena arena_;
    Roaming roaming_;
};

} // namespace flotilla
