// SPDX-License-Identifier: MIT
// Eight lanes of AVX-512 (F, DQ, VL). Included only by files compiled for that instruction set; see pack_avx2.hpp.
#pragma once

#include <immintrin.h>

#include "geometry/pack_avx2.hpp"

namespace flotilla {
namespace {

struct Avx512Mask {
    __mmask8 m;
};

struct Avx512Pack {
    using Half = Avx2Pack;
    static constexpr int kWidth = 8;
    __m512d v;

    static Avx512Pack all(double x) { return {_mm512_set1_pd(x)}; }
    static Avx512Pack load(const double* p) { return {_mm512_loadu_pd(p)}; }
    void store(double* p) const { _mm512_storeu_pd(p, v); }
    static Avx512Pack join(Half low, Half high) {
        return {_mm512_insertf64x4(_mm512_castpd256_pd512(low.v), high.v, 1)};
    }
    [[nodiscard]] Half low() const { return {_mm512_castpd512_pd256(v)}; }
    [[nodiscard]] Half high() const { return {_mm512_extractf64x4_pd(v, 1)}; }
    static Avx512Mask lanes(unsigned bits) { return {static_cast<__mmask8>(bits)}; }

    friend Avx512Pack operator+(Avx512Pack a, Avx512Pack b) { return {_mm512_add_pd(a.v, b.v)}; }
    friend Avx512Pack operator-(Avx512Pack a, Avx512Pack b) { return {_mm512_sub_pd(a.v, b.v)}; }
    friend Avx512Pack operator*(Avx512Pack a, Avx512Pack b) { return {_mm512_mul_pd(a.v, b.v)}; }
    friend Avx512Pack operator/(Avx512Pack a, Avx512Pack b) { return {_mm512_div_pd(a.v, b.v)}; }
};

inline Avx512Mask operator<(Avx512Pack a, Avx512Pack b) { return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ)}; }
inline Avx512Mask operator<=(Avx512Pack a, Avx512Pack b) { return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_LE_OQ)}; }
inline Avx512Pack min(Avx512Pack a, Avx512Pack b) { return {_mm512_min_pd(a.v, b.v)}; }
inline Avx512Pack max(Avx512Pack a, Avx512Pack b) { return {_mm512_max_pd(a.v, b.v)}; }
inline Avx512Pack sqrt(Avx512Pack a) { return {_mm512_sqrt_pd(a.v)}; }
inline Avx512Pack abs(Avx512Pack a) { return {_mm512_andnot_pd(_mm512_set1_pd(-0.0), a.v)}; }
inline Avx512Pack flip_sign(Avx512Pack a, Avx512Pack s) {
    return {_mm512_xor_pd(a.v, _mm512_and_pd(s.v, _mm512_set1_pd(-0.0)))};
}
inline Avx512Pack ceil_power_of_two(Avx512Pack a) {
    const __m512i up = _mm512_add_epi64(_mm512_castpd_si512(a.v), _mm512_set1_epi64(0x000fffffffffffffll));
    return {_mm512_castsi512_pd(_mm512_and_si512(up, _mm512_set1_epi64(0x7ff0000000000000ll)))};
}
inline Avx512Pack select(Avx512Mask m, Avx512Pack a, Avx512Pack b) { return {_mm512_mask_blend_pd(m.m, b.v, a.v)}; }
inline Avx512Mask mask_and(Avx512Mask a, Avx512Mask b) { return {static_cast<__mmask8>(a.m & b.m)}; }
inline Avx512Mask mask_or(Avx512Mask a, Avx512Mask b) { return {static_cast<__mmask8>(a.m | b.m)}; }
inline Avx512Mask mask_not(Avx512Mask a) { return {static_cast<__mmask8>(~a.m)}; }
inline unsigned mask_bits(Avx512Mask a) { return a.m; }

// Put together in registers: a wide load of what narrow stores wrote waits until they have reached the cache.
inline void load_transposed(const double* const* lanes, int first, Avx512Pack (&out)[4]) {
    Avx2Pack low[4], high[4];
    load_transposed(lanes, first, low);
    load_transposed(lanes + 4, first, high);
    for (int i = 0; i < 4; ++i) out[i] = Avx512Pack::join(low[i], high[i]);
}

inline void load_transposed(const double* const (&points)[8], Avx512Pack (&xyz)[3]) {
    const auto four = [&](int lane, int i) { // two doubles of every other lane
        const auto load = [&](int l) { return _mm_loadu_pd(points[l] + i); };
        __m512d v = _mm512_castpd128_pd512(load(lane));
        v = _mm512_insertf64x2(v, load(lane + 2), 1);
        v = _mm512_insertf64x2(v, load(lane + 4), 2);
        return _mm512_insertf64x2(v, load(lane + 6), 3);
    };
    const __m512d xy_even = four(0, 0), xy_odd = four(1, 0), yz_even = four(0, 1), yz_odd = four(1, 1);
    xyz[0] = {_mm512_unpacklo_pd(xy_even, xy_odd)};
    xyz[1] = {_mm512_unpackhi_pd(xy_even, xy_odd)};
    xyz[2] = {_mm512_unpackhi_pd(yz_even, yz_odd)};
}
inline void store_transposed(const Avx512Pack (&in)[4], unsigned which, double* const* out) {
    alignas(64) double rows[4][8];
    for (int i = 0; i < 4; ++i) in[i].store(rows[i]);
    for (int lane = 0; lane < 8; ++lane)
        if (((which >> lane) & 1u) != 0)
            for (int i = 0; i < 4; ++i) out[lane][i] = rows[i][lane];
}

} // namespace
} // namespace flotilla
