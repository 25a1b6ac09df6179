// SPDX-License-Identifier: MIT
// Proofs of recorded runs, and reports that show them.
#include <flotilla/html_report.hpp>
#include <flotilla/verify.hpp>

#include "python/bind.hpp"

namespace flotilla::python {
namespace {

constexpr std::array<std::string_view, 3> kMotions{"automatic", "always", "never"};
constexpr std::array<std::string_view, 5> kFaults{"intersection", "crossing", "unproved", "bad_pose", "bad_path"};

VerifyOptions options_of(int threads, const std::string& motion, bool distance, std::size_t max_faults,
                         const std::function<void(double)>& progress) {
    return {.threads = threads,
            .motion = choice<VerifyMotion>("motion", motion, kMotions),
            .distance = distance,
            .max_faults = max_faults,
            .progress = progress};
}

VerifyReport verify(const std::filesystem::path& source, const std::filesystem::path& poses, int threads,
                    const std::string& motion, bool distance, std::size_t max_faults,
                    const std::function<void(double)>& progress) {
    const VerifyOptions options = options_of(threads, motion, distance, max_faults, progress);
    const py::gil_scoped_release unlocked;
    return poses.empty() ? verify_run(source, options) : verify_poses(source, poses, options);
}

void bind_fault(py::module_& m) {
    using F = VerifyFault;
    auto type = value_class<F>(m, "VerifyFault", "One thing that could not be proved; str() says it in a line.");
    type.def_property_readonly(
        "kind", [](const F& f) { return kFaults[static_cast<std::size_t>(f.kind)]; },
        "intersection, crossing, unproved, bad_pose or bad_path");
    type.def_readonly("frame", &F::frame, "the frame, or the one before the motion");
    type.def_readonly("time", &F::time, "s");
    type.def_readonly("body_a", &F::body_a, "index");
    type.def_readonly("body_b", &F::body_b, "index");
    type.def_readonly("name_a", &F::name_a);
    type.def_readonly("name_b", &F::name_b);
    type.def_readonly("triangle_a", &F::triangle_a);
    type.def_readonly("triangle_b", &F::triangle_b);
    type.def_readonly("triangle_pairs", &F::triangle_pairs, "of an intersection");
    type.def_readonly("place", &F::place, "m, shape (3)");
    type.def_readonly("reason", &F::reason, "of a bad pose or path");
    type.def("__str__", [](const F& f) { return to_string(f); });
}

void bind_report(py::module_& m) {
    using R = VerifyReport;
    auto type = value_class<R>(m, "VerifyReport", "What a proof looked at, and what it found.");
    type.def_property_readonly("proved", &R::proved, "everything that was read is free of intersections");
    type.def_readonly("bodies", &R::bodies);
    type.def_readonly("frames", &R::frames, "checked");
    type.def_readonly("motions", &R::motions, "intervals between frames checked");
    type.def_readonly("motions_skipped", &R::motions_skipped, "intervals not checked: states only");
    type.def_readonly("pairs", &R::pairs, "body pairs examined in frames");
    type.def_readonly("motion_pairs", &R::motion_pairs, "body pairs examined between frames");
    type.def_readonly("triangle_pairs", &R::triangle_pairs, "tested exactly or swept");
    type.def_readonly("intersecting_pairs", &R::intersecting_pairs);
    type.def_readonly("crossing_pairs", &R::crossing_pairs);
    type.def_readonly("unproved_pairs", &R::unproved_pairs);
    type.def_readonly("bad_poses", &R::bad_poses);
    type.def_readonly("faults", &R::faults, "a VerifyFault each");
    type.def_readonly("unreadable", &R::unreadable, "frames that could not be read, messages");
    type.def_readonly("notes", &R::notes, "what was not checked, and why");
    type.def_readonly("smallest_distance", &R::smallest_distance, "m, over all frames");
    type.def_readonly("smallest_distance_frame", &R::smallest_distance_frame);
    type.def_readonly("smallest_distance_a", &R::smallest_distance_a, "name of the body");
    type.def_readonly("smallest_distance_b", &R::smallest_distance_b, "name of the body");
    type.def_readonly("seconds", &R::seconds, "wall time");
}

void bind_page(py::module_& m) {
    using R = HtmlReport;
    auto type = value_class<R>(m, "HtmlReport", "What a page of a run holds.");
    type.def_readonly("frames", &R::frames, "of the run");
    type.def_readonly("frames_shown", &R::frames_shown, "in the page");
    type.def_readonly("position_error", &R::position_error, "m, largest of a drawn body");
    type.def_readonly("rotation_error", &R::rotation_error, "rad, largest of a drawn body");
    type.def_readonly("bytes", &R::bytes, "of the file");
    type.def_readonly("problems", &R::problems, "what cannot be read");
    type.def_readonly("verification", &R::verification, "VerifyReport, or None");
    m.def(
        "write_report",
        [](const std::filesystem::path& folder, const std::filesystem::path& output, bool verify, int threads,
           std::int64_t frame_every) {
            HtmlReportOptions options;
            options.verify = verify;
            options.frame_every = frame_every;
            options.verification.threads = threads;
            const py::gil_scoped_release unlocked;
            return write_html_report(folder, output, options);
        },
        py::arg("folder"), py::arg("output"), py::kw_only(), py::arg("verify") = false, py::arg("threads") = 0,
        py::arg("frame_every") = 0,
        "Writes a run as one HTML file: animation, plots, tables. verify proves the run first; frame_every: frames of "
        "the run per frame "
        "of the page, 0: as few as keep it small.");
}

} // namespace

void bind_verify(py::module_& m) {
    bind_fault(m);
    bind_report(m);
    bind_page(m);
    m.def("verify", &verify, py::arg("source"), py::arg("poses") = "", py::kw_only(), py::arg("threads") = 0,
          py::arg("motion") = "automatic", py::arg("distance") = true, py::arg("max_faults") = 1000,
          py::arg("progress") = py::none(),
          "Proves every frame of a run folder, and the motion between frames, free of intersections, and returns a "
          "VerifyReport. With "
          "`poses`, a CSV as export_run writes, `source` is a scene file. motion: automatic, always or never; "
          "distance: measure the "
          "smallest of each frame; max_faults: kept in the report, all are counted; progress(part) is called after "
          "every frame.");
}

} // namespace flotilla::python
