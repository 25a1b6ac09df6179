// SPDX-License-Identifier: MIT
// A pack of one lane: the reference that the wide packs must equal bit for bit.
//
// Every operation is one IEEE operation per lane. min and max are the SSE ones: they return the second operand when the
// comparison is false, so that a NaN in the first is dropped.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace flotilla {
namespace {

struct ScalarPack {
    static constexpr int kWidth = 1;
    double v;

    static ScalarPack all(double x) { return {x}; }
    static ScalarPack load(const double* p) { return {*p}; }
    void store(double* p) const { *p = v; }
    /// The mask of the lanes whose bits are set.
    static bool lanes(unsigned bits) { return (bits & 1u) != 0; }

    friend ScalarPack operator+(ScalarPack a, ScalarPack b) { return {a.v + b.v}; }
    friend ScalarPack operator-(ScalarPack a, ScalarPack b) { return {a.v - b.v}; }
    friend ScalarPack operator*(ScalarPack a, ScalarPack b) { return {a.v * b.v}; }
    friend ScalarPack operator/(ScalarPack a, ScalarPack b) { return {a.v / b.v}; }
    friend bool operator<(ScalarPack a, ScalarPack b) { return a.v < b.v; }
    friend bool operator<=(ScalarPack a, ScalarPack b) { return a.v <= b.v; }
};

inline ScalarPack min(ScalarPack a, ScalarPack b) { return {a.v < b.v ? a.v : b.v}; }
inline ScalarPack max(ScalarPack a, ScalarPack b) { return {a.v > b.v ? a.v : b.v}; }
inline ScalarPack sqrt(ScalarPack a) { return {std::sqrt(a.v)}; }
inline ScalarPack abs(ScalarPack a) { return {std::fabs(a.v)}; }
/// a with its sign turned where s is negative (or -0).
inline ScalarPack flip_sign(ScalarPack a, ScalarPack s) {
    return {std::bit_cast<double>(std::bit_cast<std::uint64_t>(a.v) ^
                                  (std::bit_cast<std::uint64_t>(s.v) & 0x8000000000000000ull))};
}
/// The smallest power of two that is >= a, for positive normal a.
inline ScalarPack ceil_power_of_two(ScalarPack a) {
    return {std::bit_cast<double>((std::bit_cast<std::uint64_t>(a.v) + 0x000fffffffffffffull) & 0x7ff0000000000000ull)};
}
inline ScalarPack select(bool m, ScalarPack a, ScalarPack b) { return m ? a : b; }
inline bool mask_and(bool a, bool b) { return a & b; }
inline bool mask_or(bool a, bool b) { return a | b; }
inline bool mask_not(bool a) { return !a; }
inline unsigned mask_bits(bool a) { return a ? 1u : 0u; }

/// Component c of point p of each lane's query: lanes[i][3 * p + c].
inline void load_transposed(const double* const* lanes, int first, ScalarPack (&out)[4]) {
    for (int i = 0; i < 4; ++i) out[i] = {lanes[0][first + i]};
}
/// The coordinates of a point of each lane.
inline void load_transposed(const double* const (&points)[1], ScalarPack (&xyz)[3]) {
    for (int i = 0; i < 3; ++i) xyz[i] = {points[0][i]};
}
/// The reverse of the first, for the lanes whose bits are in `which`: out[lane][i] = in[i].
inline void store_transposed(const ScalarPack (&in)[4], unsigned which, double* const* out) {
    if ((which & 1u) == 0) return;
    for (int i = 0; i < 4; ++i) out[0][i] = in[i].v;
}

} // namespace
} // namespace flotilla
