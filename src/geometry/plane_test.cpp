// SPDX-License-Identifier: MIT
#include "geometry/plane_test.hpp"

#include "geometry/pack_scalar.hpp"

#include "geometry/plane_test_kernel.hpp"

namespace flotilla {

long near_by_planes(CcdKind kind, const CcdPoints& points, std::span<const CcdCorners> corners, double distance,
                    std::int32_t* out, Isa isa) {
    if (corners.empty()) return 0;
    const std::int32_t* const bare = corners.data()->data();
    const auto count = static_cast<long>(corners.size());
#if defined(__x86_64__)
    if (isa != Isa::scalar) return near_by_planes_avx2(kind, points, bare, count, distance, out);
#endif
    return near_by_planes_any<ScalarPack>(kind, points, bare, count, distance, out);
}

} // namespace flotilla
