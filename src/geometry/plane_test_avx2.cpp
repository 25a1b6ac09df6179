// SPDX-License-Identifier: MIT
#include "geometry/pack_avx2.hpp"
#include "geometry/plane_test.hpp"

#include "geometry/plane_test_kernel.hpp"

namespace flotilla {

long near_by_planes_avx2(CcdKind kind, const CcdPoints& points, const std::int32_t* corners, long count,
                         double distance, std::int32_t* out) {
    return near_by_planes_any<Avx2Pack>(kind, points, corners, count, distance, out);
}

} // namespace flotilla
