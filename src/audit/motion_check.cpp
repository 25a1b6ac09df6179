// SPDX-License-Identifier: MIT
// Between two frames: every pair of triangles whose moving boxes meet goes through the bisection of audit/sweep.
//
// Moving balls: each body of a turning motion stays within the ball about its centre of mass, which moves on a straight
// line. While the balls of a pair are apart, or the box of one ball is apart from those of the other's triangles,
// nothing else has to be looked at, however often the bodies turn.
//
// Moving boxes: over an interval, box faces interpolated between their values at both ends hold all points whose paths
// are straight, and those of curved paths once inflated by their deviation. Along an axis, the gap of two moving boxes
// is linear in time, so the times at which all gaps are closed form one interval, found by two divisions per axis.
#include <algorithm>
#include <cmath>
#include <limits>

#include "audit/audit.hpp"
#include "audit/candidate_pairs.hpp"
#include "audit/sweep.hpp"
#include "base/index.hpp"
#include "mesh/placement.hpp"
#include "parallel/parallel_for.hpp"

namespace flotilla::audit {
namespace {

/// Turning bodies are looked at in so short pieces of the step that boxes grow by no more than this part of the radius.
constexpr double kLargestDeviation = 0.05;
constexpr int kMaxPieces = 1 << 16;

/// m; a turn that misses the next frame's pose by more is reported. A solver's own rounding stays far below.
constexpr double kLargestMismatch = 1e-7;

/// Part of an interval, as fractions of it.
struct Window {
    double begin, end;
};

/// When two moving boxes come within `inflation` of each other. Nothing: never, which is a proof. `rounding` is at
/// least 64 u M: subtracting coordinates errs by 2 u M at most, and the root of a gap by 4 u of itself, during which
/// the gap changes by at most 16 u M.
std::optional<Window> meeting(const Bounds& a0, const Bounds& a1, const Bounds& b0, const Bounds& b1, double inflation,
                              double rounding) {
    Window window{0, 1};
    const double reach = inflation + rounding;
    const auto cut = [&](double g0, double g1) {
        if (g0 > 0 && g1 > 0) return false;
        if (g0 > 0) window.begin = std::max(window.begin, g0 / (g0 - g1));
        if (g1 > 0) window.end = std::min(window.end, g0 / (g0 - g1));
        return true;
    };
    for (std::size_t k = 0; k < 3; ++k) {
        if (!cut(a0.low[k] - b0.high[k] - reach, a1.low[k] - b1.high[k] - reach)) return {};
        if (!cut(b0.low[k] - a0.high[k] - reach, b1.low[k] - a1.high[k] - reach)) return {};
    }
    if (window.begin > window.end) return {};
    return window;
}

/// One side of a pair over one piece of the step.
struct Side {
    const Shape& shape;
    const BodyPath& path;
    const std::vector<Bounds>&boxes0, &boxes1;
    std::span<const Vec3> vertices0, vertices1;

    [[nodiscard]] const BoxTree::Node& node(std::int32_t i) const { return shape.tree.nodes[at(i)]; }
    [[nodiscard]] const Triangle& triangle(std::int32_t t) const { return shape.mesh.triangles[at(t)]; }
    [[nodiscard]] Bounds triangle_bounds(std::span<const Vec3> v, std::int32_t t) const {
        const Triangle& c = triangle(t);
        return bounds_of(std::array{v[at(c[0])], v[at(c[1])], v[at(c[2])]});
    }
};

/// The descent of two trees over one piece [begin, end] of the step; stops at the first passage.
class PieceCheck {
  public:
    PieceCheck(const Side& a, const Side& b, double begin, double end)
        : a_(a),
          b_(b),
          begin_(begin),
          length_(end - begin),
          inflation_((a.path.deviation(length_) + b.path.deviation(length_) + a.path.position_error() +
                      b.path.position_error()) *
                     1.0001),
          rounding_(0x1p-47 * std::max(a.path.max_abs(), b.path.max_abs())) {} // 64 u M

