// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>

namespace flotilla {

/// Runs work at some time on a thread beside the caller's (beside_tbb.cpp; beside_plain.cpp where
/// FLOTILLA_PLAIN_THREADS is on).
class Beside {
  public:
    Beside();
    ~Beside(); ///< work that has begun may go on
    /// No exceptions.
    void start(std::function<void()> work);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace flotilla
