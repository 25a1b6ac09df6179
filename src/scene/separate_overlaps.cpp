// SPDX-License-Identifier: MIT
#include "scene/separate_overlaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "base/index.hpp"
#include "base/rotation.hpp"
#include "geometry/closest.hpp"
#include "geometry/ray.hpp"
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
constexpr int kMostAdvances = 100;

Corners moved(const Corners& t, const Vec3& by) { return {t[0] + by, t[1] + by, t[2] + by}; }
Box moved(const Box& box, const Vec3& by) { return {box.lower + by, box.upper + by}; }

/// The place in [from, to] at which triangle a, moved along d and nearer to b than `clearance` at `from`, leaves it for
/// good: the distance of convex sets is convex along a line. So coming back from `to`, where it is left, tangents pass
/// nothing.
double place_of_leaving(const Corners& a, const Corners& b, const Vec3& d, double clearance, double from, double to) {
    double s = to;
    for (int i = 0; i < kMostAdvances; ++i) {
        const TriangleTriangleClosest at = closest_triangle_triangle(moved(a, s * d), b);
        const double distance = std::sqrt(at.distance_sq), left = distance - clearance;
        if (left <= kTolerance * clearance) break;
        const double approach = dot(d, at.p - at.q) / distance; // m per metre, backwards
        if (!(approach > 0) || !(s - left / approach > from)) return from;
        s -= left / approach;
    }
    return s;
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
        caught_with_.resize(placed_.size());
    }

    SeparatedStart run() {
        overlaps_ = find_initial_overlaps(scene_).movable;
        for (const BodyOverlap& o : overlaps_)
            if (placed_[at(o.a)].movable && placed_[at(o.b)].movable) ++caught_with_[at(o.a)], ++caught_with_[at(o.b)];
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
                if (boxes_overlap(grown_by_reach(c.body, c.by), changed, 0)) c.by = shortest_move(c.body);
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

    [[nodiscard]] double size(std::int32_t body) const { return 2 * placed_[at(body)].shape->sphere.radius; } ///< m
    /// What the body's shortest move depends on, if it is not longer than its size or than it was found.
    [[nodiscard]] Box grown_by_reach(std::int32_t body, const Vec3& by) const {
        const double found = std::isfinite(by.x) ? length(by) : kInfinity;
        const double r = std::max(size(body), found) + clearance(body, body);
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

    /// How far the body's centre goes along d before it pierces a body of infinite mass, at most `limit`.
    [[nodiscard]] double same_side(std::int32_t body, const Vec3& d, double limit) const {
        static const Bvh kOneLeaf{
            .nodes = {{0, 1}}, .triangles = {0}, .corners = {}, .vertices = {}, .first_vertex = {}, .sizes = {}};
        const Vec3 from = world_center(scene_, scene_.bodies[at(body)]), to = from + limit * d;
        const std::array<Box, 1> box{extended(extended(Box{}, from), to)};
        double least = 1;
        for (const Placed& other : placed_) {
            if (other.movable || !boxes_overlap(box[0], other.box, 0)) continue;
            for_each_overlapping_leaf_pair(kOneLeaf, box, other.shape->bvh, other.boxes, 0,
                                           [&](std::span<const std::int32_t>, std::span<const std::int32_t> triangles) {
                                               for (const std::int32_t x : triangles) {
                                                   const Corners f = other.corners(x);
                                                   least = std::min(
                                                       least, segment_triangle(from, to, f[0], f[1], f[2]).value_or(1));
                                               }
                                           });
        }
        return least * limit;
    }

    /// A body stays on the side of floors and walls on which its centre is, or one caught in a thin floor would leave
    /// it below. Where it gets free there nowhere by its own size, it is let past the movable bodies that it
    /// intersected; only then, as deep inside a solid, through the surface.
    [[nodiscard]] Vec3 shortest_move(std::int32_t body) const {
        const std::array<bool, 3>& locked = scene_.bodies[at(body)].locked_translation;
        if (locked[0] || locked[1] || locked[2]) return {kInfinity, kInfinity, kInfinity}; // it stays where it was put
        const double own = size(body);
        Vec3 by = shortest_move(body, own, true);
        if (const int n = caught_with_[at(body)]; !std::isfinite(by.x) && n > 0)
            by = shortest_move(body, (1 + n) * own, true);
        return std::isfinite(by.x) ? by : shortest_move(body, own, false);
    }

    [[nodiscard]] Vec3 shortest_move(std::int32_t body, double reach, bool on_same_side) const {
        std::vector<Vec3> directions = normals(body);
        directions.insert(directions.end(), sphere_.begin(), sphere_.end());
        Vec3 best;
        double shortest = kInfinity;
        const auto attempt = [&](const Vec3& d) {
            double limit = std::min(reach, shortest);
            if (on_same_side) limit = same_side(body, d, limit);
            const double s = free_distance(body, d, limit);
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

    /// The smallest s in [0, limit) such that the body, moved by s d, is clear of every other; infinite where there is
    /// none.
    [[nodiscard]] double free_distance(std::int32_t body, const Vec3& d, double limit) const {
        double s = 0;
        while (s < limit) {
            const double next = next_place(body, d, s, limit);
            if (next == s) return s;
            s = next;
        }
        return kInfinity;
    }

    /// s where the body, moved by s d, is clear of every other; else where it has left the first one that it is too
    /// near to, or `limit`.
    [[nodiscard]] double next_place(std::int32_t body, const Vec3& d, double s, double limit) const {
        const Placed& moving = placed_[at(body)];
        const Vec3 by = s * d;
        std::vector<Box> boxes;
        double next = s;
        for (std::size_t j = 0; j < placed_.size() && next == s; ++j) {
            const Placed& other = placed_[j];
            if (&other == &moving) continue;
            const double c = clearance(body, static_cast<std::int32_t>(j));
            if (!boxes_overlap(moved(moving.box, by), other.box, c)) continue;
            if (boxes.empty())
                for (const Box& box : moving.boxes) boxes.push_back(moved(box, by));
            const auto look = [&](std::int32_t x, std::int32_t y) {
                const Corners a = moved(moving.corners(x), by), b = other.corners(y);
                if (!boxes_overlap(box_of(a[0], a[1], a[2]), box_of(b[0], b[1], b[2]), c)) return;
                if (!(closest_triangle_triangle(a, b).distance_sq < c * c)) return;
                const double left = place_of_leaving(moving.corners(x), b, d, c, s, limit);
                next = std::max({next, left, s + kTolerance * c}); // goes on whatever was rounded
            };
            for_each_overlapping_leaf_pair(moving.shape->bvh, boxes, other.shape->bvh, other.boxes, c,
                                           [&](std::span<const std::int32_t> of_a, std::span<const std::int32_t> of_b) {
                                               for (const std::int32_t x : of_a)
                                                   for (const std::int32_t y : of_b)
                                                       if (next < limit) look(x, y);
                                           });
        }
        return std::min(next, limit);
    }

    Scene& scene_;
    std::vector<Vec3> sphere_;
    std::vector<Placed> placed_;
    std::vector<BodyOverlap> overlaps_;
    std::vector<int> caught_with_; ///< movable bodies that a body intersects at the start
};

} // namespace

SeparatedStart separate_overlaps(Scene& scene) { return Separator(scene).run(); }

} // namespace flotilla
