// SPDX-License-Identifier: MIT
#include "geometry/ccd_wide.hpp"
#include "geometry/pack_avx512.hpp"

#include "geometry/ccd_kernel.hpp"

namespace flotilla {

void ccd_batch_avx512(CcdKind kind, const CcdQuery* queries, long count, const CcdOptions& options,
                      CcdResult* results) {
    run_batch<Avx512Pack>(kind, WholeSource{queries}, count, options, results);
}

void ccd_corners_avx512(CcdKind kind, const CcdPoints& points, const std::int32_t* corners, long count,
                        const CcdOptions& options, CcdResult* results) {
    run_batch<Avx512Pack>(kind, CornerSource{&points, corners}, count, options, results);
}

void ccd_hits_avx512(CcdKind kind, const CcdPoints& points, const std::int32_t* corners, long count,
                     const CcdHitOptions& options, CcdResult* results) {
    run_hits<Avx512Pack>(kind, CornerSource{&points, corners}, count, options, results);
}

} // namespace flotilla
