// SPDX-License-Identifier: MIT
#include "audit/sweep.hpp"

#include <algorithm>
#include <cmath>

#include "audit/feature_sweep.hpp"
#include "base/rotation.hpp"
#include "geometry/exact/triangle_triangle.hpp"

namespace flotilla::audit {
namespace {

constexpr double kUnit = 0x1p-53;
constexpr int kMaxDepth = 44;        // 2^-44 of a step: below the rounding of any step that matters
constexpr int kMaxIntervals = 20000; // per triangle pair; a proof that needs more would be of touching triangles

double max_abs(std::span<const Vec3> points) {
    double m = 0;
    for (const Vec3& p : points) m = std::max(m, max_component(abs(p)));
    return m;
}

class Bisection {
  public:
    Bisection(const BodyPath& path_a, const Triangle& a, const BodyPath& path_b, const Triangle& b)
        : path_a_(path_a),
          path_b_(path_b),
          a_(a),
          b_(b),
          origin_{path_a.corners(a, 0)[0], path_a.corners(a, 1)[0]},
          rounding_(kSweepRounding * std::max(path_a.reach(a, origin_), path_b.reach(b, origin_))),
          position_error_(path_a.position_error() + path_b.position_error()) {}

    SweepResult run(double begin, double end) {
        const Corners a = path_a_.corners(a_, begin), b = path_b_.corners(b_, begin);
        const Snapshot s = at(begin);
        if (!finite(a, b))
            (void)fail(SweepVerdict::unproved, s);
        else if (exact::triangles_intersect(a, b))
            (void)fail(SweepVerdict::crossing, s);
        else
            (void)prove(s, at(end), 0, 0);
        return result_;
    }

  private:
    /// A recorded turn or place may be beyond reach: then there is nothing to prove it with.
    static bool finite(const Corners& a, const Corners& b) {
        const auto all = [](const Corners& c) {
            return std::all_of(c.begin(), c.end(), [](const Vec3& x) { return is_finite(x); });
        };
        return all(a) && all(b);
    }

    [[nodiscard]] Snapshot at(double t) const {
        return {t, path_a_.corners(a_, t, origin_), path_b_.corners(b_, t, origin_)};
    }

    bool prove(const Snapshot& s, const Snapshot& e, int depth, FeaturePairs apart) {
        const double length = e.time - s.time;
        const Slack slack{path_a_.deviation(length) + path_b_.deviation(length) + position_error_, rounding_};
        if (separates(hint_, s, e, slack)) return true;
        const Snapshot middle = at(0.5 * s.time + 0.5 * e.time);
        if (find_direction(s, e, middle, slack)) return true;
        if (!finite(middle.a, middle.b)) return fail(SweepVerdict::unproved, middle);
        if (exact::triangles_intersect(middle.a, middle.b)) return fail(SweepVerdict::crossing, middle);
        apart = features_apart(apart, s, middle, e, slack);
        if (apart == kAllFeaturePairs || turning_direction(s, e, slack)) return true;
        if (depth == kMaxDepth || ++intervals_ == kMaxIntervals) return fail(SweepVerdict::unproved, middle);
        return prove(s, middle, depth + 1, apart) && prove(middle, e, depth + 1, apart);
    }

    bool fail(SweepVerdict verdict, const Snapshot& at) {
        const Vec3 sum = (at.a[0] + at.a[1] + at.a[2]) + (at.b[0] + at.b[1] + at.b[2]);
        result_ = {verdict, at.time, origin_.at(at.time) + sum / 6};
        return false;
    }

    static bool separates(const Vec3& d, const Snapshot& s, const Snapshot& e, const Slack& slack) {
        return separated(d, s.a, s.b, e.a, e.b, slack);
    }

    bool accept(const Vec3& d, const Snapshot& s, const Snapshot& e, const Slack& slack) {
        const Vec3 direction = scaled(d);
        if (!separates(direction, s, e, slack)) return false;
        hint_ = direction;
        return true;
    }

    bool find_direction(const Snapshot& s, const Snapshot& e, const Snapshot& m, const Slack& slack) {
        const auto accept = [&](const Vec3& d) { return this->accept(d, s, e, slack); };
        if (accept({1, 0, 0}) || accept({0, 1, 0}) || accept({0, 0, 1})) return true;
        const auto edges = [](const Corners& c) { return Corners{c[1] - c[0], c[2] - c[1], c[0] - c[2]}; };
        const Corners edges_a = edges(m.a), edges_b = edges(m.b);
        const Vec3 normal_a = cross(edges_a[0], edges_a[1]), normal_b = cross(edges_b[0], edges_b[1]);
        if (accept(normal_a) || accept(normal_b)) return true;
        for (const Vec3& u : edges_a)
            for (const Vec3& v : edges_b)
                if (accept(cross(u, v))) return true;
        for (const Vec3& u : edges_a)
            if (accept(cross(normal_a, u))) return true;
        for (const Vec3& v : edges_b)
            if (accept(cross(normal_b, v))) return true;
        const ClosestPoints closest = closest_points(m.a, m.b);
        return accept(closest.on_b - closest.on_a);
    }

