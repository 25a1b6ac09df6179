// SPDX-License-Identifier: MIT
// Box tests of feature pairs, written once for every width of the box packs. Boxes stay in registers: put together in
// memory from their vertices' they cost several times as much.
#pragma once

#include "ccd/feature_tests.hpp"

namespace flotilla {
namespace {

/// The box of a feature with kCorners vertices.
template <int kCorners, class B>
inline B feature_box(const CoarseBox* points, const std::int32_t* corners) {
    B box = B::load(points[corners[0]]);
    for (int k = 1; k < kCorners; ++k) box = merged(box, B::load(points[corners[k]]));
    return box;
}

/// Whether two features come within the reach.
struct SweptTest {
    template <int kCornersA, int kCornersB, class B>
    static bool meet(const FeatureArrays& a, const std::int32_t* corners_a, const FeatureArrays& b,
                     const std::int32_t* corners_b, B reach) {
        const B gaps0 =
            feature_box<kCornersA, B>(a.at0, corners_a) + turned(feature_box<kCornersB, B>(b.at0, corners_b));
        const B gaps1 =
            feature_box<kCornersA, B>(a.at1, corners_a) + turned(feature_box<kCornersB, B>(b.at1, corners_b));
        return !any_greater_twice(gaps0, reach, gaps1, reach);
    }
};
struct NearTest {
    template <int kCornersA, int kCornersB, class B>
    static bool meet(const FeatureArrays& a, const std::int32_t* corners_a, const FeatureArrays& b,
                     const std::int32_t* corners_b, B reach) {
        return !any_greater(
            feature_box<kCornersA, B>(a.at0, corners_a) + turned(feature_box<kCornersB, B>(b.at0, corners_b)), reach);
    }
};

template <class Test, class B, FeatureKind kKind>
inline long select_kind(const FeatureIds* ids, long count, const FeatureArrays& a, const FeatureArrays& b, float reach,
                        FeaturePair* out) {
    const B within = B::all(reach);
    long n = 0;
    for (long i = 0; i < count; ++i) {
        const FeatureIds f = ids[i];
        bool keep = false;
        if constexpr (kKind == FeatureKind::vertex_face)
            keep = Test::template meet<1, 3>(a, &f.a, b, b.triangles + 3 * f.b, within);
        else if constexpr (kKind == FeatureKind::face_vertex)
            keep = Test::template meet<3, 1>(a, a.triangles + 3 * f.a, b, &f.b, within);
        else
            keep = Test::template meet<2, 2>(a, a.edges + 2 * f.a, b, b.edges + 2 * f.b, within);
        out[n].kind = kKind; // written in any case, kept or not: no branch to be mispredicted
        out[n].a = f.a;
        out[n].b = f.b;
        n += keep ? 1 : 0;
    }
    return n;
}

template <class Test, class B>
inline long select_by(FeatureKind kind, const FeatureIds* ids, long count, const FeatureArrays& a,
                      const FeatureArrays& b, float reach, FeaturePair* out) {
    switch (kind) {
    case FeatureKind::vertex_face: return select_kind<Test, B, FeatureKind::vertex_face>(ids, count, a, b, reach, out);
    case FeatureKind::face_vertex: return select_kind<Test, B, FeatureKind::face_vertex>(ids, count, a, b, reach, out);
    default: return select_kind<Test, B, FeatureKind::edge_edge>(ids, count, a, b, reach, out);
    }
}

template <class B>
inline long select_any(FeatureTest test, FeatureKind kind, const FeatureIds* ids, long count, const FeatureArrays& a,
                       const FeatureArrays& b, float reach, FeaturePair* out) {
    return test == FeatureTest::swept ? select_by<SweptTest, B>(kind, ids, count, a, b, reach, out)
                                      : select_by<NearTest, B>(kind, ids, count, a, b, reach, out);
}

} // namespace
} // namespace flotilla
