// SPDX-License-Identifier: MIT
#include "step/inner_report.hpp"

#include <algorithm>

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
    for (int k = 0; k < substeps_; ++k) {
        StepReport inner;
        inner.step = state_.step + 1;
        workers_.team.region([&] { advance(inner); });
        add_inner_step(inner, report);
        if (k + 1 == substeps_) return;
        inner_[static_cast<std::size_t>(k)].pose = state_.pose;
        inner_[static_cast<std::size_t>(k)].turn = turns_;
    }
}

} // namespace flotilla
