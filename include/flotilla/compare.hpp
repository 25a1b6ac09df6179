// SPDX-License-Identifier: MIT
// Where two recorded runs part: the first step, stage and body whose bits differ.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace flotilla {

/// A value that the two runs do not share, as text. Empty where a run does not have it.
struct ComparedValue {
    std::string name; ///< "settings/friction", "collisions"
    std::string a, b;
};

/// A step whose rows in steps.csv differ. Times are not compared, nor what DifferentWork has.
struct DifferentStep {
    std::int64_t step = 0;
    double time = 0;                    ///< s
    bool state = false;                 ///< the state hashes differ
    std::vector<ComparedValue> columns; ///< those that differ, state_hash included, in the order of the file
    /// The earliest stage that a counter of this step speaks of, and those counters; empty where only the state
    /// differs. A stage before it may differ too: a counter is no hash.
    std::string stage;
};

/// A step whose count of examined pairs differs (StepReport::pairs). It goes by what is remembered of pairs, which a
/// run that was resumed, or a restored World, finds anew: no bit of the motion depends on it.
struct DifferentWork {
    std::int64_t step = 0;
    std::vector<ComparedValue> columns;
};

/// By how much a body differs between two frames of the same step.
struct BodyDifference {
    std::int32_t body = -1;
    std::string name;
    double position = 0;         ///< m, of the mesh's origin
    double rotation = 0;         ///< rad, the angle from one to the other
    double velocity = 0;         ///< m/s, of the centre of mass
    double angular_velocity = 0; ///< rad/s
    bool activity = false;       ///< its recorded contacts, cluster state or cost differ (where both runs have them)
};

/// A frame that both runs have and that differs.
struct DifferentFrame {
    std::int64_t step = 0;
    std::int64_t frame_a = 0, frame_b = 0; ///< numbers in their runs
    double time = 0;                       ///< s
    std::int64_t bodies = 0;               ///< how many differ
    BodyDifference first;                  ///< the lowest body that differs
    BodyDifference farthest; ///< the body with the largest difference in position, the lowest of equal ones
};

struct CompareReport {
    /// What the bits of a run depend on (scene and settings), and the rest of the record (machine, threads, version,
    /// ...).
    std::vector<ComparedValue> inputs, record;
    bool same_bodies = true; ///< number, names, types and meshes; frames are compared only then

    std::int64_t steps_a = 0, steps_b = 0;    ///< rows of steps.csv
    std::int64_t steps_compared = 0;          ///< of the steps that both have
    std::int64_t last_step = 0;               ///< the last of these
    std::optional<DifferentStep> first_step;  ///< with any difference
    std::optional<DifferentStep> first_state; ///< whose state hash differs
    std::optional<DifferentWork> first_work;  ///< before that; it is no difference in bits

    std::int64_t frames_a = 0, frames_b = 0;
    std::int64_t frames_compared = 0; ///< of the steps of which both have a frame
    std::int64_t last_frame_step = 0; ///< the last of these steps
    std::optional<DifferentFrame> first_frame;
    std::optional<DifferentFrame> last_frame; ///< the last frame that both have, where it differs

    std::vector<std::string> unreadable; ///< frames that could not be read, one message each file or frame

    [[nodiscard]] bool same_inputs() const { return inputs.empty() && same_bodies; }
    [[nodiscard]] bool same_bits() const { return same_bodies && !first_step && !first_frame; }
    /// Both runs were asked for the same and gave different bits.
    [[nodiscard]] bool promise_broken() const { return same_inputs() && !same_bits(); }
};

/// Compares what the folders of two runs, finished or not, have in common. IoError where one is no run folder.
[[nodiscard]] CompareReport compare_runs(const std::filesystem::path& a, const std::filesystem::path& b);

} // namespace flotilla
