// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <vector>

#include "base/floating_point.hpp"
#include "parallel/in_order.hpp"

namespace flotilla {

/// Runs the stages of items so that the first item in order that fails ends it all, when those before it are through.
class StageErrors {
  public:
    StageErrors(const OrderedStages& stages, std::size_t places) : stages_(stages), errors_(places) {}

    [[nodiscard]] bool stopped() const { return stopped_.load(std::memory_order_relaxed); }
    void begin(std::size_t i) {
        error_of(i) = nullptr;
        guard(stages_.begin, i);
    }
    void work(std::size_t i) { guard(stages_.work, i); }
    void end(std::size_t i) {
        if (stopped()) return;
        guard(stages_.end, i);
        if (!error_of(i)) return;
        error_ = error_of(i);
        stopped_.store(true, std::memory_order_relaxed);
    }
    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
    }

  private:
    std::exception_ptr& error_of(std::size_t i) { return errors_[i % errors_.size()]; }
    void guard(const std::function<void(std::size_t)>& stage, std::size_t i) {
        if (error_of(i)) return;
        try {
            const DefaultFloatingPoint environment; // TBB's threads may have another one
            stage(i);
        } catch (...) {
            error_of(i) = std::current_exception();
        }
    }

    const OrderedStages& stages_;
    std::vector<std::exception_ptr> errors_; ///< by place
    std::exception_ptr error_;
    std::atomic<bool> stopped_ = false;
};

} // namespace flotilla
