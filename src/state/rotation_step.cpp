// SPDX-License-Identifier: MIT
#include "state/rotation_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace flotilla {
namespace {

constexpr int kMaxCorrections = 40;
// Of the energy. Small steps err by less than its rounding, always to the same side, and 10^5 of them add up; and a
// needle of inertia ratio 10^12 spins as fast as what is let pass here allows.
constexpr double kEnergyTolerance = 0x1p-10 * std::numeric_limits<double>::epsilon();

Vec3 scaled(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// Coefficients of E(theta) = E - a sin(theta) cos(theta) - c sin(theta)^2, the energy after a turn by theta about the
/// unit vector s.
struct EnergyOfTurn {
    double a, c;
};
EnergyOfTurn energy_of_turn(const Vec3& inverse, const Vec3& momentum, const Vec3& s, double e) {
    const Vec3 m = cross(s, momentum);
    return {dot(s, cross(momentum, scaled(inverse, momentum))), e - 0.5 * dot(m, scaled(inverse, m))};
}

Vec3 principal_axis(const Vec3& inverse, bool largest_inertia) {
    const double k = largest_inertia ? 1 : -1;
    const Vec3 d = k * inverse;
    if (d.x <= d.y && d.x <= d.z) return {1, 0, 0};
    return d.y <= d.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
}

/// The turn about the unit vector s by the angle whose sine and cosine are as y and x, to half the circle either way.
Quat turn_about(const Vec3& s, double y, double x) {
    const double size = std::max(std::abs(x), std::abs(y));
    if (!(size > 0)) return {};
    x /= size, y /= size;
    const double h = std::sqrt(x * x + y * y);
    const double cos_half = std::sqrt(std::max(0.0, 0.5 + 0.5 * x / h));
    const double sin_half = x > 0 ? 0.5 * y / (h * cos_half) : std::copysign(std::sqrt(0.5 - 0.5 * x / h), y);
    return {cos_half, sin_half * s.x, sin_half * s.y, sin_half * s.z};
}

/// The momentum of a body that was turned by q less that before, both in its own axes, for a unit quaternion; and the
/// rounding of its components.
struct Change {
    Vec3 value, rounding;
};
Change change_by_turn(const Quat& q, const Vec3& momentum) {
    constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon(); // of products
    const Vec3 v{q.x, q.y, q.z}, across = cross(v, momentum), x = abs(v), y = abs(momentum);
    const Vec3 terms{x.y * y.z + x.z * y.y, x.z * y.x + x.x * y.z, x.x * y.y + x.y * y.x};
    return {2 * (cross(v, across) - q.w * across), (2 * kRounding) * terms};
}

/// E(L + change) - E(L), and the rounding of that: a body of equal moments gains nothing, whatever the turn. What would
/// correct the rounding there is a turn of any size.
struct EnergyGained {
    double value, rounding;
};
EnergyGained energy_gained(const Vec3& inverse, const Vec3& momentum, const Change& change) {
    const Vec3 rate = scaled(inverse, momentum + 0.5 * change.value);
    return {dot(change.value, rate), dot(change.rounding, abs(rate))};
}

/// One correcting turn that takes off (k > 0) or adds (k < 0) the energy error k, or as much of it as one turn can.
Quat correcting_turn(const Vec3& inverse, const Vec3& momentum, double e, double k) {
    const Vec3 s = normalized(cross(momentum, scaled(inverse, momentum)));
    if (s != Vec3{}) {
        const auto [a, c] = energy_of_turn(inverse, momentum, s, e);
        const double root_sq = a * a + 4 * k * (c - k);
        if (root_sq >= 0 && a > 0) return turn_about(s, 2 * k, a + std::sqrt(root_sq));
    }
    // L is parallel to w, or no turn about s is enough: turn L towards the axis of largest inertia, where the energy is
    // least (or of smallest, where it is largest), as far as this helps, and let the caller look again.
    const Vec3 axis = principal_axis(inverse, k > 0);
    const Vec3 r = normalized(cross(dot(axis, momentum) < 0 ? -axis : axis, momentum));
    if (r == Vec3{}) return {};
    const auto [a, c] = energy_of_turn(inverse, momentum, r, e);
    const double root_sq = a * a + 4 * k * (c - k);
    if (root_sq >= 0 && c != k) {
        const double t1 = (-a + std::sqrt(root_sq)) / (2 * (c - k)), t2 = (-a - std::sqrt(root_sq)) / (2 * (c - k));
        return turn_about(r, std::abs(t1) < std::abs(t2) ? t1 : t2, 1);
    }
    const Quat twice = k > 0 ? turn_about(r, a, -c) : turn_about(r, -a, c);
    const double along = dot({twice.x, twice.y, twice.z}, r);
    return turn_about(r, along, twice.w);
}

/// R diag(d) R^T.
Mat3 symmetric_product(const Mat3& r, const Vec3& d) {
    const Vec3 x = row(r, 0), y = row(r, 1), z = row(r, 2), dx = scaled(d, x), dy = scaled(d, y);
    const double xy = dot(dx, y), xz = dot(dx, z), yz = dot(dy, z);
    return {{dot(dx, x), xy, xz, xy, dot(dy, y), yz, xz, yz, dot(scaled(d, z), z)}};
}

} // namespace

Vec3 rotation_vector_near(const Quat& q, const Vec3& near) {
    const Vec3 u = rotation_vector(q);
    const double angle = length(u);
    if (angle < 1e-9) {
        const double turns = std::round(length(near) / (2 * std::numbers::pi));
        return u + (turns * 2 * std::numbers::pi) * normalized(near);
    }
    const Vec3 axis = u / angle;
    const double turns = std::round((dot(near, axis) - angle) / (2 * std::numbers::pi));
    return (angle + turns * 2 * std::numbers::pi) * axis;
}

Mat3 turned(const Mat3& tensor, const Quat& rotation) {
    const Mat3 r = matrix(rotation);
    return r * (tensor * transpose(r));
}

PrincipalInertia turned(const PrincipalInertia& inertia, const Quat& rotation) {
    return {normalized(rotation * inertia.axes), inertia.moments, inertia.inverse};
}

Vec3 angular_velocity(const PrincipalInertia& inertia, const Vec3& momentum) {
    return rotate(inertia.axes, scaled(inertia.inverse, rotate(conjugate(inertia.axes), momentum)));
}

Vec3 angular_momentum(const PrincipalInertia& inertia, const Vec3& angular_velocity) {
    return rotate(inertia.axes, scaled(inertia.moments, rotate(conjugate(inertia.axes), angular_velocity)));
}

PrincipalInertia principal_form(const Mat3& tensor) {
    Eigen::Matrix3d m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m(i, j) = tensor.m[static_cast<std::size_t>(3 * i + j)];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(m);
    const Eigen::Matrix3d& v = eigen.eigenvectors();
    const Vec3 x{v(0, 0), v(1, 0), v(2, 0)}, y{v(0, 1), v(1, 1), v(2, 1)}, z = cross(x, y);
    const auto& d = eigen.eigenvalues();
    return {normalized(quaternion(Mat3{{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}})),
            {d(0), d(1), d(2)},
            {1 / d(0), 1 / d(1), 1 / d(2)}};
}

WorldInertia world_inertia(const PrincipalInertia& inertia) {
    const Mat3 r = matrix(inertia.axes);
    return {symmetric_product(r, inertia.moments), symmetric_product(r, inertia.inverse), inertia};
}

// In principal axes the body stands still and the momentum turns the other way.
RotationStep rotate_for(const PrincipalInertia& inertia, const Vec3& momentum, double dt) {
    const Vec3 start = rotate(conjugate(inertia.axes), momentum), omega = scaled(inertia.inverse, start);
    const Vec3 w = dt * omega + (0.5 * dt * dt) * scaled(inertia.inverse, cross(start, omega));
    const double e0 = 0.5 * dot(start, omega);
    const Quat first = rotation_from_vector(w);
    Quat q = first, best = first;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMaxCorrections; ++i) {
        const Change change = change_by_turn(q, start);
        const auto [gained, rounding] = energy_gained(inertia.inverse, start, change);
        if (!(std::abs(gained) < least)) break; // rounding
        least = std::abs(gained);
        best = q;
        if (least <= std::max(kEnergyTolerance * e0, rounding)) break;
        const Quat turn = correcting_turn(inertia.inverse, start + change.value, e0 + gained, gained);
        if (turn == Quat{}) break;
        q = normalized(q * turn);
    }
    const Vec3 turn = rotate(inertia.axes, {best.x, best.y, best.z}), vector = rotate(inertia.axes, w);
    const Quat world{best.w, turn.x, turn.y, turn.z};
    return {world, best == first ? vector : rotation_vector_near(world, vector)};
}

} // namespace flotilla
