// SPDX-License-Identifier: MIT
// Double-double arithmetic: an unevaluated sum hi + lo of two doubles, about 31 decimal digits. For set-up work whose
// result is rounded to double at the end. Additions and products are the textbook error-free transformations (Dekker
// 1971, Knuth); they need rounding to nearest, no contraction, no excess precision, and magnitudes below 2^996 (the
// split overflows above).
#pragma once

#include <cmath>

namespace flotilla {

struct DoubleDouble {
    double hi = 0, lo = 0;
    constexpr DoubleDouble() = default;
    constexpr DoubleDouble(double x) : hi(x) {} // NOLINT(google-explicit-constructor): doubles mix freely with it
    constexpr DoubleDouble(double h, double l) : hi(h), lo(l) {}
};

/// a + b exactly.
constexpr DoubleDouble two_sum(double a, double b) {
    const double s = a + b;
    const double bb = s - a;
    return {s, (a - (s - bb)) + (b - bb)};
}
/// a + b exactly where |a| >= |b| or a = 0.
constexpr DoubleDouble quick_two_sum(double a, double b) {
    const double s = a + b;
    return {s, b - (s - a)};
}
/// a b exactly, barring underflow.
constexpr DoubleDouble two_product(double a, double b) {
    constexpr double kSplit = 134217729; // 2^27 + 1
    const double p = a * b;
    const double ta = kSplit * a, tb = kSplit * b;
    const double ah = ta - (ta - a), bh = tb - (tb - b);
    const double al = a - ah, bl = b - bh;
    return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

constexpr DoubleDouble operator-(const DoubleDouble& a) { return {-a.hi, -a.lo}; }
constexpr DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    DoubleDouble s = two_sum(a.hi, b.hi);
    const DoubleDouble t = two_sum(a.lo, b.lo);
    s = quick_two_sum(s.hi, s.lo + t.hi);
    return quick_two_sum(s.hi, s.lo + t.lo);
}
constexpr DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + (-b); }
constexpr DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble p = two_product(a.hi, b.hi);
    return quick_two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}
constexpr DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double q1 = a.hi / b.hi;
    const DoubleDouble r1 = a - b * DoubleDouble(q1);
    const double q2 = r1.hi / b.hi;
    const DoubleDouble r2 = r1 - b * DoubleDouble(q2);
    return quick_two_sum(q1, q2) + DoubleDouble(r2.hi / b.hi);
}
constexpr DoubleDouble& operator+=(DoubleDouble& a, const DoubleDouble& b) { return a = a + b; }
constexpr DoubleDouble& operator-=(DoubleDouble& a, const DoubleDouble& b) { return a = a - b; }

constexpr bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
    return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo);
}
constexpr bool operator>(const DoubleDouble& a, const DoubleDouble& b) { return b < a; }
constexpr DoubleDouble abs(const DoubleDouble& a) { return a.hi < 0 ? -a : a; }
constexpr double to_double(const DoubleDouble& a) { return a.hi + a.lo; }

/// Zero where a <= 0. One Newton step from the double root doubles its digits (Karp's trick).
inline DoubleDouble sqrt(const DoubleDouble& a) {
    if (!(a.hi > 0)) return {};
    const double x = std::sqrt(a.hi);
    const DoubleDouble residual = a - two_product(x, x);
    return quick_two_sum(x, residual.hi / (2 * x));
}

} // namespace flotilla
