// SPDX-License-Identifier: MIT
#include "ccd/feature_tests.hpp"
#include "geometry/box_pack.hpp"

#include "ccd/feature_tests_kernel.hpp"

namespace flotilla {

static_assert(sizeof(Triangle) == 3 * sizeof(std::int32_t) && sizeof(Edge) == 2 * sizeof(std::int32_t),
              "the kernels read the corners as bare numbers");

FeatureArrays feature_arrays(const BodyMotion& body) {
    return {body.at0.points.data(), body.at1.points.data(), body.shape->mesh.triangles.data()->data(),
            body.shape->topology.edges.data()->data()};
}

long select_features(FeatureTest test, FeatureKind kind, const FeatureIds* ids, long count, const FeatureArrays& a,
                     const FeatureArrays& b, const CoarseReach& reach, FeaturePair* out, Isa isa) {
#if defined(__x86_64__)
    if (isa != Isa::scalar) return select_features_avx2(test, kind, ids, count, a, b, reach.distance(), out);
#endif
    return select_any<BoxPack>(test, kind, ids, count, a, b, reach.distance(), out);
}

} // namespace flotilla
