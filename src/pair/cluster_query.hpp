// SPDX-License-Identifier: MIT
// The query of two clusters.
#pragma once

#include "pair/impulses.hpp"
#include "pair/step_view.hpp"

namespace flotilla {

struct ClusterHit {
    PairHit hit;
    std::int32_t a = -1, b = -1; ///< bodies, of the first and of the second cluster
};
/// The earliest hit between two clusters; pairs of members that are proved apart are not queried again, nor those whose
/// swept boxes are too far apart for the list of a sweep. What is found of a pair without a record, which operations
/// cannot make, is forgotten: if its boxes stay that near, the next list has it.
[[nodiscard]] ClusterHit query_clusters(const StepView& view, PairTable& pairs, Worker& worker, std::int32_t a,
                                        std::int32_t b);

/// The contact of a swept hit in terms of the clusters: effective velocity and arms at the time of impact (section
/// 3.2).
struct SweptContact {
    ContactPoint point;
    double start_gap = 0; ///< m, along the normal at t = 0
};
[[nodiscard]] SweptContact swept_contact(const StepView& view, const ClusterHit& hit);

} // namespace flotilla
