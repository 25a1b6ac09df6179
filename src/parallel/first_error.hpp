// SPDX-License-Identifier: MIT
// Exceptions of tasks that run side by side.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <limits>
#include <mutex>

namespace flotilla {

/// The exception of the lowest task that throws, the one that a plain loop would throw: a task is left out only where
/// one below it threw.
class FirstError {
  public:
    void keep(std::size_t task) {
        const std::lock_guard guard(lock_);
        if (task > task_.load(std::memory_order_relaxed)) return;
        task_.store(task, std::memory_order_relaxed);
        error_ = std::current_exception();
    }
    [[nodiscard]] bool before(std::size_t task) const { return task_.load(std::memory_order_relaxed) < task; }
    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
    }

  private:
    std::mutex lock_;
    std::atomic<std::size_t> task_ = std::numeric_limits<std::size_t>::max();
    std::exception_ptr error_;
};

} // namespace flotilla
