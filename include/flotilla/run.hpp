// SPDX-License-Identifier: MIT
// A whole run: a scene simulated into a run folder.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <flotilla/edit.hpp>
#include <flotilla/report.hpp>
#include <flotilla/scene.hpp>
#include <flotilla/world.hpp>

namespace flotilla {

struct RunTotals;

struct RunOptions {
    std::filesystem::path output; ///< run folder; empty: nothing is written
    bool overwrite = false;       ///< replace what an earlier run left in the folder
    /// Go on from the last checkpoint in the folder, with the bits of a run that was never interrupted; from the
    /// beginning where there is none. Needs the same scene, settings and frame_every; a run with `unsatisfiable_script:
    /// error` may go on with `hold`.
    bool resume = false;
    std::int64_t steps = 0; ///< total, the steps before a resumption included
    int frame_every = 1;    ///< steps per frame, >= 1
    /// Steps per checkpoint; 0: 100, and at least one in five minutes. The last step has one in any case.
    int checkpoint_every = 0;
    WorldOptions world; ///< threads and their use
    std::vector<std::string> command_line;
    /// The scene file's text, for the record; where it names mesh files the folder gets the scene with their vertices.
    std::string scene_json;
    /// Where the executed tasks are recorded (flotilla/trace.hpp reads it); empty: nowhere. Written when the run ends,
    /// compressed where the name ends with .gz.
    std::filesystem::path trace;
    int trace_every = 1; ///< steps per recorded step; a step of many bodies in impact has 100,000 tasks of 30 bytes
    /// Where the contact points of every step and their impulses are written as CSV (run_folder/contacts_csv.hpp);
    /// empty: nowhere. There when the run ends, compressed where the name ends with .gz. A resumed run goes on with
    /// the file of the same name, that of a run that was killed too (FILE.tmp); where it is gone `note` is told from
    /// which step on there are contacts, and another file is refused with InputError.
    std::filesystem::path contacts;
    /// Made on the way, sorted by step: each after so many steps. What is refused ends the run with InputError or
    /// OverlapError, once what came before is written with a checkpoint. A resumed run needs the same.
    std::vector<Edit> edits;
    /// Called with the World that the run steps, before its first step; may be empty.
    std::function<void(World&)> begun;
    /// Called after every step; returning false ends the run early. Where there is a folder, the run can then be
    /// resumed. What this or another callback throws comes out of run_scene as it is, and leaves the folder like a run
    /// that was killed: whole, to be resumed.
    std::function<bool(const StepReport&)> after_step;
    /// Called with what was done, before run_scene throws ScriptError; may be empty.
    std::function<void(const RunTotals&)> blocked;
    /// Called with what the user should know, one line each; may be empty.
    std::function<void(const std::string&)> note;
};

/// Sums over a run, or over its part since it was resumed.
struct RunTotals {
    std::int64_t steps = 0;
    std::int64_t resumed_after = 0; ///< steps that were there already
    bool complete = false;          ///< false: after_step or a script ended it
    std::int64_t bodies = 0;
    double total_ms = 0, worst_ms = 0; ///< wall time in steps; of the slowest
    double output_ms = 0;              ///< wall time that steps waited for what is written into the run folder
    std::array<double, kNumPhases> phase_ms{};
    std::int64_t collisions = 0, merges = 0, rung_changes = 0, held = 0;
    std::int64_t above_tolerance = 0;    ///< steps in which a contact solve ended above its tolerance
    std::int64_t energy_corrections = 0; ///< islands that the last resort of G5 took energy from
    double energy_removed = 0;           ///< J, that it took
    double min_distance = std::numeric_limits<double>::infinity(); ///< m
    StepReport last;
    std::int64_t traced_steps = 0; ///< in RunOptions::trace
    std::vector<ThreadReport> threads;
};

/// Simulates `scene`; `source` names it in messages. Throws InputError, OverlapError, BrokenPromise, IoError or, once
/// the steps before are written with a checkpoint, ScriptError; what was written before stays readable.
[[nodiscard]] RunTotals run_scene(const SceneDescription& scene, const std::string& source, const RunOptions& options);

} // namespace flotilla
