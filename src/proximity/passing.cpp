// SPDX-License-Identifier: MIT
#include "proximity/passing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/index.hpp"
#include "base/rotation.hpp"
#include "geometry/closest.hpp"
#include "state/feature_pair.hpp"

namespace flotilla {
namespace {

Vec3 vertex(const PlacedShape& s, std::int32_t v) {
    return s.pose.origin + rotate(s.pose.rotation, s.shape.mesh.vertices[at(v)]);
}

Vec3 across(const Vec3& way, const Vec3& edge) {
    const double square = length_sq(edge);
    return square > 0 ? way - (dot(way, edge) / square) * edge : way;
}

/// The nearest feature of one body: a corner, an edge, or the inside of a face.
struct Nearest {
    const PlacedShape& body;
    std::array<std::int32_t, 2> ends{-1, -1}; ///< vertices of the edge; of a corner the same twice; -1: a face

    [[nodiscard]] bool is_face() const { return ends[0] < 0; }
    [[nodiscard]] bool is_corner() const { return ends[0] == ends[1]; }
    [[nodiscard]] Vec3 edge() const { return vertex(body, ends[1]) - vertex(body, ends[0]); }
};

Nearest nearest_of_face(const PlacedShape& body, const Triangle& face, const Vec3& to) {
    const auto share =
        closest_vertex_triangle(to, vertex(body, face[0]), vertex(body, face[1]), vertex(body, face[2])).barycentric;
    std::array<std::int32_t, 3> with{};
    std::size_t n = 0;
    for (std::size_t k = 0; k < 3; ++k)
        if (share[k] != 0) with[n++] = face[k];
    if (n > 2) return {body, {-1, -1}};
    return {body, {with[0], n > 1 ? with[1] : with[0]}};
}

std::array<Nearest, 2> nearest_features(const FeaturePair& f, const PlacedShape& a, const PlacedShape& b) {
    if (f.kind == FeatureKind::edge_edge) {
        const Edge &e = a.shape.topology.edges[at(f.a)], &g = b.shape.topology.edges[at(f.b)];
        return {Nearest{a, {e[0], e[1]}}, Nearest{b, {g[0], g[1]}}};
    }
    if (f.kind == FeatureKind::vertex_face)
        return {Nearest{a, {f.a, f.a}}, nearest_of_face(b, b.shape.mesh.triangles[at(f.b)], vertex(a, f.a))};
    return {nearest_of_face(a, a.shape.mesh.triangles[at(f.a)], vertex(b, f.b)), Nearest{b, {f.b, f.b}}};
}

/// What of a way changes the distance of the features; zero where they have one normal alone.
Vec3 changing_part(const std::array<Nearest, 2>& nearest, const Vec3& way) {
    constexpr double kParallel = 0x1p-40; // sin^2
    const auto& [p, q] = nearest;
    if (p.is_face() || q.is_face()) return {};
    if (p.is_corner()) return q.is_corner() ? way : across(way, q.edge());
    const Vec3 e = p.edge();
    if (q.is_corner()) return across(way, e);
    const Vec3 g = q.edge();
    return length_sq(cross(e, g)) > kParallel * length_sq(e) * length_sq(g) ? Vec3{} : across(way, e);
}

/// Calls visit(d) for the directions d that bound where a corner or an edge is the nearest feature of its body: points
/// at r from it with r . d <= 0. Of a corner they are its edges, of an edge the directions into its faces.
template <class Visit>
void for_each_bound(const Nearest& nearest, Visit&& visit) {
    const Topology& topology = nearest.body.shape.topology;
    const auto place = [&](std::int32_t v) { return topology.place[at(v)]; };
    const std::int32_t p = place(nearest.ends[0]), q = place(nearest.ends[1]);
    const Vec3 from = vertex(nearest.body, nearest.ends[0]), edge = nearest.edge();
    for (const std::int32_t t : topology.around_vertex(nearest.ends[0])) {
        const Triangle& face = nearest.body.shape.mesh.triangles[at(t)];
        const auto has_end = [&](std::int32_t v) { return place(v) == q; };
        if (std::none_of(face.begin(), face.end(), has_end)) continue;
        for (const std::int32_t v : face)
            if (place(v) != p && place(v) != q) visit(across(vertex(nearest.body, v) - from, edge));
    }
}

/// The share of the way `w`, at most `time`, until a point at `from` leaves where the feature is nearest.
double time_inside(const Nearest& nearest, const Vec3& from, const Vec3& w, double time) {
    constexpr double kAlong = 0x1p-40; // sin^2, of a way along a bound
    for_each_bound(nearest, [&](const Vec3& d) {
        const double rate = dot(w, d);
        if (!(rate > 0 && rate * rate > kAlong * length_sq(w) * length_sq(d))) return;
        time = std::min(time, std::max(0.0, -dot(from, d) / rate));
    });
    return time;
}

} // namespace

PointGap gap_on_the_way(const FeaturePair& features, const PlacedShape& a, const PlacedShape& b, const Vec3& way,
                        double radius, const PointGap& now) {
    if (!(now.distance > radius) || !(now.distance + dot(now.normal, way) < radius)) return now;
    const auto nearest = nearest_features(features, a, b);
    const Vec3 from = now.distance * now.normal, w = changing_part(nearest, way);
    const double square = length_sq(w), along = -dot(from, w);
    if (!(along > 0)) return now;
    // |from + t w|^2 is least at along / square, and radius^2 at the root before that.
    const double least = length_sq(from) - along * along / square;
    double t = along / square;
    if (least < radius * radius) t -= std::sqrt((radius * radius - least) / square);
    t = time_inside(nearest[0], from, w, std::min(t, 1.0));
    t = time_inside(nearest[1], -from, -w, t);
    const Vec3 normal = normalized(from + t * w);
    return {normal, dot(normal, from)};
}

} // namespace flotilla
