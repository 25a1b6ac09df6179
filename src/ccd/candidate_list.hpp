// SPDX-License-Identifier: MIT
// A neighbour list (Verlet list) of two bodies: the feature pairs that can come near each other while both bodies stay
// close to a reference motion.
//
// Most queries of a body pair repeat an earlier one with slightly other end states: the sweeps of stage 1, dynamic
// contact, the contact search, and at rest the steps themselves. The list is found once, with room for that, by one
// traversal.
//
// Within the list the feature pairs stand in the order in which they become possible: for each the build finds how far
// a motion must stray from the reference before it can matter, and a query reads those within what its own motion
// strays. Of pairs that are fast, whose lists serve one step, the leaves are listed in place of their features
// (leaf_pairs.hpp): found in a fraction of the time.
//
// A list changes the cost of a query and never a bit of its answer: it holds every feature pair that the query of any
// covered motion examines, and the query itself decides by the features' own boxes (pair_query.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "ccd/leaf_pairs.hpp"

namespace flotilla {

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

/// An upper bound on how much the gap between a point of each body changes along any axis when the bodies go from one
/// pair of placements to another, m: for each body its displacement is affine in the local coordinates, so it is
/// bounded by that of the centre and of the half extents of the shape's box; a common translation cancels.
[[nodiscard]] double relative_displacement(const RigidShape& a, const MatrixPose& a_from, const MatrixPose& a_to,
                                           const RigidShape& b, const MatrixPose& b_from, const MatrixPose& b_to);

/// The same of one body against what stands still. Those of two bodies together are never less than the bound above.
[[nodiscard]] double displacement(const RigidShape& shape, const MatrixPose& from, const MatrixPose& to);

/// The distances that queries ask for, m.
struct CandidateReach {
    double swept = 0; ///< at any time of the step
    double end = 0;   ///< at its end
};

/// Buffer of the making of a list; one per thread, reused.
struct ListingScratch {
    std::vector<ListedFeature> found;
    std::vector<NodeIds> leaves;
};

class CandidateList {
  public:
    /// A bound on what the motion of the two bodies strays from the reference.
    [[nodiscard]] CandidateMargins strayed(const BodyMotion& a, const BodyMotion& b) const;
    [[nodiscard]] double strayed_at_end(const BodyMotion& a, const BodyMotion& b) const;
    [[nodiscard]] bool covers(const CandidateMargins& strayed) const {
        return strayed.start <= margins_.start && strayed.end <= margins_.end;
    }

    /// Finds the pairs anew. `refined`: by the distances of the features themselves where the reference motion ends,
    /// not only by their boxes. That takes longer and leaves a fraction: for lists that will serve many queries. False,
    /// and no list, where there are more than kMostListed: features much thinner than the distances asked for, as in
    /// the fans of two poles, are near each other by the square of their number, and a list would take memory for every
    /// one of these pairs.
    [[nodiscard]] bool build(const BodyMotion& a, const BodyMotion& b, const CandidateReach& reach,
                             const CandidateMargins& margins, bool refined, ListingScratch& scratch);
    /// The same of leaves, for motions that start where this one does: conservative queries alone may ask it. False:
    /// there are more than LeafPairs::kMost.
    [[nodiscard]] bool build_of_leaves(const BodyMotion& a, const BodyMotion& b, const CandidateReach& reach,
                                       double margin_at_end, ListingScratch& scratch);
    void drop(); ///< and frees its memory

    /// All pairs of the list whose coarse boxes come within the reach, which is at most the list's (FeatureTest::near:
    /// for bodies that rest at the end of a covered motion, of which `strayed` need say no more than that). They stand
    /// in `buffer`, until its next use. A list of leaves leaves out what it proves to be no hit (LeafPairs::select).
    [[nodiscard]] std::span<const FeaturePair> select(FeatureTest test, const BodyMotion& a, const BodyMotion& b,
                                                      const CandidateMargins& strayed, const CoarseReach& reach,
                                                      FeatureBuffer& buffer) const;

    /// How much farther than `strayed` (a covered motion's, at its end) the bodies may stray from where they stand at
    /// the end of the reference before any feature pair can come within CandidateReach::end, m; not positive where that
    /// is not known.
    [[nodiscard]] double room_at_end(double strayed) const;

    [[nodiscard]] bool empty() const { return margins_.end < 0; } ///< there is no list
    [[nodiscard]] bool refined() const { return refined_; }
    [[nodiscard]] std::size_t size() const { return of_leaves_ ? leaves_.size() : features_.size(); }

    static constexpr std::size_t kMostListed = std::size_t{1} << 20; ///< 16 MB while it is made, 8 MB kept

    [[nodiscard]] std::size_t memory() const { ///< bytes
        return features_.capacity() * sizeof(FeatureIds) + leaves_.memory();
    }

  private:
    static constexpr int kSlots = 16;

    void start(const BodyMotion& a, const BodyMotion& b, const CandidateMargins& margins);
    /// What was listed, or more than kMostListed.
    static std::size_t list(const BodyMotion& a, const BodyMotion& b, const ListingReach& reach,
                            std::vector<ListedFeature>& out);
    std::size_t refine(const BodyMotion& a, const BodyMotion& b, const CandidateReach& reach,
                       std::span<ListedFeature> listed) const;
    void store(std::span<ListedFeature> listed);
    [[nodiscard]] int slot(float strayed) const {
        return static_cast<int>(
            std::max(0.0f, std::min(strayed * slots_per_metre_, float{kSlots - 1}))); // NaN becomes 0
    }
    [[nodiscard]] int last_slot(FeatureTest test, const CandidateMargins& strayed) const;

    std::array<MatrixPose, 2> start_, end_; ///< of the reference motion
    CandidateMargins margins_{-1, -1};
    bool refined_ = false, of_leaves_ = false;
    float scale0_ = 0, slots_per_metre_ = 0;            ///< of the listing
    std::vector<FeatureIds> features_;                  ///< by kind, and of a kind by slot
    std::array<std::uint32_t, 3 * kSlots + 1> begin_{}; ///< where each kind's slots begin
    LeafPairs leaves_;
};

/// A list that covers the motion of a query, which strays by so much from the list's reference. Null: there is none.
struct CoveringList {
    const CandidateList* list = nullptr;
    CandidateMargins strayed; ///< m
};

} // namespace flotilla
