// SPDX-License-Identifier: MIT
#include "proximity/passing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/index.hpp"
#include "base/rotation.hpp"
#include "geometry/closest.hpp"

namespace flotilla {
namespace {

/// sin^2 of an angle that is none: of parallel edges, and of ways along the bounds of features.
constexpr double kParallel = 0x1p-40;
/// A way that leads over more features than this at one place goes round in circles, and is left at its start. One that
/// goes on may lead over as many as bodies have: a drum of 1,440 sides that turns by 1.5 rad/s takes its surface over
/// some 60 in 1/24 s, and with 32 in all carried a block up to 1.2 rad, where friction of 0.4 holds it below 0.7.
constexpr int kMostAtOnePlace = 32;

/// The nearest feature of one body: a corner, an edge, or the inside of a face.
struct Nearest {
    std::array<std::int32_t, 2> ends{-1, -1}; ///< vertices of the edge; of a corner the same twice
    std::int32_t face = -1;                   ///< triangle; else -1

    [[nodiscard]] bool is_face() const { return face >= 0; }
    [[nodiscard]] bool is_corner() const { return ends[0] == ends[1] && !is_face(); }
    [[nodiscard]] bool is_edge() const { return ends[0] != ends[1]; }
};
Nearest corner(std::int32_t v) { return {{v, v}, -1}; }
Nearest edge(const Edge& e) { return {{e[0], e[1]}, -1}; }
Nearest inside(std::int32_t face) { return {{-1, -1}, face}; }

/// Where a way leaves a feature, as a share of it, and for which one.
struct Exit {
    double time = 0;
    Nearest next;
};

/// One of two bodies, of which the other moves.
class Side {
  public:
    explicit Side(const PosedShape& body) : body_(body) {}
    Nearest nearest;

    [[nodiscard]] Vec3 vertex(std::int32_t v) const { return body_.vertex(v); }
    [[nodiscard]] Vec3 start() const { return vertex(nearest.ends[0]); }
    [[nodiscard]] Vec3 edge_way() const { return vertex(nearest.ends[1]) - start(); }
    [[nodiscard]] const Topology& topology() const { return body_.shape.topology; }
    [[nodiscard]] const Triangle& triangle(std::int32_t t) const { return body_.shape.mesh.triangles[at(t)]; }

    /// What of a face is nearest to a point.
    [[nodiscard]] Nearest nearest_of_face(std::int32_t face, const Vec3& to) const {
        const Triangle& t = triangle(face);
        const auto share = closest_vertex_triangle(to, vertex(t[0]), vertex(t[1]), vertex(t[2])).barycentric;
        std::array<std::int32_t, 3> with{};
        std::size_t n = 0;
        for (std::size_t k = 0; k < 3; ++k)
            if (share[k] != 0) with[n++] = t[k];
        if (n > 2) return inside(face);
        return n > 1 ? edge({with[0], with[1]}) : corner(with[0]);
    }

    /// The next feature of a corner or an edge to which a point is nearest that goes from `r` (m, seen from the
    /// feature) along `w`, if it is so before `time`. Corners end at their edges, edges at their faces.
    [[nodiscard]] std::optional<Exit> leave_region(const Vec3& r, const Vec3& w, double time) const {
        std::optional<Exit> exit;
        for_each_bound([&](const Vec3& d, const Nearest& next) {
            const double rate = dot(w, d);
            if (!(rate > 0 && rate * rate > kParallel * length_sq(w) * length_sq(d))) return;
            const double t = std::max(0.0, -dot(r, d) / rate);
            if (t < (exit ? exit->time : time)) exit = Exit{t, next};
        });
        return exit;
    }

    /// The end of the edge that its nearest point comes to, which moves from the share `s` of it at the rate `rate`.
    [[nodiscard]] std::optional<Exit> leave_edge(double s, double rate, double time) const {
        const double t = rate > 0 ? (1 - s) / rate : rate < 0 ? -s / rate : time;
        if (!(t < time)) return std::nullopt;
        return Exit{std::max(0.0, t), corner(nearest.ends[rate > 0 ? 1 : 0])};
    }

