// SPDX-License-Identifier: MIT
// Continuous collision detection, one row per kind of query, situation and instruction set, and the one-shot
// certificate. Features are 0.3 m or so across, placed and turned at random within 2 m of the origin; both take part in
// a common motion of 0.4 m.
//   far      0.5 m apart, sliding and approaching by 0.1 m                             certified miss
//   near     5 mm apart, sliding by 10 mm, approaching to 1 mm; separation 0.2 mm      certified miss at a small gap
//   resting  10 mm apart (the rest distance), moving by 10 um; separation 0.2 mm       certified miss
//   hitting  from 0.1 m on one side to 0.1 m on the other                              hit
// Counters: per_query, CPU time; advances, the mean number of iterations of a query; flops per query, counted by
// running the kernel on a pack that counts (counting_pack.hpp); of_peak, the share of this core's arithmetic limit
// (arithmetic_peak.hpp) that these operations reach. The limit takes a division for as cheap as an addition, and knows
// no selections or loads. Before anything is timed every query must end as its class says and with the bits of the
// scalar code.
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "arithmetic_peak.hpp"
#include "counting_pack.hpp"
#include "geometry/ccd.hpp"
#include "geometry/pack_scalar.hpp"

#include "geometry/ccd_kernel.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kQueries = 1024; // 250 kB with the results: they stay in the second-level cache
constexpr CcdOptions kOptions{.separation = 2e-4};

struct Situation {
    const char* name;
    double gap, approach, slide; ///< m
    bool hit;
};
constexpr Situation kSituations[] = {{"far", 0.5, 0.1, 0.1, false},
                                     {"near", 5e-3, 4e-3, 1e-2, false},
                                     {"resting", 1e-2, 1e-5, 1e-5, false},
                                     {"hitting", 0.1, 0.2, 0, true}};

class Random {
  public:
    double real(double a, double b) { return std::uniform_real_distribution<double>(a, b)(bits_); }
    Vec3 vector() {
        const double x = normal_(bits_), y = normal_(bits_);
        return {x, y, normal_(bits_)};
    }
    Vec3 unit() { return normalized(vector()); }

  private:
    std::mt19937_64 bits_{7};
    std::normal_distribution<double> normal_;
};

/// The features `gap` apart along the unit vector n, which leads from the second to the first.
CcdQuery place(CcdKind kind, Random& r, double gap, Vec3& n) {
    const Vec3 c = 2 * r.unit();
    for (;;) {
        const Vec3 u = r.unit(), v = r.unit();
        n = cross(u, v);
        if (length(n) < 0.5) continue;
        n = normalized(n);
        if (kind == CcdKind::edge_edge) {
            const Vec3 p = c + gap * n;
            const double s = r.real(0.05, 0.25), t = r.real(0.05, 0.25);
            return {{p - s * u, p + (0.3 - s) * u, c - t * v, c + (0.3 - t) * v}, {}};
        }
        const double s = r.real(0.1, 0.8), t = r.real(0.1, 0.9 - s);
        return {{c + (0.3 * s) * u + (0.3 * t) * v + gap * n, c, c + 0.3 * u, c + 0.3 * v}, {}};
    }
}

std::vector<CcdQuery> make_queries(CcdKind kind, const Situation& situation) {
    Random r;
    std::vector<CcdQuery> queries;
    for (std::size_t i = 0; i < kQueries; ++i) {
        Vec3 n;
        CcdQuery q = place(kind, r, situation.gap, n);
        const Vec3 common = 0.4 * r.unit();
        const Vec3 relative = situation.slide * normalized(cross(n, r.vector())) - situation.approach * n;
        const std::size_t first = kind == CcdKind::edge_edge ? 2 : 1;
        for (std::size_t k = 0; k < 4; ++k) q.x1[k] = q.x0[k] + common + (k < first ? relative : Vec3{});
        queries.push_back(q);
    }
    return queries;
}

bool same_bits(const CcdResult& a, const CcdResult& b) {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    return a.hit == b.hit && a.iterations == b.iterations && bits(a.toi) == bits(b.toi) &&
           bits(a.direction.x) == bits(b.direction.x) && bits(a.direction.y) == bits(b.direction.y) &&
           bits(a.direction.z) == bits(b.direction.z);
}

/// Whether the answers are those of the class, and the scalar ones. A hit's time must come before contact, at half the
/// step.
bool verified(CcdKind kind, const std::vector<CcdQuery>& queries, const std::vector<CcdResult>& results, bool hit) {
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const CcdResult& r = results[i];
        if (r.hit != hit || (hit && !(r.toi < 0.5 && r.toi > 0.49)) || !same_bits(r, ccd(kind, queries[i], kOptions)))
            return false;
    }
    return true;
}

