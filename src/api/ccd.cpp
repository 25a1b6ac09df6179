// SPDX-License-Identifier: MIT
#include <flotilla/ccd.hpp>

#include <flotilla/error.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/floating_point.hpp"
#include "geometry/ccd.hpp"
#include "geometry/ccd_cubic.hpp"
#include "geometry/ccd_distance.hpp"
#include "io/ccd_file.hpp"

namespace flotilla {
namespace {

/// The queries of one kind, as the batch kernels want them, with their answers.
struct Batch {
    CcdKind kind;
    std::vector<CcdFileRow> rows;
    std::vector<CcdQuery> queries;
    std::vector<CcdResult> results;
};

std::array<Batch, 2> split_by_kind(const std::vector<CcdFileRow>& rows) {
    std::array<Batch, 2> batches{Batch{CcdKind::vertex_face, {}, {}, {}}, Batch{CcdKind::edge_edge, {}, {}, {}}};
    for (const CcdFileRow& row : rows) {
        Batch& batch = batches[row.kind == CcdKind::vertex_face ? 0 : 1];
        batch.rows.push_back(row);
        batch.queries.push_back(row.query);
    }
    for (Batch& batch : batches) batch.results.resize(batch.queries.size());
    return batches;
}

void run(Batch& batch, const CcdFileOptions& options) {
    if (options.method == CcdMethod::conservative) {
        ccd_batch(batch.kind, batch.queries, {.separation = options.separation}, batch.results, best_isa());
        return;
    }
    const double tolerance = options.separation > 0 ? options.separation : kCubicTolerance;
    for (std::size_t i = 0; i < batch.queries.size(); ++i)
        batch.results[i] = ccd_cubic(batch.kind, batch.queries[i], tolerance);
}

/// Median time of one pass over the file, per query. Small files are repeated until a tenth of a second is spent.
double time_passes(std::array<Batch, 2>& batches, std::size_t rows, const CcdFileOptions& options) {
    using Clock = std::chrono::steady_clock;
    constexpr std::size_t kMinPasses = 5, kMaxPasses = 1001;
    const Clock::time_point start = Clock::now();
    std::vector<double> passes;
    while (passes.size() < kMinPasses ||
           (passes.size() < kMaxPasses && Clock::now() - start < std::chrono::milliseconds(100))) {
        const Clock::time_point pass = Clock::now();
        for (Batch& batch : batches) run(batch, options);
        passes.push_back(std::chrono::duration<double, std::nano>(Clock::now() - pass).count());
    }
    const auto middle = passes.begin() + static_cast<std::ptrdiff_t>(passes.size() / 2);
    std::nth_element(passes.begin(), middle, passes.end());
    return rows == 0 ? 0 : *middle / static_cast<double>(rows);
}

/// Where a row without contact lies relative to the separation s.
enum class Nearness {
    within,    ///< minimum distance <= s: a hit is due
    between,   ///< neither certainly: in (s, 1.01 s], or beyond the reach of the bounds
    far_apart, ///< minimum distance > 1.01 s: a hit is false
};

Nearness nearness(const CcdFileRow& row, double separation) {
    const double far = 1.01 * separation;
    // Bounds within (s, 1.01 s] can stop as well: they have settled on `between`.
    const DistanceGoal goal{.tolerance = 1e-3 * separation, .above = far, .below = separation, .budget = 20'000};
    const DistanceBounds d = sweep_distance(row.kind, row.query, goal);
    return d.upper <= separation ? Nearness::within : d.lower > far ? Nearness::far_apart : Nearness::between;
}

void count_row(const CcdFileRow& row, const CcdResult& result, double separation, CcdFileReport& report) {
    ++report.rows;
    if (row.expected) {
        ++report.positives;
        if (!result.hit) ++report.missed;
        if (result.hit && row.toi && result.toi > *row.toi) ++report.late;
    } else if (separation == 0) {
        if (result.hit) ++report.false_hits;
    } else {
        const Nearness near = nearness(row, separation);
        if (!result.hit && near == Nearness::within) ++report.missed;
        if (result.hit && near == Nearness::far_apart) ++report.false_hits;
    }
}

} // namespace

CcdFileReport evaluate_ccd_file(const std::filesystem::path& path, const CcdFileOptions& options) {
    const DefaultFloatingPoint environment;
    if (!std::isfinite(options.separation) || options.separation < 0)
        throw InputError("separation: " + std::to_string(options.separation) + " is not a finite length >= 0");
    std::array<Batch, 2> batches = split_by_kind(read_ccd_file(path));
    CcdFileReport report;
    report.ns_per_query = time_passes(batches, batches[0].rows.size() + batches[1].rows.size(), options);
    for (const Batch& batch : batches)
        for (std::size_t i = 0; i < batch.rows.size(); ++i)
            count_row(batch.rows[i], batch.results[i], options.separation, report);
    return report;
}

} // namespace flotilla
