// SPDX-License-Identifier: MIT
#include "ccd/feature_candidates.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "geometry/closest.hpp"

namespace flotilla {
namespace {

/// The corners of a feature pair in the order of CcdQuery, and the two bodies they belong to.
struct Corners {
    const BodyMotion* first;
    const BodyMotion* second;
    CcdCorners v;
    std::size_t split; ///< corners before it belong to the first body
};

Corners corners(const BodyMotion& a, const BodyMotion& b, const FeaturePair& f) {
    const bool a_first = f.kind != FeatureKind::face_vertex;
    return {a_first ? &a : &b, a_first ? &b : &a, ccd_corners(a, b, f), f.kind == FeatureKind::edge_edge ? 2u : 1u};
}

/// Puts the corners [begin, end) of a turning body where they are at time t, and both ends where the velocity there
/// leads.
void follow_turn(const BodyMotion& body, double t, const Corners& c, std::size_t begin, std::size_t end, CcdQuery& q,
                 std::array<Vec3, 4>& x) {
    const Pose pose = body.pose(t);
    const Mat3 rotation = matrix(pose.rotation);
    const Vec3 velocity = body.at1.pose->com - body.at0.pose->com; // per step
    for (std::size_t i = begin; i < end; ++i) {
        x[i] = rotation * body.shape->mesh.vertices[at(c.v[i])] + pose.origin;
        const Vec3 v = velocity + cross(body.turn, x[i] - pose.com);
        q.x0[i] = x[i] - t * v;
        q.x1[i] = q.x0[i] + v;
    }
}

/// Where the corners are at time t; both ends of turning bodies' as follow_turn() has them.
std::array<Vec3, 4> corners_at(double t, const Corners& c, CcdQuery& q) {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = q.x0[i] + t * (q.x1[i] - q.x0[i]);
    if (!c.first->straight()) follow_turn(*c.first, t, c, 0, c.split, q, x);
    if (!c.second->straight()) follow_turn(*c.second, t, c, c.split, 4, q, x);
    return x;
}

/// Closest points at the given corner positions, as weights of the corners.
struct Weights {
    std::array<double, 4> w;
    double distance_sq;
    bool interior;
};
Weights closest_weights(FeatureKind kind, const std::array<Vec3, 4>& x) {
    if (kind == FeatureKind::edge_edge) {
        const auto c = closest_edge_edge(x[0], x[1], x[2], x[3]);
        const bool interior = c.s > 0 && c.s < 1 && c.t > 0 && c.t < 1;
        return {{1 - c.s, c.s, 1 - c.t, c.t}, c.distance_sq, interior};
    }
    const auto c = closest_vertex_triangle(x[0], x[1], x[2], x[3]);
    return {{1, c.barycentric[0], c.barycentric[1], c.barycentric[2]}, c.distance_sq, true};
}

Vec3 blend(const std::array<double, 4>& w, const std::array<Vec3, 4>& x, std::size_t begin, std::size_t end) {
    Vec3 p = w[begin] * x[begin];
    for (std::size_t i = begin + 1; i < end; ++i) p += w[i] * x[i];
    return p;
}

} // namespace

CcdQuery ccd_query(const BodyMotion& a, const BodyMotion& b, const FeaturePair& f) {
    return ccd_query(ccd_kind(f.kind), ccd_points(a, b, f.kind), ccd_corners(a, b, f));
}

CcdPoints ccd_points(const BodyMotion& a, const BodyMotion& b, FeatureKind kind) {
    const bool a_first = kind != FeatureKind::face_vertex;
    const BodyMotion &first = a_first ? a : b, &second = a_first ? b : a;
    return {first.at0.x.data(), first.at1.x.data(), second.at0.x.data(), second.at1.x.data()};
}

FeaturePoints closest_points(const BodyMotion& a, const BodyMotion& b, const FeaturePair& f, double t) {
    const Corners c = corners(a, b, f);
    CcdQuery q = ccd_query(a, b, f);
    const std::array<Vec3, 4> x = corners_at(t, c, q);
    const Weights w = closest_weights(f.kind, x);
    const std::size_t split = c.split;
    FeaturePoints p{blend(w.w, q.x0, 0, split),
                    blend(w.w, q.x1, 0, split),
                    blend(w.w, q.x0, split, 4),
                    blend(w.w, q.x1, split, 4),
                    blend(w.w, x, 0, split),
                    blend(w.w, x, split, 4),
                    w.distance_sq,
                    w.interior};
    if (f.kind == FeatureKind::face_vertex) {
        std::swap(p.a0, p.b0);
        std::swap(p.a1, p.b1);
        std::swap(p.a, p.b);
    }
    return p;
}

Vec3 closest_direction(const BodyMotion& a, const BodyMotion& b, const FeaturePair& f, double t) {
    const Corners c = corners(a, b, f);
    CcdQuery q = ccd_query(a, b, f);
    const std::array<Vec3, 4> x = corners_at(t, c, q);
    const Weights w = closest_weights(f.kind, x);
    const Vec3 first = blend(w.w, x, 0, c.split), second = blend(w.w, x, c.split, 4);
    return direction_between(f.kind == FeatureKind::face_vertex ? first - second : second - first,
                             std::max(a.max_abs(), b.max_abs()), c.split == 2 ? x[1] - x[0] : x[2] - x[1],
                             x[3] - x[c.split]);
}

} // namespace flotilla
