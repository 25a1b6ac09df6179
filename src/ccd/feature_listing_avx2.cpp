// SPDX-License-Identifier: MIT
#include "ccd/feature_listing.hpp"
#include "geometry/box_pack_avx2.hpp"

#include "ccd/feature_listing_kernel.hpp"

namespace flotilla {

long open_node_pairs_avx2(const ListingArrays& a, const ListingArrays& b, const ListingReach& reach,
                          ListingStack& stack, NodeIds* leaves, long room) {
    return open_node_pairs_by<Avx2BoxPack>(a, b, reach, stack, leaves, room);
}

long meeting_leaves_avx2(const ListingArrays& a, const ListingArrays& b, float reach, const NodeIds* leaves, long count,
                         std::int32_t* out) {
    return meeting_leaves_by<Avx2BoxPack>(a, b, reach, leaves, count, out);
}

void select_leaf_features_avx2(const ListingArrays& a, const ListingArrays& b, float reach, const NodeIds* leaves,
                               long count, SelectedFeatures& selected) {
    select_leaf_features_by<Avx2BoxPack>(a, b, reach, leaves, count, selected);
}

long list_features_avx2(const ListingArrays& a, const ListingArrays& b, const ListingReach& reach,
                        const NodeIds* leaves, long count, ListedFeature* out) {
    return list_features_by<Avx2BoxPack>(a, b, reach, leaves, count, out);
}

} // namespace flotilla
