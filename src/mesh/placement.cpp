// SPDX-License-Identifier: MIT
#include "mesh/placement.hpp"

#include "base/assert.hpp"

namespace flotilla {

void world_vertices(std::span<const Vec3> local, const Vec3& position, const Quat& rotation, std::span<Vec3> world) {
    FLOTILLA_ASSERT(local.size() == world.size());
    const Mat3 r = matrix(rotation);
    for (std::size_t i = 0; i < local.size(); ++i) world[i] = r * local[i] + position;
}

} // namespace flotilla
