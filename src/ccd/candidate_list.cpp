// SPDX-License-Identifier: MIT
#include "ccd/candidate_list.hpp"

#include <algorithm>
#include <cmath>

#include "ccd/leaf_features.hpp"

namespace flotilla {
namespace {

// Room for the rounding of world vertices (8 u |x| or so each, four of them) and of the bounds themselves, far above both.
constexpr double kRounding = 0x1p-40;

} // namespace

double relative_displacement(const RigidShape& a, const MatrixPose& a_from, const MatrixPose& a_to, const RigidShape& b,
                             const MatrixPose& b_from, const MatrixPose& b_to) {
    Vec3 shift, spread; // of b against a: of the centres of the local boxes, and of what is around them
    const auto add = [&](const RigidShape& shape, const MatrixPose& from, const MatrixPose& to, double sign) {
        if (from.origin == to.origin && from.rotation == to.rotation) return;
        const Mat3 turn = to.rotation - from.rotation;
        shift += sign * ((to.origin - from.origin) + turn * center(shape.box));
        const Vec3 half = 0.5 * extent(shape.box);
        spread += Vec3{dot(abs(row(turn, 0)), half), dot(abs(row(turn, 1)), half), dot(abs(row(turn, 2)), half)};
    };
    add(a, a_from, a_to, -1);
    add(b, b_from, b_to, 1);
    return max_component(abs(shift) + spread);
}

CandidateMargins CandidateList::strayed(const BodyMotion& a, const BodyMotion& b) const {
    return {relative_displacement(*a.shape, start_[0], matrix_pose(a.at0), *b.shape, start_[1], matrix_pose(b.at0)),
            relative_displacement(*a.shape, end_[0], matrix_pose(a.at1), *b.shape, end_[1], matrix_pose(b.at1))};
}

void CandidateList::build(const BodyMotion& a, const BodyMotion& b, const CandidateReach& reach,
                          const CandidateMargins& margins) {
    start_ = {matrix_pose(a.at0), matrix_pose(b.at0)};
    end_ = {matrix_pose(a.at1), matrix_pose(b.at1)};
    margins_ = margins;
    for (auto& list : features_) list.clear();
    const double max_abs = std::max(a.max_abs(), b.max_abs()), room = kRounding * max_abs;
    const CoarseReach r0(reach.swept + margins.start + room, max_abs);
    const CoarseReach r1(std::max(reach.swept, reach.end) + margins.end + room, max_abs);
    // One axis at a time: no division, and queries decide anyway.
    const auto meet = [&](const MovingCoarseBox& p, const MovingCoarseBox& q) {
        return coarse_overlap_by_axis(p, q, r0, r1);
    };
    const auto emit = [&](const FeaturePair& f) { features_[static_cast<std::size_t>(f.kind)].push_back({f.a, f.b}); };
    bvh_detail::traverse(
        a.shape->bvh, b.shape->bvh, a.at1.nodes, b.at1.nodes,
        [&](std::int32_t i, std::int32_t j, double&) { return meet(coarse_node(a, i), coarse_node(b, j)); },
        [](double) { return true; },
        [&](std::int32_t i, std::int32_t j, double) { for_each_leaf_feature_pair(a, b, i, j, meet, emit); });
}

void CandidateList::drop() {
    margins_ = {-1, -1};
    for (auto& list : features_) list.clear();
}

template <FeatureKind kKind, class Test>
void CandidateList::select(const BodyMotion& a, const BodyMotion& b, Test&& test, FeatureBuffer& out) const {
    const auto& list = features_[static_cast<std::size_t>(kKind)];
    const Triangle *triangles_a = a.shape->mesh.triangles.data(), *triangles_b = b.shape->mesh.triangles.data();
    const Edge *edges_a = a.shape->topology.edges.data(), *edges_b = b.shape->topology.edges.data();
    std::size_t n = out.size();
    out.resize(n + list.size());
    for (const Ids& f : list) {
        bool keep = false;
        if constexpr (kKind == FeatureKind::vertex_face)
            keep = test(coarse_vertex(a, f.a), coarse_triangle(b, triangles_b[f.b]));
        else if constexpr (kKind == FeatureKind::face_vertex)
            keep = test(coarse_triangle(a, triangles_a[f.a]), coarse_vertex(b, f.b));
        else
            keep = test(coarse_edge(a, edges_a[f.a]), coarse_edge(b, edges_b[f.b]));
        out[n] = {kKind, f.a, f.b}; // written in any case, kept or not: no branch to be mispredicted
        n += keep ? 1 : 0;
    }
    out.resize(n);
}

void CandidateList::find_swept(const BodyMotion& a, const BodyMotion& b, const CoarseReach& reach,
                               FeatureBuffer& out) const {
    const auto test = [&](const MovingCoarseBox& p, const MovingCoarseBox& q) {
        return coarse_overlap_by_axis(p, q, reach, reach);
    };
    out.clear();
    select<FeatureKind::vertex_face>(a, b, test, out);
    select<FeatureKind::face_vertex>(a, b, test, out);
    select<FeatureKind::edge_edge>(a, b, test, out);
}

void CandidateList::find_near(const BodyMotion& a, const BodyMotion& b, const CoarseReach& reach,
                              FeatureBuffer& out) const {
    const auto test = [&](const MovingCoarseBox& p, const MovingCoarseBox& q) {
        return coarse_overlap(p.at0, q.at0, reach);
    };
    out.clear();
    select<FeatureKind::vertex_face>(a, b, test, out);
    select<FeatureKind::face_vertex>(a, b, test, out);
    select<FeatureKind::edge_edge>(a, b, test, out);
}

} // namespace flotilla
