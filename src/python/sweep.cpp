// SPDX-License-Identifier: MIT
// Campaigns; flotilla/_sweep.py makes their runs.
#include <flotilla/sweep.hpp>

#include "python/bind.hpp"

namespace flotilla::python {
namespace {

void bind_member(py::module_& m) {
    using M = SweepMember;
    auto type = value_class<M>(m, "SweepMember", "A run to be made.");
    type.def_readonly("name", &M::name);
    type.def_readonly("scene", &M::scene, "scene file");
    type.def_readonly("folder", &M::folder, "run folder, gone on with where it has a checkpoint");
    type.def_readonly("log", &M::log, "file for messages");
    type.def_readonly("preset", &M::preset);
    type.def_property_readonly(
        "settings",
        [](const M& member) {
            py::dict out;
            for (const auto& [key, value] : member.overrides) out[py::str(key)] = value;
            return out;
        },
        "settings that replace the scene's, as text by key");
    type.def_readonly("steps", &M::steps);
    type.def_readonly("frame_every", &M::frame_every);
    type.def_readonly("threads", &M::threads);
}

void bind_tables(py::module_& m) {
    using T = SweepMetric;
    auto metric = value_class<T>(m, "SweepMetric", "What is measured of a run.");
    metric.def_readonly("name", &T::name);
    metric.def_readonly("unit", &T::unit);
    metric.def_readonly("description", &T::description);
    metric.def_property_readonly(
        "truth", [](const T& t) { return t.truth == T::Truth::zero ? "zero" : "reference"; },
        "reference: the reference's value, start by start; zero: the value is the error");
    metric.def_readonly("needs_reference", &T::needs_reference);

    auto axis = value_class<SweepAxis>(m, "SweepAxis", "A setting that is varied.");
    axis.def_readonly("key", &SweepAxis::key);
    axis.def_readonly("values", &SweepAxis::values);

    auto value = value_class<SweepValue>(m, "SweepValue", "Over the starts; nan where there is none.");
    value.def_readonly("mean", &SweepValue::mean);
    value.def_readonly("spread", &SweepValue::spread, "standard deviation; of an error its standard error");
    value.def_readonly("starts", &SweepValue::starts, "that have a value");

    using P = SweepPoint;
    auto point = value_class<P>(m, "SweepPoint", "One choice of settings.");
    point.def_readonly("label", &P::label);
    point.def_readonly("values", &P::values, "by axis");
    point.def_readonly("reference", &P::reference);
    point.def_readonly("complete", &P::complete, "starts");
    point.def_readonly("cost", &P::cost, "s, wall time of the steps, or CPU time where no core was free");
    point.def_readonly("values_of", &P::values_of, "by metric");
    point.def_readonly("errors", &P::errors, "by metric, distance from the truth");
    point.def_readonly("on_front", &P::on_front, "no other point has less of both cost and error");

    using C = SweepChange;
    auto change = value_class<C>(m, "SweepChange", "What one change of one setting brings, against the base.");
    change.def_readonly("key", &C::key);
    change.def_property_readonly(
        "from_", [](const C& c) { return c.from; }, "value of the base");
    change.def_readonly("to", &C::to);
    change.def_readonly("cost_ratio", &C::cost_ratio, "new / old");
    change.def_readonly("error_ratio", &C::error_ratio, "new / old");
    change.def_readonly("gain", &C::gain, "-log of the product");
    change.def_readonly("cost_from", &C::cost_from);
    change.def_readonly("cost_to", &C::cost_to);
    change.def_readonly("error_from", &C::error_from);
    change.def_readonly("error_to", &C::error_to);
}

void bind_report(py::module_& m) {
    using R = SweepReport;
    auto type = value_class<R>(m, "SweepReport", "What a campaign found.");
    type.def_readonly("axes", &R::axes, "without seeds");
    type.def_readonly("starts", &R::starts, "names");
    type.def_readonly("metrics", &R::metrics, "those asked for");
    type.def_readonly("headline", &R::headline, "index of the metric that front and advice go by");
    type.def_readonly("chaotic", &R::chaotic, "runs do not stay with the reference: poses say nothing");
    type.def_readonly("size", &R::size, "m, mean size of the moving bodies");
    type.def_readonly("duration", &R::duration, "s");
    type.def_readonly("points", &R::points);
    type.def_readonly("base", &R::base, "index of the point that changes start from");
    type.def_readonly("changes", &R::changes, "the largest gain first");
    type.def_readonly("advice", &R::advice);
    type.def_readonly("problems", &R::problems, "members that failed or are not complete");
    type.def_readonly("remarks", &R::remarks);
    type.def_readonly("members", &R::members);
    type.def_readonly("complete", &R::complete);
    type.def_readonly("stopped", &R::stopped, "some member can go on");
    type.def_readonly("exit_code", &R::exit_code, "of the command");
}

/// run(member) gives (exit code, reason, CPU seconds).
SweepReport sweep(const std::vector<std::string>& scenes, const std::filesystem::path& output,
                  const std::vector<std::pair<std::string, std::vector<std::string>>>& vary, int bodies,
                  const std::string& preset, const std::vector<std::pair<std::string, std::string>>& settings,
                  const std::string& reference, const std::vector<std::string>& metrics, std::int64_t steps,
                  double duration, int threads, int jobs, bool overwrite, bool resume,
                  const std::function<std::tuple<int, std::string, double>(const SweepMember&)>& run,
                  const std::function<void(std::size_t, std::size_t, const std::string&)>& progress,
                  const std::function<void(const std::string&)>& note) {
    SweepOptions options;
    options.scenes = scenes;
    options.output = output;
    for (const auto& [key, values] : vary) options.vary.push_back({key, values});
    options.bodies = bodies;
    options.preset = preset;
    options.overrides = settings;
    options.reference = reference;
    options.metrics = metrics;
    options.steps = steps;
    options.duration = duration;
    options.threads = threads;
    options.jobs = jobs;
    options.overwrite = overwrite;
    options.resume = resume;
    options.command_line = {"flotilla.sweep"};
    options.run = [&run](const SweepMember& member) {
        const auto [code, reason, cpu] = run(member);
        return SweepOutcome{code, reason, cpu};
    };
    options.stop = [] {
        const py::gil_scoped_acquire locked;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        return false;
    };
    options.progress = progress;
    options.note = note;
    const py::gil_scoped_release unlocked;
    return run_sweep(options);
}

} // namespace

void bind_sweep(py::module_& m) {
    bind_member(m);
    bind_tables(m);
    bind_report(m);
    m.def(
        "sweep_metrics",
        [] {
            const auto metrics = sweep_metrics();
            return std::vector<SweepMetric>(metrics.begin(), metrics.end());
        },
        "Every metric, in the order of the tables.");
    m.def("_sweep", &sweep, py::arg("scenes"), py::arg("output"), py::arg("vary"), py::arg("bodies"), py::arg("preset"),
          py::arg("settings"), py::arg("reference"), py::arg("metrics"), py::arg("steps"), py::arg("duration"),
          py::arg("threads"), py::arg("jobs"), py::arg("overwrite"), py::arg("resume"), py::arg("run"),
          py::arg("progress"), py::arg("note"));
}

} // namespace flotilla::python
