// SPDX-License-Identifier: MIT
#include "ccd/feature_listing.hpp"

#include "geometry/box_pack.hpp"

#include "ccd/feature_listing_kernel.hpp"

namespace flotilla {

ListingArrays listing_arrays(const BodyMotion& body) {
    const RigidShape& shape = *body.shape;
    return {feature_arrays(body),
            body.at0.nodes.data(),
            body.at1.nodes.data(),
            shape.bvh.nodes.data(),
            shape.bvh.sizes.data(),
            shape.bvh.triangles.data(),
            shape.bvh.corners.data()->data(),
            shape.topology.triangle_edges.data()->data(),
            shape.topology.owned.data()};
}

long open_node_pairs(const ListingArrays& a, const ListingArrays& b, const ListingReach& reach, ListingStack& stack,
                     NodeIds* leaves, long room, Isa isa) {
#if defined(__x86_64__)
    if (isa != Isa::scalar) return open_node_pairs_avx2(a, b, reach, stack, leaves, room);
#endif
    return open_node_pairs_by<BoxPack>(a, b, reach, stack, leaves, room);
}

long meeting_leaves(const ListingArrays& a, const ListingArrays& b, float reach, const NodeIds* leaves, long count,
                    std::int32_t* out, Isa isa) {
#if defined(__x86_64__)
    if (isa != Isa::scalar) return meeting_leaves_avx2(a, b, reach, leaves, count, out);
#endif
    return meeting_leaves_by<BoxPack>(a, b, reach, leaves, count, out);
}

void select_leaf_features(const ListingArrays& a, const ListingArrays& b, float reach, const NodeIds* leaves,
                          long count, SelectedFeatures& selected, Isa isa) {
#if defined(__x86_64__)
    if (isa != Isa::scalar) return select_leaf_features_avx2(a, b, reach, leaves, count, selected);
#endif
    select_leaf_features_by<BoxPack>(a, b, reach, leaves, count, selected);
}

long list_features(const ListingArrays& a, const ListingArrays& b, const ListingReach& reach, const NodeIds* leaves,
                   long count, ListedFeature* out, Isa isa) {
#if defined(__x86_64__)
    if (isa != Isa::scalar) return list_features_avx2(a, b, reach, leaves, count, out);
#endif
    return list_features_by<BoxPack>(a, b, reach, leaves, count, out);
}

} // namespace flotilla
