// SPDX-License-Identifier: MIT
#include "scene/separate_overlaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "base/rotation.hpp"
#include "geometry/closest.hpp"
#include "scene/initial_overlap.hpp"

namespace flotilla {
namespace {

using Corners = std::array<Vec3, 3>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kSphereDirections = 48;
constexpr std::size_t kMostNormals = 24;
// Directions around the best one so far, by ever smaller angles: the last is 0.6 degrees.
constexpr int kRefinements = 6, kAround = 6;
constexpr double kFirstTilt = 20 * std::numbers::pi / 180;
// The distance is searched to this part of the clearance; what is searched for is so much more than what is asked for.
constexpr double kTolerance = 0.01;
constexpr int kMostAdvances = 200;

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

struct Interval {
    double low, high; ///< m along a direction
};

double distance(const Corners& a, const Vec3& by, const Corners& b) {
    return std::sqrt(closest_triangle_triangle({a[0] + by, a[1] + by, a[2] + by}, b).distance_sq);
}

/// First place in [from, to] at which triangle a, moved along d, comes within `clearance` of b; `to` may lie below `from`. The distance
/// changes by at most 1 m per metre, so a step of what is left over the clearance passes nothing.
std::optional<double> first_meeting(const Corners& a, const Corners& b, const Vec3& d, double clearance, double from,
                                    double to) {
    const double sign = to < from ? -1 : 1;
    double s = from;
    for (int i = 0; i < kMostAdvances; ++i) {
        const double left = distance(a, s * d, b) - clearance;
        if (left <= kTolerance * clearance) return s;
        s += sign * left;
        if (sign * (s - to) > 0) return {};
    }
    return s; // it grazes: taken for a meeting
}

/// Where along d, in [0, reach], triangle a comes within `clearance` of b. The distance of convex sets is convex along a line, so this
/// is one interval.
std::optional<Interval> blocked(const Corners& a, const Corners& b, const Vec3& d, double clearance, double reach) {
    const std::optional<double> low = first_meeting(a, b, d, clearance, 0, reach);
    if (!low) return {};
    return Interval{*low, first_meeting(a, b, d, clearance, reach, *low).value_or(*low)};
}

/// The smallest place in [0, reach] that no interval holds; infinite where there is none.
double first_gap(std::vector<Interval>& intervals, double reach) {
    std::sort(intervals.begin(), intervals.end(), [](const Interval& x, const Interval& y) { return x.low < y.low; });
    double s = 0;
    for (const Interval& i : intervals) {
        if (i.low > s) break;
        s = std::max(s, i.high);
    }
    return s < reach ? s : kInfinity;
}

/// A body at its present place.
struct Placed {
    const Shape* shape = nullptr;
    bool movable = false;
    std::vector<Vec3> vertices;
    std::vector<Box> boxes; ///< of the nodes of its hierarchy
    Box box;

