// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/random.hpp"
#include "base/rotation.hpp"
#include "base/vec3.hpp"
#include "scene/library.hpp"

namespace flotilla::survey {

/// Numbers drawn one after the other; each a function of (seed, index, how many were drawn before).
class Draws {
  public:
    Draws(std::uint64_t seed, std::uint64_t index) : seed_(seed), index_(index) {}

    [[nodiscard]] std::uint64_t bits() { return random_bits(seed_, index_, count_++); }
    [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * unit_interval(bits()); }
    [[nodiscard]] double log_uniform(double low, double high) {
        return std::clamp(std::exp(uniform(std::log(low), std::log(high))), low, high);
    }
    [[nodiscard]] int integer(int low, int high) { return low + static_cast<int>(uniform(0, high - low + 1)); }
    [[nodiscard]] bool chance(double probability) { return uniform(0, 1) < probability; }
    template <class T, std::size_t N>
    [[nodiscard]] T one_of(const std::array<T, N>& values) {
        return values[static_cast<std::size_t>(integer(0, static_cast<int>(N) - 1))];
    }
    [[nodiscard]] Quat rotation() { return library::random_rotation(bits(), 0); }
    [[nodiscard]] Vec3 in_ball(double radius) { return library::random_in_ball(bits(), 0, radius); }
    [[nodiscard]] Vec3 direction() { return rotate(rotation(), {0, 0, 1}); }

  private:
    std::uint64_t seed_, index_, count_ = 0;
};

} // namespace flotilla::survey
