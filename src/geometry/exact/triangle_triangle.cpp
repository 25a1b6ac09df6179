// SPDX-License-Identifier: MIT
// Guigue and Devillers, Fast and robust triangle-triangle overlap test using orientation predicates, 2003, for two
// triangles that are neither degenerate nor coplanar; a separating-line test in a coordinate plane and a sort along a
// line for all other cases. Only signs of orient2d and orient3d and comparisons of coordinates decide, so the answer is
// exact.
//
// Deviations: zero signs are carried through the proof below rather than enumerated, and the coplanar case compares the
// corners with the edge lines (at most 18 orient2d) instead of descending a decision tree.
#include "geometry/exact/triangle_triangle.hpp"

#include <cstddef>
#include <tuple>
#include <utility>

#include "base/assert.hpp"
#include "geometry/exact/predicates.hpp"

namespace flotilla::exact {
namespace {

using Corners = std::array<Vec3, 3>;
using Signs = std::array<int, 3>;

// ---- lower dimensions: hulls of up to three points -----------------------------------------------------------------

/// The corners of a convex hull: one point, the two ends of a segment, or a triangle of positive area.
struct Hull {
    Corners corner;
    std::size_t size;
};

/// Drops one coordinate; keeps a right-handed order of the other two.
Point2 project(const Vec3& p, int axis) {
    if (axis == 0) return {p.y, p.z};
    if (axis == 1) return {p.z, p.x};
    return {p.x, p.y};
}

int projected_turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
    return orient2d(project(a, axis), project(b, axis), project(c, axis));
}

/// An axis along which the projection keeps the plane of a, b, c injective, or -1 where the points are collinear: the
/// three turns are the signs of the components of (b - a) x (c - a).
int projection_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
    for (const int axis : {2, 1, 0})
        if (projected_turn(a, b, c, axis) != 0) return axis;
    return -1;
}

