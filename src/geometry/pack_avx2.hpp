// SPDX-License-Identifier: MIT
// Four lanes of AVX2. Included only by files compiled for that instruction set; everything has internal linkage, so that no
// inline function compiled here can replace the baseline one of another file at link time.
#pragma once

#include <immintrin.h>

namespace flotilla {
namespace {

struct Avx2Pack {
    static constexpr int kWidth = 4;
    __m256d v;

    static Avx2Pack all(double x) { return {_mm256_set1_pd(x)}; }
    static Avx2Pack load(const double* p) { return {_mm256_loadu_pd(p)}; }
    void store(double* p) const { _mm256_storeu_pd(p, v); }

    friend Avx2Pack operator+(Avx2Pack a, Avx2Pack b) { return {_mm256_add_pd(a.v, b.v)}; }
    friend Avx2Pack operator-(Avx2Pack a, Avx2Pack b) { return {_mm256_sub_pd(a.v, b.v)}; }
    friend Avx2Pack operator*(Avx2Pack a, Avx2Pack b) { return {_mm256_mul_pd(a.v, b.v)}; }
    friend Avx2Pack operator/(Avx2Pack a, Avx2Pack b) { return {_mm256_div_pd(a.v, b.v)}; }
};

struct Avx2Mask {
    __m256d m;
};

inline Avx2Mask operator<(Avx2Pack a, Avx2Pack b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ)}; }
inline Avx2Mask operator<=(Avx2Pack a, Avx2Pack b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_LE_OQ)}; }
inline Avx2Pack min(Avx2Pack a, Avx2Pack b) { return {_mm256_min_pd(a.v, b.v)}; }
inline Avx2Pack max(Avx2Pack a, Avx2Pack b) { return {_mm256_max_pd(a.v, b.v)}; }
inline Avx2Pack sqrt(Avx2Pack a) { return {_mm256_sqrt_pd(a.v)}; }
inline Avx2Pack abs(Avx2Pack a) { return {_mm256_andnot_pd(_mm256_set1_pd(-0.0), a.v)}; }
inline Avx2Pack flip_sign(Avx2Pack a, Avx2Pack s) {
    return {_mm256_xor_pd(a.v, _mm256_and_pd(s.v, _mm256_set1_pd(-0.0)))};
}
inline Avx2Pack ceil_power_of_two(Avx2Pack a) {
    const __m256i up = _mm256_add_epi64(_mm256_castpd_si256(a.v), _mm256_set1_epi64x(0x000fffffffffffffll));
    return {_mm256_castsi256_pd(_mm256_and_si256(up, _mm256_set1_epi64x(0x7ff0000000000000ll)))};
}
inline Avx2Pack select(Avx2Mask m, Avx2Pack a, Avx2Pack b) { return {_mm256_blendv_pd(b.v, a.v, m.m)}; }
inline Avx2Mask mask_and(Avx2Mask a, Avx2Mask b) { return {_mm256_and_pd(a.m, b.m)}; }
inline Avx2Mask mask_or(Avx2Mask a, Avx2Mask b) { return {_mm256_or_pd(a.m, b.m)}; }
inline Avx2Mask mask_not(Avx2Mask a) { return {_mm256_xor_pd(a.m, _mm256_castsi256_pd(_mm256_set1_epi64x(-1)))}; }
inline unsigned mask_bits(Avx2Mask a) { return static_cast<unsigned>(_mm256_movemask_pd(a.m)); }

inline void load_transposed(const double* const* lanes, int first, Avx2Pack (&out)[4]) {
    const __m256d r0 = _mm256_loadu_pd(lanes[0] + first), r1 = _mm256_loadu_pd(lanes[1] + first);
    const __m256d r2 = _mm256_loadu_pd(lanes[2] + first), r3 = _mm256_loadu_pd(lanes[3] + first);
    const __m256d lo01 = _mm256_unpacklo_pd(r0, r1), hi01 = _mm256_unpackhi_pd(r0, r1);
    const __m256d lo23 = _mm256_unpacklo_pd(r2, r3), hi23 = _mm256_unpackhi_pd(r2, r3);
    out[0] = {_mm256_permute2f128_pd(lo01, lo23, 0x20)};
    out[1] = {_mm256_permute2f128_pd(hi01, hi23, 0x20)};
    out[2] = {_mm256_permute2f128_pd(lo01, lo23, 0x31)};
    out[3] = {_mm256_permute2f128_pd(hi01, hi23, 0x31)};
}

} // namespace
} // namespace flotilla
