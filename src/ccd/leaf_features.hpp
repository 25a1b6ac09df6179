// SPDX-License-Identifier: MIT
// From pairs of leaves to the feature pairs that they own.
#pragma once

#include <span>
#include <vector>

#include "ccd/feature_listing.hpp"

namespace flotilla {

/// Buffers of what is selected of leaves; one per thread, reused. They grow and never shrink.
struct FeatureBuffer {
    std::vector<FeaturePair> pairs;
    std::vector<std::int32_t> meeting; ///< places of leaf pairs whose boxes meet
    std::vector<NodeIds> open;         ///< leaves that no direction keeps apart
};

/// The feature pairs of the leaves in `buffer.open` whose coarse boxes come within the reach at some time. They stand
/// in `buffer`, by kind, until its next use.
[[nodiscard]] std::span<const FeaturePair> features_of_leaves(const BodyMotion& a, const BodyMotion& b,
                                                              const CoarseReach& reach, FeatureBuffer& buffer);

} // namespace flotilla
