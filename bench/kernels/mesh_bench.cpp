// SPDX-License-Identifier: MIT
// Rows for the bounding hierarchy. Anchor: a moving-box test that needs no division is about 50 SSE2 instructions, 12
// cycles at four per cycle; the divisions, where they are reached, add three of about 5 cycles and 40 instructions.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "base/rotation.hpp"
#include "mesh/bvh.hpp"
#include "mesh/mass_properties.hpp"
#include "mesh/mesh_file.hpp"

namespace flotilla {
namespace {

const TriangleMesh& boat() {
    static const TriangleMesh mesh = read_mesh(FLOTILLA_SOURCE_DIR "/bench/meshes/boat.obj");
    return mesh;
}

std::vector<Vec3> placed(const Vec3& rotation, const Vec3& position) {
    const Mat3 r = matrix(rotation_from_vector(rotation));
    std::vector<Vec3> out;
    for (const Vec3& v : boat().vertices) out.push_back(r * v + position);
    return out;
}

/// The time of one of n items.
benchmark::Counter per_item(std::size_t n) {
    return {static_cast<double>(n), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

std::vector<CoarseBox> coarse_points(const std::vector<Vec3>& vertices) {
    std::vector<CoarseBox> points;
    for (const Vec3& v : vertices) points.push_back(coarse_box(v));
    return points;
}

/// Two boats, the upper one nested in the lower as in a resting pile: `gap` (m) apart at the keel, somewhat turned. The
/// upper one moves by `move` and `spin` during the step.
struct BoatPair {
    Bvh bvh;
    MovingBoxes a, b;
    std::array<std::vector<CoarseBox>, 2> coarse_a, coarse_b; ///< at both times
    BoatPair(int max_leaf, double gap, const Vec3& move, const Vec3& spin) : bvh(build_bvh(boat(), {max_leaf})) {
        const Vec3 turn{0.02, -0.03, 0.4}, up{0, 0, gap};
        const auto below = placed({}, {});
        refit(bvh, below, below, a);
        refit(bvh, placed(turn, up), placed(turn + spin, up + move), b);
        coarse_a[0] = coarse_a[1] = coarse_nodes(below);
        coarse_b[0] = coarse_nodes(placed(turn, up));
        coarse_b[1] = coarse_nodes(placed(turn + spin, up + move));
    }
    [[nodiscard]] std::vector<CoarseBox> coarse_nodes(const std::vector<Vec3>& vertices) const {
        std::vector<CoarseBox> nodes;
        refit(bvh, coarse_points(vertices), nodes);
        return nodes;
    }
};

void BM_MeshRefit_Boat(benchmark::State& state) {
    const Bvh bvh = build_bvh(boat(), {static_cast<int>(state.range(0))});
    const auto vertices = placed({0.1, 0.2, 0.3}, {4, 5, 6});
    std::vector<Box> boxes;
    for (auto _ : state) {
        refit(bvh, vertices, boxes);
        benchmark::DoNotOptimize(boxes.data());
    }
    state.counters["nodes"] = static_cast<double>(bvh.nodes.size());
    state.counters["per_node"] = per_item(bvh.nodes.size());
}
BENCHMARK(BM_MeshRefit_Boat)->ArgName("leaf")->Arg(1)->Arg(2)->Arg(4);

/// Counts what a traversal does, once: the rows below report times per box test.
std::size_t count_box_tests(const BoatPair& pair, double inflation, std::size_t& triangle_pairs) {
    std::size_t tests = 0;
    triangle_pairs = 0;
    const OutwardInflation outward(inflation, 10);
    bvh_detail::traverse(
        pair.bvh, pair.bvh, std::span<const Box>(pair.a.t1), std::span<const Box>(pair.b.t1),
        [&](std::int32_t i, std::int32_t j, double& entry) {
            ++tests;
            const auto k = static_cast<std::size_t>(i), l = static_cast<std::size_t>(j);
            return moving_boxes_overlap(pair.a.t0[k], pair.a.t1[k], pair.b.t0[l], pair.b.t1[l], outward, entry);
        },
        [](double) { return true; },
        [&](std::int32_t a, std::int32_t b, double) {
            triangle_pairs += pair.bvh.leaf_triangles(a).size() * pair.bvh.leaf_triangles(b).size();
        });
    return tests;
}

/// Calls leaf(node_a, node_b) for the leaves whose coarse moving boxes meet; returns the number of box tests.
template <class Leaf>
std::size_t traverse_coarse(const BoatPair& pair, double inflation, Leaf&& leaf) {
    std::size_t tests = 0;
    const CoarseReach reach(inflation, 10);
    bvh_detail::traverse(
        pair.bvh, pair.bvh, std::span<const CoarseBox>(pair.coarse_a[1]), std::span<const CoarseBox>(pair.coarse_b[1]),
        [&](std::int32_t i, std::int32_t j, double& entry_time) {
            ++tests;
            const auto k = static_cast<std::size_t>(i), l = static_cast<std::size_t>(j);
            float entry = 0;
            const bool meet = coarse_overlap({pair.coarse_a[0][k], pair.coarse_a[1][k]},
                                             {pair.coarse_b[0][l], pair.coarse_b[1][l]}, reach, reach, entry);
            entry_time = entry;
            return meet;
        },
        [](double) { return true; }, [&](std::int32_t a, std::int32_t b, double) { leaf(a, b); });
    return tests;
}

void report(benchmark::State& state, std::size_t tests, std::size_t triangle_pairs) {
    state.counters["box_tests"] = static_cast<double>(tests);
    state.counters["triangle_pairs"] = static_cast<double>(triangle_pairs);
    state.counters["per_test"] = per_item(tests);
}

void traverse_moving(benchmark::State& state, const BoatPair& pair, double inflation) {
    std::size_t expected = 0;
    const std::size_t tests = count_box_tests(pair, inflation, expected);
    std::size_t pairs = 0;
    for (auto _ : state) {
        pairs = 0;
        for_each_overlapping_leaf_pair(pair.bvh, pair.a, pair.bvh, pair.b, inflation,
                                       [&](auto ta, auto tb, double) { pairs += ta.size() * tb.size(); });
        benchmark::DoNotOptimize(pairs);
    }
    if (pairs != expected) state.SkipWithError("the traversal does not find the pairs of the reference");
    report(state, tests, expected);
}

/// Resting: the boats hardly move; the inflation is twice the rest distance, as for a contact query.
void BM_MeshTraverse_RestingBoats(benchmark::State& state) {
    traverse_moving(state, BoatPair(static_cast<int>(state.range(0)), 0.25, {0, 0, -1e-3}, {1e-3, 0, 0}), 0.02);
}
BENCHMARK(BM_MeshTraverse_RestingBoats)->ArgName("leaf")->Arg(1)->Arg(2)->Arg(4);

/// Hitting: 10 m/s and 3 rad/s for 1/24 s, separation as for a collision query.
void BM_MeshTraverse_FastBoats(benchmark::State& state) {
    traverse_moving(state, BoatPair(static_cast<int>(state.range(0)), 0.6, {0.1, 0, -0.4}, {0.125, 0.05, 0}), 2e-4);
}
BENCHMARK(BM_MeshTraverse_FastBoats)->ArgName("leaf")->Arg(1)->Arg(2)->Arg(4);

/// What the step does: single-precision boxes.
void traverse_coarse_row(benchmark::State& state, const BoatPair& pair, double inflation) {
    std::size_t expected = 0, tests = 0;
    (void)count_box_tests(pair, inflation, expected);
    std::size_t pairs = 0;
    for (auto _ : state) {
        pairs = 0;
        tests = traverse_coarse(pair, inflation, [&](std::int32_t a, std::int32_t b) {
            pairs += pair.bvh.leaf_triangles(a).size() * pair.bvh.leaf_triangles(b).size();
        });
        benchmark::DoNotOptimize(pairs);
    }
    if (pairs < expected) state.SkipWithError("single precision loses pairs");
    report(state, tests, pairs);
}

void BM_MeshTraverse_RestingBoatsCoarse(benchmark::State& state) {
    traverse_coarse_row(state, BoatPair(1, 0.25, {0, 0, -1e-3}, {1e-3, 0, 0}), 0.02);
}
BENCHMARK(BM_MeshTraverse_RestingBoatsCoarse);

void BM_MeshTraverse_FastBoatsCoarse(benchmark::State& state) {
    traverse_coarse_row(state, BoatPair(1, 0.6, {0.1, 0, -0.4}, {0.125, 0.05, 0}), 2e-4);
}
BENCHMARK(BM_MeshTraverse_FastBoatsCoarse);

void BM_MeshRefit_BoatCoarse(benchmark::State& state) {
    const Bvh bvh = build_bvh(boat());
    const auto points = coarse_points(placed({0.1, 0.2, 0.3}, {4, 5, 6}));
    std::vector<CoarseBox> boxes;
    for (auto _ : state) {
        refit(bvh, points, boxes);
        benchmark::DoNotOptimize(boxes.data());
    }
    state.counters["per_node"] = per_item(bvh.nodes.size());
}
BENCHMARK(BM_MeshRefit_BoatCoarse);

void BM_MeshTraverse_RestingBoatsStatic(benchmark::State& state) {
    const BoatPair pair(static_cast<int>(state.range(0)), 0.25, {}, {});
    std::size_t pairs = 0;
    for (auto _ : state) {
        pairs = 0;
        for_each_overlapping_leaf_pair(pair.bvh, pair.a.t1, pair.bvh, pair.b.t1, 0.02,
                                       [&](auto ta, auto tb) { pairs += ta.size() * tb.size(); });
        benchmark::DoNotOptimize(pairs);
    }
    state.counters["triangle_pairs"] = static_cast<double>(pairs);
}
BENCHMARK(BM_MeshTraverse_RestingBoatsStatic)->ArgName("leaf")->Arg(1)->Arg(2)->Arg(4);

constexpr std::size_t kBoxPairs = 128; // 24 KB: they stay in the first cache

enum class BoxCase { apart, near, passing };

/// Pairs of moving boxes of one outcome, taken in turn: apart all the time, near from the start, or meeting on the
/// way or not, which takes the divisions.
std::vector<std::array<Box, 4>> box_pairs(BoxCase wanted) {
    std::mt19937_64 rng(1);
    std::uniform_real_distribution<double> x(-1, 1);
    const auto box = [&] {
        const Vec3 low{x(rng), x(rng), x(rng)};
        return Box{low, low + Vec3{0.2, 0.2, 0.2}};
    };
    std::vector<std::array<Box, 4>> pairs;
    while (pairs.size() < kBoxPairs) {
        const std::array<Box, 4> p{box(), box(), box(), box()};
        double entry = -1; // stays so where the boxes are apart all the time
        const bool overlap = moving_boxes_overlap(p[0], p[1], p[2], p[3], 0.01, entry);
        const BoxCase kind = entry < 0                                    ? BoxCase::apart
                             : overlap && boxes_overlap(p[0], p[2], 0.01) ? BoxCase::near
                                                                          : BoxCase::passing;
        if (kind == wanted) pairs.push_back(p);
    }
    return pairs;
}

void BM_MeshMovingBox(benchmark::State& state, BoxCase kind) {
    const auto pairs = box_pairs(kind);
    const OutwardInflation outward(0.01, 3);
    std::size_t i = 0, overlaps = 0;
    for (auto _ : state) {
        const auto& p = pairs[i++ % kBoxPairs];
        double entry = 0;
        overlaps += moving_boxes_overlap(p[0], p[1], p[2], p[3], outward, entry);
        benchmark::DoNotOptimize(entry);
    }
    benchmark::DoNotOptimize(overlaps);
}
BENCHMARK_CAPTURE(BM_MeshMovingBox, apart, BoxCase::apart);
BENCHMARK_CAPTURE(BM_MeshMovingBox, near_from_the_start, BoxCase::near);
BENCHMARK_CAPTURE(BM_MeshMovingBox, passing, BoxCase::passing);

void BM_MeshBuild_Boat(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(build_bvh(boat()));
}
BENCHMARK(BM_MeshBuild_Boat);

void BM_MeshMassProperties_Boat(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(shell_mass_properties(boat(), 10, "boat"));
}
BENCHMARK(BM_MeshMassProperties_Boat);

} // namespace
} // namespace flotilla
