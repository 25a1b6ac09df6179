// SPDX-License-Identifier: MIT
#include "geometry/ccd_wide.hpp"
#include "geometry/pack_avx2.hpp"

#include "geometry/ccd_kernel.hpp"

namespace flotilla {

void ccd_batch_avx2(CcdKind kind, const CcdQuery* queries, long count, const CcdOptions& options, CcdResult* results) {
    run_batch<Avx2Pack>(kind, WholeSource{queries}, count, options, results);
}

void ccd_corners_avx2(CcdKind kind, const CcdPoints& points, const std::int32_t* corners, long count,
                      const CcdOptions& options, CcdResult* results) {
    run_batch<Avx2Pack>(kind, CornerSource{&points, corners}, count, options, results);
}

void ccd_hits_avx2(CcdKind kind, const CcdPoints& points, const std::int32_t* corners, long count,
                   const CcdHitOptions& options, CcdResult* results) {
    run_hits<Avx2Pack>(kind, CornerSource{&points, corners}, count, options, results);
}

} // namespace flotilla
