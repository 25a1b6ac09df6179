// SPDX-License-Identifier: MIT
// Feature pairs by their corners in arrays (CcdPoints), several at a time. Include after a pack header; like the packs,
// everything has internal linkage.
#pragma once

#include "geometry/ccd.hpp"
#include "geometry/pack_vec.hpp"

namespace flotilla {
namespace {

/// A pack of queries whose corners stand in arrays: those of the first feature and those of the second, at both times.
template <class P>
struct CornerQueries {
    const double *first[2], *second[2];
    long corner[4][P::kWidth]; ///< where its coordinates begin
};

/// The corners at t = 0 or t = 1.
template <CcdKind kKind, class P>
inline void load_points(const CornerQueries<P>& queries, int time, PackVec<P> (&x)[4]) {
    constexpr int kSplit = kKind == CcdKind::vertex_face ? 1 : 2;
    for (int i = 0; i < 4; ++i) {
        const double* const all = i < kSplit ? queries.first[time] : queries.second[time];
        const double* points[P::kWidth];
        for (int lane = 0; lane < P::kWidth; ++lane) points[lane] = all + queries.corner[i][lane];
        P xyz[3];
        load_transposed(points, xyz);
        x[i] = {xyz[0], xyz[1], xyz[2]};
    }
}

/// Queries in a row, by their corners.
struct CornerSource {
    template <class P>
    using Pack = CornerQueries<P>;
    const CcdPoints* points;
    const std::int32_t* corners; ///< four per query

    [[nodiscard]] CornerSource from(long first) const { return {points, corners + 4 * first}; }
    template <class P>
    void set(CornerQueries<P>& pack, int lane, long k) const {
        for (int i = 0; i < 4; ++i) pack.corner[i][lane] = 3 * static_cast<long>(corners[4 * k + i]);
    }
    template <class P>
    CornerQueries<P> begin_pack() const {
        return {{&points->first0->x, &points->first1->x}, {&points->second0->x, &points->second1->x}, {}};
    }
};

} // namespace
} // namespace flotilla
