// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>

namespace flotilla {

/// Adds the wall time of a scope to a counter, ms. Times are reported, never used.
class Stopwatch {
  public:
    explicit Stopwatch(double& ms) : ms_(ms), start_(std::chrono::steady_clock::now()) {}
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;
    ~Stopwatch() {
        ms_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    double& ms_;
    std::chrono::steady_clock::time_point start_;
};

} // namespace flotilla
