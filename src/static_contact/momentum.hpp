// SPDX-License-Identifier: MIT
// The sequence of Nesterov's momentum: a sweep goes on from y = x + m (x - x_before) (README.md).
#pragma once

#include <algorithm>
#include <cmath>

namespace flotilla {

class Momentum {
  public:
    explicit Momentum(double most) : most_(most) {}
    /// The m of the next sweep, at most `most`: 0 after a restart.
    double next(bool restart) {
        const double next = (1 + std::sqrt(1 + 4 * theta_ * theta_)) / 2;
        const double m = restart ? 0.0 : std::min(most_, (theta_ - 1) / next);
        theta_ = restart ? 1.0 : next;
        return m;
    }

  private:
    double most_, theta_ = 1;
};

} // namespace flotilla
