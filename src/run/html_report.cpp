// SPDX-License-Identifier: MIT
#include <flotilla/html_report.hpp>

#include <cmath>

#include <flotilla/error.hpp>

#include "base/floating_point.hpp"
#include "parallel/threads.hpp"
#include "report/html_report.hpp"
#include "report/tables.hpp"
#include "run_folder/run_folder.hpp"

namespace flotilla {
namespace {

using report::Verification;

constexpr std::size_t kFaultsShown = 20;

Verification not_verified(const std::filesystem::path& folder) {
    return {Verification::Verdict::not_verified, "not verified; run: flotilla verify " + folder.string(), {}, {}};
}

Verification::Verdict verdict_of(const VerifyReport& r) {
    if (!r.proved()) return Verification::Verdict::failed;
    if (!r.unreadable.empty()) return Verification::Verdict::incomplete;
    return r.frames > 0 ? Verification::Verdict::proved : Verification::Verdict::not_verified;
}

std::string verdict_text(const VerifyReport& r) {
    switch (verdict_of(r)) {
    case Verification::Verdict::not_verified: return "there is no frame to verify";
    case Verification::Verdict::failed: return "FAILED: bodies intersect, or could not be proved apart";
    case Verification::Verdict::incomplete: return "incomplete: part of the run cannot be read";
    case Verification::Verdict::proved: break;
    }
    if (r.motions == 0) return "free of intersections in every frame; the motion between frames was not checked";
    if (r.motions_skipped > 0) return "free of intersections in every frame, and where the motion was checked";
    return "free of intersections in every frame and between frames";
}

Verification verification_of(const VerifyReport& r) {
    Verification v{verdict_of(r), verdict_text(r), {}, {}};
    const auto count = [&v](const char* label, std::int64_t value) {
        v.rows.emplace_back(label, std::to_string(value));
    };
    count("frames checked", r.frames);
    count("motions between frames checked", r.motions);
    if (r.motions_skipped > 0) count("motions not checked", r.motions_skipped);
    count("body pairs examined in frames", r.pairs);
    count("body pairs examined in motion", r.motion_pairs);
    count("intersecting pairs", r.intersecting_pairs);
    count("pairs passing through each other", r.crossing_pairs);
    count("pairs not proved apart", r.unproved_pairs);
    count("bad poses", r.bad_poses);
    if (std::isfinite(r.smallest_distance))
        v.rows.emplace_back("smallest distance in a frame", report::short_number(r.smallest_distance) + " m (frame " +
                                                                std::to_string(r.smallest_distance_frame) + ", \"" +
                                                                r.smallest_distance_a + "\" and \"" +
                                                                r.smallest_distance_b + "\")");
    v.rows.emplace_back("time of the proof", report::short_number(r.seconds) + " s");
    for (const auto& note : r.notes) v.rows.emplace_back("note", note);
    for (std::size_t i = 0; i < r.faults.size() && i < kFaultsShown; ++i) v.faults.push_back(to_string(r.faults[i]));
    return v;
}

} // namespace

HtmlReport write_html_report(const std::filesystem::path& folder, const std::filesystem::path& output,
                             const HtmlReportOptions& options) {
    const DefaultFloatingPoint environment;
    if (options.frame_every < 0) throw InputError("report: frame_every must not be negative");
    const int threads = options.verification.threads;
    if (threads < 0) throw InputError(std::to_string(threads) + " threads: must be one or more, or 0 for the default");
    io::RunReader run(folder); // a folder that is none is known before the proof
    HtmlReport result;
    if (options.verify) result.verification = verify_run(folder, options.verification);
    const auto page =
        report::write_page(run, result.verification ? verification_of(*result.verification) : not_verified(folder),
                           options.frame_every, threads > 0 ? threads : free_threads(), output);
    result.frames = run.frames();
    result.frames_shown = page.frames_shown;
    result.position_error = page.position_error;
    result.rotation_error = page.rotation_error;
    result.bytes = page.bytes;
    result.problems = page.problems;
    return result;
}

} // namespace flotilla
