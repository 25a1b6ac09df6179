// SPDX-License-Identifier: MIT
// Exceptions of tasks that run side by side.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <limits>
#include <mutex>

namespace flotilla {

/// The exception of the lowest task.
class FirstError {
  public:
    void keep(std::size_t task) {
        const std::lock_guard guard(lock_);
        if (task > task_) return;
        task_ = task;
        error_ = std::current_exception();
        any_.store(true, std::memory_order_relaxed);
    }
    [[nodiscard]] bool any() const { return any_.load(std::memory_order_relaxed); }
    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
    }

  private:
    std::mutex lock_;
    std::atomic<bool> any_ = false;
    std::size_t task_ = std::numeric_limits<std::size_t>::max();
    std::exception_ptr error_;
};

} // namespace flotilla
