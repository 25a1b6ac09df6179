// SPDX-License-Identifier: MIT
#include "arithmetic_peak.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <string>

#include <benchmark/benchmark.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace flotilla::bench {
namespace {

// Six chains of each kind: three or four cycles of latency times two pipes, in 14 of 16 registers.
#define FLOTILLA_PEAK_LOOP(lanes, Type, set, add, mul)                                                                 \
    double one = 1, zero = 0;                                                                                          \
    benchmark::DoNotOptimize(one);                                                                                     \
    benchmark::DoNotOptimize(zero);                                                                                    \
    const Type o = set(one), z = set(zero);                                                                            \
    Type a0 = o, a1 = o, a2 = o, a3 = o, a4 = o, a5 = o, m0 = o, m1 = o, m2 = o, m3 = o, m4 = o, m5 = o;               \
    for (int i = 0; i < kPeakSteps; ++i) {                                                                             \
        a0 = add(a0, z), m0 = mul(m0, o), a1 = add(a1, z), m1 = mul(m1, o), a2 = add(a2, z), m2 = mul(m2, o);          \
        a3 = add(a3, z), m3 = mul(m3, o), a4 = add(a4, z), m4 = mul(m4, o), a5 = add(a5, z), m5 = mul(m5, o);          \
    }                                                                                                                  \
    Type sum = add(add(add(add(a0, a1), add(a2, a3)), add(a4, a5)), add(add(m0, m1), add(add(m2, m3), add(m4, m5))));  \
    benchmark::DoNotOptimize(sum);                                                                                     \
    return 12.0 * kPeakSteps * (lanes)

double same(double x) { return x; }
double plus(double a, double b) { return a + b; }
double times(double a, double b) { return a * b; }
double scalar_loop() { FLOTILLA_PEAK_LOOP(1, double, same, plus, times); }
#if defined(__x86_64__)
__attribute__((target("avx2"))) double avx2_loop() {
    FLOTILLA_PEAK_LOOP(4, __m256d, _mm256_set1_pd, _mm256_add_pd, _mm256_mul_pd);
}
__attribute__((target("avx512f"))) double avx512_loop() {
    FLOTILLA_PEAK_LOOP(8, __m512d, _mm512_set1_pd, _mm512_add_pd, _mm512_mul_pd);
}
#endif
#undef FLOTILLA_PEAK_LOOP

double cpu_seconds() {
    std::timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double measure(Isa isa) {
    double best = 0;
    for (int run = 0; run < 50; ++run) {
        double operations = 0;
        const double start = cpu_seconds();
        for (int i = 0; i < 200; ++i) operations += run_peak_loop(isa);
        best = std::max(best, operations / (cpu_seconds() - start));
    }
    return best;
}

void BM_ArithmeticPeak(benchmark::State& state, Isa isa) {
    double operations = 0;
    for (auto _ : state) operations += run_peak_loop(isa);
    state.counters["flops"] = benchmark::Counter(operations, benchmark::Counter::kIsRate);
}

const bool kRegistered = [] {
    for (const Isa isa : {Isa::scalar, Isa::avx2, Isa::avx512})
        if (isa <= best_isa())
            benchmark::RegisterBenchmark((std::string("BM_ArithmeticPeak/") + name(isa)).c_str(), BM_ArithmeticPeak,
                                         isa);
    return true;
}();

} // namespace

double run_peak_loop(Isa isa) {
#if defined(__x86_64__)
    if (isa == Isa::avx512) return avx512_loop();
    if (isa == Isa::avx2) return avx2_loop();
#endif
    return isa == Isa::scalar ? scalar_loop() : 0;
}

double arithmetic_peak(Isa isa) {
    static std::array<double, 3> peak{};
    double& p = peak[static_cast<std::size_t>(isa)];
    if (p == 0) p = measure(isa);
    return p;
}

const char* name(Isa isa) { return isa == Isa::avx512 ? "avx512" : isa == Isa::avx2 ? "avx2" : "scalar"; }

} // namespace flotilla::bench
