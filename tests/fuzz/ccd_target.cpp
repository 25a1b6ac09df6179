// SPDX-License-Identifier: MIT
// Files of queries with known answers, CSV where they begin as such, else BIN; and continuous collision detection of
// what they hold: it ends, every instruction set gives the same bits, and where it says "no hit" no sample of the
// motion says otherwise.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "fuzz/checks.hpp"
#include "geometry/closest.hpp"
#include "io/ccd_file.hpp"

namespace {

using namespace flotilla;

/// Samples of a motion are points of it only where sums of its coordinates do not round much.
constexpr double kLargest = 1e6, kRounding = 1e-8;

double distance_at(const CcdFileRow& row, double t) {
    std::array<Vec3, 4> x;
    for (std::size_t k = 0; k < 4; ++k) x[k] = (1 - t) * row.query.x0[k] + t * row.query.x1[k];
    return std::sqrt(row.kind == CcdKind::vertex_face ? closest_vertex_triangle(x[0], x[1], x[2], x[3]).distance_sq
                                                      : closest_edge_edge(x[0], x[1], x[2], x[3]).distance_sq);
}

double largest(const CcdQuery& query) {
    double most = 0;
    for (const auto* points : {&query.x0, &query.x1})
        for (const Vec3& p : *points) most = std::max(most, max_component(abs(p)));
    return most;
}

bool same_bits(const CcdResult& a, const CcdResult& b) {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    return a.hit == b.hit && bits(a.toi) == bits(b.toi) && a.iterations == b.iterations;
}

void check_row(const CcdFileRow& row, double separation, CcdStart start) {
    const CcdOptions options{separation, start};
    const CcdResult result = ccd(row.kind, row.query, options);
    fuzz::require(result.toi >= 0 && result.toi <= 1, "the time of impact is in the step");
    for (const Isa isa : {Isa::scalar, best_isa()}) {
        CcdResult wide;
        ccd_batch(row.kind, {&row.query, 1}, options, {&wide, 1}, isa);
        fuzz::require(same_bits(result, wide), "every instruction set gives the same bits");
    }
    const double most = largest(row.query);
    if (most > kLargest || start == CcdStart::relaxed) return;
    const double proved = result.hit ? result.toi : 1;
    if (result.hit && result.toi == 0) return;
    for (const double t : {0.0, 0.25, 0.5, 0.75, 0.9, 1.0})
        fuzz::require(distance_at(row, t * proved) >= separation - kRounding * most, "no sample is nearer than proved");
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text = fuzz::text_of(data, size);
    const std::string name = text.starts_with("kind") ? "queries.csv" : "queries.bin";
    const std::filesystem::path path = fuzz::write_scratch(name, text);
    std::vector<CcdFileRow> rows;
    if (!fuzz::accepted(name, [&] { rows = read_ccd_file(path); })) return 0;
    rows.resize(std::min<std::size_t>(rows.size(), 8));
    for (const CcdFileRow& row : rows) {
        if (row.toi) fuzz::require(*row.toi >= 0 && *row.toi <= 1 && row.expected, "a time is of a hit");
        for (const double separation : {0.0, 1e-3}) {
            check_row(row, separation, CcdStart::strict);
            check_row(row, separation, CcdStart::relaxed);
        }
    }
    return 0;
}
