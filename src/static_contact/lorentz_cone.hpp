// SPDX-License-Identifier: MIT
// The Lorentz cone L = {(x, y, z): |(y, z)| <= x}: its Jordan product and the scaling of Nesterov and Todd, in the
// notation of Vandenberghe, The CVXOPT linear and quadratic cone program solvers (2010), sections 4 and 5. J = diag(1,
// -1, -1). Vectors with y = z = 0 form the half-line x >= 0, and every function here keeps them there.
#pragma once

#include <cmath>
#include <limits>

#include "base/vec3.hpp"

namespace flotilla {

constexpr Mat3 outer(const Vec3& a, const Vec3& b) {
    return {{a.x * b.x, a.x * b.y, a.x * b.z, a.y * b.x, a.y * b.y, a.y * b.z, a.z * b.x, a.z * b.y, a.z * b.z}};
}

/// Length of the last two components: of an impulse its friction, of a velocity its slip.
inline double tangential_length(const Vec3& a) { return std::sqrt(a.y * a.y + a.z * a.z); }

/// a J a, positive inside the cone and of its opposite. Written as a product: the difference of squares loses near the
/// edge the digits that decide.
inline double lorentz_square(const Vec3& a) {
    const double t = tangential_length(a);
    return (a.x - t) * (a.x + t);
}

constexpr Vec3 jordan_product(const Vec3& a, const Vec3& b) {
    return {dot(a, b), a.x * b.y + b.x * a.y, a.x * b.z + b.x * a.z};
}

/// The z with a o z = b, for a inside the cone.
inline Vec3 jordan_quotient(const Vec3& b, const Vec3& a) {
    const double z = (a.x * b.x - (a.y * b.y + a.z * b.z)) / lorentz_square(a);
    return {z, (b.y - z * a.y) / a.x, (b.z - z * a.z) / a.x};
}

/// The largest t for which x + t d is in the cone, for x inside it; infinite where the ray never leaves it.
inline double step_to_edge(const Vec3& x, const Vec3& d) {
    const double root = std::sqrt(lorentz_square(x));
    const Vec3 l = x / root;
    const double rho = (l.x * d.x - (l.y * d.y + l.z * d.z)) / root;
    const double f = (rho + d.x / root) / (l.x + 1);
    const double excess = tangential_length({0, d.y / root - f * l.y, d.z / root - f * l.z}) - rho;
    return excess <= 0 ? std::numeric_limits<double>::infinity() : 1 / excess;
}

/// The symmetric W = eta [w_0, w_1^T; w_1, I + w_1 w_1^T / (1 + w_0)], w J w = 1, with W x = W^-1 y.
struct NesterovTodd {
    double eta = 1;
    Vec3 w{1, 0, 0};

    static NesterovTodd of(const Vec3& x, const Vec3& y) {
        const double size_x = std::sqrt(lorentz_square(x)), size_y = std::sqrt(lorentz_square(y));
        const Vec3 a = x / size_x, b = y / size_y;
        const double twice_gamma = 2 * std::sqrt((1 + dot(a, b)) / 2);
        NesterovTodd s;
        s.w = {0, (b.y - a.y) / twice_gamma, (b.z - a.z) / twice_gamma};
        s.w.x = std::sqrt(1 + (s.w.y * s.w.y + s.w.z * s.w.z)); // so that w J w = 1 in spite of rounding
        s.eta = std::sqrt(size_y / size_x);
        return s;
    }
    Vec3 apply(const Vec3& v) const {
        const double along = w.y * v.y + w.z * v.z, f = v.x + along / (1 + w.x);
        return eta * Vec3{w.x * v.x + along, v.y + f * w.y, v.z + f * w.z};
    }
    Vec3 apply_inverse(const Vec3& v) const {
        const double along = w.y * v.y + w.z * v.z, f = along / (1 + w.x) - v.x;
        return (1 / eta) * Vec3{w.x * v.x - along, v.y + f * w.y, v.z + f * w.z};
    }
    /// W^-2 = (2 Jw (Jw)^T - J) / eta^2.
    Mat3 inverse_square() const {
        const Vec3 jw{w.x, -w.y, -w.z};
        return (1 / (eta * eta)) * (2 * outer(jw, jw) - diagonal({1, -1, -1}));
    }
};

} // namespace flotilla
