// SPDX-License-Identifier: MIT
#include "geometry/exact_cgal_check.hpp"

#include <algorithm>
#include <cstdio>
#include <variant>

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include "geometry/exact/triangle_triangle.hpp"

namespace flotilla::test {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using Triangle3 = Kernel::Triangle_3;

/// CGAL's tests require triangles of positive area and segments of positive length; which of the three a set of corners
/// is, CGAL's own exact predicates tell.
using Shape = std::variant<Point, Segment, Triangle3>;

Point cgal(const Vec3& p) { return {p.x, p.y, p.z}; }

Shape cgal_shape(const Corners& t) {
    const Point p = cgal(t[0]), q = cgal(t[1]), r = cgal(t[2]);
    if (!CGAL::collinear(p, q, r)) return Triangle3(p, q, r);
    const auto [first, last] = std::minmax({p, q, r}, CGAL::Less<Point, Point>());
    if (first == last) return first;
    return Segment(first, last);
}

struct Intersect {
    bool operator()(const Point& a, const Point& b) const { return a == b; }
    bool operator()(const Point& a, const Segment& b) const { return b.has_on(a); }
    bool operator()(const Point& a, const Triangle3& b) const { return b.has_on(a); }
    bool operator()(const Segment& a, const Point& b) const { return a.has_on(b); }
    bool operator()(const Triangle3& a, const Point& b) const { return a.has_on(b); }
    template <class A, class B>
    bool operator()(const A& a, const B& b) const {
        return CGAL::do_intersect(a, b);
    }
};

bool cgal_intersect(const Shape& a, const Shape& b) { return std::visit(Intersect{}, a, b); }

} // namespace

Agreement compare_with_cgal(const PairClass& pair_class, std::int64_t pairs, std::uint64_t seed) {
    Agreement result;
    Random r(seed);
    for (std::int64_t i = 0; i < pairs; ++i) {
        const auto [a, b] = pair_class.make(r);
        const Shape shape_a = cgal_shape(a), shape_b = cgal_shape(b);
        const bool ours = exact::triangles_intersect(a, b);
        const bool segment = exact::segment_intersects_triangle(a[0], a[1], b);
        ++result.pairs;
        result.intersecting += ours;
        result.degenerate += shape_a.index() != 2 || shape_b.index() != 2;
        result.disagreements += ours != cgal_intersect(shape_a, shape_b);
        ++result.segments;
        result.segments_hit += segment;
        result.disagreements += segment != cgal_intersect(cgal_shape({a[0], a[1], a[1]}), shape_b);
    }
    return result;
}

void expect_agreement_with_cgal(const PairClass& pair_class, std::int64_t pairs, std::uint64_t seed) {
    const Agreement n = compare_with_cgal(pair_class, pairs, seed);
    std::printf("%-10s %8lld pairs, %8lld intersect, %8lld degenerate, %8lld of the segments hit, %lld disagreements\n",
                pair_class.name, static_cast<long long>(n.pairs), static_cast<long long>(n.intersecting),
                static_cast<long long>(n.degenerate), static_cast<long long>(n.segments_hit),
                static_cast<long long>(n.disagreements));
    const double least = pair_class.rarer_answer * static_cast<double>(n.pairs);
    EXPECT_EQ(n.disagreements, 0);
    EXPECT_GE(static_cast<double>(n.intersecting), least);
    EXPECT_GE(static_cast<double>(n.pairs - n.intersecting), least);
    EXPECT_GE(static_cast<double>(n.segments_hit), 0.4 * least);
    EXPECT_GE(static_cast<double>(n.segments - n.segments_hit), least);
}

} // namespace flotilla::test
