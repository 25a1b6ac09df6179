// SPDX-License-Identifier: MIT
// Four lanes of AVX2. Included only by files compiled for that instruction set; everything has internal linkage, so
// that no inline function compiled here can replace the baseline one of another file at link time.
#pragma once

#include <immintrin.h>

namespace flotilla {
namespace {

struct Avx2Mask {
    __m256d m;
};

struct Avx2Pack {
    static constexpr int kWidth = 4;
    __m256d v;

    static Avx2Pack all(double x) { return {_mm256_set1_pd(x)}; }
    static Avx2Pack load(const double* p) { return {_mm256_loadu_pd(p)}; }
    void store(double* p) const { _mm256_storeu_pd(p, v); }
    static Avx2Mask lanes(unsigned bits) {
        const __m256i lane = _mm256_set_epi64x(8, 4, 2, 1);
        const __m256i set = _mm256_and_si256(_mm256_set1_epi64x(static_cast<long long>(bits)), lane);
        return {_mm256_castsi256_pd(_mm256_cmpeq_epi64(set, lane))};
    }

    friend Avx2Pack operator+(Avx2Pack a, Avx2Pack b) { return {_mm256_add_pd(a.v, b.v)}; }
    friend Avx2Pack operator-(Avx2Pack a, Avx2Pack b) { return {_mm256_sub_pd(a.v, b.v)}; }
    friend Avx2Pack operator*(Avx2Pack a, Avx2Pack b) { return {_mm256_mul_pd(a.v, b.v)}; }
    friend Avx2Pack operator/(Avx2Pack a, Avx2Pack b) { return {_mm256_div_pd(a.v, b.v)}; }
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

inline void transpose(Avx2Pack r0, Avx2Pack r1, Avx2Pack r2, Avx2Pack r3, Avx2Pack (&out)[4]) {
    const __m256d lo01 = _mm256_unpacklo_pd(r0.v, r1.v), hi01 = _mm256_unpackhi_pd(r0.v, r1.v);
    const __m256d lo23 = _mm256_unpacklo_pd(r2.v, r3.v), hi23 = _mm256_unpackhi_pd(r2.v, r3.v);
    out[0] = {_mm256_permute2f128_pd(lo01, lo23, 0x20)};
    out[1] = {_mm256_permute2f128_pd(hi01, hi23, 0x20)};
    out[2] = {_mm256_permute2f128_pd(lo01, lo23, 0x31)};
    out[3] = {_mm256_permute2f128_pd(hi01, hi23, 0x31)};
}
inline void load_transposed(const double* const* lanes, int first, Avx2Pack (&out)[4]) {
    transpose(Avx2Pack::load(lanes[0] + first), Avx2Pack::load(lanes[1] + first), Avx2Pack::load(lanes[2] + first),
              Avx2Pack::load(lanes[3] + first), out);
}
inline void load_transposed(const double* const (&points)[4], Avx2Pack (&xyz)[3]) {
    const auto two = [&](int low, int high, int i) {
        return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(points[low] + i)),
                                    _mm_loadu_pd(points[high] + i), 1);
    };
    const __m256d xy02 = two(0, 2, 0), xy13 = two(1, 3, 0), yz02 = two(0, 2, 1), yz13 = two(1, 3, 1);
    xyz[0] = {_mm256_unpacklo_pd(xy02, xy13)};
    xyz[1] = {_mm256_unpackhi_pd(xy02, xy13)};
    xyz[2] = {_mm256_unpackhi_pd(yz02, yz13)};
}
inline void store_transposed(const Avx2Pack (&in)[4], unsigned which, double* const* out) {
    Avx2Pack rows[4];
    transpose(in[0], in[1], in[2], in[3], rows);
    for (unsigned lane = 0; lane < 4; ++lane)
        if (((which >> lane) & 1u) != 0) rows[lane].store(out[lane]);
}

} // namespace
} // namespace flotilla
