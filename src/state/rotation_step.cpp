// SPDX-License-Identifier: MIT
#include "state/rotation_step.hpp"

#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace flotilla {
namespace {

constexpr int kMaxCorrections = 40;
constexpr double kEnergyTolerance = 4 * std::numeric_limits<double>::epsilon();

double energy(const Mat3& inverse, const Vec3& momentum) { return 0.5 * dot(momentum, inverse * momentum); }

/// Coefficients of E(theta) = E - a sin(theta) cos(theta) - c sin(theta)^2, the energy after a turn by theta about the
/// unit vector s.
struct EnergyOfTurn {
    double a, c;
};
EnergyOfTurn energy_of_turn(const Mat3& inverse, const Vec3& momentum, const Vec3& s, double e) {
    const Vec3 m = cross(s, momentum);
    return {dot(s, cross(momentum, inverse * momentum)), e - 0.5 * dot(m, inverse * m)};
}

Vec3 principal_axis(const Mat3& inverse, bool largest_inertia) {
    Eigen::Matrix3d m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m(i, j) = inverse.m[static_cast<std::size_t>(3 * i + j)];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(m);
    // Eigenvalues of the inverse ascend: the first belongs to the largest inertia.
    const auto column = eigen.eigenvectors().col(largest_inertia ? 0 : 2);
    return {column(0), column(1), column(2)};
}

/// One correcting turn that takes off (k > 0) or adds (k < 0) the energy error k, or as much of it as one turn can.
Vec3 correcting_turn(const Mat3& inverse, const Vec3& momentum, double e, double k) {
    const Vec3 s = normalized(cross(momentum, inverse * momentum));
    if (s != Vec3{}) {
        const auto [a, c] = energy_of_turn(inverse, momentum, s, e);
        const double root_sq = a * a + 4 * k * (c - k);
        if (root_sq >= 0 && a > 0) return std::atan2(2 * k, a + std::sqrt(root_sq)) * s;
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
        return std::atan(std::abs(t1) < std::abs(t2) ? t1 : t2) * r;
    }
    const double theta = 0.5 * (k > 0 ? std::atan2(a, -c) : std::atan2(-a, c));
    return theta * r;
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

RotationStep rotate_for(const WorldInertia& inertia, const Vec3& momentum, double dt) {
    const Vec3 omega = inertia.inverse * momentum;
    const Vec3 w = dt * omega + (0.5 * dt * dt) * (inertia.inverse * cross(momentum, omega));
    const double e0 = energy(inertia.inverse, momentum);
    Quat q = rotation_from_vector(w);
    bool corrected = false;
    for (int i = 0; i < kMaxCorrections; ++i) {
        const Mat3 inverse = turned(inertia.inverse, q);
        const double e = energy(inverse, momentum);
        if (!(std::abs(e - e0) > kEnergyTolerance * e0)) break;
        const Vec3 turn = correcting_turn(inverse, momentum, e, e - e0);
        if (turn == Vec3{}) break;
        q = normalized(rotation_from_vector(turn) * q);
        corrected = true;
    }
    return {q, corrected ? rotation_vector_near(q, w) : w};
}

} // namespace flotilla
