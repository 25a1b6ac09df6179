// SPDX-License-Identifier: MIT
// Exact triangle test, one row per situation; the counter per_pair is the time of one pair:
//   Boxes      bounding boxes disjoint                                    comparisons only
//   Far        boxes overlap, one triangle beside the other's plane       3 to 6 filtered orient3d
//   Near       metre-sized triangles 1e-6 m apart                         filters still decide
//   Crossing   proper intersections                                       6 + 2 filtered orient3d
//   Touching   a corner exactly in the other triangle                     one exact zero
//   Coplanar   both in one oblique plane                                  exact zeros, then orient2d
//   Wide       Touching scaled by 2^-900                                  the integer fallback
// Arithmetic of Near, the common case of resting contact: 2 planes of 18 and 6 sides of 18 additions and
// multiplications, 144 in all besides comparisons, about 36 cycles for a core that retires four scalar ones per cycle.
// The answer of every pair is known by construction and checked before anything is timed.
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "base/vec3.hpp"
#include "geometry/exact/predicates.hpp"
#include "geometry/exact/triangle_triangle.hpp"

namespace flotilla::exact {
namespace {

using Corners = std::array<Vec3, 3>;

struct Query {
    Corners a, b;
    bool intersect;
};

constexpr std::size_t kQueries = 1024; // 150 kB: stays in the second-level cache

class Random {
  public:
    double real() { return static_cast<double>(static_cast<std::int64_t>(bits_()) >> 11) * 0x1p-52; }
    Vec3 point() {
        const double x = real(), y = real();
        return {x, y, real()};
    }
    /// Integers of magnitude up to n.
    double integer(int n) { return double(static_cast<int>(bits_() % static_cast<std::uint64_t>(2 * n + 1)) - n); }

  private:
    std::mt19937_64 bits_{7};
};

Corners moved(const Corners& t, const Vec3& by) { return {t[0] + by, t[1] + by, t[2] + by}; }

/// Corners a, and a unit vector normal to it.
Corners fat_triangle(Random& r, Vec3& normal) {
    for (;;) {
        const Vec3 p = r.point(), q = r.point();
        const Corners a{p, q, r.point()};
        const Vec3 n = cross(a[1] - a[0], a[2] - a[0]);
        if (length(n) < 0.5) continue;
        normal = normalized(n);
        return a;
    }
}

Vec3 centre(const Corners& t) { return (t[0] + t[1] + t[2]) / 3; }

Query boxes(Random& r) {
    Vec3 n;
    const Corners a = fat_triangle(r, n);
    return {a, moved(fat_triangle(r, n), {0, 2.5, 0}), false};
}

/// A triangle over the middle of a, its lowest corner `gap` above it.
Query above(Random& r, double gap) {
    Vec3 n;
    const Corners a = fat_triangle(r, n);
    const Vec3 low = centre(a) + gap * n, side = cross(n, a[1] - a[0]);
    return {a, {low + 0.5 * n + 0.3 * side, low, low + 0.6 * n - 0.3 * side}, false};
}

Query crossing(Random& r) {
    Query q = above(r, -0.25);
    q.intersect = true;
    return q;
}

/// Integers below 2^50: a corner of b is a's centre of mass exactly.
Query touching(Random& r) {
    const auto point = [&] { return Vec3{3 * r.integer(1 << 30), 3 * r.integer(1 << 30), 3 * r.integer(1 << 30)}; };
    const Corners a{point(), point(), point()};
    const Vec3 c = centre(a), n = cross(a[1] - a[0], a[2] - a[0]) / 0x1p30;
    return {a, {c + n, c, c + 2 * n + (a[1] - a[0])}, true};
}

/// Both in the plane spanned by two integer vectors; every other pair apart.
Query coplanar(Random& r) {
    const auto vector = [&] { return Vec3{r.integer(1 << 20), r.integer(1 << 20), r.integer(1 << 20)}; };
    const Vec3 o = vector(), u = vector(), v = vector();
    const bool intersect = r.integer(1) > 0;
    const double shift = intersect ? 1 : 6;
    const Corners a{o, o + 5 * u, o + 5 * v};
    return {a, {o + shift * u, o + (shift - 2) * u + 5 * v, o + (shift + 5) * u + v}, intersect};
}

Query wide(Random& r) {
    Query q = touching(r);
    for (Corners* t : {&q.a, &q.b})
        for (Vec3& p : *t) p = 0x1p-900 * p;
    return q;
}

template <class Make>
void run(benchmark::State& state, Make&& make) {
    Random r;
    std::vector<Query> queries;
    for (std::size_t i = 0; i < kQueries; ++i) queries.push_back(make(r));
    for (const Query& q : queries)
        if (triangles_intersect(q.a, q.b) != q.intersect) return state.SkipWithError("wrong answer: not timed");
    for (auto _ : state)
        for (const Query& q : queries) benchmark::DoNotOptimize(triangles_intersect(q.a, q.b));
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kQueries));
    using benchmark::Counter;
    state.counters["per_pair"] =
        Counter(static_cast<double>(kQueries), Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void BM_ExactTriangle_Boxes(benchmark::State& s) { run(s, boxes); }
void BM_ExactTriangle_Far(benchmark::State& s) {
    run(s, [](Random& r) { return above(r, 0.25); });
}
void BM_ExactTriangle_Near(benchmark::State& s) {
    run(s, [](Random& r) { return above(r, 1e-6); });
}
void BM_ExactTriangle_Crossing(benchmark::State& s) { run(s, crossing); }
void BM_ExactTriangle_Touching(benchmark::State& s) { run(s, touching); }
void BM_ExactTriangle_Coplanar(benchmark::State& s) { run(s, coplanar); }
void BM_ExactTriangle_Wide(benchmark::State& s) { run(s, wide); }

BENCHMARK(BM_ExactTriangle_Boxes);
BENCHMARK(BM_ExactTriangle_Far);
BENCHMARK(BM_ExactTriangle_Near);
BENCHMARK(BM_ExactTriangle_Crossing);
BENCHMARK(BM_ExactTriangle_Touching);
BENCHMARK(BM_ExactTriangle_Coplanar);
BENCHMARK(BM_ExactTriangle_Wide);

} // namespace
} // namespace flotilla::exact
