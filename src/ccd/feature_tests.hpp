// SPDX-License-Identifier: MIT
// Box tests of many feature pairs of two bodies.
#pragma once

#include "ccd/feature_candidates.hpp"

namespace flotilla {

/// The features of a body as the kernels see them: bare arrays.
struct FeatureArrays {
    const CoarseBox *at0, *at1;    ///< boxes of the vertices at both times
    const std::int32_t* triangles; ///< three vertices each
    const std::int32_t* edges;     ///< two vertices each
};
[[nodiscard]] FeatureArrays feature_arrays(const BodyMotion& body);

/// Numbers of a feature of body a and one of body b, the kind being known.
struct FeatureIds {
    std::int32_t a, b;
};

enum class FeatureTest : std::uint8_t {
    swept, ///< along the motion, judged by one axis at a time
    near   ///< at rest at t = 0
};

/// Writes the pairs among `count` of one kind whose boxes come within a reach. Returns how many; `out` has room for
/// all.
[[nodiscard]] long select_features(FeatureTest test, FeatureKind kind, const FeatureIds* ids, long count,
                                   const FeatureArrays& a, const FeatureArrays& b, const CoarseReach& reach,
                                   FeaturePair* out, Isa isa);

/// Compiled for its instruction set: call only where the processor has it. The reach is a CoarseReach's value.
long select_features_avx2(FeatureTest test, FeatureKind kind, const FeatureIds* ids, long count, const FeatureArrays& a,
                          const FeatureArrays& b, float reach, FeaturePair* out);

} // namespace flotilla
