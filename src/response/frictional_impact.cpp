// SPDX-License-Identifier: MIT
#include "response/frictional_impact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Eigenvalues>

#include "base/axis_locks.hpp"

namespace flotilla {
namespace {

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

class Course {
  public:
    Course(const ImpactPoint& point, const Vec3& velocity, double target)
        : k_(point.k),
          n_(point.normal),
          friction_(point.friction),
          target_(target),
          semidefinite_(point.semidefinite),
          start_(velocity),
          u_(velocity) {}

    Vec3 impulse() {
        const double least_slip = kLeast * length(start_), least_left = kLeast * (target_ - dot(n_, start_));
        for (int i = 0; i < kMostSteps; ++i) {
            if (!(length(slip(u_)) > least_slip)) return stop();
            step();
            if (target_ - dot(n_, u_) <= least_left) break;
        }
        return finish(against(u_));
    }

  private:
    static constexpr double kLeast = 0x1p-16; ///< of the velocity before: slip that has stopped, an end that is reached
    static constexpr double kTurn = 0.25;     ///< rad, by which slip turns in a step
    static constexpr double kSlower = 0.9375; ///< the most of it that a step takes
    static constexpr double kRate = 1;        ///< of the relaxation of its direction, within the method's stability
    static constexpr int kMostSteps = 100;    ///< two are usual

    [[nodiscard]] Vec3 slip(const Vec3& u) const { return u - dot(n_, u) * n_; }
    /// dI/dp at the relative velocity u.
    [[nodiscard]] Vec3 against(const Vec3& u) const { return n_ - friction_ * normalized(slip(u)); }
    [[nodiscard]] std::optional<Vec3> solved(const Vec3& b) const {
        return semidefinite_ ? solve_semidefinite(k_, b) : solve(k_, b);
    }

    /// A step of the classical method of Runge and Kutta: to the end, or as far as slip keeps its direction.
    void step() {
        const Vec3 s = slip(u_), push1 = against(u_), rate1 = k_ * push1;
        const double size = length(s), slower = -dot(slip(rate1), s) / size;
        const double aside = length(slip(rate1) + (slower / size) * s);
        double p = std::numeric_limits<double>::infinity();
        if (const double out = dot(n_, rate1); out > 0) p = (target_ - dot(n_, u_)) / out;
        if (const double turns = aside + kTurn * slower; turns > 0) p = std::min(p, kTurn * size / turns);
        if (slower > 0) p = std::min(p, kSlower * size / slower);
        // The direction's own rate, by how much faster friction stops a slip across than this one.
        const Vec3 across = cross(n_, s) / size;
        p = std::min(p, kRate * size / std::abs(slower - friction_ * dot(across, k_ * across)));
        const Vec3 push2 = against(u_ + (0.5 * p) * rate1);
        const Vec3 push3 = against(u_ + (0.5 * p) * (k_ * push2));
        const Vec3 push4 = against(u_ + p * (k_ * push3));
        const Vec3 push = (p / 6) * (push1 + 2 * (push2 + push3) + push4);
        u_ += k_ * push;
        impulse_ += push;
    }

    Vec3 stop() {
        const auto hold = solved(n_);
        if (hold && length(*hold - dot(*hold, n_) * n_) <= friction_ * dot(*hold, n_))
            if (const auto all = solved(target_ * n_ - start_)) return *all;
        Vec3 way = hold ? -*hold : Vec3{};
        constexpr int kTries = 20; // a fixed point
        for (int i = 0; i < kTries; ++i) way = k_ * against(way);
        return finish(against(way));
    }

    /// What is left, with slip in one direction.
    Vec3 finish(const Vec3& push) {
        const double out = dot(n_, k_ * push);
        const Vec3 last = out > 0 ? push / out : n_ / dot(n_, k_ * n_);
        return impulse_ + (target_ - dot(n_, u_)) * last;
    }

    const Mat3& k_;
    Vec3 n_;
    double friction_, target_;
    bool semidefinite_;
    Vec3 start_, u_, impulse_;
};

} // namespace

Vec3 frictional_impact(const ImpactPoint& point, const Vec3& velocity, double target) {
    return Course(point, velocity, target).impulse();
}

} // namespace flotilla
