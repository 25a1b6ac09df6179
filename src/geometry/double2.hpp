// SPDX-License-Identifier: MIT
// Two doubles side by side, for tests too short for a wide kernel. SSE2 is part of baseline x86-64; elsewhere plain
// code with the same results, bit for bit. Every operation is the IEEE one per lane; larger() and smaller() return
// their second argument where a lane holds a NaN.
#pragma once

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace flotilla {

#if defined(__SSE2__)

struct Double2 {
    __m128d v;
};
/// All bits of a lane set (true) or none (false).
struct Mask2 {
    __m128d v;
};

inline Double2 load2(const double* p) { return {_mm_loadu_pd(p)}; }
inline Double2 both(double x) { return {_mm_set1_pd(x)}; }
inline Double2 pair2(double first, double second) { return {_mm_set_pd(second, first)}; }
inline Double2 operator+(Double2 a, Double2 b) { return {_mm_add_pd(a.v, b.v)}; }
inline Double2 operator-(Double2 a, Double2 b) { return {_mm_sub_pd(a.v, b.v)}; }
inline Double2 operator/(Double2 a, Double2 b) { return {_mm_div_pd(a.v, b.v)}; }
inline Double2 larger(Double2 a, Double2 b) { return {_mm_max_pd(a.v, b.v)}; }
inline Double2 smaller(Double2 a, Double2 b) { return {_mm_min_pd(a.v, b.v)}; }
inline Mask2 operator>(Double2 a, Double2 b) { return {_mm_cmpgt_pd(a.v, b.v)}; }
inline Mask2 operator&(Mask2 a, Mask2 b) { return {_mm_and_pd(a.v, b.v)}; }
inline Mask2 operator|(Mask2 a, Mask2 b) { return {_mm_or_pd(a.v, b.v)}; }
inline bool any(Mask2 m) { return _mm_movemask_pd(m.v) != 0; }
/// a where the mask is set, else b.
inline Double2 select(Mask2 m, Double2 a, Double2 b) {
    return {_mm_or_pd(_mm_and_pd(m.v, a.v), _mm_andnot_pd(m.v, b.v))};
}
/// a where the mask is set, else +0.
inline Double2 select_or_zero(Mask2 m, Double2 a) { return {_mm_and_pd(m.v, a.v)}; }
inline double first(Double2 a) { return _mm_cvtsd_f64(a.v); }
inline double second(Double2 a) { return _mm_cvtsd_f64(_mm_unpackhi_pd(a.v, a.v)); }

#else

struct Double2 {
    double v[2];
};
struct Mask2 {
    bool v[2];
};

inline Double2 load2(const double* p) { return {{p[0], p[1]}}; }
inline Double2 both(double x) { return {{x, x}}; }
inline Double2 pair2(double first, double second) { return {{first, second}}; }
inline Double2 operator+(Double2 a, Double2 b) { return {{a.v[0] + b.v[0], a.v[1] + b.v[1]}}; }
inline Double2 operator-(Double2 a, Double2 b) { return {{a.v[0] - b.v[0], a.v[1] - b.v[1]}}; }
inline Double2 operator/(Double2 a, Double2 b) { return {{a.v[0] / b.v[0], a.v[1] / b.v[1]}}; }
inline Double2 larger(Double2 a, Double2 b) {
    return {{a.v[0] > b.v[0] ? a.v[0] : b.v[0], a.v[1] > b.v[1] ? a.v[1] : b.v[1]}};
}
inline Double2 smaller(Double2 a, Double2 b) {
    return {{a.v[0] < b.v[0] ? a.v[0] : b.v[0], a.v[1] < b.v[1] ? a.v[1] : b.v[1]}};
}
inline Mask2 operator>(Double2 a, Double2 b) { return {{a.v[0] > b.v[0], a.v[1] > b.v[1]}}; }
inline Mask2 operator&(Mask2 a, Mask2 b) { return {{a.v[0] && b.v[0], a.v[1] && b.v[1]}}; }
inline Mask2 operator|(Mask2 a, Mask2 b) { return {{a.v[0] || b.v[0], a.v[1] || b.v[1]}}; }
inline bool any(Mask2 m) { return m.v[0] || m.v[1]; }
inline Double2 select(Mask2 m, Double2 a, Double2 b) { return {{m.v[0] ? a.v[0] : b.v[0], m.v[1] ? a.v[1] : b.v[1]}}; }
inline Double2 select_or_zero(Mask2 m, Double2 a) { return select(m, a, {{0, 0}}); }
inline double first(Double2 a) { return a.v[0]; }
inline double second(Double2 a) { return a.v[1]; }

#endif

} // namespace flotilla
