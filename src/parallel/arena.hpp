// SPDX-License-Identifier: MIT
// What all coarse work asks of oneTBB; included by *_tbb.cpp alone.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>

#include "parallel/threads.hpp"
#include "parallel/unbound.hpp"

namespace flotilla {

/// Threads that coarse work may take in this process. oneTBB's own limit, the cores that it sees, is lifted once: one
/// that comes and goes loses workers. Also where there is one core a job beside the caller (beside.hpp) has a thread:
/// oneTBB complains on stderr of one that it cannot have. A limit of the host's stands.
inline std::size_t most_coarse_threads() {
    static const auto most = static_cast<std::size_t>(std::max({usable_cores(), default_threads(), 2}));
    static const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, most);
    return most;
}

/// An arena whose workers may use all cores.
class RoamingArena {
  public:
    RoamingArena(int threads, unsigned callers) : arena_(threads, callers), roaming_(arena_) {}
    [[nodiscard]] tbb::task_arena& arena() { return arena_; }

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

/// Arenas not in use, for the next caller that wants one of the same size: oneTBB (2021.8) leaks 7 kB with every arena
/// that had work and is destroyed. So there are as many as were ever in use at once.
class SpareArenas {
  public:
    using Size = std::pair<int, unsigned>; ///< threads, callers

    static SpareArenas& all() {
        static auto* const spares =
            new SpareArenas; // never destroyed: its workers may outlive whatever ends with the program
        return *spares;
    }
    std::unique_ptr<RoamingArena> take(const Size& size) {
        {
            const std::lock_guard guard(lock_);
            auto& list = spares_[size];
            if (!list.empty()) {
                auto arena = std::move(list.back());
                list.pop_back();
                return arena;
            }
        }
        return std::make_unique<RoamingArena>(size.first, size.second);
    }
    /// Where there is no memory to keep it, it is destroyed.
    void give_back(const Size& size, std::unique_ptr<RoamingArena> arena) noexcept {
        const std::lock_guard guard(lock_);
        try {
            spares_[size].push_back(std::move(arena));
        } catch (const std::bad_alloc&) {
            arena.reset();
        }
    }

  private:
    std::mutex lock_;
    std::map<Size, std::vector<std::unique_ptr<RoamingArena>>> spares_;
};

/// An arena of so many threads, where the process may take them; `callers` of them are the caller, 1 or 0.
class Arena {
  public:
    explicit Arena(std::size_t threads, unsigned callers = 1)
        : size_(static_cast<int>(std::min(threads, most_coarse_threads())), callers),
          arena_(SpareArenas::all().take(size_)) {}
    ~Arena() { SpareArenas::all().give_back(size_, std::move(arena_)); }
    Arena(const Arena&) = delete;
    Arena& operator=(const Arena&) = delete;

    tbb::task_arena* operator->() { return &arena_->arena(); }

  private:
    SpareArenas::Size size_;
    std::unique_ptr<RoamingArena> arena_;
};

} // namespace flotilla
