// SPDX-License-Identifier: MIT
// One contact in its own frame (normal, tangent 1, tangent 2): the projection of eqs 17-20 and nothing else. It knows the
// contact's relative velocity u, its impulse and the 3x3 matrix W that turns a change of the one into a change of the
// other; where u comes from (bodies, or a matrix of a test problem) is the caller's business.
//
// A visit does the three scalar rows of projected Gauss-Seidel in the order normal, tangent 1, tangent 2; each row sees
// what the rows before it did. Deviations from eqs 18-20: Cone::disc replaces the pyramid by |lambda_t| <= mu lambda_n
// with the friction opposite to the slip, because the pyramid's friction is up to sqrt(2) too large along its diagonal
// (on average over random tangents 4/pi).
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec3.hpp"

namespace flotilla {

/// Shape of the friction bound.
enum class Cone : std::uint8_t {
    pyramid, ///< |lambda_1| <= mu lambda_n, |lambda_2| <= mu lambda_n (eqs 18-20)
    disc,    ///< |(lambda_1, lambda_2)| <= mu lambda_n
    frozen,  ///< pyramid with a given bound instead of mu lambda_n: shock propagation
};

/// Components x, y, z of a Vec3 in contact coordinates are normal, tangent 1, tangent 2.
struct LocalContact {
    Vec3 mass_diagonal;     ///< 1/kg: W_nn, W_11, W_22, each > 0
    Vec3 inv_mass_diagonal; ///< kg: their inverses
    Vec3 coupling;          ///< 1/kg: W_n1, W_n2, W_12
    Vec3 impulse;           ///< N s: lambda_n >= 0, lambda_1, lambda_2
    double target = 0;      ///< m/s: u_n >= target
    double friction = 0;    ///< mu; with Cone::frozen the bound itself, N s
};

struct Vec2 {
    double x = 0, y = 0;
};

/// The violation is |change of impulse| W_ii in m/s: |u_n - target| where the contact holds, the approach where it does
/// not, nothing where a sliding contact already has its full friction.
struct LocalUpdate {
    Vec3 change;          ///< N s
    double violation = 0; ///< m/s, largest of the three rows, each seen at its turn
};

template <Cone kCone>
double friction_bound(const LocalContact& c, double normal_impulse) {
    return kCone == Cone::frozen ? c.friction : c.friction * normal_impulse;
}

/// The tangential impulse (W_tt + s I)^-1 rhs, for s >= 0.
inline Vec2 solve_tangent(const LocalContact& c, double s, const Vec2& rhs) {
    const double w11 = c.mass_diagonal.y + s, w22 = c.mass_diagonal.z + s, w12 = c.coupling.z;
    const double scale = 1.0 / (w11 * w22 - w12 * w12);
    return {scale * (w22 * rhs.x - w12 * rhs.y), scale * (w11 * rhs.y - w12 * rhs.x)};
}

/// The tangential impulse of the disc |lambda| <= bound for slip velocity u at the present impulse: the minimiser of
/// 1/2 lambda W lambda + b lambda over the disc, b = u - W lambda_old. Inside the disc it stops the slip; on its edge it
/// is -(W + s I)^-1 b, where s = |slip after| / bound makes friction and slip opposite. s is found by Newton's method on
/// 1/|lambda(s)|, started from the present slip, so that at the solution of the whole system the first guess is exact;
/// three steps, because the next visit goes on from there.
inline Vec2 disc_impulse(const LocalContact& c, const Vec2& u, double bound) {
    const Vec2 rhs{(c.mass_diagonal.y * c.impulse.y + c.coupling.z * c.impulse.z) - u.x,
                   (c.coupling.z * c.impulse.y + c.mass_diagonal.z * c.impulse.z) - u.y};
    if (!(bound > 0)) return {};
    Vec2 l = solve_tangent(c, 0, rhs);
    if (l.x * l.x + l.y * l.y <= bound * bound) return l;
    double s = std::sqrt(u.x * u.x + u.y * u.y) / bound;
    for (int i = 0; i < 3; ++i) {
        l = solve_tangent(c, s, rhs);
        const Vec2 m = solve_tangent(c, s, l);
        const double square = l.x * l.x + l.y * l.y;
        const double slope = l.x * m.x + l.y * m.y;
        if (!(slope > 0)) break;
        s = std::max(0.0, s + (std::sqrt(square) / bound - 1) * square / slope);
    }
    l = solve_tangent(c, s, rhs);
    const double scale = bound / std::sqrt(l.x * l.x + l.y * l.y);
    return {scale * l.x, scale * l.y};
}

/// One visit: the change that eqs 17-20 ask for at relative velocity u (of the present impulse). Does not apply it.
template <Cone kCone>
LocalUpdate visit(const LocalContact& c, const Vec3& u) {
    LocalUpdate r;
    r.change.x = std::max(0.0, c.impulse.x - (u.x - c.target) * c.inv_mass_diagonal.x) - c.impulse.x;
    const double bound = friction_bound<kCone>(c, c.impulse.x + r.change.x);
    const double u1 = u.y + c.coupling.x * r.change.x;
    const double u2 = u.z + c.coupling.y * r.change.x;
    if constexpr (kCone == Cone::disc) {
        const Vec2 l = disc_impulse(c, {u1, u2}, bound);
        r.change.y = l.x - c.impulse.y;
        r.change.z = l.y - c.impulse.z;
    } else {
        r.change.y = std::clamp(c.impulse.y - u1 * c.inv_mass_diagonal.y, -bound, bound) - c.impulse.y;
        const double u2_after = u2 + c.coupling.z * r.change.y;
        r.change.z = std::clamp(c.impulse.z - u2_after * c.inv_mass_diagonal.z, -bound, bound) - c.impulse.z;
    }
    r.violation = std::max(std::max(std::abs(r.change.x) * c.mass_diagonal.x, std::abs(r.change.y) * c.mass_diagonal.y),
                           std::abs(r.change.z) * c.mass_diagonal.z);
    return r;
}

/// Constraint violation at relative velocity u with nothing applied, m/s: for every row |lambda - P(lambda - u / W)| W,
/// which is zero exactly at a solution of eqs 17-20 (of the disc law, with W the larger tangential diagonal, for
/// Cone::disc). The friction bound is that of the present normal impulse.
template <Cone kCone>
double violation(const LocalContact& c, const Vec3& u) {
    const double n = std::max(0.0, c.impulse.x - (u.x - c.target) * c.inv_mass_diagonal.x) - c.impulse.x;
    const double bound = friction_bound<kCone>(c, c.impulse.x);
    Vec2 l;
    Vec2 scale{c.mass_diagonal.y, c.mass_diagonal.z};
    if constexpr (kCone == Cone::disc) {
        scale.x = scale.y = std::max(c.mass_diagonal.y, c.mass_diagonal.z);
        l = {c.impulse.y - u.y / scale.x, c.impulse.z - u.z / scale.y};
        const double size = std::sqrt(l.x * l.x + l.y * l.y);
        const double shrink = size > bound ? bound / size : 1.0;
        l = {shrink * l.x, shrink * l.y};
    } else {
        l = {std::clamp(c.impulse.y - u.y * c.inv_mass_diagonal.y, -bound, bound),
             std::clamp(c.impulse.z - u.z * c.inv_mass_diagonal.z, -bound, bound)};
    }
    return std::max(std::max(std::abs(n) * c.mass_diagonal.x, std::abs(l.x - c.impulse.y) * scale.x),
                    std::abs(l.y - c.impulse.z) * scale.y);
}

/// The impulse nearest to an old one that the bounds allow: what a warm start may begin with.
template <Cone kCone>
Vec3 cut_to_cone(const Vec3& impulse, double friction) {
    const double n = std::max(0.0, impulse.x);
    const double bound = friction * n;
    if constexpr (kCone == Cone::disc) {
        const double size = std::sqrt(impulse.y * impulse.y + impulse.z * impulse.z);
        const double shrink = size > bound ? bound / size : 1.0;
        return {n, shrink * impulse.y, shrink * impulse.z};
    } else {
        return {n, std::clamp(impulse.y, -bound, bound), std::clamp(impulse.z, -bound, bound)};
    }
}

} // namespace flotilla
