// SPDX-License-Identifier: MIT
// Pictures, checks and plans of scenes, recorded tasks, and files of collision queries.
#include <flotilla/ccd.hpp>
#include <flotilla/picture.hpp>
#include <flotilla/plan.hpp>
#include <flotilla/scene_check.hpp>
#include <flotilla/trace.hpp>

#include "python/bind.hpp"
#include "python/scene.hpp"

namespace flotilla::python {
namespace {

PictureReport picture(const std::filesystem::path& source, const std::filesystem::path& output,
                      std::optional<std::int64_t> frame, int width, int height, int supersampling, double azimuth,
                      double elevation, double field_of_view, double zoom, std::optional<Vec3> target,
                      std::optional<std::int64_t> camera_frame, int sun_samples, int sky_samples, double outlines) {
    const PictureOptions options{.width = width,
                                 .height = height,
                                 .supersampling = supersampling,
                                 .azimuth = azimuth,
                                 .elevation = elevation,
                                 .field_of_view = field_of_view,
                                 .zoom = zoom,
                                 .target = target,
                                 .camera_frame = camera_frame,
                                 .sun_samples = sun_samples,
                                 .sky_samples = sky_samples,
                                 .outlines = outlines};
    const py::gil_scoped_release unlocked;
    return write_picture(source, output, options, frame);
}

void bind_picture(py::module_& m) {
    auto type = value_class<PictureReport>(m, "PictureReport", "What a picture shows.");
    type.def_readonly("frame", &PictureReport::frame, "index from 0");
    type.def_readonly("frames", &PictureReport::frames, "how many there are");
    type.def_readonly("time", &PictureReport::time, "s");
    type.def_readonly("bodies", &PictureReport::bodies);
    const PictureOptions d;
    m.def("_write_picture", &picture, py::arg("source"), py::arg("output"), py::kw_only(),
          py::arg("frame") = py::none(), py::arg("width") = d.width, py::arg("height") = d.height,
          py::arg("supersampling") = d.supersampling, py::arg("azimuth") = d.azimuth,
          py::arg("elevation") = d.elevation, py::arg("field_of_view") = d.field_of_view, py::arg("zoom") = d.zoom,
          py::arg("target") = py::none(), py::arg("camera_frame") = py::none(), py::arg("sun_samples") = d.sun_samples,
          py::arg("sky_samples") = d.sky_samples, py::arg("outlines") = d.outlines,
          "As flotilla.picture, of a run folder or a scene file.");
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
