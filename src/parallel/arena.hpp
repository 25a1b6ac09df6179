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

/// An arena of as many threads as asked for, more than there are cores where somebody wants that; a limit of the host's stands.
class Arena {
  public:
    /// `callers` of them are the caller, 1 or 0.
    explicit Arena(std::size_t threads, unsigned callers = 1)
        : limit_(tbb::global_control::max_allowed_parallelism,
                 std::max(threads + 1 - callers, static_cast<std::size_t>(usable_cores()))),
          arena_(static_cast<int>(threads), callers),
          roaming_(arena_) {}

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

    tbb::global_control limit_;
    tbb::task_arena arena_;
    Roaming roaming_;
};

} // namespace flotilla
