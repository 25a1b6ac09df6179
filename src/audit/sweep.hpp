// SPDX-License-Identifier: MIT
// The proof that two moving triangles stay apart over an interval of time, by bisection.
//
// Let the corners a_i(t) and b_j(t) be given at the ends s and e of an interval, and let every corner stay within delta
// of the straight line between its two ends, taken at equal times. For any vector d and all i, j
//   d.(b_j(t) - a_i(t)) >= (1-l) d.(b_j(s) - a_i(s)) + l d.(b_j(e) - a_i(e)) - |d| (delta_a + delta_b),  l =
//   (t-s)/(e-s).
// So if min_j d.b_j - max_i d.a_i exceeds |d| (delta_a + delta_b) at both ends, the plane family with normal d
// separates the triangles at every t between. Where no d among the candidates does, the interval is halved; delta falls
// with the square of its length. Candidates are the axes and, in the middle of the interval, the separating axes of two
// triangles and the line of their closest points, so that for triangles a positive distance apart some d works once the
// interval is short enough. Faces that turn together at a tiny gap would need very short ones; audit/feature_sweep
// proves those at once, or a direction that turns with them does (separated_on_the_way()).
//
// delta for a body that turns at angular speed w about its moving centre, all points within r of it: r (w (e-s))^2 / 8,
// because |x''| <= r w^2 and linear interpolation of x errs by at most |x''| (e-s)^2 / 8; and never more than 2 r,
// since the point and the line between its two ends are both within r of the centre.
//
// Rounding, u = 2^-53. Coordinates are relative to a corner of one of the triangles, from place to place of it, and at
// most M. Corners at s and e are computed: differences r0 = x0 - o0, r1 = x1 - o1 err by u M, linear interpolation r0 +
// t (r1 - r0) by 5 u M in a coordinate. Two dot products and their difference err by at most 8 u M |d|_1. Together 20 u
// M |d|_1; kSweepRounding = 32 u covers it. d itself is whatever double vector was computed, without error. So the
// proof is as fine far from the world's origin, and of bodies that fly there, as it is near. What a turning path adds
// is in its position_error.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "audit/audit.hpp"
#include "audit/triangle_distance.hpp"

namespace flotilla::audit {

/// A point that moves on a straight line, from which others are seen; at rest in the world's origin unless given.
struct MovingOrigin {
    Vec3 from, to;
    [[nodiscard]] Vec3 at(double t) const { return from + t * (to - from); }
    /// A point that moves from x0 to x1, both on straight lines.
    [[nodiscard]] Vec3 relative(const Vec3& x0, const Vec3& x1, double t) const {
        const Vec3 r = x0 - from;
        return r + t * ((x1 - to) - r);
    }
};

/// The path of one body's vertices over t in [0, 1]: x(t) = c0 + t (c1 - c0) + R(t w) (x0 - c0), or a straight segment.
class BodyPath {
  public:
    /// Straight segments from x0 to x1.
    BodyPath(std::span<const Vec3> x0, std::span<const Vec3> x1);
    /// The turning motion with rotation vector `turn`; c0 and c1 are the centres of mass at both ends.
    BodyPath(std::span<const Vec3> x0, std::span<const Vec3> x1, const Vec3& c0, const Vec3& c1, const Vec3& turn,
             double radius);

    /// Relative to `origin`.
    [[nodiscard]] Corners corners(const Triangle& triangle, double t, const MovingOrigin& origin = {}) const;
    /// No coordinate of the triangle relative to `origin` exceeds this, nor any that it is computed from, m.
    [[nodiscard]] double reach(const Triangle& triangle, const MovingOrigin& origin) const;
    void vertices(double t, std::vector<Vec3>& out) const;
    /// How far a vertex strays from the line between its places at the ends of an interval of length dt, m.
    [[nodiscard]] double deviation(double dt) const {
        return 1.0001 * radius_ * std::min(0.125 * (angle_ * dt) * (angle_ * dt), 2.0);
    }
    /// Distance of a computed place from the exact one beyond kSweepRounding, m.
    [[nodiscard]] double position_error() const { return position_error_; }
    /// The place that the path reaches at t = 1 against the recorded one, the largest distance over the vertices, m.
    [[nodiscard]] double mismatch() const { return mismatch_; }
    [[nodiscard]] double max_abs() const { return max_abs_; }
    [[nodiscard]] double angle() const { return angle_; } ///< rad
    /// m; the ball about the centre of mass holds the body however it turns. Zero where no centre is known.
    [[nodiscard]] double radius() const { return radius_; }
    [[nodiscard]] Vec3 center(double t) const { return c0_ + t * (c1_ - c0_); }

  private:
    [[nodiscard]] Vec3 vertex(std::size_t i, double t, const Mat3& rotation, const MovingOrigin& origin) const;

    std::span<const Vec3> x0_, x1_;
    Vec3 c0_, c1_, turn_;
    double angle_ = 0, radius_ = 0, position_error_ = 0, mismatch_ = 0, max_abs_ = 0;
};

inline constexpr double kSweepRounding = 0x1p-48; // 32 u

enum class SweepVerdict {
    apart,    ///< proved
    crossing, ///< the triangles intersect at `time`
    unproved, ///< no proof around `time`
};
struct SweepResult {
    SweepVerdict verdict = SweepVerdict::apart;
    double time = 0;
    Vec3 place;
};

/// The triangles of two bodies over [begin, end].
[[nodiscard]] SweepResult sweep_triangles(const BodyPath& path_a, const Triangle& a, const BodyPath& path_b,
                                          const Triangle& b, double begin, double end);

} // namespace flotilla::audit