const double* coordinates(const CcdQuery& q) { return reinterpret_cast<const double*>(&q); }

template <CcdKind kKind>
long count_ccd(const CcdQuery& q) {
    const WholeQueries<CountingPack> lanes{{coordinates(q)}};
    CcdResult result;
    CcdResult* const results[1] = {&result};
    Progress<CountingPack> state{CountingPack::all(0), CountingPack::all(kOptions.separation)};
    CountingPack::operations = 0;
    run<kKind>(lanes, Wanted{}, state, 1u, results);
    return CountingPack::operations;
}

template <CcdKind kKind>
long count_certificate(const CcdQuery& q, const Vec3& d) {
    const WholeQueries<CountingPack> lanes{{coordinates(q)}};
    CountingPack::operations = 0;
    benchmark::DoNotOptimize(
        certify_along<kKind>(lanes, {CountingPack::all(d.x), CountingPack::all(d.y), CountingPack::all(d.z)},
                             CountingPack::all(kOptions.separation)));
    return CountingPack::operations;
}

void report(benchmark::State& state, Isa isa, long flops) {
    using benchmark::Counter;
    const auto count = static_cast<double>(kQueries), total = static_cast<double>(flops);
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kQueries));
    state.counters["per_query"] = Counter(count, Counter::kIsIterationInvariantRate | Counter::kInvert);
    state.counters["flops"] = total / count;
    state.counters["of_peak"] = Counter(total / bench::arithmetic_peak(isa), Counter::kIsIterationInvariantRate);
}

void BM_Ccd(benchmark::State& state, CcdKind kind, const Situation& situation, Isa isa) {
    const auto queries = make_queries(kind, situation);
    std::vector<CcdResult> results(queries.size());
    ccd_batch(kind, queries, kOptions, results, isa);
    if (!verified(kind, queries, results, situation.hit)) return state.SkipWithError("wrong answer: not timed");
    long flops = 0, iterations = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        flops += kind == CcdKind::vertex_face ? count_ccd<CcdKind::vertex_face>(queries[i])
                                              : count_ccd<CcdKind::edge_edge>(queries[i]);
        iterations += results[i].iterations;
    }
    for (auto _ : state) {
        ccd_batch(kind, queries, kOptions, results, isa);
        benchmark::ClobberMemory();
    }
    report(state, isa, flops);
    state.counters["advances"] = static_cast<double>(iterations) / static_cast<double>(kQueries);
}

/// The witnesses are the directions of the answers, as they are kept from step to step.
void BM_CcdCertifiedAlong(benchmark::State& state, CcdKind kind) {
    const auto queries = make_queries(kind, kSituations[2]);
    std::vector<Vec3> witnesses;
    long flops = 0;
    for (const CcdQuery& q : queries) {
        const Vec3 d = witnesses.emplace_back(ccd(kind, q, kOptions).direction);
        if (!certified_along(kind, q, d, kOptions.separation) || certified_along(kind, q, -d, kOptions.separation))
            return state.SkipWithError("wrong answer: not timed");
        flops += kind == CcdKind::vertex_face ? count_certificate<CcdKind::vertex_face>(q, d)
                                              : count_certificate<CcdKind::edge_edge>(q, d);
    }
    for (auto _ : state)
        for (std::size_t i = 0; i < queries.size(); ++i)
            benchmark::DoNotOptimize(certified_along(kind, queries[i], witnesses[i], kOptions.separation));
    report(state, Isa::scalar, flops);
}

const bool kRegistered = [] {
    for (const CcdKind kind : {CcdKind::vertex_face, CcdKind::edge_edge}) {
        const std::string kind_name = kind == CcdKind::vertex_face ? "vertex_face/" : "edge_edge/";
        for (const Situation& situation : kSituations)
            for (const Isa isa : {Isa::scalar, Isa::avx2, Isa::avx512})
                if (isa <= best_isa())
                    benchmark::RegisterBenchmark(
                        ("BM_Ccd/" + kind_name + situation.name + "/" + bench::name(isa)).c_str(), BM_Ccd, kind,
                        situation, isa);
        benchmark::RegisterBenchmark(("BM_CcdCertifiedAlong/" + kind_name + "resting/scalar").c_str(),
                                     BM_CcdCertifiedAlong, kind);
    }
    return true;
}();

} // namespace
} // namespace flotilla
