// SPDX-License-Identifier: MIT
#include "mesh/placement_avx2.hpp"

#include <immintrin.h>

#include "mesh/bvh.hpp"

namespace flotilla {
namespace {

__m256d column(const double* m, int c) { return _mm256_set_pd(0, m[6 + c], m[3 + c], m[c]); }

__m256 load(const CoarseBox& box) { return _mm256_load_ps(box.lower); }

/// merged(), which keeps the second of two equal floats.
__m256 merged_with(__m256 a, const CoarseBox& b) { return _mm256_min_ps(a, load(b)); }

/// coarse_box() of the point in the first three lanes; the fourth is 0.
__m256 coarse(__m256d point) {
    const __m128 kOut = _mm_set1_ps(0x1p-22f), kTiny = _mm_set_ps(0, 0x1p-126f, 0x1p-126f, 0x1p-126f);
    const __m128 f = _mm256_cvtpd_ps(point), size = _mm_andnot_ps(_mm_set1_ps(-0.0f), f);
    const __m128 room = _mm_add_ps(_mm_mul_ps(kOut, size), kTiny);
    const __m128 lower = _mm_sub_ps(f, room), neg_upper = _mm_sub_ps(_mm_sub_ps(_mm_setzero_ps(), f), room);
    return _mm256_insertf128_ps(_mm256_castps128_ps256(lower), neg_upper, 1);
}

} // namespace

static_assert(sizeof(CoarseBox) == 8 * sizeof(float) && alignof(CoarseBox) == 32);

void place_vertices_avx2(const double (*local)[3], std::size_t count, const double* rotation, const double* position,
                         double (*world)[3], CoarseBox* points, double* low, double* high) {
    const __m256d x = column(rotation, 0), y = column(rotation, 1), z = column(rotation, 2);
    const __m256d p = _mm256_set_pd(0, position[2], position[1], position[0]);
    const __m256i first_three = _mm256_set_epi64x(0, -1, -1, -1);
    __m256d lower = _mm256_set1_pd(__builtin_inf()), upper = _mm256_set1_pd(-__builtin_inf());
    const auto place = [&](std::size_t i) {
        const __m256d turned = _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(x, _mm256_broadcast_sd(&local[i][0])),
                                                           _mm256_mul_pd(y, _mm256_broadcast_sd(&local[i][1]))),
                                             _mm256_mul_pd(z, _mm256_broadcast_sd(&local[i][2])));
        const __m256d at = _mm256_add_pd(turned, p);
        lower = _mm256_min_pd(at, lower); // of two equal numbers the second, as min() of vectors keeps the first
        upper = _mm256_max_pd(at, upper);
        _mm256_store_ps(points[i].lower, coarse(at));
        return at;
    };
    // The fourth lane goes where the next vertex follows.
    for (std::size_t i = 0; i + 1 < count; ++i) _mm256_storeu_pd(world[i], place(i));
    if (count > 0) _mm256_maskstore_pd(world[count - 1], first_three, place(count - 1));
    _mm256_maskstore_pd(low, first_three, lower);
    _mm256_maskstore_pd(high, first_three, upper);
}

void refit_avx2(const BvhNode* nodes, std::size_t count, const std::int32_t (*corners)[3], const CoarseBox* vertices,
                CoarseBox* boxes) {
    for (std::size_t i = count; i-- > 0;) {
        const BvhNode node = nodes[i];
        __m256 box;
        if (node.count == 0) {
            box = merged_with(load(boxes[i + 1]), boxes[node.first]);
        } else {
            const std::int32_t(*triangle)[3] = corners + node.first, (*const end)[3] = triangle + node.count;
            box = load(vertices[(*triangle)[0]]);
            for (; triangle != end; ++triangle)
                for (const std::int32_t v : *triangle) box = merged_with(box, vertices[v]);
        }
        _mm256_store_ps(boxes[i].lower, box);
    }
}

} // namespace flotilla
