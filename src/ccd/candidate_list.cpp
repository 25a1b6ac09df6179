// SPDX-License-Identifier: MIT
#include "ccd/candidate_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/rounding.hpp"

namespace flotilla {
namespace {

// Room for the rounding of the excess of a gap over the reach (2^-24 of the largest coordinate), and of its scales.
constexpr double kExcessRounding = 0x1p-21, kScaleRoom = 1 + 0x1p-10;
constexpr float kNoStraying = 0x1p100f; // scales any excess beyond every margin
constexpr double kLargestListed = 0x1p100;

/// Of the centre of a body's local box, and of what is around that at most, m by axis.
struct Displacement {
    Vec3 shift, spread;
};

Displacement displacement_of(const RigidShape& shape, const MatrixPose& from, const MatrixPose& to) {
    if (from.origin == to.origin && from.rotation == to.rotation) return {};
    const Mat3 turn = to.rotation - from.rotation;
    const Vec3 half = 0.5 * extent(shape.box);
    return {(to.origin - from.origin) + turn * center(shape.box),
            Vec3{dot(abs(row(turn, 0)), half), dot(abs(row(turn, 1)), half), dot(abs(row(turn, 2)), half)}};
}

bool in_range(const BodyMotion& a, const BodyMotion& b) { return std::max(a.max_abs(), b.max_abs()) < kLargestListed; }

ListingReach listing_reach(const BodyMotion& a, const BodyMotion& b, const CandidateReach& reach,
                           const CandidateMargins& margins) {
    const double max_abs = std::max(a.max_abs(), b.max_abs()),
                 room = place_rounding(max_abs) + kExcessRounding * max_abs;
    const CoarseReach r0(reach.swept + room, max_abs), r1(std::max(reach.swept, reach.end) + room, max_abs);
    const float scale0 = margins.start > 0 ? static_cast<float>(margins.end / margins.start) : kNoStraying;
    const auto margin = static_cast<float>(margins.end * kScaleRoom);
    // Beyond the range of float everything is listed.
    constexpr float kAll = std::numeric_limits<float>::infinity();
    if (!in_range(a, b)) return {kAll, kAll, scale0, margin};
    return {r0.distance(), r1.distance(), scale0, margin};
}

} // namespace

double relative_displacement(const RigidShape& a, const MatrixPose& a_from, const MatrixPose& a_to, const RigidShape& b,
                             const MatrixPose& b_from, const MatrixPose& b_to) {
    const Displacement da = displacement_of(a, a_from, a_to), db = displacement_of(b, b_from, b_to);
    return max_component(abs(db.shift - da.shift) + (da.spread + db.spread));
}

double displacement(const RigidShape& shape, const MatrixPose& from, const MatrixPose& to) {
    const Displacement d = displacement_of(shape, from, to);
    return max_component(abs(d.shift) + d.spread);
}

CandidateMargins CandidateList::strayed(const BodyMotion& a, const BodyMotion& b) const {
    return {relative_displacement(*a.shape, start_[0], matrix_pose(a.at0), *b.shape, start_[1], matrix_pose(b.at0)),
            strayed_at_end(a, b)};
}

double CandidateList::strayed_at_end(const BodyMotion& a, const BodyMotion& b) const {
    return relative_displacement(*a.shape, end_[0], matrix_pose(a.at1), *b.shape, end_[1], matrix_pose(b.at1));
}

void CandidateList::start(const BodyMotion& a, const BodyMotion& b, const CandidateMargins& margins) {
    start_ = {matrix_pose(a.at0), matrix_pose(b.at0)};
    end_ = {matrix_pose(a.at1), matrix_pose(b.at1)};
    margins_ = margins;
}

bool CandidateList::build(const BodyMotion& a, const BodyMotion& b, const CandidateReach& reach,
                          const CandidateMargins& margins, bool refined, ListingScratch& scratch) {
    start(a, b, margins);
    of_leaves_ = false;
    leaves_.drop();
    const ListingReach listed = listing_reach(a, b, reach, margins);
    scale0_ = listed.scale0;
    slots_per_metre_ = listed.margin > 0 ? kSlots / listed.margin : 0;
    std::size_t n = list(a, b, listed, scratch.found);
    if (n > kMostListed) {
        drop();
        return false;
    }
    refined_ = refined && in_range(a, b) && margins.start > 0;
    if (refined_) n = refine(a, b, reach, std::span(scratch.found).first(n));
    store(std::span(scratch.found).first(n));
    return true;
}

bool CandidateList::build_of_leaves(const BodyMotion& a, const BodyMotion& b, const CandidateReach& reach,
                                    double margin_at_end, ListingScratch& scratch) {
    const CandidateMargins margins{0, margin_at_end};
    start(a, b, margins);
    of_leaves_ = true;
    refined_ = false;
    features_ = std::vector<FeatureIds>();
    if (leaves_.find(a, b, listing_reach(a, b, reach, margins), scratch.leaves)) return true;
    drop();
    return false;
}

// Straying by x along every axis, both at the start and at the end of the step, moves points of the two bodies by at
// most sqrt(3) x against each other at any time of it. So features that are d apart where the reference ends
//  - come within the reach at the end only for x >= (d - reach.end) / sqrt(3), and
//  - within the other reach at some time only for x >= (d - way - reach.swept) / sqrt(3), with the relative way of the
//    reference.
// A list is read up to the larger of both strayings, that at the start counted margins.end / margins.start >= 1 times.
std::size_t CandidateList::refine(const BodyMotion& a, const BodyMotion& b, const CandidateReach& reach,
                                  std::span<ListedFeature> listed) const {
    constexpr double kRoom = 1 - 0x1p-10; // for rounding, here and of what strayed
    const double way =
        std::numbers::sqrt3 * relative_displacement(*a.shape, start_[0], end_[0], *b.shape, start_[1], end_[1]);
    const double beyond = std::max(reach.end, way + reach.swept);
    std::size_t n = 0;
    for (ListedFeature& f : listed) {
        const double d = std::sqrt(closest_points(a, b, {f.kind, f.ids.a, f.ids.b}, 1).distance_sq);
        f.distance = std::max(f.distance, static_cast<float>(kRoom * (kRoom * d - beyond) / std::numbers::sqrt3));
        if (!(f.distance > margins_.end)) listed[n++] = f;
    }
    return n;
}

std::size_t CandidateList::list(const BodyMotion& a, const BodyMotion& b, const ListingReach& reach,
                                std::vector<ListedFeature>& out) {
    constexpr std::size_t kLeafPairs = 128; // between two checks of the room left
    const Isa isa = best_isa();
    const ListingArrays arrays_a = listing_arrays(a), arrays_b = listing_arrays(b);
    ListingStack stack;
    stack.pairs[stack.size++] = {0, 0};
    std::array<NodeIds, kLeafPairs> leaves;
    std::size_t n = 0;
    while (stack.size > 0 && n <= kMostListed) {
        const long found = open_node_pairs(arrays_a, arrays_b, reach, stack, leaves.data(), kLeafPairs, isa);
        std::size_t triangle_pairs = 0;
        for (const NodeIds& p : std::span(leaves).first(static_cast<std::size_t>(found)))
            triangle_pairs += a.shape->bvh.leaf_triangles(p.a).size() * b.shape->bvh.leaf_triangles(p.b).size();
        const std::size_t room = n + triangle_pairs * kFeaturesPerTrianglePair + 1;
        if (out.size() < room) out.resize(room);
        n += static_cast<std::size_t>(
            list_features(arrays_a, arrays_b, reach, leaves.data(), found, out.data() + n, isa));
    }
    return n;
}

void CandidateList::store(std::span<ListedFeature> listed) {
    begin_ = {};
    for (ListedFeature& f : listed) {
        f.place = static_cast<int>(f.kind) * kSlots + slot(f.distance);
        ++begin_[static_cast<std::size_t>(f.place) + 1];
    }
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    auto next = begin_;
    if (2 * listed.size() < features_.capacity()) features_ = std::vector<FeatureIds>();
    features_.resize(listed.size());
    for (const ListedFeature& f : listed) features_[next[static_cast<std::size_t>(f.place)]++] = f.ids;
}

void CandidateList::drop() {
    margins_ = {-1, -1};
    features_ = std::vector<FeatureIds>(); // of {} a vector keeps its memory
    begin_ = {};
    leaves_.drop();
}

double CandidateList::room_at_end(double strayed) const {
    constexpr double kFloatRoom = 1 - kLengthRounding; // for the rounding of slot()
    if (of_leaves_) return -strayed;
    double room = margins_.end;
    for (int s = 0; s < kSlots && room == margins_.end; ++s)
        for (int place = s; place < 3 * kSlots; place += kSlots)
            if (begin_[static_cast<std::size_t>(place)] != begin_[static_cast<std::size_t>(place) + 1])
                room = std::min(room, kFloatRoom * s / (kScaleRoom * std::max(double{slots_per_metre_}, 1e-300)));
    return room - strayed;
}

int CandidateList::last_slot(FeatureTest test, const CandidateMargins& strayed) const {
    double far = strayed.end;
    if (test == FeatureTest::swept && margins_.start > 0) far = std::max(far, strayed.start * double{scale0_});
    return slot(static_cast<float>(far * kScaleRoom));
}

std::span<const FeaturePair> CandidateList::select(FeatureTest test, const BodyMotion& a, const BodyMotion& b,
                                                   const CandidateMargins& strayed, const CoarseReach& reach,
                                                   FeatureBuffer& buffer) const {
    if (of_leaves_) return leaves_.select(test, a, b, reach, buffer);
    if (features_.empty()) return {};
    if (buffer.pairs.size() < size() + 1) buffer.pairs.resize(size() + 1);
    const FeatureArrays arrays_a = feature_arrays(a), arrays_b = feature_arrays(b);
    const Isa isa = best_isa();
    const auto slots = static_cast<std::size_t>(last_slot(test, strayed)) + 1;
    std::size_t n = 0;
    for (const FeatureKind kind : {FeatureKind::vertex_face, FeatureKind::face_vertex, FeatureKind::edge_edge}) {
        const std::size_t first = static_cast<std::size_t>(kind) * kSlots;
        n += static_cast<std::size_t>(select_features(test, kind, features_.data() + begin_[first],
                                                      static_cast<long>(begin_[first + slots] - begin_[first]),
                                                      arrays_a, arrays_b, reach, buffer.pairs.data() + n, isa));
    }
    return {buffer.pairs.data(), n};
}

} // namespace flotilla