/// On a line, lexicographic order is the order along the line.
bool before(const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

Hull hull_of(const Corners& t) {
    if (projection_axis(t[0], t[1], t[2]) >= 0) return {t, 3};
    const auto [first, last] = std::minmax_element(t.begin(), t.end(), before);
    return {{*first, *last, *last}, *first == *last ? 1U : 2U};
}

Hull hull_of(const Vec3& p, const Vec3& q) {
    if (p == q) return {{p, p, p}, 1};
    return before(p, q) ? Hull{{p, q, q}, 2} : Hull{{q, p, p}, 2};
}

/// Both hulls on one line, ends in lexicographic order.
bool collinear_hulls_intersect(const Hull& a, const Hull& b) {
    return !before(a.corner[a.size - 1], b.corner[0]) && !before(b.corner[b.size - 1], a.corner[0]);
}

/// Some directed edge line of a has all of b strictly on its outer (right) side. The corners of a triangle must run
/// counter-clockwise; a segment counts as two opposite edges, a point as one edge of length zero, which never
/// separates.
bool edge_separates(const Hull& a, const Hull& b, int axis) {
    for (std::size_t i = 0; i < a.size; ++i) {
        const Vec3 &from = a.corner[i], &to = a.corner[(i + 1) % a.size];
        bool all_outside = true;
        for (std::size_t j = 0; j < b.size && all_outside; ++j)
            all_outside = projected_turn(from, to, b.corner[j], axis) < 0;
        if (all_outside) return true;
    }
    return false;
}

Hull counter_clockwise(Hull h, int axis) {
    if (h.size == 3 && projected_turn(h.corner[0], h.corner[1], h.corner[2], axis) < 0)
        std::swap(h.corner[1], h.corner[2]);
    return h;
}

/// Hulls in one plane that projects injectively along axis, not all on one line (that is collinear_hulls_intersect's).
/// Complete because disjoint means that the origin lies outside the convex polygon a - b, hence strictly outside one of
/// its edge lines, and every edge of a - b has the outer normal of an edge of a or the opposite of one of b, along
/// which a and b are then strictly separated. (Parallel segments on two lines, or a segment and a point off its line: a
/// - b is a segment whose line misses the origin, and the line of either segment separates.)
bool coplanar_hulls_intersect(const Hull& a, const Hull& b, int axis) {
    const Hull p = counter_clockwise(a, axis), q = counter_clockwise(b, axis);
    return !edge_separates(p, q, axis) && !edge_separates(q, p, axis);
}

/// A line through p and q that crosses the plane of the triangle t in one point X, with X on the segment. Seen along
/// the line, X is the common projection of p and q, and orient3d(p, q, f, g) tells the side of the edge (f, g) on which
/// it lies: X is in the closed triangle where no two of the three signs are opposite.
bool crossing_segment_hits_triangle(const Vec3& p, const Vec3& q, const Corners& t) {
    const int s0 = orient3d(p, q, t[0], t[1]), s1 = orient3d(p, q, t[1], t[2]);
    if (s0 * s1 < 0) return false;
    const int s2 = orient3d(p, q, t[2], t[0]);
    return s0 * s2 >= 0 && s1 * s2 >= 0;
}

/// a is a triangle of positive area and b a point, a segment, or a triangle in the plane of a.
bool triangle_meets_hull(const Hull& a, const Hull& b) {
    if (b.size < 3) {
        const OrientedPlane plane(a.corner[0], a.corner[1], a.corner[2]);
        const int s0 = plane.side(b.corner[0]), s1 = b.size == 1 ? s0 : plane.side(b.corner[1]);
        if (s0 * s1 > 0) return false;
        if (s0 != 0 || s1 != 0) return crossing_segment_hits_triangle(b.corner[0], b.corner[1], a.corner);
    }
    return coplanar_hulls_intersect(a, b, projection_axis(a.corner[0], a.corner[1], a.corner[2]));
}

/// a is a segment, b a segment or a point.
bool segment_meets_hull(const Hull& a, const Hull& b) {
    const Vec3 &p = a.corner[0], &q = a.corner[1], &r = b.corner[0], &s = b.corner[b.size - 1];
    int axis = projection_axis(p, q, r);
    if (axis < 0) axis = projection_axis(p, q, s);
    if (axis < 0) return collinear_hulls_intersect(a, b);
    if (orient3d(p, q, r, s) != 0) return false;
    return coplanar_hulls_intersect(a, b, axis);
}

/// Precondition: two triangles of positive area are coplanar.
bool hulls_intersect(const Hull& a, const Hull& b) {
    if (a.size < b.size) return hulls_intersect(b, a);
    if (a.size == 3) return triangle_meets_hull(a, b);
    if (a.size == 2) return segment_meets_hull(a, b);
    return a.corner[0] == b.corner[0];
}

// ---- the general position ------------------------------------------------------------------------------------------

Signs sides(const Corners& plane, const Corners& points) {
    const OrientedPlane p(plane[0], plane[1], plane[2]);
    return {p.side(points[0]), p.side(points[1]), p.side(points[2])};
}

bool all_strictly_on_one_side(const Signs& s) { return s[0] != 0 && s[0] == s[1] && s[0] == s[2]; }
bool all_zero(const Signs& s) { return s[0] == 0 && s[1] == 0 && s[2] == 0; }

/// The apex of a triangle that meets a plane without lying in it: the corner at which both edges together hold the
/// whole intersection with the plane. Either it is off the plane and the others are not on its side, or it is the only
/// corner on the plane and the others are on one side. Precondition: not all_zero, not all_strictly_on_one_side.
struct Apex {
    std::size_t corner;
    int side; ///< of the apex, or the opposite of the others' where the apex is on the plane
};

Apex find_apex(const Signs& s) {
    for (std::size_t i = 0; i < 3; ++i) {
        const int own = s[i], next = s[(i + 1) % 3], last = s[(i + 2) % 3];
        if (own != 0 && own * next <= 0 && own * last <= 0) return {i, own};
        if (own == 0 && next * last > 0) return {i, -next};
    }
    FLOTILLA_ASSERT(false);
    return {0, 1};
}

/// The corners from the apex on, in the same orientation, or in the opposite one.
Corners from_apex(const Corners& t, const Apex& apex, bool reversed) {
    const Vec3 &next = t[(apex.corner + 1) % 3], &last = t[(apex.corner + 2) % 3];
    return reversed ? Corners{t[apex.corner], last, next} : Corners{t[apex.corner], next, last};
}

/// Two triangles in different planes, neither wholly on one side of the other's plane; s_a, s_b are the sides of their
/// corners with respect to the other's plane.
///
/// Both meet the common line L of the planes, in intervals [i, j] and [k, l]. Turn and orient the triangles so that
/// A = (p1, q1, r1) and B = (p2, q2, r2) have their apexes first, on the closed positive side of the other's plane, and
/// the other corners on its closed negative side. (Reversing B flips the sides of A's corners and leaves those of B's.)
/// Then p1q1 and p1r1 are not parallel to B's plane (if p1 is on it, q1 and r1 are not), and so for B.
/// Let j = p1q1 with L, i = p1r1 with L, k = p2q2 with L, l = p2r2 with L, N1, N2 the normals, d = N1 x N2 along L.
///
/// (1) sign orient3d(p1, q1, p2, q2) = sign (k - j).d. Write p1 = j + s e1, q1 = j - t e1 with s, t >= 0, s + t > 0 and
///     e1.N2 > 0; p2 = k + s' e2, q2 = k - t' e2 likewise with e2.N1 > 0. The determinant is
///     (s + t)(s' + t') (k - j).(e2 x e1), k - j is parallel to d, and by e1.N1 = e2.N2 = 0
///     d.(e2 x e1) = (N1.e2)(N2.e1) - (N1.e1)(N2.e2) > 0.
/// (2) (j - i).d >= 0. With e = q1 - p1, f = r1 - p1, N1 = e x f, h = N2.(p1 - j) >= 0, m = -N2.e > 0, n = -N2.f > 0:
///     j - i = h (e / m - f / n), and expanding, (j - i).d = h |sqrt(n/m) e - sqrt(m/n) f|^2. The same for B, whose
///     direction is N2 x N1 = -d and whose corners q, r give k and l: (l - k).d >= 0.
/// So the closed intervals meet exactly where k <= j and i <= l along d, which (1) decides for the edges p1q1, p2q2 and
/// for p1r1, p2r2. Zero signs anywhere are covered.
bool crossing_triangles_intersect(const Corners& a, const Signs& s_a, const Corners& b, const Signs& s_b) {
    const Apex apex_a = find_apex(s_a), apex_b = find_apex(s_b);
    const auto [p1, q1, r1] = from_apex(a, apex_a, apex_b.side < 0);
    const auto [p2, q2, r2] = from_apex(b, apex_b, apex_a.side < 0);
    return orient3d(p1, q1, p2, q2) <= 0 && orient3d(p1, r1, p2, r2) >= 0;
}

} // namespace

/// A strict side proves that the plane is one (its three points are not collinear), so the early exits need no look at
/// degeneracy, and all degenerate or coplanar cases have an all_zero.
bool triangles_intersect_unboxed(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
    const Signs s_a = sides(b, a);
    if (all_strictly_on_one_side(s_a)) return false;
    const Signs s_b = sides(a, b);
    if (all_strictly_on_one_side(s_b)) return false;
    if (all_zero(s_a) || all_zero(s_b)) return hulls_intersect(hull_of(a), hull_of(b));
    return crossing_triangles_intersect(a, s_a, b, s_b);
}

bool segment_intersects_triangle_unboxed(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
    const OrientedPlane plane(t[0], t[1], t[2]);
    const int s_p = plane.side(p), s_q = plane.side(q);
    if (s_p * s_q > 0) return false;
    if (s_p == 0 && s_q == 0) return hulls_intersect(hull_of(p, q), hull_of(t));
    return crossing_segment_hits_triangle(p, q, t);
}

} // namespace flotilla::exact
