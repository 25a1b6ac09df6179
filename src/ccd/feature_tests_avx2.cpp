// SPDX-License-Identifier: MIT
#include "ccd/feature_tests.hpp"
#include "geometry/box_pack_avx2.hpp"

#include "ccd/feature_tests_kernel.hpp"

namespace flotilla {

long select_features_avx2(FeatureTest test, FeatureKind kind, const FeatureIds* ids, long count, const FeatureArrays& a,
                          const FeatureArrays& b, float reach, FeaturePair* out) {
    return select_any<Avx2BoxPack>(test, kind, ids, count, a, b, reach, out);
}

} // namespace flotilla
