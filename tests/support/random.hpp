// SPDX-License-Identifier: MIT
// A series of random numbers, the same everywhere.
#pragma once

#include <cmath>
#include <cstdint>

#include <flotilla/types.hpp>

#include "base/random.hpp"

namespace flotilla::test {

class Random {
  public:
    explicit Random(std::uint64_t seed) : seed_(seed) {}
    std::uint64_t bits() { return random_bits(seed_, ++count_); }
    std::uint64_t below(std::uint64_t n) { return bits() % n; }
    double uniform(double low, double high) { return low + (high - low) * unit_interval(bits()); }
    /// Components in [-r, r].
    Vec3 vec(double r) { return {uniform(-r, r), uniform(-r, r), uniform(-r, r)}; }
    /// Uniform over all rotations.
    Quat rotation() {
        constexpr double kTurn = 6.283185307179586;
        const double u = uniform(0, 1), a = uniform(0, kTurn), b = uniform(0, kTurn);
        return {std::sqrt(1 - u) * std::sin(a), std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b),
                std::sqrt(u) * std::cos(b)};
    }

  private:
    std::uint64_t seed_, count_ = 0;
};

} // namespace flotilla::test
