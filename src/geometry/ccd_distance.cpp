// SPDX-License-Identifier: MIT
#include "geometry/ccd_distance.hpp"

#include "geometry/closest.hpp"

#include <algorithm>
#include <queue>

namespace flotilla {
namespace {

using Corners = std::array<Vec3, 4>;

Corners positions(const CcdQuery& q, double t) {
    Corners x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = (1 - t) * q.x0[i] + t * q.x1[i];
    return x;
}

/// Shortest vector from the second feature to the first.
Vec3 shortest(CcdKind kind, const Corners& x) {
    if (kind == CcdKind::vertex_face) return x[0] - closest_vertex_triangle(x[0], x[1], x[2], x[3]).point;
    const EdgeEdgeClosest c = closest_edge_edge(x[0], x[1], x[2], x[3]);
    return c.p - c.q;
}

/// Least d . (a - b) over the corners a of the first and b of the second feature.
double gap_along(const Vec3& d, CcdKind kind, const Corners& x) {
    const std::size_t first = kind == CcdKind::vertex_face ? 1 : 2;
    double gap = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < first; ++i)
        for (std::size_t j = first; j < 4; ++j) gap = std::min(gap, dot(d, x[i] - x[j]));
    return gap;
}

double rounding_error(const CcdQuery& q) {
    double largest = 0;
    for (const Corners* x : {&q.x0, &q.x1})
        for (const Vec3& p : *x) largest = std::max(largest, max_component(abs(p)));
    return 64 * 0x1p-53 * largest;
}

struct Interval {
    double t0, t1, lower;
    bool operator<(const Interval& other) const { return lower > other.lower; } // least lower bound on top of the queue
};

} // namespace

DistanceBounds sweep_distance(CcdKind kind, const CcdQuery& query, const DistanceGoal& goal) {
    const double error = rounding_error(query);
    std::priority_queue<Interval> open;
    double upper = std::min(length(shortest(kind, query.x0)), length(shortest(kind, query.x1))) + error;
    const auto examine = [&](double t0, double t1) {
        const Vec3 v = shortest(kind, positions(query, (t0 + t1) / 2));
        upper = std::min(upper, length(v) + error);
        const Vec3 d = normalized(v);
        const double gap = std::min(gap_along(d, kind, positions(query, t0)), gap_along(d, kind, positions(query, t1)));
        open.push({t0, t1, std::max(gap - error, 0.0)});
    };
    examine(0, 1);
    for (int evaluations = 1;; evaluations += 2) {
        const Interval nearest = open.top();
        const double lower = std::min(nearest.lower, upper);
        if (upper - lower <= goal.tolerance || lower > goal.above || upper <= goal.below || evaluations >= goal.budget)
            return {lower, upper};
        open.pop();
        const double middle = (nearest.t0 + nearest.t1) / 2;
        examine(nearest.t0, middle);
        examine(middle, nearest.t1);
    }
}

} // namespace flotilla
