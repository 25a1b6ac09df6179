// SPDX-License-Identifier: MIT
// How far bodies have moved since the contacts of their pairs were last searched for (contact_reuse): while that is
// little, the features in contact are known (pair/contact_search.cpp).
#include "base/index.hpp"
#include "base/rotation.hpp"
#include "step/stepper.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kBodyGrain = 16; // bodies of a task

/// A bound on the displacement of any point of a body along any axis, from a pose to the present one, m.
double stray_from(const Pose& from, const BodyMotion& now) {
    return displacement(*now.shape, {from.origin, matrix(from.rotation)}, matrix_pose(now.at0));
}

} // namespace

/// For all bodies, at x^n.
void Stepper::measure_strays() {
    if (model_.settings.contact_reuse == 0) return;
    if (state_.searched.empty())
        for (const Pose& pose : state_.pose) state_.searched.push_back({pose, state_.step});
    search_.stray.resize(model_.size());
    workers_.team.for_each("strays", model_.size(), kBodyGrain, [&](std::size_t i, int) {
        search_.stray[i] = stray_from(state_.searched[i].pose, trajectories_.at_start(i));
    });
}

/// For the active bodies, at x^{n+1} of the given step. A body that moved by more than half of what a pair may has its
/// pairs searched anew.
void Stepper::note_strays(std::int64_t step) {
    if (state_.searched.empty()) return;
    const std::vector<std::int32_t>& active = model_.active;
    workers_.team.for_each("strays", active.size(), kBodyGrain, [&](std::size_t k, int) {
        const std::size_t i = at(active[k]);
        double& stray = search_.stray[i];
        stray = stray_from(state_.searched[i].pose, trajectories_.at_end(i));
        const double most =
            model_.bodies[i].movable() ? 0.5 * model_.settings.contact_reuse * body_lengths(model_, i).rest : 0.0;
        if (!(stray > most)) return;
        state_.searched[i] = {trajectories_.end_pose(i), step};
        stray = 0;
    });
}

} // namespace flotilla
