// SPDX-License-Identifier: MIT
#include "step/inner_report.hpp"

#include <algorithm>
#include <iterator>

#include "step/stepper.hpp"

namespace flotilla {

void add_inner_step(const StepReport& inner, StepReport& report) {
    for (std::size_t k = 0; k < kNumPhases; ++k) report.phase_ms[k] += inner.phase_ms[k];
    report.pairs += inner.pairs;
    report.collisions += inner.collisions;
    report.iterations += inner.iterations;
    report.merges += inner.merges;
    report.rung_changes += inner.rung_changes;
    report.energy_corrections += inner.energy_corrections;
    report.energy_removed += inner.energy_removed;
    report.warnings |= inner.warnings;

    report.residual = std::max(report.residual, inner.residual);
    report.min_distance = std::min(report.min_distance, inner.min_distance);
    report.held = std::max(report.held, inner.held);
    report.kinematic_bodies = std::max(report.kinematic_bodies, inner.kinematic_bodies);
    report.rigid_bodies = std::max(report.rigid_bodies, inner.rigid_bodies);
    report.largest_cluster = std::max(report.largest_cluster, inner.largest_cluster);
    if (report.trigger_a < 0) {
        report.trigger_a = inner.trigger_a;
        report.trigger_b = inner.trigger_b;
    }

    report.contacts = inner.contacts;
    report.sleeping_contacts = inner.sleeping_contacts;
    report.lift = inner.lift;
    report.proximities = inner.proximities;
    report.pruned_end_points = inner.pruned_end_points;
    report.pruned_same_direction = inner.pruned_same_direction;
    report.pruned_angle = inner.pruned_angle;
    report.pruned_occluded = inner.pruned_occluded;
}

void Stepper::make_inner_steps(StepReport& report) {
    activity_.assign(model_.size(), {});
    state_.earlier.clear();
    for (int k = 0; k < substeps_; ++k) {
        inner_over_ = k;
        StepReport inner;
        inner.step = state_.step + 1;
        workers_.team.region([&] { advance(inner); });
        add_inner_step(inner, report);
        if (k + 1 == substeps_) return;
        add_earlier(state_.warm, 1);
        inner_[static_cast<std::size_t>(k)].pose = state_.pose;
        inner_[static_cast<std::size_t>(k)].turn = turns_;
    }
}

/// What contacts carried in inner steps before the last one, so often.
void Stepper::add_earlier(const WarmImpulses& stages, double times) {
    // All of a step's is stage 7's where velocities are those of its end.
    if (model_.settings.velocity_update == VelocityUpdate::trapezoidal)
        add_impulses(stages[ContactStage::kept], times, state_.earlier, earlier_scratch_);
    add_impulses(stages[ContactStage::final], times, state_.earlier, earlier_scratch_);
}

/// What waits with sleepers is what each inner step of the step so far carried.
void Stepper::keep_earlier_of_woken() {
    if (substeps_ == 1) return;
    std::erase_if(state_.earlier, [&](const WarmImpulse& w) { return rests(w.a, w.b); }); // they fell asleep
    WarmImpulses woken;
    for (const auto stage : {ContactStage::kept, ContactStage::final})
        std::ranges::copy_if(state_.waiting[stage], std::back_inserter(woken[stage]),
                             [&](const WarmImpulse& w) { return !rests(w.a, w.b); });
    add_earlier(woken, inner_over_);
}

} // namespace flotilla
