// SPDX-License-Identifier: MIT
// flotilla compare: where two runs part.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <flotilla/compare.hpp>

#include "cli/commands.hpp"

namespace flotilla::cli {
namespace {

constexpr std::size_t kValuesShown = 20;

void print_values(const std::vector<ComparedValue>& values) {
    const auto or_none = [](const std::string& text) { return text.empty() ? "(none)" : text; };
    for (std::size_t i = 0; i < std::min(values.size(), kValuesShown); ++i)
        std::cout << "  " << values[i].name << ": " << or_none(values[i].a) << " | " << or_none(values[i].b) << "\n";
    if (values.size() > kValuesShown) std::cout << "  and " << values.size() - kValuesShown << " more\n";
}

void print_inputs(const CompareReport& r) {
    std::cout << "scene and settings:   " << (r.same_inputs() ? "the same" : "different") << "\n";
    print_values(r.inputs);
    if (!r.same_bodies) std::cout << "  bodies or meshes differ: frames are not compared\n";
    if (r.record.empty()) return;
    std::cout << "rest of the record:   different\n";
    print_values(r.record);
}

/// "A has 40 more" where one run is longer.
std::string longer(std::int64_t a, std::int64_t b) {
    if (a == b) return "";
    return (a > b ? "; A has " : "; B has ") + std::to_string(std::abs(a - b)) + " more";
}

void print_step(const char* title, const DifferentStep& s) {
    std::cout << title << s.step << ", t = " << s.time << " s; columns that differ (A | B):\n";
    print_values(s.columns);
    std::cout << "earliest sign of it:  "
              << (s.stage.empty() ? "none: no counter of a stage differs, only what the step ends with" : s.stage)
              << "\n";
}

void print_steps(const CompareReport& r) {
    std::cout << "steps compared:       " << r.steps_compared;
    if (r.steps_compared > 0) std::cout << ", up to step " << r.last_step;
    std::cout << longer(r.steps_a, r.steps_b) << "\n";
    if (r.first_work) {
        std::cout << "work:                 differs first in step " << r.first_work->step
                  << ", by what was known of pairs; no bits (A | B):\n";
        print_values(r.first_work->columns);
    }
    if (!r.first_step) return;
    print_step("first step:           ", *r.first_step);
    if (r.first_step->state) return;
    std::cout << "its state hashes are equal";
    if (!r.first_state) {
        std::cout << ", and so are those of all later steps\n";
        return;
    }
    std::cout << "\n";
    print_step("first state:          ", *r.first_state);
}

void print_body(const char* title, const BodyDifference& d) {
    std::cout << title << d.body << " \"" << d.name << "\" differs by " << d.position << " m, " << d.rotation
              << " rad, " << d.velocity << " m/s, " << d.angular_velocity << " rad/s"
              << (d.activity ? "; contacts, cluster or cost differ\n" : "\n");
}

void print_frame(const char* title, const DifferentFrame& f) {
    std::cout << title << f.frame_a;
    if (f.frame_b != f.frame_a) std::cout << " of A, " << f.frame_b << " of B";
    std::cout << " (step " << f.step << ", t = " << f.time << " s), " << f.bodies
              << (f.bodies == 1 ? " body differs\n" : " bodies differ\n");
    print_body("  the first:          body ", f.first);
    print_body("  the farthest:       body ", f.farthest);
}

void print_frames(const CompareReport& r) {
    if (!r.same_bodies) return;
    std::cout << "frames compared:      " << r.frames_compared;
    if (r.frames_compared > 0) std::cout << ", up to step " << r.last_frame_step;
    std::cout << longer(r.frames_a, r.frames_b) << "\n";
    if (r.first_frame) print_frame("first frame:          ", *r.first_frame);
    if (r.last_frame)
        print_frame("last common frame:    ", *r.last_frame);
    else if (r.first_frame)
        std::cout << "last common frame:    equal\n";
}

int verdict(const CompareReport& r) {
    std::cout << "verdict:              ";
    if (r.promise_broken()) {
        std::cout << "DIFFERENT BITS from the same scene and settings\n";
        return kBrokenPromise;
    }
    if (!r.unreadable.empty()) {
        std::cout << "incomplete: part of a run cannot be read\n";
        return kIoFailure;
    }
    if (!r.same_bits())
        std::cout << "different bits from different scenes or settings\n";
    else if (r.steps_compared + r.frames_compared == 0)
        std::cout << "nothing in common to compare\n";
    else
        std::cout << "the same bits" << (r.steps_a == r.steps_b ? "\n" : " as far as both runs go\n");
    return kOk;
}

int run_compare(const std::string& a, const std::string& b) {
    const CompareReport report = compare_runs(a, b);
    for (const auto& message : report.unreadable) std::cerr << "flotilla: " << message << '\n';
    std::cout << "A:                    " << a << "\nB:                    " << b << "\n";
    print_inputs(report);
    print_steps(report);
    print_frames(report);
    return verdict(report);
}

} // namespace

void register_compare(CLI::App& app, Action& action) {
    const auto folders = std::make_shared<std::pair<std::string, std::string>>();
    CLI::App* command = app.add_subcommand("compare", "Find the first step, stage and body that differ between two "
                                                      "runs; exit code 3 where scene and settings are the "
                                                      "same and bits are not");
    command->add_option("A", folders->first, "Run folder")->required();
    command->add_option("B", folders->second, "Run folder")->required();
    command->callback(
        [folders, &action] { action = [folders] { return run_compare(folders->first, folders->second); }; });
}

} // namespace flotilla::cli
