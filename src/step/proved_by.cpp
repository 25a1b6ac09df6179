// SPDX-License-Identifier: MIT
// How the last step proved a pair apart, from what it left: nothing is written down for this.
#include "base/index.hpp"
#include "step/stepper.hpp"

namespace flotilla {

ProofWay Stepper::proved_by(std::int32_t a, std::int32_t b) const {
    if (a > b) return proved_by(b, a);
    if (proved_step_ != state_.step || stale_ || woken_ || any_changed_) return ProofWay::none;
    // commit() gave every body that was active a new version, one after that of its end state.
    const auto active = [&](std::int32_t i) { return trajectories_.version(at(i)) != first_version_[at(i)]; };
    const auto end_version = [&](std::int32_t i) { return trajectories_.version(at(i)) - (active(i) ? 1 : 0); };
    const auto moves = [&](std::int32_t i) { return active(i) && model_.bodies[at(i)].dynamic(); };
    if ((!moves(a) && !moves(b)) || model_.ignores(a, b)) return ProofWay::none;
    const PairRecord* record = pairs_.table.find(a, b);
    if (record != nullptr && record->verdict.at(end_version(a), end_version(b)) == Verdict::apart)
        return ProofWay::query;
    const std::int32_t c = clusters_.of(at(a));
    if (c == clusters_.of(at(b)) && clusters_[c].rung != Rung::held) return ProofWay::cluster;
    // The certificate lists pairs whose swept boxes come within the separation, and of those that are left both bodies
    // stand still. So it listed them where their boxes do so now, or else way a holds.
    const double separation = pair_lengths(model_, state_, a, b).separation;
    const auto box = [&](std::int32_t i) { return trajectories_.start_box(at(i)); };
    return boxes_overlap(box(a), box(b), separation) ? ProofWay::still : ProofWay::boxes;
}

} // namespace flotilla
