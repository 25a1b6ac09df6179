// SPDX-License-Identifier: MIT
// Pairs of leaves of two bodies that can come near each other in a step, and for those whose boxes meet a direction
// that keeps them apart: what most queries of fast pairs look at (candidate_list.hpp).
//
// Between nested shells no plane fits, but between nearly all of their leaves one does, and pushes change few of these
// planes. Vertices that move straight are as far along a fixed direction as the mean of their ends says: leaves that
// are apart along it by some gap at both ends are no nearer than the lesser gap at any time between. The gap at the
// start is known once for a step; the one at the end costs a dozen products, where the features of two leaves are up to
// sixty pairs.
//
// Rounding. u = 2^-53, M the largest coordinate, d the kept direction, whose components are floats and exact from then
// on. A computed d.x is off by 3.01 u sum |d_i x_i| <= 5.3 u M |d|, the difference of two of them by twice that and u
// times itself, at most 3.5 u M |d|: below 16 u M |d| together. kGapRounding M is eight times that. |d| <= 1 + 2^-22,
// for which kLengthRoom has room.
#pragma once

#include <span>
#include <vector>

#include "ccd/leaf_features.hpp"
#include "geometry/rounding.hpp"

namespace flotilla {

inline constexpr double kGapRounding = 0x1p-46; ///< of the largest coordinate
inline constexpr double kLengthRoom = 1 - kLengthRounding;

class LeafPairs {
  public:
    /// Finds all pairs of leaves whose boxes a motion within the reach's margin may bring together. False, and none,
    /// where there are more than kMost. `found` is scratch: the lists of all pairs together are most of what an impact
    /// takes, and have no room to spare.
    [[nodiscard]] bool find(const BodyMotion& a, const BodyMotion& b, const ListingReach& reach,
                            std::vector<NodeIds>& found);
    void drop(); ///< and frees its memory

    /// The feature pairs of the leaves whose coarse boxes come within the reach, except those that are proved apart: by
    /// kClear times the reach at both ends, or by the reach at the end (FeatureTest::near). The bodies start where they
    /// did for find(). They stand in `buffer`, by kind, until its next use. Directions that are found or lost change
    /// what is left out and no answer.
    [[nodiscard]] std::span<const FeaturePair> select(FeatureTest test, const BodyMotion& a, const BodyMotion& b,
                                                      const CoarseReach& reach, FeatureBuffer& buffer) const;

    [[nodiscard]] std::size_t size() const { return leaves_.size(); }
    [[nodiscard]] std::size_t memory() const { ///< bytes
        return leaves_.capacity() * sizeof(NodeIds) + kept_.capacity() * sizeof(Kept);
    }

    /// 1.8 MB, and the features of as many fill 80. Flat sides of long thin triangles that lie on each other have so
    /// many: six gears of 2,240 triangles that fall flat took 14.2 s in their worst step where pairs with more than
    /// 2^14 have no list, 6.9 s with this, 6.6 s with 2^18.
    static constexpr std::size_t kMost = std::size_t{1} << 16;

  private:
    /// What is known of a pair of leaves.
    struct Kept {
        float direction[3] = {};  ///< from a to b, of unit length; zero: none is known
        float start_gap = -1;     ///< m, along it at the start, rounding taken off
        std::int32_t in_vain = 0; ///< for so many queries none is looked for
    };

    class Separation;

    std::vector<NodeIds> leaves_;
    /// By pair: a cache of the query under way, which belongs to one thread.
    mutable std::vector<Kept> kept_;
};

} // namespace flotilla