    /// False where a passage was found.
    bool run() { return balls_clear() || descend(0, 0); }
    /// Whether the ball of one body stays clear of the other, however it turns.
    [[nodiscard]] bool balls_clear() const { return ball_clears(a_, b_) || ball_clears(b_, a_); }
    [[nodiscard]] const Passage& passage() const { return passage_; }
    [[nodiscard]] std::int64_t tested() const { return tested_; }

  private:
    /// Where one chord is a poor guide the ball is the tighter bound.
    [[nodiscard]] bool ball_clears(const Side& ball, const Side& other) const {
        const double radius = 1.0001 * ball.path.radius();
        if (radius == 0 || ball.path.deviation(length_) < radius) return false;
        const auto box = [&](double t) {
            const Vec3 c = ball.path.center(t);
            return Bounds{{c.x - radius, c.y - radius, c.z - radius}, {c.x + radius, c.y + radius, c.z + radius}};
        };
        return clears(box(begin_), box(begin_ + length_), other, inflation_ - ball.path.deviation(length_), 0);
    }
    [[nodiscard]] bool clears(const Bounds& from, const Bounds& to, const Side& other, double inflation,
                              std::int32_t i) const {
        if (!meeting(from, to, other.boxes0[at(i)], other.boxes1[at(i)], inflation, rounding_)) return true;
        const BoxTree::Node& node = other.node(i);
        return !node.is_leaf() && clears(from, to, other, inflation, i + 1) &&
               clears(from, to, other, inflation, node.right);
    }

    bool descend(std::int32_t i, std::int32_t j) {
        if (!meeting(a_.boxes0[at(i)], a_.boxes1[at(i)], b_.boxes0[at(j)], b_.boxes1[at(j)], inflation_, rounding_))
            return true;
        const auto &node_a = a_.node(i), &node_b = b_.node(j);
        if (node_a.is_leaf() && node_b.is_leaf()) return test_leaves(node_a, node_b);
        if (node_b.is_leaf() || (!node_a.is_leaf() && node_a.end - node_a.begin >= node_b.end - node_b.begin))
            return descend(i + 1, j) && descend(node_a.right, j);
        return descend(i, j + 1) && descend(i, node_b.right);
    }

    bool test_leaves(const BoxTree::Node& node_a, const BoxTree::Node& node_b) {
        for (std::int32_t k = node_a.begin; k < node_a.end; ++k)
            for (std::int32_t l = node_b.begin; l < node_b.end; ++l)
                if (!test(a_.shape.tree.order[at(k)], b_.shape.tree.order[at(l)])) return false;
        return true;
    }

    bool test(std::int32_t a, std::int32_t b) {
        const auto window =
            meeting(a_.triangle_bounds(a_.vertices0, a), a_.triangle_bounds(a_.vertices1, a),
                    b_.triangle_bounds(b_.vertices0, b), b_.triangle_bounds(b_.vertices1, b), inflation_, rounding_);
        if (!window) return true;
        ++tested_;
        const SweepResult result = sweep_triangles(a_.path, a_.triangle(a), b_.path, b_.triangle(b),
                                                   time(window->begin, -1), time(window->end, 1));
        if (result.verdict == SweepVerdict::apart) return true;
        passage_.triangle_a = a;
        passage_.triangle_b = b;
        passage_.crossing = result.verdict == SweepVerdict::crossing;
        passage_.time = result.time;
        passage_.place = result.place;
        return false;
    }

    /// A fraction of the piece as a time of the step, moved outward by more than its rounding.
    [[nodiscard]] double time(double fraction, double outward) const {
        return std::clamp(begin_ + fraction * length_ + outward * 0x1p-50, begin_, begin_ + length_);
    }

    const Side &a_, &b_;
    double begin_, length_, inflation_, rounding_;
    Passage passage_;
    std::int64_t tested_ = 0;
};

/// Everything about the bodies' motion over the step.
struct Bodies {
    const Scene& scene;
    const Placement &from, &to;
    std::vector<std::optional<BodyPath>> paths;

