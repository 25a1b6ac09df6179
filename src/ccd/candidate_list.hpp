// SPDX-License-Identifier: MIT
// Feature pairs of two bodies that can come near each other while both bodies stay close to a reference motion.
//
// Most queries of a body pair repeat an earlier one with slightly other end states: the sweeps of stage 1, dynamic contact, the
// contact search, and at rest the steps themselves. The list is found once, with room for that, by one traversal.
//
// A list changes the cost of a query and never a bit of its answer: it holds every feature pair that the query of any covered
// motion looks at, and the query itself decides by the features' own boxes (pair_query.hpp).
#pragma once

#include <vector>

#include "ccd/feature_candidates.hpp"

namespace flotilla {

/// Buffers of feature pairs; one set per thread, reused.
using FeatureBuffer = std::vector<FeaturePair>;

/// How far a motion may stray from the reference at the start and at the end of the step, both bodies together, m.
struct CandidateMargins {
    double start = 0, end = 0;
};

/// Where a body stands, in matrix form.
struct MatrixPose {
    Vec3 origin; ///< m
    Mat3 rotation;
};
[[nodiscard]] inline MatrixPose matrix_pose(const BodyPlacement& p) { return {p.pose->origin, *p.rotation}; }

/// An upper bound on how much the gap between a point of each body changes along any axis when the bodies go from one pair of
/// placements to another, m: for each body its displacement is affine in the local coordinates, so it is bounded by that of the
/// centre and of the half extents of the shape's box; a common translation cancels.
[[nodiscard]] double relative_displacement(const RigidShape& a, const MatrixPose& a_from, const MatrixPose& a_to,
                                           const RigidShape& b, const MatrixPose& b_from, const MatrixPose& b_to);

/// The distances that queries ask for, m.
struct CandidateReach {
    double swept = 0; ///< at any time of the step
    double end = 0;   ///< at its end
};

class CandidateList {
  public:
    /// A bound on what the motion of the two bodies strays from the reference.
    [[nodiscard]] CandidateMargins strayed(const BodyMotion& a, const BodyMotion& b) const;
    [[nodiscard]] bool covers(const CandidateMargins& strayed) const {
        return strayed.start <= margins_.start && strayed.end <= margins_.end;
    }

    /// Finds the pairs anew.
    void build(const BodyMotion& a, const BodyMotion& b, const CandidateReach& reach, const CandidateMargins& margins);
    void drop();

    /// All pairs of the list, in `out`, whose coarse boxes come within the reach along the motion (near one axis at a time),
    /// or at rest at x0.
    void find_swept(const BodyMotion& a, const BodyMotion& b, const CoarseReach& reach, FeatureBuffer& out) const;
    void find_near(const BodyMotion& a, const BodyMotion& b, const CoarseReach& reach, FeatureBuffer& out) const;

    [[nodiscard]] bool empty() const { return margins_.end < 0; } ///< there is no list
    [[nodiscard]] std::size_t size() const { return features_[0].size() + features_[1].size() + features_[2].size(); }

  private:
    struct Ids {
        std::int32_t a, b;
    };
    template <FeatureKind kKind, class Test>
    void select(const BodyMotion& a, const BodyMotion& b, Test&& test, FeatureBuffer& out) const;

    std::array<MatrixPose, 2> start_, end_; ///< of the reference motion
    CandidateMargins margins_{-1, -1};
    std::array<std::vector<Ids>, 3> features_; ///< by kind
};

} // namespace flotilla
