// SPDX-License-Identifier: MIT
// Entry points of the kernels compiled per instruction set. Call only where the processor has it.
#pragma once

#include "geometry/ccd_hits.hpp"

namespace flotilla {

void ccd_batch_avx2(CcdKind kind, const CcdQuery* queries, long count, const CcdOptions& options, CcdResult* results);
void ccd_batch_avx512(CcdKind kind, const CcdQuery* queries, long count, const CcdOptions& options, CcdResult* results);
/// `corners`: four per query.
void ccd_corners_avx2(CcdKind kind, const CcdPoints& points, const std::int32_t* corners, long count,
                      const CcdOptions& options, CcdResult* results);
void ccd_corners_avx512(CcdKind kind, const CcdPoints& points, const std::int32_t* corners, long count,
                        const CcdOptions& options, CcdResult* results);
void ccd_hits_avx2(CcdKind kind, const CcdPoints& points, const std::int32_t* corners, long count,
                   const CcdHitOptions& options, CcdResult* results);
void ccd_hits_avx512(CcdKind kind, const CcdPoints& points, const std::int32_t* corners, long count,
                     const CcdHitOptions& options, CcdResult* results);

} // namespace flotilla
