// SPDX-License-Identifier: MIT
#include "mesh/placement.hpp"

#include "base/assert.hpp"
#include "mesh/placement_avx2.hpp"

namespace flotilla {

void world_vertices(std::span<const Vec3> local, const Vec3& position, const Quat& rotation, std::span<Vec3> world) {
    FLOTILLA_ASSERT(local.size() == world.size());
    const Mat3 r = matrix(rotation);
    for (std::size_t i = 0; i < local.size(); ++i) world[i] = r * local[i] + position;
}

Box world_vertices(std::span<const Vec3> local, const Vec3& position, const Quat& rotation, std::span<Vec3> world,
                   std::span<CoarseBox> points, [[maybe_unused]] Isa isa) {
    FLOTILLA_ASSERT(local.size() == world.size() && local.size() == points.size());
    Box box;
#if defined(__x86_64__)
    static_assert(sizeof(Vec3) == 3 * sizeof(double)); // the kernel reads coordinates as bare numbers
    if (isa != Isa::scalar) {
        const Mat3 r = matrix(rotation);
        place_vertices_avx2(reinterpret_cast<const double(*)[3]>(local.data()), local.size(), r.m.data(), &position.x,
                            reinterpret_cast<double(*)[3]>(world.data()), points.data(), &box.lower.x, &box.upper.x);
        return box;
    }
#endif
    world_vertices(local, position, rotation, world);
    for (std::size_t i = 0; i < world.size(); ++i) {
        points[i] = coarse_box(world[i]);
        box = extended(box, world[i]);
    }
    return box;
}

} // namespace flotilla
