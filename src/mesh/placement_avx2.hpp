// SPDX-License-Identifier: MIT
// What placing a body costs most of, eight floats at a time: the bits of the plain code.
#pragma once

#include <cstddef>
#include <cstdint>

#include "geometry/coarse_box.hpp"

namespace flotilla {

struct BvhNode;

/// world_vertices() with their boxes: `rotation` row by row, `low` and `high` the corners of the box of all, which is
/// not empty.
void place_vertices_avx2(const double (*local)[3], std::size_t count, const double* rotation, const double* position,
                         double (*world)[3], CoarseBox* points, double* low, double* high);

/// refit() of coarse boxes; `corners` as Bvh has them.
void refit_avx2(const BvhNode* nodes, std::size_t count, const std::int32_t (*corners)[3], const CoarseBox* vertices,
                CoarseBox* boxes);

} // namespace flotilla
