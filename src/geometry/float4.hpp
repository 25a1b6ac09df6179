// SPDX-License-Identifier: MIT
// Four floats side by side. SSE2 is part of baseline x86-64; elsewhere plain code with the same results, bit for bit.
// Every operation is the IEEE one per lane; larger() and smaller() return their second argument where a lane holds a
// NaN.
#pragma once

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace flotilla {

#if defined(__SSE2__)

struct Float4 {
    __m128 v;
};
/// All bits of a lane set (true) or none (false).
struct Mask4 {
    __m128 v;
};

inline Float4 load4(const float* aligned) { return {_mm_load_ps(aligned)}; }
inline void store(float* aligned, Float4 a) { _mm_store_ps(aligned, a.v); }
inline Float4 both4(float x) { return {_mm_set1_ps(x)}; }
/// The nearest floats.
inline Float4 narrow4(double a, double b, double c, double d) {
    return {_mm_movelh_ps(_mm_cvtpd_ps(_mm_set_pd(b, a)), _mm_cvtpd_ps(_mm_set_pd(d, c)))};
}
inline Float4 both4_but_last(float x) { return {_mm_set_ps(0, x, x, x)}; }
inline Float4 magnitude(Float4 a) { return {_mm_andnot_ps(_mm_set1_ps(-0.0f), a.v)}; }
inline Float4 operator+(Float4 a, Float4 b) { return {_mm_add_ps(a.v, b.v)}; }
inline Float4 operator-(Float4 a, Float4 b) { return {_mm_sub_ps(a.v, b.v)}; }
inline Float4 operator*(Float4 a, Float4 b) { return {_mm_mul_ps(a.v, b.v)}; }
inline Float4 operator/(Float4 a, Float4 b) { return {_mm_div_ps(a.v, b.v)}; }
inline Float4 larger(Float4 a, Float4 b) { return {_mm_max_ps(a.v, b.v)}; }
inline Float4 smaller(Float4 a, Float4 b) { return {_mm_min_ps(a.v, b.v)}; }
inline Mask4 operator>(Float4 a, Float4 b) { return {_mm_cmpgt_ps(a.v, b.v)}; }
inline Mask4 operator&(Mask4 a, Mask4 b) { return {_mm_and_ps(a.v, b.v)}; }
inline Mask4 operator|(Mask4 a, Mask4 b) { return {_mm_or_ps(a.v, b.v)}; }
inline bool any(Mask4 m) { return _mm_movemask_ps(m.v) != 0; }
/// a where the mask is set, else b.
inline Float4 select(Mask4 m, Float4 a, Float4 b) { return {_mm_or_ps(_mm_and_ps(m.v, a.v), _mm_andnot_ps(m.v, b.v))}; }
/// a where the mask is set, else +0.
inline Float4 select_or_zero(Mask4 m, Float4 a) { return {_mm_and_ps(m.v, a.v)}; }
/// Of the first three lanes; no NaN among them.
inline float largest3(Float4 a) {
    const __m128 m = _mm_max_ps(a.v, _mm_shuffle_ps(a.v, a.v, _MM_SHUFFLE(3, 0, 2, 1)));
    return _mm_cvtss_f32(_mm_max_ss(m, _mm_shuffle_ps(a.v, a.v, _MM_SHUFFLE(3, 1, 0, 2))));
}
inline float smallest3(Float4 a) {
    const __m128 m = _mm_min_ps(a.v, _mm_shuffle_ps(a.v, a.v, _MM_SHUFFLE(3, 0, 2, 1)));
    return _mm_cvtss_f32(_mm_min_ss(m, _mm_shuffle_ps(a.v, a.v, _MM_SHUFFLE(3, 1, 0, 2))));
}
/// Of all four lanes; no NaN among them.
inline float largest4(Float4 a) {
    const __m128 m = _mm_max_ps(a.v, _mm_movehl_ps(a.v, a.v));
    return _mm_cvtss_f32(_mm_max_ss(m, _mm_shuffle_ps(m, m, _MM_SHUFFLE(1, 1, 1, 1))));
}

#else

struct Float4 {
    float v[4];
};
struct Mask4 {
    bool v[4];
};

namespace float4_detail {
template <class F>
Float4 lanes(F&& f) {
    return {{f(0), f(1), f(2), f(3)}};
}
template <class F>
Mask4 masks(F&& f) {
    return {{f(0), f(1), f(2), f(3)}};
}
} // namespace float4_detail

inline Float4 load4(const float* p) {
    return float4_detail::lanes([&](int i) { return p[i]; });
}
inline void store(float* p, Float4 a) {
    for (int i = 0; i < 4; ++i) p[i] = a.v[i];
}
inline Float4 both4(float x) { return {{x, x, x, x}}; }
inline Float4 narrow4(double a, double b, double c, double d) {
    return {{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), static_cast<float>(d)}};
}
inline Float4 both4_but_last(float x) { return {{x, x, x, 0}}; }
inline Float4 magnitude(Float4 a) {
    return float4_detail::lanes([&](int i) { return a.v[i] < 0 ? -a.v[i] : a.v[i]; });
}
inline Float4 operator+(Float4 a, Float4 b) {
    return float4_detail::lanes([&](int i) { return a.v[i] + b.v[i]; });
}
inline Float4 operator-(Float4 a, Float4 b) {
    return float4_detail::lanes([&](int i) { return a.v[i] - b.v[i]; });
}
inline Float4 operator*(Float4 a, Float4 b) {
    return float4_detail::lanes([&](int i) { return a.v[i] * b.v[i]; });
}
inline Float4 operator/(Float4 a, Float4 b) {
    return float4_detail::lanes([&](int i) { return a.v[i] / b.v[i]; });
}
inline Float4 larger(Float4 a, Float4 b) {
    return float4_detail::lanes([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
}
inline Float4 smaller(Float4 a, Float4 b) {
    return float4_detail::lanes([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
}
inline Mask4 operator>(Float4 a, Float4 b) {
    return float4_detail::masks([&](int i) { return a.v[i] > b.v[i]; });
}
inline Mask4 operator&(Mask4 a, Mask4 b) {
    return float4_detail::masks([&](int i) { return a.v[i] && b.v[i]; });
}
inline Mask4 operator|(Mask4 a, Mask4 b) {
    return float4_detail::masks([&](int i) { return a.v[i] || b.v[i]; });
}
inline bool any(Mask4 m) { return m.v[0] || m.v[1] || m.v[2] || m.v[3]; }
inline Float4 select(Mask4 m, Float4 a, Float4 b) {
    return float4_detail::lanes([&](int i) { return m.v[i] ? a.v[i] : b.v[i]; });
}
inline Float4 select_or_zero(Mask4 m, Float4 a) { return select(m, a, both4(0)); }
inline float largest3(Float4 a) {
    const float m = a.v[0] > a.v[1] ? a.v[0] : a.v[1];
    return m > a.v[2] ? m : a.v[2];
}
inline float smallest3(Float4 a) {
    const float m = a.v[0] < a.v[1] ? a.v[0] : a.v[1];
    return m < a.v[2] ? m : a.v[2];
}
inline float largest4(Float4 a) {
    const float m = largest3(a);
    return m > a.v[3] ? m : a.v[3];
}

#endif

} // namespace flotilla
