// SPDX-License-Identifier: MIT
// Closest features and the segment-triangle test; the counter per_pair is the CPU time of one pair. Features are 0.1 to
// 1 m across and placed at random.
//   vertex_triangle, edge_edge     apart by a distance known by construction
//   triangle_triangle/apart        one above the other, 10 mm apart: all 6 + 9 feature pairs and 6 segment tests
//   triangle_triangle/crossing     an edge of one through the other
//   segment_triangle/hit, miss     through the interior; beside it
// Before anything is timed every answer is compared with the constructed one.
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "geometry/closest.hpp"
#include "geometry/ray.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kPairs = 1024;
constexpr double kGap = 1e-2;        // m
constexpr double kTolerance = 1e-12; // m: a few thousand roundings at this size

struct Pair {
    std::array<Vec3, 3> a, b; ///< unused corners stay zero
};

class Random {
  public:
    double real(double a, double b) { return std::uniform_real_distribution<double>(a, b)(bits_); }
    Vec3 unit() {
        const double x = normal_(bits_), y = normal_(bits_);
        return normalized({x, y, normal_(bits_)});
    }

  private:
    std::mt19937_64 bits_{7};
    std::normal_distribution<double> normal_;
};

struct Frame {
    Vec3 o, u, v, n; ///< a point, two unit vectors at an angle of 30 degrees or more, the unit normal of their plane
};
Frame frame(Random& r) {
    for (;;) {
        const Vec3 u = r.unit(), v = r.unit(), n = cross(u, v);
        if (length(n) >= 0.5) return {r.unit(), u, v, normalized(n)};
    }
}

std::array<Vec3, 3> triangle(const Frame& f) { return {f.o, f.o + f.u, f.o + f.v}; }
Vec3 inner_point(const Frame& f, Random& r) {
    const double s = r.real(0.1, 0.8);
    return f.o + s * f.u + r.real(0.1, 0.9 - s) * f.v;
}

Pair vertex_triangle(Random& r) {
    const Frame f = frame(r);
    return {{inner_point(f, r) + kGap * f.n}, triangle(f)};
}
Pair edge_edge(Random& r) {
    const Frame f = frame(r);
    const double s = r.real(0.1, 0.9), t = r.real(0.1, 0.9);
    const Vec3 p = f.o + kGap * f.n;
    return {{p - s * f.u, p + (1 - s) * f.u}, {f.o - t * f.v, f.o + (1 - t) * f.v}};
}
/// A triangle whose lowest corner is `height` above the inside of another.
Pair triangles(Random& r, double height) {
    const Frame f = frame(r);
    const Vec3 low = inner_point(f, r) + height * f.n;
    return {{low, low + 0.5 * f.n + 0.3 * f.u, low + 0.7 * f.n - 0.2 * f.v}, triangle(f)};
}
/// From `below` to 0.5 m above the inside of a triangle.
Pair segment(Random& r, double below) {
    const Frame f = frame(r);
    const Vec3 x = inner_point(f, r);
    return {{x + below * f.n, x + 0.5 * f.n}, triangle(f)};
}

double vertex_triangle_distance(const Pair& p) {
    return std::sqrt(closest_vertex_triangle(p.a[0], p.b[0], p.b[1], p.b[2]).distance_sq);
}
double edge_edge_distance(const Pair& p) {
    return std::sqrt(closest_edge_edge(p.a[0], p.a[1], p.b[0], p.b[1]).distance_sq);
}
double triangle_distance(const Pair& p) { return std::sqrt(closest_triangle_triangle(p.a, p.b).distance_sq); }
double segment_time(const Pair& p) { return segment_triangle(p.a[0], p.a[1], p.b[0], p.b[1], p.b[2]).value_or(-1); }

template <class Make, class Measure>
void run(benchmark::State& state, Make&& make, Measure&& measure, double expected) {
    Random r;
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < kPairs; ++i) pairs.push_back(make(r));
    for (const Pair& p : pairs)
        if (!(std::abs(measure(p) - expected) <= kTolerance)) return state.SkipWithError("wrong answer: not timed");
    for (auto _ : state)
        for (const Pair& p : pairs) benchmark::DoNotOptimize(measure(p));
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPairs));
    using benchmark::Counter;
    state.counters["per_pair"] =
        Counter(static_cast<double>(kPairs), Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void BM_Closest_VertexTriangle(benchmark::State& s) { run(s, vertex_triangle, vertex_triangle_distance, kGap); }
void BM_Closest_EdgeEdge(benchmark::State& s) { run(s, edge_edge, edge_edge_distance, kGap); }
void BM_Closest_TriangleTriangle_Apart(benchmark::State& s) {
    run(
        s, [](Random& r) { return triangles(r, kGap); }, triangle_distance, kGap);
}
void BM_Closest_TriangleTriangle_Crossing(benchmark::State& s) {
    run(
        s, [](Random& r) { return triangles(r, -0.1); }, triangle_distance, 0);
}
void BM_SegmentTriangle_Hit(benchmark::State& s) {
    run(
        s, [](Random& r) { return segment(r, -0.5); }, segment_time, 0.5);
}
void BM_SegmentTriangle_Miss(benchmark::State& s) {
    run(
        s, [](Random& r) { return segment(r, 0.1); }, segment_time, -1);
}

BENCHMARK(BM_Closest_VertexTriangle);
BENCHMARK(BM_Closest_EdgeEdge);
BENCHMARK(BM_Closest_TriangleTriangle_Apart);
BENCHMARK(BM_Closest_TriangleTriangle_Crossing);
BENCHMARK(BM_SegmentTriangle_Hit);
BENCHMARK(BM_SegmentTriangle_Miss);

} // namespace
} // namespace flotilla
