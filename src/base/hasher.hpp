// SPDX-License-Identifier: MIT
// A hash of numbers by their bits.
#pragma once

#include <bit>
#include <cstdint>

#include <flotilla/types.hpp>

namespace flotilla {

/// FNV-1a over 64-bit words with a final mix: quality enough to tell states apart, and the same everywhere.
class Hasher {
  public:
    void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3ull + (value_ >> 29); }
    void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
    void add(const Vec3& v) { add(v.x), add(v.y), add(v.z); }
    void add(const Quat& q) { add(q.w), add(q.x), add(q.y), add(q.z); }
    [[nodiscard]] std::uint64_t value() const {
        std::uint64_t z = value_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325ull;
};

} // namespace flotilla
