// SPDX-License-Identifier: MIT
// Pictures, checks and plans of scenes, recorded tasks, and files of collision queries.
#include <flotilla/ccd.hpp>
#include <flotilla/picture.hpp>
#include <flotilla/plan.hpp>
#include <flotilla/scene_check.hpp>
#include <flotilla/step_picture.hpp>
#include <flotilla/trace.hpp>

#include "python/bind.hpp"
#include "python/scene.hpp"
#include "python/world.hpp"

namespace flotilla::python {
namespace {

/// The keywords of functions that draw. TypeError: there is no such one, or its value is of another type.
PictureOptions picture_options(const py::kwargs& given) {
    PictureOptions o;
    const auto set = [&o](const std::string& name, const py::handle& value) {
        const auto take = [&](std::string_view key, auto& member) {
            if (name != key) return false;
            member = value.cast<std::decay_t<decltype(member)>>();
            return true;
        };
        return take("width", o.width) || take("height", o.height) || take("supersampling", o.supersampling) ||
               take("azimuth", o.azimuth) || take("elevation", o.elevation) || take("field_of_view", o.field_of_view) ||
               take("zoom", o.zoom) || take("target", o.target) || take("camera_frame", o.camera_frame) ||
               take("sun_samples", o.sun_samples) || take("sky_samples", o.sky_samples) || take("outlines", o.outlines);
    };
    for (const auto& [key, value] : given) {
        const auto name = key.cast<std::string>();
        try {
            if (!set(name, value)) throw py::type_error("pictures have no option '" + name + "'");
        } catch (const py::cast_error&) {
            throw py::type_error("picture: " + name + " is " + std::string(py::repr(value)));
        }
    }
    return o;
}

PictureReport picture(const std::filesystem::path& source, const std::filesystem::path& output,
                      std::optional<std::int64_t> frame, const py::kwargs& given) {
    const PictureOptions options = picture_options(given);
    const py::gil_scoped_release unlocked;
    return write_picture(source, output, options, frame);
}

StepPictureReport step_picture(const py::object& source, const std::filesystem::path& output,
                               std::optional<std::int64_t> step, const std::string& lines,
                               const std::function<void(std::int64_t, std::int64_t)>& progress,
                               const py::kwargs& given) {
    constexpr std::array<std::string_view, 2> kLines{"contacts", "proofs"};
    const PictureOptions options = picture_options(given);
    const StepPictureOptions step_options{choice<PairLines>("lines", lines, kLines), progress};
    const bool of_world = py::isinstance<PythonWorld>(source);
    if (of_world == step.has_value())
        throw py::type_error("write_step_picture: a step is given of a scene file or a run folder, and of these alone");
    if (of_world)
        return write_step_picture(source.cast<const PythonWorld&>().world(), output, options, step_options.lines);
    const auto path = source.cast<std::filesystem::path>();
    const py::gil_scoped_release unlocked;
    return write_step_picture(path, *step, output, options, step_options);
}

void bind_step_picture(py::module_& m) {
    using R = StepPictureReport;
    auto type = value_class<R>(m, "StepPictureReport",
                               "What a picture of a step shows. A pair is counted once by what is between its bodies, "
                               "and once by how it was proved apart.");
    type.def_readonly("step", &R::step);
    type.def_readonly("time", &R::time, "s");
    type.def_readonly("bodies", &R::bodies);
    type.def_readonly("contacts", &R::contacts, "points, those of sleeping bodies included");
    type.def_readonly("loaded_pairs", &R::loaded_pairs, "contacts, one of them with an impulse in the last step");
    type.def_readonly("sleeping_pairs", &R::sleeping_pairs, "contacts, but neither body moves");
    type.def_readonly("touching_pairs", &R::touching_pairs, "contacts, but no impulse");
    type.def_readonly("near_pairs", &R::near_pairs, "boxes that meet, and no contact");
    type.def_readonly("largest_impulse", &R::largest_impulse, "N s, of one contact point");
    type.def_readonly("proved_by_query", &R::proved_by_query, "the continuous detection found no hit");
    type.def_readonly("proved_by_boxes", &R::proved_by_boxes, "the boxes of both whole ways are apart");
    type.def_readonly("proved_by_cluster", &R::proved_by_cluster, "both moved by a common motion");
    type.def_readonly("proved_by_rest", &R::proved_by_rest, "neither moved");
    type.def_readonly("not_proved", &R::not_proved, "neither could move, or no step was made");
    m.def("write_step_picture", &step_picture, py::arg("source"), py::arg("output"), py::arg("step") = py::none(),
          py::kw_only(), py::arg("lines") = "contacts", py::arg("progress") = py::none(),
          "Writes a PNG of what the solver found in a step: contact points, normals and impulses, and a line for each "
          "pair of bodies near each other. source: a World as it stands; or a scene file or a run folder, whose step "
          "is made again. lines: \"contacts\" colours them by what is between the bodies, \"proofs\" by how they were "
          "proved apart. progress(done, total) is called after every step made. Other keywords are those of picture, "
          "without frame and camera_frame.");
}

void bind_picture(py::module_& m) {
    auto type = value_class<PictureReport>(m, "PictureReport", "What a picture shows.");
    type.def_readonly("frame", &PictureReport::frame, "index from 0");
    type.def_readonly("frames", &PictureReport::frames, "how many there are");
    type.def_readonly("time", &PictureReport::time, "s");
    type.def_readonly("bodies", &PictureReport::bodies);
    m.def("_write_picture", &picture, py::arg("source"), py::arg("output"), py::kw_only(),
          py::arg("frame") = py::none(), "As flotilla.picture, of a run folder or a scene file.");
    bind_step_picture(m);
}

template <class T>
py::class_<T> bind_intersection(py::module_& m) {
    auto type =
        value_class<T>(m, "InitialIntersection", "Two bodies that intersect where they start; touching counts.");
    type.def_readonly("body_a", &T::body_a, "name");
    type.def_readonly("body_b", &T::body_b, "name");
    type.def_readonly("triangle_pairs", &T::triangle_pairs, "that intersect");
    type.def_readonly("place", &T::place, "m, in the middle of one of them, shape (3)");
    const auto triangles = [&](const char* name, auto member) {
        type.def_property_readonly(
            name,
            [member](const T& t) {
                const auto n = static_cast<py::ssize_t>((t.*member).size());
                auto corners = t.*member;
                return owning_array(std::move(corners), py::dtype::of<double>(), {n, 3, 3});
            },
            "those that take part, world coordinates, m, shape (triangles, 3, 3)");
    };
    triangles("triangles_a", &T::triangles_a);
    triangles("triangles_b", &T::triangles_b);
    return type;
}

void bind_check(py::module_& m) {
    bind_intersection<InitialIntersection>(m);
    auto repair = value_class<InitialRepair>(m, "InitialRepair", "A body that initial_overlap \"separate\" will move.");
    repair.def_readonly("body", &InitialRepair::body, "name");
    repair.def_readonly("by", &InitialRepair::by, "m, shape (3)");
    using C = SceneCheck;
    auto type =
        value_class<C>(m, "SceneCheck", "Whether a scene is ready to run: it is where `intersections` is empty.");
    type.def_readonly("dynamic_bodies", &C::dynamic_bodies);
    type.def_readonly("static_bodies", &C::static_bodies);
    type.def_readonly("kinematic_bodies", &C::kinematic_bodies);
    type.def_readonly("locked_bodies", &C::locked_bodies, "of the dynamic ones: with locked axes");
    type.def_readonly("driven_bodies", &C::driven_bodies, "of the dynamic ones: with a force or a torque");
    type.def_readonly("shapes", &C::shapes, "identical ones counted once");
    type.def_readonly("triangles", &C::triangles, "of all bodies");
    type.def_readonly("mass", &C::mass, "kg, of the dynamic bodies");
    type.def_readonly("warnings", &C::warnings);
    type.def_readonly("intersections", &C::intersections, "the scene cannot start with these");
    type.def_readonly("repairs", &C::repairs, "the moves that free all bodies, with initial_overlap \"separate\"");
    type.def_readonly("ignored_intersections", &C::ignored_intersections, "between bodies of infinite mass: allowed");
    m.def(
        "check_scene",
        [](const py::object& scene, const py::object& preset, const py::object& settings) {
            const NamedScene named = scene_argument(scene, preset, settings);
            const py::gil_scoped_release unlocked;
            return check_scene(*named.scene, named.source);
        },
        py::arg("scene"), py::kw_only(), py::arg("preset") = py::none(), py::arg("settings") = py::none(),
        "Validates a scene and looks, exactly, for bodies that intersect at the start. InputError with every problem "
        "of an invalid scene.");
    m.def(
        "write_intersections",
        [](const std::vector<InitialIntersection>& intersections, const std::filesystem::path& path) {
            write_intersections(path, intersections);
        },
        py::arg("intersections"), py::arg("path"),
        "Writes the triangles of SceneCheck.intersections as an OBJ file, in world coordinates.");
    m.def(
        "plan",
        [](const py::object& scene, const py::object& preset, const py::object& settings) {
            const NamedScene named = scene_argument(scene, preset, settings);
            const py::gil_scoped_release unlocked;
            std::vector<std::pair<std::string, std::string>> lines;
            for (const PlanLine& line : plan_scene(*named.scene, named.source))
                lines.emplace_back(line.topic, line.text);
            return lines;
        },
        py::arg("scene"), py::kw_only(), py::arg("preset") = py::none(), py::arg("settings") = py::none(),
        "What the solver will model of a scene, and why: (topic, text) each.");
}

void bind_trace(py::module_& m) {
    using C = TraceCosts;
    auto costs = value_class<C>(m, "TraceCosts", "What a number of cores pays beside its tasks, ns.");
    costs.def_readonly("cores", &C::cores);
    costs.def_readonly("fork_join", &C::fork_join, "a parallel section without work");
    costs.def_readonly("barrier", &C::barrier, "of all threads");
    costs.def_readonly("hand_over", &C::hand_over, "of a task to another thread");
    using W = TraceRow;
    auto row = value_class<W>(
        m, "TraceRow", "A phase of a step, or the parallel sections of one name in it; sums over all recorded steps.");
    row.def_readonly("name", &W::name);
    row.def_readonly("kind", &W::kind, "phase, rest, loop, ordered or sweeps");
    row.def_readonly("depth", &W::depth, "rows follow the row that they are part of, which has less");
    row.def_readonly("count", &W::count, "of phases or regions");
    row.def_readonly("regions", &W::regions, "parallel sections");
    row.def_readonly("tasks", &W::tasks);
    row.def_readonly("wall_ms", &W::wall_ms, "ms");
    row.def_readonly("serial_ms", &W::serial_ms, "ms, outside regions");
    row.def_readonly("work_ms", &W::work_ms, "ms, serial and all tasks");
    row.def_readonly("critical_path_ms", &W::critical_path_ms, "ms, any number of cores");
    row.def_readonly("parallelism", &W::parallelism, "work over critical path");
    row.def_readonly("speedup", &W::speedup, "by TraceReport.cores");
    using R = TraceReport;
    auto type = value_class<R>(m, "TraceReport", "What the recorded task graph of a run says about more cores.");
    type.def_readonly("version", &R::version);
    type.def_readonly("commit", &R::commit);
    type.def_readonly("processor", &R::processor);
    type.def_readonly("command_line", &R::command_line);
    type.def_readonly("threads", &R::threads, "of the recorded run");
    type.def_readonly("recordings", &R::recordings, "files");
    type.def_readonly("steps", &R::steps, "recorded");
    type.def_readonly("trace_every", &R::trace_every, "steps per recorded step");
    type.def_readonly("wall_seconds", &R::wall_seconds, "s, of the recorded steps");
    type.def_readonly("cpu_seconds", &R::cpu_seconds, "s, of the process in them");
    type.def_readonly("covered", &R::covered, "tasks and serial stretches as a share of cpu_seconds");
    type.def_readonly("cores", &R::cores);
    type.def_readonly("costs", &R::costs, "by cores");
    type.def_readonly("measured_cores", &R::measured_cores, "costs of more are extrapolated; 1: all are assumed");
    type.def_readonly("total", &R::total, "a TraceRow");
    type.def_readonly("rows", &R::rows, "a TraceRow each");
    type.def_readonly("notes", &R::notes);
    m.def(
        "analyze_trace",
        [](const std::vector<std::filesystem::path>& files, const std::vector<int>& cores, const std::string& growth,
           bool assume_costs) {
            constexpr std::array<std::string_view, 2> kGrowths{"log2", "linear"};
            const TraceOptions options{cores, choice<CostGrowth>("growth", growth, kGrowths), assume_costs};
            const py::gil_scoped_release unlocked;
            return analyze_trace(files, options);
        },
        py::arg("files"), py::kw_only(), py::arg("cores") = TraceOptions{}.cores, py::arg("growth") = "log2",
        py::arg("assume_costs") = false,
        "Greedy schedules of a record of run(trace=...) for numbers of cores. Several files: recordings of the same "
        "run.");
}

void bind_ccd(py::module_& m) {
    using R = CcdFileReport;
    auto type =
        value_class<R>(m, "CcdFileReport", "How a collision test does on a file of queries with known answers.");
    type.def_readonly("rows", &R::rows);
    type.def_readonly("positives", &R::positives, "rows with contact");
    type.def_readonly("missed", &R::missed, "no hit, although there is contact or less than the separation");
    type.def_readonly("late", &R::late, "hit after the exact contact time");
    type.def_readonly("false_hits", &R::false_hits);
    type.def_readonly("ns_per_query", &R::ns_per_query, "ns, wall time");
    m.def(
        "evaluate_ccd_file",
        [](const std::filesystem::path& path, const std::string& method, double separation) {
            constexpr std::array<std::string_view, 2> kMethods{"conservative", "cubic"};
            const CcdFileOptions options{choice<CcdMethod>("method", method, kMethods), separation};
            const py::gil_scoped_release unlocked;
            return evaluate_ccd_file(path, options);
        },
        py::arg("path"), py::kw_only(), py::arg("method") = "conservative", py::arg("separation") = 0.0,
        "Runs every query of a file (CSV or BIN). separation: m, features within it are to be reported.");
}

} // namespace

void bind_tools(py::module_& m) {
    bind_picture(m);
    bind_check(m);
    bind_trace(m);
    bind_ccd(m);
}

} // namespace flotilla::python
