// SPDX-License-Identifier: MIT
#include "geometry/ccd.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <string_view>

#include "base/assert.hpp"
#include "geometry/ccd_wide.hpp"
#include "geometry/pack_scalar.hpp"

#include "geometry/ccd_kernel.hpp"

namespace flotilla {

static_assert(sizeof(CcdCorners) == 4 * sizeof(std::int32_t), "the kernels read corners as bare numbers");
static_assert(sizeof(Vec3) == 3 * sizeof(double), "the kernels read points as three doubles");
static_assert(sizeof(CcdQuery) == 24 * sizeof(double), "the kernels read a query as 24 doubles");
static_assert(offsetof(CcdResult, direction) == 0 && offsetof(CcdResult, toi) == 3 * sizeof(double),
              "the kernels write direction and toi as four doubles");

CcdResult ccd(CcdKind kind, const CcdQuery& query, const CcdOptions& options) {
    CcdResult result;
    const WholeQueries<ScalarPack> lanes{{reinterpret_cast<const double*>(&query)}};
    CcdResult* const results[1] = {&result};
    Progress<ScalarPack> state{{0.0}, {options.separation}};
    const Wanted wanted{.relaxed = options.start == CcdStart::relaxed};
    if (kind == CcdKind::vertex_face)
        run<CcdKind::vertex_face>(lanes, wanted, state, 1u, results);
    else
        run<CcdKind::edge_edge>(lanes, wanted, state, 1u, results);
    return result;
}

bool certified_along(CcdKind kind, const CcdQuery& query, const Vec3& direction, double separation) {
    const WholeQueries<ScalarPack> lanes{{reinterpret_cast<const double*>(&query)}};
    const PackVec<ScalarPack> d{{direction.x}, {direction.y}, {direction.z}};
    const ScalarPack s{separation};
    return (kind == CcdKind::vertex_face ? certify_along<CcdKind::vertex_face>(lanes, d, s)
                                         : certify_along<CcdKind::edge_edge>(lanes, d, s)) != 0;
}

double ccd_error(double w) { return (ScalarPack{kErrFactor} * ceil_power_of_two(ScalarPack{w}) + ScalarPack{kTiny}).v; }

double ccd_floor(double w) { return kFloorPerError * ccd_error(w); }

namespace {

Isa widest_isa() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
        return Isa::avx512;
    if (__builtin_cpu_supports("avx2")) return Isa::avx2;
#endif
    return Isa::scalar;
}

Isa allowed_isa() {
    const char* text = std::getenv("FLOTILLA_SIMD");
    const std::string_view name = text != nullptr ? text : "";
    const Isa limit = name == "scalar" ? Isa::scalar : name == "avx2" ? Isa::avx2 : Isa::avx512;
    return std::min(limit, widest_isa());
}

} // namespace

Isa best_isa() {
    static const Isa isa = allowed_isa();
    return isa;
}

void ccd_batch(CcdKind kind, std::span<const CcdQuery> queries, const CcdOptions& options, std::span<CcdResult> results,
               Isa isa) {
    FLOTILLA_ASSERT(queries.size() == results.size());
    const auto count = static_cast<long>(queries.size());
#if defined(__x86_64__)
    if (isa == Isa::avx512) return ccd_batch_avx512(kind, queries.data(), count, options, results.data());
    if (isa == Isa::avx2) return ccd_batch_avx2(kind, queries.data(), count, options, results.data());
#endif
    for (std::size_t i = 0; i < queries.size(); ++i) results[i] = ccd(kind, queries[i], options);
}

CcdQuery ccd_query(CcdKind kind, const CcdPoints& points, const CcdCorners& corners) {
    const std::size_t split = kind == CcdKind::vertex_face ? 1 : 2;
    CcdQuery q;
    for (std::size_t i = 0; i < 4; ++i) {
        q.x0[i] = (i < split ? points.first0 : points.second0)[corners[i]];
        q.x1[i] = (i < split ? points.first1 : points.second1)[corners[i]];
    }
    return q;
}

void ccd_batch(CcdKind kind, const CcdPoints& points, std::span<const CcdCorners> corners, const CcdOptions& options,
               std::span<CcdResult> results, Isa isa) {
    FLOTILLA_ASSERT(corners.size() == results.size());
#if defined(__x86_64__)
    const auto count = static_cast<long>(corners.size());
    if (count == 0) return;
    const std::int32_t* const bare = corners.data()->data();
    if (isa == Isa::avx512) return ccd_corners_avx512(kind, points, bare, count, options, results.data());
    if (isa == Isa::avx2) return ccd_corners_avx2(kind, points, bare, count, options, results.data());
#endif
    for (std::size_t i = 0; i < corners.size(); ++i)
        results[i] = ccd(kind, ccd_query(kind, points, corners[i]), options);
}

void ccd_hits(CcdKind kind, const CcdPoints& points, std::span<const CcdCorners> corners, const CcdHitOptions& options,
              std::span<CcdResult> results, Isa isa) {
    FLOTILLA_ASSERT(corners.size() == results.size());
#if defined(__x86_64__)
    const auto count = static_cast<long>(corners.size());
    if (count == 0) return;
    const std::int32_t* const bare = corners.data()->data();
    if (isa == Isa::avx512) return ccd_hits_avx512(kind, points, bare, count, options, results.data());
    if (isa == Isa::avx2) return ccd_hits_avx2(kind, points, bare, count, options, results.data());
#endif
    for (std::size_t i = 0; i < corners.size(); ++i)
        results[i] = ccd(kind, ccd_query(kind, points, corners[i]), {options.separation, options.start});
}

} // namespace flotilla
