// SPDX-License-Identifier: MIT
// The floating point environment that all results and all proofs take for granted; a host may have another one.
#pragma once

#include <cfenv>

namespace flotilla {

/// While it lives, the calling thread rounds to nearest, keeps subnormal numbers and traps nothing. Afterwards it is as
/// it was, flags included.
class DefaultFloatingPoint {
  public:
    DefaultFloatingPoint() {
        std::fegetenv(&own_);
        std::fesetenv(FE_DFL_ENV); // in glibc and musl also ends flush-to-zero and denormals-are-zero
    }
    ~DefaultFloatingPoint() { std::fesetenv(&own_); }
    DefaultFloatingPoint(const DefaultFloatingPoint&) = delete;
    DefaultFloatingPoint& operator=(const DefaultFloatingPoint&) = delete;

  private:
    std::fenv_t own_{};
};

} // namespace flotilla