    [[nodiscard]] bool rests(std::int32_t body) const {
        return paths[at(body)]->angle() == 0 && from.poses[at(body)] == to.poses[at(body)];
    }
};

/// The boxes of one body at the border between two pieces of the step.
struct Border {
    std::vector<Vec3> vertices;
    std::vector<Bounds> boxes;
    void set(const Shape& shape, const BodyPath& path, double t) {
        path.vertices(t, vertices);
        refit(shape.tree, shape.mesh.triangles, vertices, boxes);
    }
};

struct PairResult {
    std::optional<Passage> passage;
    std::int64_t tested = 0;
};

/// Into how many pieces of equal length the step is cut for a pair.
int pieces(const Bodies& bodies, BodyPair pair) {
    int n = 1;
    for (const std::int32_t body : {pair.a, pair.b}) {
        const BodyPath& path = *bodies.paths[at(body)];
        const double limit = kLargestDeviation * bodies.scene.shape_of(at(body)).radius;
        while (n < kMaxPieces && path.deviation(1.0 / n) > limit) n *= 2;
    }
    return n;
}

class PairCheck {
  public:
    PairCheck(const Bodies& bodies, BodyPair pair)
        : pair_(pair),
          shape_a_(bodies.scene.shape_of(at(pair.a))),
          shape_b_(bodies.scene.shape_of(at(pair.b))),
          path_a_(*bodies.paths[at(pair.a)]),
          path_b_(*bodies.paths[at(pair.b)]) {}

    /// Straight paths: the frames' own vertices and boxes.
    PairResult run_straight(const Bodies& bodies) {
        const auto side = [&](std::int32_t i) {
            return Side{bodies.scene.shape_of(at(i)), *bodies.paths[at(i)],        bodies.from.boxes[at(i)],
                        bodies.to.boxes[at(i)],       bodies.from.vertices[at(i)], bodies.to.vertices[at(i)]};
        };
        run_piece(side(pair_.a), side(pair_.b), 0, 1);
        return result_;
    }

    PairResult run_turning(int n) {
        if (balls_apart(0, 1)) return result_;
        Border a0, a1, b0, b1;
        const auto side_a = [&] { return Side{shape_a_, path_a_, a0.boxes, a1.boxes, a0.vertices, a1.vertices}; };
        const auto side_b = [&] { return Side{shape_b_, path_b_, b0.boxes, b1.boxes, b0.vertices, b1.vertices}; };
        int placed = -1; // the border that a1 and b1 are at
        const auto place = [&](int border) {
            if (placed == border) return;
            const double t = static_cast<double>(border) / n;
            a1.set(shape_a_, path_a_, t);
            b1.set(shape_b_, path_b_, t);
            placed = border;
        };
        const auto span = [&](int from, int to) {
            place(from);
            std::swap(a0, a1);
            std::swap(b0, b1);
            place(to);
        };
        span(0, n);
        if (n > 1 && PieceCheck(side_a(), side_b(), 0, 1).balls_clear()) return result_;
        for (int k = 0; k < n; ++k) {
            const double begin = static_cast<double>(k) / n, end = static_cast<double>(k + 1) / n;
            if (balls_apart(begin, end)) continue;
            span(k, k + 1);
            if (!run_piece(side_a(), side_b(), begin, end)) break;
        }
        return result_;
    }

  private:
    /// Whether the balls about the centres of mass stay apart during a part of the step.
    [[nodiscard]] bool balls_apart(double begin, double end) const {
        const auto between = [&](double t) { return path_b_.center(t) - path_a_.center(t); };
        const Vec3 from = between(begin), along = between(end) - from;
        const double square = length_sq(along);
        if (!std::isfinite(square)) return false;
        const double nearest = square > 0 ? std::clamp(-dot(from, along) / square, 0.0, 1.0) : 0;
        // Rounding: of the centres and of what is made of them, a few u M.
        const double error = (path_a_.position_error() + path_b_.position_error()) +
                             0x1p-47 * std::max(path_a_.max_abs(), path_b_.max_abs());
        return length(from + nearest * along) > 1.0001 * ((path_a_.radius() + path_b_.radius()) + error);
    }

