// SPDX-License-Identifier: MIT
// What run folders hold.
#include <flotilla/compare.hpp>
#include <flotilla/run_folder.hpp>

#include "python/bind.hpp"

namespace flotilla::python {
namespace {

constexpr std::array<std::string_view, 5> kFormats{"csv", "vtp", "obj", "glb", "usd"};

FrameRange frame_range(std::int64_t first, std::optional<std::int64_t> last, std::int64_t every) {
    FrameRange range{.first = first, .every = every};
    if (last) range.last = *last;
    return range;
}

void bind_summary(py::module_& m) {
    using S = RunSummary;
    auto type = value_class<S>(m, "RunSummary", "What a run folder holds, and where it comes from.");
    type.def_readonly("status", &S::status, "\"running\", \"complete\" or why it ended");
    type.def_readonly("version", &S::version);
    type.def_readonly("commit", &S::commit);
    type.def_readonly("compiler", &S::compiler);
    type.def_readonly("processor", &S::processor);
    type.def_readonly("started", &S::started, "UTC, ISO 8601");
    type.def_readonly("updated", &S::updated, "UTC, ISO 8601");
    type.def_readonly("command_line", &S::command_line);
    type.def_readonly("threads", &S::threads);
    type.def_readonly("time_step", &S::time_step, "s");
    type.def_readonly("substeps", &S::substeps, "inner steps of a step");
    type.def_readonly("bodies", &S::bodies);
    type.def_readonly("dynamic_bodies", &S::dynamic_bodies);
    type.def_readonly("shapes", &S::shapes);
    type.def_readonly("triangles", &S::triangles, "of all bodies");
    type.def_readonly("frames", &S::frames);
    type.def_readonly("last_step", &S::last_step);
    type.def_readonly("last_time", &S::last_time, "s");
    type.def_readonly("frame_bytes", &S::frame_bytes);
    type.def_readonly("checkpoint_step", &S::checkpoint_step, "-1: no valid checkpoint");
    type.def_readonly("problems", &S::problems, "files that are damaged or missing");
    type.def_readonly("settings_json", &S::settings_json);
}

/// Arrays of shape (frames, bodies, ...), that take over the memory of what was read.
struct Frames {
    py::object bodies, frame, step, time, positions, rotations, velocities, angular_velocities, contacts, cluster, cost;
};

Frames arrays_of(RunFrames&& read) {
    const auto frames = static_cast<py::ssize_t>(read.frame.size()),
               bodies = static_cast<py::ssize_t>(read.bodies.size());
    Frames out;
    out.bodies = py::cast(read.bodies);
    const auto activity = [&](auto get) -> py::object {
        if (read.activity.empty()) return py::none();
        std::vector<std::int64_t> values;
        for (const BodyActivity& a : read.activity) values.push_back(get(a));
        return owning_array(std::move(values), py::dtype::of<std::int64_t>(), {frames, bodies});
    };
    out.contacts = activity([](const BodyActivity& a) { return a.contacts; });
    out.cluster = activity([](const BodyActivity& a) { return static_cast<std::int64_t>(a.cluster); });
    out.cost = activity([](const BodyActivity& a) { return a.cost; });
    out.frame = numbers(std::move(read.frame));
    out.step = numbers(std::move(read.step));
    out.time = numbers(std::move(read.time));
    out.positions = rows(std::move(read.position), {frames, bodies});
    out.rotations = rows(std::move(read.rotation), {frames, bodies});
    out.velocities = rows(std::move(read.velocity), {frames, bodies});
    out.angular_velocities = rows(std::move(read.angular_velocity), {frames, bodies});
    return out;
}

Frames read(const std::filesystem::path& folder, std::int64_t first, std::optional<std::int64_t> last,
            std::int64_t every) {
    RunFrames frames;
    {
        const py::gil_scoped_release unlocked;
        frames = read_frames(folder, frame_range(first, last, every));
    }
    return arrays_of(std::move(frames));
}

void bind_frames(py::module_& m) {
    py::class_<Frames> type(m, "Frames", "Poses of a run over time, as arrays.");
    type.def_readonly("bodies", &Frames::bodies, "names");
    type.def_readonly("frame", &Frames::frame, "numbers in the run, shape (frames)");
    type.def_readonly("step", &Frames::step, "that ended at the frame, shape (frames)");
    type.def_readonly("time", &Frames::time, "s, shape (frames)");
    type.def_readonly("positions", &Frames::positions, "of the meshes' own origins, m, shape (frames, bodies, 3)");
    type.def_readonly("rotations", &Frames::rotations, "unit quaternions w x y z, shape (frames, bodies, 4)");
    type.def_readonly("velocities", &Frames::velocities, "of the centres of mass, m/s, shape (frames, bodies, 3)");
    type.def_readonly("angular_velocities", &Frames::angular_velocities,
                      "rad/s, world axes, shape (frames, bodies, 3)");
    type.def_readonly("contacts", &Frames::contacts,
                      "contact points by body, shape (frames, bodies); None: not recorded");
    type.def_readonly("cluster", &Frames::cluster, "ClusterState, shape (frames, bodies); None: not recorded");
    type.def_readonly("cost", &Frames::cost,
                      "how often a step set the body's end state, shape (frames, bodies); None: not recorded");
    type.def("__len__", [](const Frames& f) { return py::len(f.frame); });
    type.def("__repr__", [](const Frames& f) {
        return "Frames(" + std::to_string(py::len(f.frame)) + " frames, " + std::to_string(py::len(f.bodies)) +
               " bodies)";
    });
}

void bind_compare(py::module_& m) {
    auto value = value_class<ComparedValue>(m, "ComparedValue", "A value that two runs do not share, as text.");
    value.def_readonly("name", &ComparedValue::name);
    value.def_readonly("a", &ComparedValue::a, "empty where the run does not have it");
    value.def_readonly("b", &ComparedValue::b, "empty where the run does not have it");

    auto step = value_class<DifferentStep>(
        m, "DifferentStep",
        "A step whose rows in steps.csv differ; times are not compared, nor what DifferentWork has.");
    step.def_readonly("step", &DifferentStep::step);
    step.def_readonly("time", &DifferentStep::time, "s");
    step.def_readonly("state", &DifferentStep::state, "the state hashes differ");
    step.def_readonly("columns", &DifferentStep::columns, "those that differ");
    step.def_readonly("stage", &DifferentStep::stage, "the earliest that a counter of this step speaks of");

    auto work = value_class<DifferentWork>(
        m, "DifferentWork",
        "A step whose count of examined pairs differs. It goes by what is remembered of pairs, which a run that was "
        "resumed, or a restored World, finds anew: no bit of the motion depends on it.");
    work.def_readonly("step", &DifferentWork::step);
    work.def_readonly("columns", &DifferentWork::columns, "those that differ");

    using B = BodyDifference;
    auto body = value_class<B>(m, "BodyDifference", "By how much a body differs between two frames of the same step.");
    body.def_readonly("body", &B::body, "index");
    body.def_readonly("name", &B::name);
    body.def_readonly("position", &B::position, "m");
    body.def_readonly("rotation", &B::rotation, "rad");
    body.def_readonly("velocity", &B::velocity, "m/s");
    body.def_readonly("angular_velocity", &B::angular_velocity, "rad/s");
    body.def_readonly("activity", &B::activity, "contacts, cluster state or cost differ");

    using F = DifferentFrame;
    auto frame = value_class<F>(m, "DifferentFrame", "A frame that both runs have and that differs.");
    frame.def_readonly("step", &F::step);
    frame.def_readonly("frame_a", &F::frame_a, "number in its run");
    frame.def_readonly("frame_b", &F::frame_b, "number in its run");
    frame.def_readonly("time", &F::time, "s");
    frame.def_readonly("bodies", &F::bodies, "how many differ");
    frame.def_readonly("first", &F::first, "the lowest body that differs");
    frame.def_readonly("farthest", &F::farthest, "the body with the largest difference in position");

    using R = CompareReport;
    auto type = value_class<R>(m, "CompareReport", "Where two recorded runs part.");
    type.def_readonly("inputs", &R::inputs, "what the bits depend on and the runs do not share");
    type.def_readonly("record", &R::record, "of the rest: machine, threads, version, ...");
    type.def_readonly("same_bodies", &R::same_bodies);
    type.def_readonly("steps_a", &R::steps_a);
    type.def_readonly("steps_b", &R::steps_b);
    type.def_readonly("steps_compared", &R::steps_compared);
    type.def_readonly("last_step", &R::last_step);
    type.def_readonly("first_step", &R::first_step, "with any difference, or None");
    type.def_readonly("first_state", &R::first_state, "whose state hash differs, or None");
    type.def_readonly("first_work", &R::first_work, "whose counts of work differ, or None; no difference in bits");
    type.def_readonly("frames_a", &R::frames_a);
    type.def_readonly("frames_b", &R::frames_b);
    type.def_readonly("frames_compared", &R::frames_compared);
    type.def_readonly("last_frame_step", &R::last_frame_step);
    type.def_readonly("first_frame", &R::first_frame, "that differs, or None");
    type.def_readonly("last_frame", &R::last_frame, "the last that both have, where it differs");
    type.def_readonly("unreadable", &R::unreadable, "messages");
    type.def_property_readonly("same_inputs", &R::same_inputs);
    type.def_property_readonly("same_bits", &R::same_bits);
    type.def_property_readonly("promise_broken", &R::promise_broken, "asked for the same, and gave other bits");
    m.def("compare_runs", &compare_runs, py::arg("a"), py::arg("b"), py::call_guard<py::gil_scoped_release>(),
          "Compares what the folders of two runs, finished or not, have in common.");
}

} // namespace

void bind_run_folder(py::module_& m) {
    bind_summary(m);
    bind_frames(m);
    bind_compare(m);
    m.def("summarize_run", &summarize_run, py::arg("folder"), "RunSummary of a run folder, finished or not.");
    m.def("read_frames", &read, py::arg("folder"), py::kw_only(), py::arg("first") = 0, py::arg("last") = py::none(),
          py::arg("every") = 1,
          "Frames first, first + every, ... up to last (default: the run's last one) of a run folder.");
    m.def(
        "export_run",
        [](const std::filesystem::path& folder, const std::string& format, const std::filesystem::path& output,
           std::int64_t first, std::optional<std::int64_t> last, std::int64_t every) {
            const auto kind = choice<ExportFormat>("format", format, kFormats);
            const py::gil_scoped_release unlocked;
            export_run(folder, kind, output, frame_range(first, last, every));
        },
        py::arg("folder"), py::arg("format"), py::arg("output"), py::kw_only(), py::arg("first") = 0,
        py::arg("last") = py::none(), py::arg("every") = 1,
        "Writes frames of a run as csv, glb or usd (a file), vtp or obj (a folder); what exists is replaced.");
    m.def(
        "estimate_export",
        [](const std::filesystem::path& folder, const std::string& format, std::int64_t first,
           std::optional<std::int64_t> last, std::int64_t every) {
            const ExportSize size = estimate_export(folder, choice<ExportFormat>("format", format, kFormats),
                                                    frame_range(first, last, every));
            return std::pair(size.frames, size.bytes);
        },
        py::arg("folder"), py::arg("format"), py::kw_only(), py::arg("first") = 0, py::arg("last") = py::none(),
        py::arg("every") = 1, "(frames, bytes) that export_run writes, to within a third.");
}

} // namespace flotilla::python
