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
            if (balances(against(u_))) break;
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
    static constexpr double kLeastMoved = 0x1p-10; ///< of what a push along the normal moves
    static constexpr int kMostSteps = 100;         ///< two are usual

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

    /// Whether a push hardly moves the point at all, as one that hinges or rails take has it: finish() then ends it, as
    /// a rule without friction.
    [[nodiscard]] bool balances(const Vec3& push) const {
        return !(dot(push, k_ * push) > kLeastMoved * dot(n_, k_ * n_));
    }

    Vec3 stop() {
        const auto hold = solved(n_);
        if (hold && length(*hold - dot(*hold, n_) * n_) <= friction_ * dot(*hold, n_))
            if (const auto all = solved(target_ * n_ - start_)) return *all;
        return finish(n_ - friction_ * starting_slip());
    }

    /// The unit direction t that slip keeps when it starts, K (n - mu t) being along t there: t = (mu M + s)^-1 m for
    /// the tangential parts m of K n and M of K and the one s > 0 at which that is of unit length. Newton's method for
    /// the inverse of the length, from below (More and Sorensen 1983).
    [[nodiscard]] Vec3 starting_slip() const {
        const Vec3 m = slip(k_ * n_);
        const double size = length(m);
        if (!(size > 0)) return {};
        const Vec3 t1 = m / size, t2 = cross(n_, t1), k1 = friction_ * (k_ * t1), k2 = friction_ * (k_ * t2);
        const double a = dot(t1, k1), b = dot(t1, k2), c = dot(t2, k2);
        constexpr double kRounding = 0x1p-40;
        constexpr int kNewtonSteps = 30;
        double s = std::max(size - (a + c), kRounding * size), x = 1, y = 0;
        for (int i = 0; i < kNewtonSteps; ++i) {
            const double p = a + s, q = c + s, det = p * q - b * b;
            x = q * size / det;
            y = -b * size / det;
            const double square = x * x + y * y, is = std::sqrt(square);
            if (!(std::abs(is - 1) > kRounding)) break;
            const double slope = (q * x * x - 2 * b * x * y + p * y * y) / det;
            s = std::max(s + square / slope * (is - 1), kRounding * size);
        }
        return normalized(x * t1 + y * t2);
    }

    /// What is left, with slip in one direction.
    Vec3 finish(const Vec3& push) {
        const double out = dot(n_, k_ * push), nkn = dot(n_, k_ * n_);
        const Vec3 last = out > kLeastMoved * nkn ? push / out : n_ / nkn;
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
