// SPDX-License-Identifier: MIT
#include "response/impulse.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace flotilla {
namespace {

Mat3 point_mobility(const Impulsive& body, const Vec3& arm) {
    const Mat3 r = cross_matrix(arm);
    const double w = body.inverse_mass;
    return diagonal(free_part(body.locked, {w, w, w})) + transpose(r) * (body.inverse_inertia * r);
}

/// Solves K x = b for a symmetric positive definite K (Cramer's rule by cross products).
std::optional<Vec3> solve(const Mat3& k, const Vec3& b) {
    const Vec3 r0 = row(k, 0), r1 = row(k, 1), r2 = row(k, 2);
    const Vec3 c0 = cross(r1, r2), c1 = cross(r2, r0), c2 = cross(r0, r1);
    const double det = dot(r0, c0);
    if (!(det > 0)) return std::nullopt;
    return (b.x * c0 + b.y * c1 + b.z * c2) / det;
}

/// The least x with K x = b for a symmetric positive semidefinite K, as bodies with locked axes have it; nothing where
/// b asks for a motion that no impulse makes.
std::optional<Vec3> solve_semidefinite(const Mat3& k, const Vec3& b) {
    constexpr double kNoMotion = 1e-9; // of b
    Eigen::Matrix3d m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m(i, j) = k.m[static_cast<std::size_t>(3 * i + j)];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(m); // values ascend
    Vec3 x;
    double left = 0;
    for (int i = 0; i < 3; ++i) {
        const auto column = eigen.eigenvectors().col(i);
        const Vec3 axis{column(0), column(1), column(2)};
        if (eigen.eigenvalues()(i) > kLeastMobility * eigen.eigenvalues()(2))
            x += (dot(axis, b) / eigen.eigenvalues()(i)) * axis;
        else
            left = std::max(left, std::abs(dot(axis, b)));
    }
    if (left > kNoMotion * length(b)) return std::nullopt;
    return x;
}

bool can_move(const Impulsive& body, const Vec3& arm, const Vec3& n) {
    return dot(n, point_mobility(body, arm) * n) > kLeastMobility * body.inverse_mass;
}

} // namespace

double normal_mobility(const Impulsive& a, const Impulsive& b, const ContactPoint& point, const Mat3& k) {
    const Vec3& n = point.normal;
    if ((a.locked | b.locked) != 0 && !can_move(a, point.arm_a, n) && !can_move(b, point.arm_b, n)) return 0;
    return dot(n, k * n);
}

Mat3 collision_matrix(const Impulsive& a, const Impulsive& b, const Vec3& arm_a, const Vec3& arm_b) {
    return point_mobility(a, arm_a) + point_mobility(b, arm_b);
}

std::optional<Vec3> contact_impulse(const Impulsive& a, const Impulsive& b, const ContactPoint& point, double target) {
    const Vec3& n = point.normal;
    const double vn = dot(n, point.relative_velocity);
    if (!(target > vn)) return std::nullopt;
    const Mat3 k = collision_matrix(a, b, point.arm_a, point.arm_b);
    const Vec3 kn = k * n;
    const double nkn = normal_mobility(a, b, point, k);
    if (!(nkn > 0)) return std::nullopt;
    const Vec3 frictionless = ((target - vn) / nkn) * n;
    if (point.friction <= 0) return frictionless;

    const Vec3 change = target * n - point.relative_velocity;
    if (const auto stick = (a.locked | b.locked) != 0 ? solve_semidefinite(k, change) : solve(k, change)) {
        const double ln = dot(*stick, n);
        if (ln > 0 && length(*stick - ln * n) <= point.friction * ln) return stick;
    }
    const Vec3 t = normalized(point.relative_velocity - vn * n);
    const double denominator = nkn - point.friction * dot(kn, t);
    // With a long arm friction can pull the point in faster than the normal impulse pushes it out (Painleve): without
    // friction then.
    if (!(denominator > 1e-3 * nkn)) return frictionless;
    return ((target - vn) / denominator) * (n - point.friction * t);
}

double energy_clamp(const Impulsive& a, const Impulsive& b, const Vec3& arm_a, const Vec3& arm_b, const Vec3& impulse) {
    const double slope = dot(impulse, point_velocity(b, arm_b) - point_velocity(a, arm_a));
    if (!(slope < 0)) return 0;
    const double curvature = dot(impulse, collision_matrix(a, b, arm_a, arm_b) * impulse);
    return curvature > -2 * slope ? -2 * slope / curvature : 1.0;
}

} // namespace flotilla
