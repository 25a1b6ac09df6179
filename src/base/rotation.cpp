// SPDX-License-Identifier: MIT
#include "base/rotation.hpp"

namespace flotilla {
namespace {

// pi/2 in three parts; the first two have 33 bits, so that k * part is exact for |k| < 2^20 (Cody and Waite).
constexpr double kHalfPi1 = 0x1.921fb544p+0;
constexpr double kHalfPi2 = 0x1.0b4611a6p-34;
constexpr double kHalfPi3 = 0x1.3198a2e037073p-69;
constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
constexpr double kTwoPi = 0x1.921fb54442d18p+2;
constexpr double kLargestDirect = 1e6;

// Taylor series on [-pi/4, pi/4]: the first term left out is below 1e-19 relative.
double sin_series(double x, double x2) {
    const double p =
        -1.0 / 6.0 +
        x2 * (1.0 / 120.0 +
              x2 * (-1.0 / 5040.0 +
                    x2 * (1.0 / 362880.0 +
                          x2 * (-1.0 / 39916800.0 +
                                x2 * (1.0 / 6227020800.0 + x2 * (-1.0 / 1307674368000.0 + x2 / 355687428096000.0))))));
    return x + (x * x2) * p;
}

double cos_series(double x2) {
    const double p =
        1.0 / 24.0 +
        x2 * (-1.0 / 720.0 +
              x2 * (1.0 / 40320.0 + x2 * (-1.0 / 3628800.0 + x2 * (1.0 / 479001600.0 + x2 * (-1.0 / 87178291200.0 +
                                                                                             x2 / 20922789888000.0)))));
    const double half = 0.5 * x2;
    const double one_minus = 1.0 - half;
    // (1 - one_minus) - half is what the subtraction rounded away.
    return one_minus + (((1.0 - one_minus) - half) + (x2 * x2) * p);
}

/// The angle in [0, pi/2] with this sine and cosine, to a few ulp: from an approximation to 5e-3 by two Newton steps of
/// third order.
double angle_of(const SinCos& unit) {
    const bool steep = unit.sin > unit.cos;
    const double ratio = steep ? unit.cos / unit.sin : unit.sin / unit.cos;
    const double about = ratio / (1 + 0.28 * ratio * ratio);
    double angle = steep ? kHalfPi1 - about : about;
    for (int i = 0; i < 2; ++i) {
        const SinCos at = sin_cos(angle);
        const double off = unit.sin * at.cos - unit.cos * at.sin;
        angle += off + off * off * off / 6;
    }
    return angle;
}

} // namespace

SinCos sin_cos(double x) {
    if (!(std::abs(x) <= kLargestDirect)) {
        x = std::fmod(x, kTwoPi);
        if (std::isnan(x)) return {x, x}; // has no quadrant
    }
    const double k = std::floor(x * kTwoOverPi + 0.5);
    const double r = ((x - k * kHalfPi1) - k * kHalfPi2) - k * kHalfPi3;
    const double r2 = r * r;
    const double s = sin_series(r, r2);
    const double c = cos_series(r2);
    switch (static_cast<long>(k) & 3) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
    }
}

Quat operator*(const Quat& a, const Quat& b) {
    return {(a.w * b.w - a.x * b.x) - (a.y * b.y + a.z * b.z), (a.w * b.x + a.x * b.w) + (a.y * b.z - a.z * b.y),
            (a.w * b.y + a.y * b.w) + (a.z * b.x - a.x * b.z), (a.w * b.z + a.z * b.w) + (a.x * b.y - a.y * b.x)};
}

double norm(const Quat& q) { return std::sqrt((q.w * q.w + q.x * q.x) + (q.y * q.y + q.z * q.z)); }

Quat normalized(const Quat& q) {
    const double n = norm(q);
    return n > 0 ? Quat{q.w / n, q.x / n, q.y / n, q.z / n} : Quat{};
}

Quat rotation_from_vector(const Vec3& w) {
    const double angle = length(w);
    const auto [s, c] = sin_cos(0.5 * angle);
    // sin(a/2)/a tends to 1/2; below 1e-9 the next term, a^2/48, is under one ulp. The length itself underflows there
    // too.
    const double k = angle > 1e-9 ? s / angle : 0.5;
    return {c, k * w.x, k * w.y, k * w.z};
}

Vec3 rotation_vector(const Quat& q) {
    const Vec3 v = q.w < 0 ? Vec3{-q.x, -q.y, -q.z} : Vec3{q.x, q.y, q.z};
    const double s = length(v);
    if (s < 1e-9) return 2.0 * v;
    return (2.0 * angle_of({s, std::abs(q.w)}) / s) * v;
}

Mat3 matrix(const Quat& q) {
    const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
    const double xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
    const double wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
    return {{1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy), 2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx),
             2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)}};
}

Quat quaternion(const Mat3& r) {
    const auto& m = r.m;
    const double trace = m[0] + m[4] + m[8];
    Quat q;
    if (trace >= m[0] && trace >= m[4] && trace >= m[8]) {
        q = {1 + trace, m[7] - m[5], m[2] - m[6], m[3] - m[1]};
    } else if (m[0] >= m[4] && m[0] >= m[8]) {
        q = {m[7] - m[5], 1 + m[0] - m[4] - m[8], m[1] + m[3], m[2] + m[6]};
    } else if (m[4] >= m[8]) {
        q = {m[2] - m[6], m[1] + m[3], 1 + m[4] - m[0] - m[8], m[5] + m[7]};
    } else {
        q = {m[3] - m[1], m[2] + m[6], m[5] + m[7], 1 + m[8] - m[0] - m[4]};
    }
    if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
    return normalized(q);
}

Vec3 rotate(const Quat& q, const Vec3& v) { return matrix(q) * v; }

} // namespace flotilla
