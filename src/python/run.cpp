// SPDX-License-Identifier: MIT
// Whole runs into run folders.
#include <flotilla/run.hpp>

#include <cmath>

#include "python/bind.hpp"
#include "python/edits.hpp"
#include "python/reports.hpp"
#include "python/scene.hpp"
#include "python/world_options.hpp"

namespace flotilla::python {
namespace {

constexpr double kDefaultDuration = 10; // s, as the command's

std::int64_t total_steps(std::optional<std::int64_t> steps, std::optional<double> duration, double dt) {
    if (steps && duration) throw InputError("run: steps or duration, not both");
    if (steps) return *steps;
    const double count = std::ceil(duration.value_or(kDefaultDuration) / dt - 1e-9);
    constexpr double kMostCount = 9007199254740992; // 2^53
    if (!(count >= 0 && count <= kMostCount)) throw InputError("run: the duration must be finite, 0 or more");
    return static_cast<std::int64_t>(count);
}

/// Whether the run goes on: what the caller says, where None is yes, unless a signal interrupts it.
bool goes_on(const py::object& after_step, const StepReport& report) {
    const py::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (after_step.is_none()) return true;
    const py::object answer = after_step(report);
    return answer.is_none() || answer.cast<bool>();
}

RunTotals run(const py::object& scene, const std::filesystem::path& output, std::optional<std::int64_t> steps,
              std::optional<double> duration, const py::object& preset, const py::object& settings, bool overwrite,
              bool resume, int frame_every, int checkpoint_every, int threads, const std::string& executor,
              const std::filesystem::path& trace, int trace_every, const std::filesystem::path& contacts,
              const py::object& edits, const py::object& after_step,
              const std::function<void(const RunTotals&)>& blocked,
              const std::function<void(const std::string&)>& note) {
    const NamedScene named = scene_argument(scene, preset, settings);
    const SceneDescription start = *named.scene; // the caller's may change while the lock is away
    RunOptions options;
    options.output = output;
    options.overwrite = overwrite;
    options.resume = resume;
    options.steps = total_steps(steps, duration, start.settings.time_step);
    options.frame_every = frame_every;
    options.checkpoint_every = checkpoint_every;
    options.world = world_options(threads, executor);
    options.command_line = {"flotilla.run"};
    options.scene_json = output.empty() ? "" : self_contained_json(start);
    options.trace = trace;
    options.trace_every = trace_every;
    options.contacts = contacts;
    options.edits = edits_argument(edits, start);
    options.blocked = blocked;
    options.after_step = [&](const StepReport& report) { return goes_on(after_step, report); };
    options.note = note;
    const py::gil_scoped_release unlocked;
    return run_scene(start, named.source, options);
}

void bind_totals(py::module_& m) {
    using T = RunTotals;
    auto type = value_class<T>(m, "RunTotals", "Sums over a run, or over its part since it was resumed.");
    type.def_readonly("steps", &T::steps, "made");
    type.def_readonly("resumed_after", &T::resumed_after, "steps that were there already");
    type.def_readonly("complete", &T::complete, "False: after_step ended it");
    type.def_readonly("bodies", &T::bodies);
    type.def_readonly("total_ms", &T::total_ms, "ms, wall time in steps");
    type.def_readonly("worst_ms", &T::worst_ms, "ms, of the slowest step");
    type.def_readonly("output_ms", &T::output_ms, "ms, wall time that steps waited for what is written");
    type.def_property_readonly(
        "phase_ms", [](const T& t) { return phases_of(t.phase_ms); }, "ms by phase");
    type.def_readonly("collisions", &T::collisions, "impulses of stage 1");
    type.def_readonly("merges", &T::merges, "failsafe: clusters merged");
    type.def_readonly("rung_changes", &T::rung_changes, "failsafe: steps down its ladder");
    type.def_readonly("held", &T::held, "bodies held, all steps together");
    type.def_readonly("above_tolerance", &T::above_tolerance,
                      "steps in which a contact solve ended above its tolerance");
    type.def_readonly("energy_corrections", &T::energy_corrections, "islands that the last resort took energy from");
    type.def_readonly("energy_removed", &T::energy_removed, "J, that it took");
    type.def_readonly("min_distance", &T::min_distance, "m, smallest at the end of a step");
    type.def_readonly("last", &T::last, "StepReport of the last step");
    type.def_readonly("traced_steps", &T::traced_steps, "in the file of `trace`");
    type.def_readonly("threads", &T::threads, "a ThreadReport each");
}

} // namespace

void bind_run(py::module_& m) {
    bind_totals(m);
    m.def("run", &run, py::arg("scene"), py::arg("output") = "", py::kw_only(), py::arg("steps") = py::none(),
          py::arg("duration") = py::none(), py::arg("preset") = py::none(), py::arg("settings") = py::none(),
          py::arg("overwrite") = false, py::arg("resume") = false, py::arg("frame_every") = 1,
          py::arg("checkpoint_every") = 0, py::arg("threads") = 0, py::arg("executor") = "parallel",
          py::arg("trace") = "", py::arg("trace_every") = 1, py::arg("contacts") = "", py::arg("edits") = py::none(),
          py::arg("after_step") = py::none(), py::arg("blocked") = py::none(), py::arg("note") = py::none(),
          "Simulates a scene into a run folder and returns RunTotals. scene, preset, settings: as World takes them; "
          "output: the folder, "
          "empty: nothing is written. steps or duration (s, default 10) are totals, those before a resumption "
          "included. overwrite "
          "replaces an earlier run in the folder; resume goes on from its last checkpoint with the same bits. "
          "frame_every: steps per "
          "frame; checkpoint_every: steps per checkpoint (0: 100, and one in five minutes). trace, contacts: files for "
          "the executed "
          "tasks and for the contact points of every step, which resume goes on with. edits, as read_edits takes them "
          "or a list of Edit, are made "
          "on "
          "the way; one that is refused ends the run with its error. after_step(report) is called after every step and "
          "ends the "
          "run by returning "
          "False; blocked(totals), before ScriptError is raised, with what was done; note(text) is told what a user "
          "should know. An exception of a callback, or an interrupt, leaves a "
          "folder that can be resumed.");
}

} // namespace flotilla::python
