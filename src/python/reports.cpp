// SPDX-License-Identifier: MIT
// What steps report.
#include <flotilla/report.hpp>
#include <flotilla/world.hpp>

#include "python/bind.hpp"
#include "python/reports.hpp"

namespace flotilla::python {

py::dict phases_of(const std::array<double, kNumPhases>& milliseconds) {
    py::dict out;
    for (std::size_t p = 0; p < kNumPhases; ++p) out[py::str(std::string(kPhaseNames[p]))] = milliseconds[p];
    return out;
}

namespace {

void bind_work(py::class_<StepReport>& type) {
    using R = StepReport;
    type.def_readonly("step", &R::step, "1 after the first step");
    type.def_readonly("time", &R::time, "s, at the end of the step");
    type.def_readonly("total_ms", &R::total_ms, "wall time, ms");
    type.def_property_readonly(
        "phase_ms", [](const R& r) { return phases_of(r.phase_ms); },
        "ms by phase; the last four split the same time again");
    type.def_readonly("pairs", &R::pairs,
                      "candidate body pairs examined; a count of work, which may be another after a restore");
    type.def_readonly("collisions", &R::collisions, "impulses of stage 1");
    type.def_readonly("contacts", &R::contacts, "contact points of stage 7");
    type.def_readonly("iterations", &R::iterations, "sweeps of the contact solver, stages 3 and 7 together");
    type.def_readonly("residual", &R::residual, "m/s, largest constraint violation that contact solves left");
    type.def_readonly("merges", &R::merges, "clusters merged, by the failsafe and as dynamic contact rigidified pairs");
    type.def_readonly("rung_changes", &R::rung_changes,
                      "steps down the failsafe's ladder free, kinematic, rigid, held; and bodies slowed down");
    type.def_readonly("held", &R::held, "bodies that stand where the step began");
}

void bind_sums(py::class_<StepReport>& type) {
    using R = StepReport;
    type.def_readonly("energy", &R::energy, "J, kinetic and potential");
    type.def_readonly("momentum", &R::momentum, "kg m/s, linear, of all dynamic bodies together, shape (3)");
    type.def_readonly("min_distance", &R::min_distance,
                      "m, smallest of two bodies, one of them awake, at the ends of inner steps; inf: none near");
    type.def_readonly("state_hash", &R::state_hash,
                      "of all that can change a later bit; the same at any number of threads");
    type.def_readonly("angular_momentum", &R::angular_momentum, "kg m^2/s about the world's origin, shape (3)");
    type.def_readonly("kinetic_energy", &R::kinetic_energy, "J");
    type.def_readonly("kinematic_bodies", &R::kinematic_bodies,
                      "bodies in kinematic clusters of the failsafe at the end");
    type.def_readonly("rigid_bodies", &R::rigid_bodies, "bodies in rigid clusters of the failsafe at the end");
    type.def_readonly("largest_cluster", &R::largest_cluster, "bodies in the largest cluster");
    type.def_readonly("trigger_a", &R::trigger_a, "body of the pair of the first failsafe event; -1: none");
    type.def_readonly("trigger_b", &R::trigger_b, "the other body of that pair");
    type.def_readonly("sleeping", &R::sleeping, "bodies asleep");
    type.def_readonly("sleeping_contacts", &R::sleeping_contacts,
                      "contact points of bodies that slept through the step");
    type.def_property_readonly(
        "warnings", [](const R& r) { return py::module_::import("flotilla._enums").attr("StepWarning")(r.warnings); },
        "StepWarning: reasons to look at the step");
    type.def_readonly("energy_corrections", &R::energy_corrections, "islands whose velocities the last resort cut");
    type.def_readonly("energy_removed", &R::energy_removed, "J, taken from them");
    type.def_readonly("lift", &R::lift,
                      "J, booked for all bodies at the end of the step: by which energy may have risen to bring them "
                      "to their rest distance");
}

void bind_pruning(py::class_<StepReport>& type) {
    using R = StepReport;
    type.def_readonly("proximities", &R::proximities, "feature pairs within the proximity distance");
    type.def_readonly("pruned_end_points", &R::pruned_end_points,
                      "of them: ends of edges, what is in a flat face or at one place");
    type.def_readonly("pruned_same_direction", &R::pruned_same_direction,
                      "of them: farther faces in the same direction");
    type.def_readonly("pruned_angle", &R::pruned_angle, "of them: not the nearest point that the other body sees");
    type.def_readonly("pruned_occluded", &R::pruned_occluded, "of them: a body lies between the points");
}

} // namespace

void bind_reports(py::module_& m) {
    auto step = value_class<StepReport>(
        m, "StepReport", "What one time step did. With substeps: times and counts of the inner ones together.");
    bind_work(step);
    bind_sums(step);
    bind_pruning(step);
    step.def(
        "to_dict", [](const py::object& self) { return properties(self); }, "All fields by name.");

    auto body = value_class<BodyState>(m, "BodyState", "Where a body is and how it moves.");
    body.def_readonly("position", &BodyState::position, "of the mesh's own origin, m, shape (3)");
    body.def_readonly("rotation", &BodyState::rotation, "mesh axes to world, unit quaternion w x y z, shape (4)");
    body.def_readonly("center_of_mass", &BodyState::center_of_mass, "m, shape (3)");
    body.def_readonly("velocity", &BodyState::velocity, "of the centre of mass, m/s, shape (3)");
    body.def_readonly("angular_velocity", &BodyState::angular_velocity, "rad/s, world axes, shape (3)");

    auto point = value_class<WayPoint>(m, "WayPoint", "Where an inner step of a body's last step ended.");
    point.def_readonly("position", &WayPoint::position, "of the mesh's own origin, m, shape (3)");
    point.def_readonly("rotation", &WayPoint::rotation, "unit quaternion w x y z, shape (4)");
    point.def_readonly("turn", &WayPoint::turn, "rotation vector with whole turns, rad, world axes, shape (3)");

    auto moved =
        value_class<MovedBody>(m, "MovedBody", "A body that initial_overlap \"separate\" moved before the start.");
    moved.def_readonly("body", &MovedBody::body, "index");
    moved.def_readonly("by", &MovedBody::by, "m, shape (3)");

    auto thread = value_class<ThreadReport>(m, "ThreadReport", "What a thread of a World did since that was made.");
    thread.def_readonly("busy_ms", &ThreadReport::busy_ms, "ms, in tasks");
    thread.def_readonly("waiting_ms", &ThreadReport::waiting_ms, "ms, in parallel sections without a task");
    thread.def_readonly("tasks", &ThreadReport::tasks, "chunks of loops and ordered operations");
    thread.def_readonly("stolen", &ThreadReport::stolen, "of them, those first given to another thread");
}

} // namespace flotilla::python