    /// The edge of the face that the foot of a point comes to, which is at `p` and moves along `w`.
    [[nodiscard]] std::optional<Exit> leave_face(const Vec3& p, const Vec3& w, double time) const {
        std::optional<Exit> exit;
        const Triangle& t = triangle(nearest.face);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t from = t[k], to = t[(k + 1) % 3];
            const Vec3 a = vertex(from), d = across(vertex(t[(k + 2) % 3]) - a, vertex(to) - a); // inwards
            const double rate = dot(w, d);
            if (!(rate < 0)) continue;
            const double at_edge = std::max(0.0, -dot(p - a, d) / rate);
            if (at_edge < (exit ? exit->time : time)) exit = Exit{at_edge, edge({from, to})};
        }
        return exit;
    }

    [[nodiscard]] static Vec3 across(const Vec3& way, const Vec3& edge) {
        const double square = length_sq(edge);
        return square > 0 ? way - (dot(way, edge) / square) * edge : way;
    }

  private:
    /// Calls visit(d, next) for the directions d that bound where a corner or an edge is the nearest feature of its
    /// body, which it is for points at r from it with r . d <= 0: along the edges of a corner, into the faces of an
    /// edge.
    template <class Visit>
    void for_each_bound(Visit&& visit) const {
        if (nearest.is_face()) return;
        const auto place = [&](std::int32_t v) { return topology().place[at(v)]; };
        const std::int32_t p = place(nearest.ends[0]), q = place(nearest.ends[1]);
        const Vec3 from = start(), along = edge_way();
        for (const std::int32_t t : topology().around_vertex(nearest.ends[0])) {
            const Triangle& face = triangle(t);
            const auto has_end = [&](std::int32_t v) { return place(v) == q; };
            if (std::none_of(face.begin(), face.end(), has_end)) continue;
            for (const std::int32_t v : face)
                if (place(v) != p && place(v) != q)
                    visit(across(vertex(v) - from, along),
                          nearest.is_corner() ? edge({nearest.ends[0], v}) : inside(t));
        }
    }

    const PosedShape& body_;
};

/// The way of body b, seen from a, and what is nearest on it.
class Passage {
  public:
    Passage(const FeaturePair& f, const PosedShape& a, const PosedShape& b, const Vec3& way, const Vec3& from)
        : a_(a), b_(b), way_(way), r_(from) {
        if (f.kind == FeatureKind::edge_edge) {
            a_.nearest = edge(a_.topology().edges[at(f.a)]);
            b_.nearest = edge(b_.topology().edges[at(f.b)]);
        } else if (f.kind == FeatureKind::vertex_face) {
            a_.nearest = corner(f.a);
            b_.nearest = b_.nearest_of_face(f.b, a_.vertex(f.a));
        } else {
            b_.nearest = corner(f.b);
            a_.nearest = a_.nearest_of_face(f.a, b_.vertex(f.b));
        }
    }

    /// Goes on to where the points come as near as `radius`, or nearest. False: at its start, or in circles.
    bool go(double radius) {
        const std::size_t most = a_.topology().edges.size() + b_.topology().edges.size();
        int at_one_place = 0;
        for (std::size_t k = 0; k < kMostAtOnePlace + most && at_one_place < kMostAtOnePlace; ++k) {
            const Vec3 w = changing_part();
            const double square = length_sq(w), along = -dot(r_, w);
            if (!(along > 0) || !(length_sq(r_) > radius * radius)) return moved_;
            // |r + t w|^2 is least at along / square, and radius^2 at the root before that.
            const double least = length_sq(r_) - along * along / square;
            double t = along / square;
            if (least < radius * radius) t -= std::sqrt((radius * radius - least) / square);
            t = std::min(t, 1 - time_);
            const std::optional<Exit> exit_a = leave(a_, b_, r_, w, way_, t);
            const std::optional<Exit> exit_b = leave(b_, a_, -r_, -w, -way_, exit_a ? exit_a->time : t);
            const double until = exit_b ? exit_b->time : exit_a ? exit_a->time : t;
            r_ += until * w;
            at_one_place = time_ + until > time_ ? 0 : at_one_place + 1;
            time_ += until;
            moved_ = moved_ || (until > 0 && !has_one_normal());
            if (exit_b)
                b_.nearest = exit_b->next;
            else if (exit_a)
                a_.nearest = exit_a->next;
            else
                return moved_;
        }
        return false;
    }

