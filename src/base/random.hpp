// SPDX-License-Identifier: MIT
// Counter-based random numbers: a pure function of a key, so that neither order nor threads can change them. Words of
// the key are absorbed one by one with the finaliser of SplitMix64 (Steele, Lea, Flood 2014), a bijection of 64 bits.
#pragma once

#include <concepts>
#include <cstdint>

namespace flotilla {

/// The finaliser of SplitMix64: every input bit flips every output bit with probability near one half.
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
}

/// 64 random bits for a key of any number of words; the order of the words matters.
template <std::integral... Words>
[[nodiscard]] constexpr std::uint64_t random_bits(Words... words) {
    std::uint64_t h = 0x243f6a8885a308d3U;
    ((h = mix_bits(h + 0x9e3779b97f4a7c15U + static_cast<std::uint64_t>(words))), ...);
    return h;
}

/// Uniform on the multiples of 2^-53 in [0, 1).
[[nodiscard]] constexpr double unit_interval(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

} // namespace flotilla
