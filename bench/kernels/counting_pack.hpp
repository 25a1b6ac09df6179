// SPDX-License-Identifier: MIT
// A pack of one lane that counts: running a kernel on it tells how many floating-point operations the kernel needs for
// a query. Counted, one each: additions, subtractions, multiplications, divisions, square roots, comparisons, minima
// and maxima. Not counted: operations on bits (absolute value, sign, selection, masks), loads, stores, transposition.
#pragma once

#include "geometry/pack_scalar.hpp"

namespace flotilla {
namespace {

struct CountingPack {
    static constexpr int kWidth = 1;
    static inline long operations = 0;
    ScalarPack p;

    static CountingPack all(double x) { return {{x}}; }
    static CountingPack load(const double* x) { return {{*x}}; }
    void store(double* x) const { *x = p.v; }
    static bool lanes(unsigned bits) { return ScalarPack::lanes(bits); }
    static CountingPack counted(ScalarPack x) { return ++operations, CountingPack{x}; }
    static bool counted(bool x) { return ++operations, x; }

    friend CountingPack operator+(CountingPack a, CountingPack b) { return counted(a.p + b.p); }
    friend CountingPack operator-(CountingPack a, CountingPack b) { return counted(a.p - b.p); }
    friend CountingPack operator*(CountingPack a, CountingPack b) { return counted(a.p * b.p); }
    friend CountingPack operator/(CountingPack a, CountingPack b) { return counted(a.p / b.p); }
    friend bool operator<(CountingPack a, CountingPack b) { return counted(a.p < b.p); }
    friend bool operator<=(CountingPack a, CountingPack b) { return counted(a.p <= b.p); }
};

inline CountingPack min(CountingPack a, CountingPack b) { return CountingPack::counted(min(a.p, b.p)); }
inline CountingPack max(CountingPack a, CountingPack b) { return CountingPack::counted(max(a.p, b.p)); }
inline CountingPack sqrt(CountingPack a) { return CountingPack::counted(sqrt(a.p)); }
inline CountingPack abs(CountingPack a) { return {abs(a.p)}; }
inline CountingPack flip_sign(CountingPack a, CountingPack s) { return {flip_sign(a.p, s.p)}; }
inline CountingPack ceil_power_of_two(CountingPack a) { return {ceil_power_of_two(a.p)}; }
inline CountingPack select(bool m, CountingPack a, CountingPack b) { return m ? a : b; }

inline void load_transposed(const double* const* lanes, int first, CountingPack (&out)[4]) {
    for (int i = 0; i < 4; ++i) out[i] = {{lanes[0][first + i]}};
}
inline void store_transposed(const CountingPack (&in)[4], unsigned which, double* const* out) {
    const ScalarPack values[4] = {in[0].p, in[1].p, in[2].p, in[3].p};
    store_transposed(values, which, out);
}

} // namespace
} // namespace flotilla