    [[nodiscard]] Corners corners(std::int32_t triangle) const {
        const Triangle& t = shape->mesh.triangles[at(triangle)];
        return {vertices[at(t[0])], vertices[at(t[1])], vertices[at(t[2])]};
    }
};

Box moved_along(const Box& box, const Vec3& by) { return merged(box, {box.lower + by, box.upper + by}); }

std::vector<Vec3> sphere_directions() {
    std::vector<Vec3> out{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    const double turn = std::numbers::pi * (3 - std::sqrt(5.0)); // the golden angle spreads points evenly
    for (int i = 0; i < kSphereDirections; ++i) {
        const double z = 1 - (2 * i + 1.0) / kSphereDirections, r = std::sqrt(1 - z * z);
        const SinCos phi = sin_cos(i * turn);
        out.push_back({r * phi.cos, r * phi.sin, z});
    }
    return out;
}

class Separator {
  public:
    explicit Separator(Scene& scene) : scene_(scene), sphere_(sphere_directions()) {
        for (std::size_t i = 0; i < scene.bodies.size(); ++i) placed_.push_back(place(i));
    }

    SeparatedStart run() {
        overlaps_ = find_initial_overlaps(scene_).movable;
        std::vector<Candidate> candidates;
        for (const std::int32_t body : overlapping_bodies()) candidates.push_back({body, shortest_move(body)});
        SeparatedStart out;
        while (!overlaps_.empty()) {
            const auto best = std::min_element(candidates.begin(), candidates.end(), [](const auto& x, const auto& y) {
                return length_sq(x.by) < length_sq(y.by);
            });
            if (best == candidates.end() || !std::isfinite(best->by.x)) {
                for (const Candidate& c : candidates) out.not_freed.push_back(c.body);
                break;
            }
            const Candidate chosen = *best;
            const Box before = placed_[at(chosen.body)].box;
            move(chosen.body, chosen.by);
            out.moves.push_back({chosen.body, chosen.by});
            std::erase_if(overlaps_, [&](const BodyOverlap& o) { return o.a == chosen.body || o.b == chosen.body; });
            const std::vector<std::int32_t> left = overlapping_bodies();
            std::erase_if(candidates, [&](const Candidate& c) {
                return std::find(left.begin(), left.end(), c.body) == left.end();
            });
            const Box changed = merged(before, placed_[at(chosen.body)].box);
            for (Candidate& c : candidates)
                if (boxes_overlap(grown_by_reach(c.body), changed, 0)) c.by = shortest_move(c.body);
        }
        return out;
    }

  private:
    struct Candidate {
        std::int32_t body;
        Vec3 by; ///< infinite: none frees it
    };

    [[nodiscard]] Placed place(std::size_t i) const {
        Placed p;
        p.shape = &scene_.shapes[at(scene_.bodies[i].shape)];
        p.movable = scene_.bodies[i].type == BodyType::dynamic;
        p.vertices = initial_vertices(scene_, i);
        refit(p.shape->bvh, p.vertices, p.boxes);
        for (const Vec3& x : p.vertices) p.box = extended(p.box, x);
        return p;
    }

    void move(std::int32_t body, const Vec3& by) {
        scene_.bodies[at(body)].position += by;
        placed_[at(body)] = place(at(body));
    }

    [[nodiscard]] std::vector<std::int32_t> overlapping_bodies() const {
        std::vector<std::int32_t> out;
        for (const BodyOverlap& o : overlaps_)
            for (const std::int32_t body : {o.a, o.b})
                if (placed_[at(body)].movable) out.push_back(body);
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        return out;
    }

    /// m, the farthest that a body is moved: its own size.
    [[nodiscard]] double reach(std::int32_t body) const { return 2 * placed_[at(body)].shape->sphere.radius; }
    [[nodiscard]] Box grown_by_reach(std::int32_t body) const {
        const double r = reach(body) + clearance(body, body);
        const Box& box = placed_[at(body)].box;
        return {box.lower - Vec3{r, r, r}, box.upper + Vec3{r, r, r}};
    }
    /// m: a little more than the pair's rest distance.
    [[nodiscard]] double clearance(std::int32_t a, std::int32_t b) const {
        double size = kInfinity;
        for (const std::int32_t i : {a, b})
            if (placed_[at(i)].movable) size = std::min(size, 2 * placed_[at(i)].shape->sphere.radius);
        const double rest = scene_.settings.rest_distance;
        return (1 + kTolerance) * (rest > 0 ? rest : size / kSizePerRestDistance);
    }

    /// Unit normals of the triangles that take part in the body's overlaps.
    [[nodiscard]] std::vector<Vec3> normals(std::int32_t body) const {
        std::vector<Vec3> out;
        for (const BodyOverlap& o : overlaps_) {
            if (o.a != body && o.b != body) continue;
            for (const auto& pair : o.triangles)
                for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
                    const Corners t = placed_[at(side == 0 ? o.a : o.b)].corners(pair[side]);
                    const Vec3 n = normalized(cross(t[1] - t[0], t[2] - t[0]));
                    const auto same = [&](const Vec3& m) { return std::abs(dot(m, n)) > 1 - 1e-6; };
                    if (n == Vec3{} || std::any_of(out.begin(), out.end(), same)) continue;
                    out.insert(out.end(), {n, -n});
                    if (out.size() >= 2 * kMostNormals) return out;
                }
        }
        return out;
    }

    [[nodiscard]] Vec3 shortest_move(std::int32_t body) const {
        std::vector<Vec3> directions = normals(body);
        directions.insert(directions.end(), sphere_.begin(), sphere_.end());
        Vec3 best;
        double shortest = kInfinity;
        const auto attempt = [&](const Vec3& d) {
            const double s = free_distance(body, d, std::min(reach(body), shortest));
            if (s < shortest) shortest = s, best = d;
        };
        for (const Vec3& d : directions) attempt(d);
        if (!std::isfinite(shortest)) return {kInfinity, kInfinity, kInfinity};
        double tilt = kFirstTilt;
        for (int i = 0; i < kRefinements; ++i, tilt *= 0.5) {
            const Vec3 middle = best;
            const Vec3 u = normalized(cross(middle, std::abs(middle.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0}));
            const Vec3 v = cross(middle, u);
            for (int k = 0; k < kAround; ++k) {
                const SinCos phi = sin_cos(2 * std::numbers::pi * k / kAround), theta = sin_cos(tilt);
                attempt(normalized(theta.cos * middle + theta.sin * (phi.cos * u + phi.sin * v)));
            }
        }
        return shortest * best;
    }

    /// The smallest s in [0, limit) such that the body, moved by s d, is clear of every other; infinite where there is none.
    [[nodiscard]] double free_distance(std::int32_t body, const Vec3& d, double limit) const {
        const Placed& moving = placed_[at(body)];
        std::vector<Box> swept = moving.boxes;
        for (Box& box : swept) box = moved_along(box, limit * d);
        const Box whole = moved_along(moving.box, limit * d);
        std::vector<Interval> intervals;
        for (std::size_t j = 0; j < placed_.size(); ++j) {
            const auto other = static_cast<std::int32_t>(j);
            const double c = other == body ? 0 : clearance(body, other);
            if (other == body || !boxes_overlap(whole, placed_[j].box, c)) continue;
            for_each_overlapping_leaf_pair(moving.shape->bvh, swept, placed_[j].shape->bvh, placed_[j].boxes, c,
                                           [&](std::span<const std::int32_t> of_a, std::span<const std::int32_t> of_b) {
                                               for (const std::int32_t x : of_a) {
                                                   const Corners a = moving.corners(x);
                                                   const Box box = moved_along(box_of(a[0], a[1], a[2]), limit * d);
                                                   for (const std::int32_t y : of_b) {
                                                       const Corners b = placed_[j].corners(y);
                                                       if (!boxes_overlap(box, box_of(b[0], b[1], b[2]), c)) continue;
                                                       if (const auto i = blocked(a, b, d, c, limit))
                                                           intervals.push_back(*i);
                                                   }
                                               }
                                           });
        }
        return first_gap(intervals, limit);
    }

    Scene& scene_;
    std::vector<Vec3> sphere_;
    std::vector<Placed> placed_;
    std::vector<BodyOverlap> overlaps_;
};

} // namespace

SeparatedStart separate_overlaps(Scene& scene) { return Separator(scene).run(); }

} // namespace flotilla
