// SPDX-License-Identifier: MIT
// The feature pairs of two bodies that may come near each other along motions near a given one, by one traversal of
// both hierarchies.
#pragma once

#include "ccd/feature_tests.hpp"

namespace flotilla {

/// How near a feature pair must come to be listed. Along each axis and either way round take the gap of its boxes less
/// `reach0` at t = 0, times `scale0`, and less `reach1` at t = 1: unless both exceed x for one of these six, the pair
/// is listed, x being the margin. The least x for which that is so is how far the motion must stray before the pair can
/// matter.
struct ListingReach {
    float reach0, reach1, scale0, margin;
};

/// A body as the kernels see it: bare arrays.
struct ListingArrays {
    FeatureArrays features;
    const CoarseBox *nodes0, *nodes1; ///< boxes of the hierarchy's nodes at both times
    const BvhNode* nodes;
    const float* sizes;
    const std::int32_t* leaf_triangles; ///< Bvh::triangles
    const std::int32_t* leaf_corners;   ///< Bvh::corners
    const std::int32_t* triangle_edges; ///< three per triangle
    const std::uint8_t* owned;          ///< Topology::owned
};
[[nodiscard]] ListingArrays listing_arrays(const BodyMotion& body);

struct NodeIds {
    std::int32_t a, b;
};

inline constexpr int kListingBlock = 8; // node pairs opened together

/// Node pairs that wait. Each pair of a block is replaced by at most two, one node level further down; so, taking
/// blocks from the top, no more than a block for each level of both trees wait, and one. One slot more is written and
/// not kept.
struct ListingStack {
    int size = 0;
    NodeIds pairs[kListingBlock * (2 * kMaxBvhDepth + 2) + 2];
};

struct ListedFeature {
    FeatureIds ids;
    float distance; ///< that the motion must stray before the pair can matter, m
    FeatureKind kind;
    std::int32_t place; ///< for the list's use
};

/// Opens node pairs of the stack until it is empty or `room` pairs of leaves are found; returns how many were. The
/// stack's pairs are taken to meet.
[[nodiscard]] long open_node_pairs(const ListingArrays& a, const ListingArrays& b, const ListingReach& reach,
                                   ListingStack& stack, NodeIds* leaves, long room, Isa isa);
/// Writes the places of those leaf pairs whose boxes come within a reach (CoarseReach::distance) at some time; returns
/// how many. `out` has room for all.
[[nodiscard]] long meeting_leaves(const ListingArrays& a, const ListingArrays& b, float reach, const NodeIds* leaves,
                                  long count, std::int32_t* out, Isa isa);
/// Lists the feature pairs that leaf pairs own; returns how many. `out` has room for kFeaturesPerTrianglePair for each
/// pair of their triangles and one more.
[[nodiscard]] long list_features(const ListingArrays& a, const ListingArrays& b, const ListingReach& reach,
                                 const NodeIds* leaves, long count, ListedFeature* out, Isa isa);
inline constexpr std::size_t kFeaturesPerTrianglePair = 15;

/// What is selected of leaf pairs, by kind. Each kind has room for as many as the pairs of triangles own at most, and
/// one more.
struct SelectedFeatures {
    FeaturePair* out[3];
    long count[3];
};
inline constexpr std::size_t kKindsPerTrianglePair[3] = {3, 3, 9};
/// Those of the feature pairs that leaf pairs own whose boxes come within a reach (CoarseReach::distance) at some time.
void select_leaf_features(const ListingArrays& a, const ListingArrays& b, float reach, const NodeIds* leaves,
                          long count, SelectedFeatures& selected, Isa isa);

/// Compiled for its instruction set: call only where the processor has it.
long open_node_pairs_avx2(const ListingArrays& a, const ListingArrays& b, const ListingReach& reach,
                          ListingStack& stack, NodeIds* leaves, long room);
long meeting_leaves_avx2(const ListingArrays& a, const ListingArrays& b, float reach, const NodeIds* leaves, long count,
                         std::int32_t* out);
void select_leaf_features_avx2(const ListingArrays& a, const ListingArrays& b, float reach, const NodeIds* leaves,
                               long count, SelectedFeatures& selected);
long list_features_avx2(const ListingArrays& a, const ListingArrays& b, const ListingReach& reach,
                        const NodeIds* leaves, long count, ListedFeature* out);

} // namespace flotilla
