// SPDX-License-Identifier: MIT
// The plane test of feature pairs, written once for every vector width.
//
// With n = e x f the features lie in planes n . x = const, |n . w| / |n| apart, w being any vector between them: (e, f)
// are two edges of the face, or the two edges. The factor on the distance is far above the rounding of either side as
// long as n is more than noise, which the sine of the angle between e and f tells.
#pragma once

#include "geometry/corner_pack.hpp"

namespace flotilla {
namespace {

inline constexpr double kPlaneMargin = 1 + 1e-3; // of squares
inline constexpr double kLeastSine = 1e-5;       // of directions whose cross product is a normal, not noise

/// The bits of the pairs that are known to be farther apart.
template <CcdKind kKind, class P>
inline unsigned farther_by_planes(const CornerQueries<P>& pairs, P distance_sq) {
    PackVec<P> x[4];
    load_points<kKind>(pairs, 0, x);
    constexpr bool kFace = kKind == CcdKind::vertex_face;
    const PackVec<P> e = kFace ? x[2] - x[1] : x[1] - x[0];
    const PackVec<P> f = kFace ? x[3] - x[1] : x[3] - x[2];
    const PackVec<P> w = kFace ? x[0] - x[1] : x[2] - x[0];
    const PackVec<P> n = cross(e, f);
    const P square = dot(n, n), d = dot(n, w);
    return mask_bits(mask_and((P::all(kPlaneMargin) * distance_sq) * square < d * d,
                              P::all(kLeastSine * kLeastSine) * (dot(e, e) * dot(f, f)) < square));
}

template <CcdKind kKind, class P>
inline long near_by_planes_of(const CornerSource& source, long count, double distance, std::int32_t* out) {
    const P distance_sq = P::all(distance * distance);
    long n = 0;
    for (long first = 0; first < count; first += P::kWidth) {
        auto pairs = source.begin_pack<P>();
        for (int lane = 0; lane < P::kWidth; ++lane) source.set(pairs, lane, first + (first + lane < count ? lane : 0));
        const unsigned far = farther_by_planes<kKind>(pairs, distance_sq);
        for (int lane = 0; lane < P::kWidth; ++lane) {
            out[n] = static_cast<std::int32_t>(first + lane); // written in any case
            n += (far >> lane & 1u) == 0 && first + lane < count ? 1 : 0;
        }
    }
    return n;
}

template <class P>
inline long near_by_planes_any(CcdKind kind, const CcdPoints& points, const std::int32_t* corners, long count,
                               double distance, std::int32_t* out) {
    const CornerSource source{&points, corners};
    return kind == CcdKind::vertex_face ? near_by_planes_of<CcdKind::vertex_face, P>(source, count, distance, out)
                                        : near_by_planes_of<CcdKind::edge_edge, P>(source, count, distance, out);
}

} // namespace
} // namespace flotilla
