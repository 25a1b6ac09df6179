// SPDX-License-Identifier: MIT
// Times of loops. A step has some fifty of them, in a small scene of less than a microsecond each: of ten plates at
// rest reading the system's clock before and after each was a fifteenth of the step.
#pragma once

#include <cstdint>

#include "parallel/wait.hpp"

namespace flotilla {

/// Of the processor's own counter, where there is one that the system's clock goes by as well, at half of its cost.
[[nodiscard]] inline std::int64_t now_ticks() {
#if defined(__x86_64__)
    return static_cast<std::int64_t>(__builtin_ia32_rdtsc());
#else
    return now_ns();
#endif
}

/// Adds the ticks of a scope to a counter.
class TickWatch {
  public:
    explicit TickWatch(std::int64_t& ticks) : ticks_(ticks) {}
    TickWatch(const TickWatch&) = delete;
    TickWatch& operator=(const TickWatch&) = delete;
    ~TickWatch() { ticks_ += now_ticks() - begin_; }

  private:
    std::int64_t& ticks_;
    std::int64_t begin_ = now_ticks();
};

/// How long ticks are: as long as those since it was made.
class TickRate {
  public:
    [[nodiscard]] double ms(std::int64_t ticks) const {
        const std::int64_t since = now_ticks() - ticks_;
        return since > 0 ? 1e-6 * static_cast<double>(now_ns() - ns_) * static_cast<double>(ticks) /
                               static_cast<double>(since)
                         : 0;
    }

  private:
    std::int64_t ns_ = now_ns(), ticks_ = now_ticks();
};

} // namespace flotilla