    [[nodiscard]] const Vec3& gap() const { return r_; } ///< m, from the point of a to that of b

  private:
    [[nodiscard]] bool crossing() const {
        if (!a_.nearest.is_edge() || !b_.nearest.is_edge()) return false;
        const Vec3 e = a_.edge_way(), g = b_.edge_way();
        return length_sq(cross(e, g)) > kParallel * length_sq(e) * length_sq(g);
    }
    [[nodiscard]] bool has_one_normal() const { return a_.nearest.is_face() || b_.nearest.is_face() || crossing(); }

    /// What of the way changes the gap: what is along the normal, where there is one alone.
    [[nodiscard]] Vec3 changing_part() const {
        if (has_one_normal()) return (dot(way_, r_) / length_sq(r_)) * r_;
        if (a_.nearest.is_edge()) return Side::across(way_, a_.edge_way());
        return b_.nearest.is_edge() ? Side::across(way_, b_.edge_way()) : way_;
    }

    /// Where `own`, one side, stops to be nearest, seen from which the other one is at r, moves along `way` and, as far
    /// as that changes the gap, along w.
    [[nodiscard]] std::optional<Exit> leave(const Side& own, const Side& other, const Vec3& r, const Vec3& w,
                                            const Vec3& way, double time) const {
        const Vec3 moved = time_ * way;
        std::optional<Exit> exit = own.leave_region(r, w, time);
        const auto offer = [&](const std::optional<Exit>& e) {
            if (e && (!exit || e->time < exit->time)) exit = e;
        };
        const bool point = other.nearest.is_corner();
        if (own.nearest.is_face() && point)
            offer(own.leave_face(other.start() + moved - r, way - w, time));
        else if (own.nearest.is_edge() && point) {
            const Vec3 e = own.edge_way();
            offer(own.leave_edge(dot(other.start() + moved - own.start(), e) / length_sq(e), dot(way, e) / length_sq(e),
                                 time));
        } else if (crossing()) {
            // Of own.start + s e and other.start + moved + u g, both at right angles to the gap.
            const Vec3 e = own.edge_way(), g = other.edge_way(), between = other.start() + moved - own.start();
            const double ee = length_sq(e), eg = dot(e, g), gg = length_sq(g), det = ee * gg - eg * eg;
            const auto share = [&](const Vec3& d) { return (gg * dot(e, d) - eg * dot(g, d)) / det; };
            offer(own.leave_edge(share(between), share(way), time));
        }
        return exit;
    }

    Side a_, b_;
    Vec3 way_, r_;
    double time_ = 0;    ///< share of the way
    bool moved_ = false; ///< the gap has turned
};

} // namespace

PointGap gap_on_the_way(const FeaturePair& features, const PosedShape& a, const PosedShape& b, const Vec3& way,
                        double radius, const PointGap& now) {
    if (!(now.distance > radius) || !(now.distance + dot(now.normal, way) < radius)) return now;
    const Vec3 from = now.distance * now.normal;
    Passage passage(features, a, b, way, from);
    if (!passage.go(radius)) return now;
    const Vec3 normal = normalized(passage.gap());
    return {normal, dot(normal, from)};
}

} // namespace flotilla
