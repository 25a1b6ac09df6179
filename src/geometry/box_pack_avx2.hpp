// SPDX-License-Identifier: MIT
// A coarse box in one register. Included only by files compiled for that instruction set; everything has internal
// linkage, so that no inline function compiled here can replace the baseline one of another file at link time.
#pragma once

#include <immintrin.h>

#include "geometry/coarse_box.hpp"

namespace flotilla {
namespace {

struct Avx2BoxPack {
    __m256 v;

    static Avx2BoxPack load(const CoarseBox& box) { return {_mm256_load_ps(reinterpret_cast<const float*>(&box))}; }
    static Avx2BoxPack all(float x) { return {_mm256_set1_ps(x)}; }
    friend Avx2BoxPack merged(Avx2BoxPack a, Avx2BoxPack b) { return {_mm256_min_ps(a.v, b.v)}; }
    friend Avx2BoxPack turned(Avx2BoxPack a) { return {_mm256_permute2f128_ps(a.v, a.v, 1)}; }
    friend Avx2BoxPack operator+(Avx2BoxPack a, Avx2BoxPack b) { return {_mm256_add_ps(a.v, b.v)}; }
    friend Avx2BoxPack operator-(Avx2BoxPack a, Avx2BoxPack b) { return {_mm256_sub_ps(a.v, b.v)}; }
    friend Avx2BoxPack operator*(Avx2BoxPack a, Avx2BoxPack b) { return {_mm256_mul_ps(a.v, b.v)}; }
    friend float largest(Avx2BoxPack a) {
        const __m128 four = _mm_max_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1));
        const __m128 two = _mm_max_ps(four, _mm_movehl_ps(four, four));
        return _mm_cvtss_f32(_mm_max_ss(two, _mm_movehdup_ps(two)));
    }
    friend bool any_greater(Avx2BoxPack a, Avx2BoxPack b) {
        return _mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ)) != 0;
    }
    friend bool any_greater_twice(Avx2BoxPack a, Avx2BoxPack b, Avx2BoxPack c, Avx2BoxPack d) {
        const __m256 first = _mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ), second = _mm256_cmp_ps(c.v, d.v, _CMP_GT_OQ);
        return _mm256_testz_ps(first, second) == 0;
    }
};

} // namespace
} // namespace flotilla
