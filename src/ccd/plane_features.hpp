// SPDX-License-Identifier: MIT
// Feature pairs that can be near each other of two bodies that a plane keeps apart, or nearly so: what convex bodies of
// few vertices need in place of hierarchies and neighbour lists.
//
// Along a unit vector d from a to b let a reach up to A and b down to B. A point of a that is within a distance r of b
// is above B - r along d, and one of b within r of a is below A + r. So of either body a slice counts, and of its
// features those that meet the box of the other's slice, widened by r. Where bodies touch at a corner that is one
// vertex and a face or two.
//
// Where vertices move straight a point's height over the border of its slice, which moves as well, is at any time the
// mean of what it is at both ends, weighted by that time, and so is each bound of a box. So a point that is in its
// slice at some time is so at one of the ends, and boxes hold at any time what they hold at both.
//
// This holds for any two meshes and any d, so whatever d is given, the pairs that are found include all that are near.
// What convexity says is that there is a d for which the slices are thin.
//
// Rounding. u = 2^-53, M the largest coordinate. Heights along d are off by 6 u M, the point where an edge leaves the
// slice is as high as its border to 12 u M, and computed closest points are nearer than the features by as much.
// Against all of that the border is lower by place_rounding(), 2^13 u M. Boxes have the room of CoarseReach.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "ccd/feature_tests.hpp"

namespace flotilla {

/// What there is of one body in its slice, at rest by at0 alone. Buffers grow and never shrink.
struct BodySlice {
    /// Features that meet the other slice, and the boxes of what of them is in this one.
    struct Part {
        std::vector<std::int32_t> features;
        std::vector<MovingCoarseBox> boxes;
        std::size_t size = 0;
    };
    std::array<std::vector<double>, 2> heights; ///< at both times, by vertex, m
    std::vector<std::int32_t> above;            ///< edges that reach into the slice
    std::size_t count = 0;                      ///< of those
    std::vector<MovingCoarseBox> edges;         ///< by edge, of what of it is in the slice
    MovingCoarseBox box;                        ///< of the slice
    std::array<Part, 3> parts;                  ///< vertices, edges, faces
};

/// One per thread, reused.
struct SliceScratch {
    std::array<BodySlice, 2> slices;
    std::vector<FeaturePair> pairs;
    std::size_t size = 0; ///< of the pairs that were found
    [[nodiscard]] std::span<const FeaturePair> found() const { return std::span(pairs).first(size); }
};

/// Whether slices cost less than a neighbour list: of convex bodies of few vertices. Both must be.
[[nodiscard]] bool worth_slicing(const RigidShape& shape);
[[nodiscard]] inline bool worth_slicing(const BodyMotion& a, const BodyMotion& b) {
    return worth_slicing(*a.shape) && worth_slicing(*b.shape);
}

/// Finds all feature pairs that come within `distance` (m) and some others: scratch.found(), by kind.
/// FeatureTest::near: whose closest points, as they are computed, do so at t = 0; FeatureTest::swept: which do so at
/// any time, every vertex moving straight. False, and none, where `direction` (unit, from a to b) is of no use, since
/// the bodies overlap along it by much.
[[nodiscard]] bool slice_features(FeatureTest test, const BodyMotion& a, const BodyMotion& b, const Vec3& direction,
                                  double distance, SliceScratch& scratch);

} // namespace flotilla