    bool run_piece(const Side& a, const Side& b, double begin, double end) {
        PieceCheck check(a, b, begin, end);
        const bool apart = check.run();
        result_.tested += check.tested();
        if (apart) return true;
        result_.passage = check.passage();
        result_.passage->body_a = pair_.a;
        result_.passage->body_b = pair_.b;
        return false;
    }

    BodyPair pair_;
    const Shape &shape_a_, &shape_b_;
    const BodyPath &path_a_, &path_b_;
    PairResult result_;
};

PairResult check_pair(const Bodies& bodies, BodyPair pair) {
    // Nothing moved: the check of the frame is the proof.
    if (bodies.rests(pair.a) && bodies.rests(pair.b)) return {};
    PairCheck check(bodies, pair);
    const bool straight = bodies.paths[at(pair.a)]->angle() == 0 && bodies.paths[at(pair.b)]->angle() == 0;
    return straight ? check.run_straight(bodies) : check.run_turning(pieces(bodies, pair));
}

BodyPath make_path(const Shape& shape, const Placement& from, const Placement& to, std::size_t body, Motion motion,
                   std::span<const Vec3> turns) {
    if (motion == Motion::linear) return {from.vertices[body], to.vertices[body]};
    const auto center = [&](const Placement& placement) {
        Vec3 c;
        const Pose& pose = placement.poses[body];
        world_vertices(std::span(&shape.center_of_mass, 1), pose.position, pose.rotation, std::span(&c, 1));
        return c;
    };
    return {from.vertices[body], to.vertices[body], center(from), center(to), turns[body], shape.radius};
}

/// A box that holds the body during the whole step.
Bounds swept_bounds(const Bodies& bodies, std::size_t body) {
    Bounds bounds = merged(bodies.from.boxes[body][0], bodies.to.boxes[body][0]);
    const BodyPath& path = *bodies.paths[body];
    // A whole turn or more reaches no farther than the diameter.
    double reach = std::min(path.deviation(1), 2 * bodies.scene.shape_of(body).radius) + 2 * path.position_error() +
                   kSweepRounding * path.max_abs();
    if (std::isnan(reach)) reach = std::numeric_limits<double>::infinity(); // a path beyond numbers may be anywhere
    for (std::size_t k = 0; k < 3; ++k) bounds.low[k] -= reach, bounds.high[k] += reach;
    return bounds;
}

} // namespace

MotionReport check_motion(const Scene& scene, const Placement& from, const Placement& to, Motion motion,
                          std::span<const Vec3> turns, int threads) {
    Bodies bodies{scene, from, to, {}};
    bodies.paths.resize(scene.bodies.size());
    std::vector<std::optional<Bounds>> boxes(scene.bodies.size());
    parallel_for(boxes.size(), threads, [&](std::size_t i) {
        if (!from.is_placed(i) || !to.is_placed(i)) return;
        bodies.paths[i] = make_path(scene.shape_of(i), from, to, i, motion, turns);
        boxes[i] = swept_bounds(bodies, i);
    });
    const auto pairs = candidate_pairs(scene, boxes);
    std::vector<PairResult> results(pairs.size());
    parallel_for(pairs.size(), threads, [&](std::size_t i) { results[i] = check_pair(bodies, pairs[i]); });

    MotionReport report;
    report.pairs = static_cast<std::int64_t>(pairs.size());
    for (const auto& result : results) {
        report.triangle_pairs += result.tested;
        if (result.passage) report.passages.push_back(*result.passage);
    }
    for (std::size_t i = 0; i < bodies.paths.size(); ++i)
        if (bodies.paths[i] && !(bodies.paths[i]->mismatch() <= kLargestMismatch * (1 + bodies.paths[i]->max_abs())))
            report.bad_paths.push_back(
                {static_cast<std::int32_t>(i), "the recorded turn misses the next frame's pose by " +
                                                   std::to_string(bodies.paths[i]->mismatch()) + " m"});
    return report;
}

} // namespace flotilla::audit