    /// Whether a direction that turns with the triangles keeps them apart: of bodies that turn as one by an angle
    /// theta, at a distance g, that needs intervals of sqrt(g) / theta, where one direction for each needs g / theta,
    /// and parallel edges have no determinant.
    static bool turning_direction(const Snapshot& s, const Snapshot& e, const Slack& slack) {
        const auto normal = [](const Corners& c) { return cross(c[1] - c[0], c[2] - c[1]); };
        const auto edge = [](const Corners& c, std::size_t k) { return c[(k + 1) % 3] - c[k]; };
        const auto keep = [&](const Vec3& d_s, const Vec3& d_e) {
            const Vec3 from = scaled(d_s), to = scaled(d_e);
            if (from == Vec3{} || to == Vec3{}) return false;
            return separated_on_the_way(from / length(from), to / length(to), s.a, s.b, e.a, e.b, slack);
        };
        const Vec3 a_s = normal(s.a), a_e = normal(e.a), b_s = normal(s.b), b_e = normal(e.b);
        if (keep(a_s, a_e) || keep(b_s, b_e)) return true;
        for (std::size_t k = 0; k < 3; ++k)
            if (keep(cross(a_s, edge(s.a, k)), cross(a_e, edge(e.a, k))) ||
                keep(cross(b_s, edge(s.b, k)), cross(b_e, edge(e.b, k))))
                return true;
        // Needles have no normals: what lies across one, towards the other.
        const auto towards = [](const Corners& a, const Corners& b) {
            const ClosestPoints closest = closest_points(a, b);
            return closest.on_b - closest.on_a;
        };
        const Vec3 d_s = towards(s.a, s.b), d_e = towards(e.a, e.b);
        for (std::size_t k = 0; k < 3; ++k)
            if (keep(without(d_s, edge(s.a, k)), without(d_e, edge(e.a, k)))) return true;
        return false;
    }

    const BodyPath &path_a_, &path_b_;
    const Triangle &a_, &b_;
    MovingOrigin origin_; ///< of all coordinates here: near the triangles, so that these round as finely as their gap
    double rounding_, position_error_;
    Vec3 hint_{0, 0, 1};
    int intervals_ = 0;
    SweepResult result_;
};

} // namespace

BodyPath::BodyPath(std::span<const Vec3> x0, std::span<const Vec3> x1)
    : x0_(x0), x1_(x1), max_abs_(std::max(flotilla::audit::max_abs(x0), flotilla::audit::max_abs(x1))) {}

BodyPath::BodyPath(std::span<const Vec3> x0, std::span<const Vec3> x1, const Vec3& c0, const Vec3& c1, const Vec3& turn,
                   double radius)
    : BodyPath(x0, x1) {
    c0_ = c0, c1_ = c1, turn_ = turn;
    radius_ = radius;
    if (turn == Vec3{}) return; // the segments are the motion, but for rounding at t = 1
    angle_ = length(turn);
    max_abs_ = std::max(max_component(abs(c0)), max_component(abs(c1))) + radius;
    const Mat3 r = matrix(rotation_from_vector(turn));
    for (std::size_t i = 0; i < x0.size(); ++i) {
        const double missed = length(vertex(i, 1, r, {x1[i], x1[i]}));
        if (!(missed <= mismatch_) && !std::isnan(mismatch_))
            mismatch_ = missed; // not a number stays so: nothing is proved
    }
    // Rounding of x0 - c0 and of the product: a few u r; of the matrix: its angle t |w| is known to 2 u |w|, its
    // entries to 16 u more; three coordinates. The centre's interpolation is in kSweepRounding. The path's end and the
    // recorded end differ by the mismatch, which is spread over the path.
    position_error_ = 4 * kUnit * radius * (32 + 4 * angle_) + 1.0001 * mismatch_;
}

Vec3 BodyPath::vertex(std::size_t i, double t, const Mat3& rotation, const MovingOrigin& o) const {
    if (angle_ == 0 || t == 0) return o.relative(x0_[i], x1_[i], t);
    return o.relative(c0_, c1_, t) + rotation * (x0_[i] - c0_);
}

Corners BodyPath::corners(const Triangle& triangle, double t, const MovingOrigin& origin) const {
    const Mat3 r = angle_ == 0 ? Mat3{} : matrix(rotation_from_vector(t * turn_));
    Corners c;
    for (std::size_t k = 0; k < 3; ++k) c[k] = vertex(static_cast<std::size_t>(triangle[k]), t, r, origin);
    return c;
}

double BodyPath::reach(const Triangle& triangle, const MovingOrigin& o) const {
    const auto reach_of = [&](const Vec3& from, const Vec3& to) {
        return std::max(max_component(abs(from - o.from)), max_component(abs(to - o.to)));
    };
    if (angle_ != 0) return reach_of(c0_, c1_) + radius_;
    double m = 0;
    for (const std::int32_t v : triangle)
        m = std::max(m, reach_of(x0_[static_cast<std::size_t>(v)], x1_[static_cast<std::size_t>(v)]));
    return m;
}

void BodyPath::vertices(double t, std::vector<Vec3>& out) const {
    const Mat3 r = angle_ == 0 ? Mat3{} : matrix(rotation_from_vector(t * turn_));
    out.resize(x0_.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = vertex(i, t, r, {});
}

SweepResult sweep_triangles(const BodyPath& path_a, const Triangle& a, const BodyPath& path_b, const Triangle& b,
                            double begin, double end) {
    return Bisection(path_a, a, path_b, b).run(begin, end);
}

} // namespace flotilla::audit
