// SPDX-License-Identifier: MIT
#include "ccd/leaf_features.hpp"

#include <algorithm>

#include "base/index.hpp"

namespace flotilla {

std::span<const FeaturePair> features_of_leaves(const BodyMotion& a, const BodyMotion& b, const CoarseReach& reach,
                                                FeatureBuffer& buffer) {
    std::size_t triangle_pairs = 0;
    for (const NodeIds& p : buffer.open)
        triangle_pairs += a.shape->bvh.leaf_triangles(p.a).size() * b.shape->bvh.leaf_triangles(p.b).size();
    const std::size_t room = triangle_pairs * kFeaturesPerTrianglePair + 3;
    if (buffer.pairs.size() < room) buffer.pairs.resize(room);
    SelectedFeatures selected{};
    FeaturePair* next = buffer.pairs.data();
    for (std::size_t k = 0; k < 3; ++k) {
        selected.out[k] = next;
        next += triangle_pairs * kKindsPerTrianglePair[k] + 1;
    }
    select_leaf_features(listing_arrays(a), listing_arrays(b), reach.distance(), buffer.open.data(),
                         static_cast<long>(buffer.open.size()), selected, best_isa());
    FeaturePair* end = buffer.pairs.data();
    for (std::size_t k = 0; k < 3; ++k) end = std::copy(selected.out[k], selected.out[k] + selected.count[k], end);
    return {buffer.pairs.data(), end};
}

} // namespace flotilla
