// SPDX-License-Identifier: MIT
// Independent proof that a recorded trajectory is free of intersections: every frame with exact predicates, and the
// motion between successive frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <flotilla/types.hpp>

namespace flotilla {

/// Between which frames the motion is checked.
enum class VerifyMotion : std::uint8_t {
    automatic, ///< where the frames are one time step apart; the others are checked as states only, and counted
    always,
    never,
};

struct VerifyOptions {
    int threads = 0; ///< 0: FLOTILLA_NUM_THREADS, OMP_NUM_THREADS or all cores; negative: InputError
    VerifyMotion motion = VerifyMotion::automatic;
    bool distance = true;                 ///< measure the smallest distance of each frame
    std::size_t max_faults = 1000;        ///< faults kept in the report; all are counted
    std::function<void(double)> progress; ///< called with the part done, [0, 1], after every frame; may be empty
};

struct VerifyFault {
    enum class Kind : std::uint8_t {
        intersection, ///< two bodies intersect in a frame
        crossing,     ///< two bodies intersect between two frames
        unproved,     ///< two bodies could not be proved apart between two frames
        bad_pose,     ///< a pose that is not finite, or no rotation
        bad_path,     ///< a recorded turn that does not lead to the next frame
    };
    Kind kind = Kind::intersection;
    std::int64_t frame = 0; ///< the frame, or the one before the motion
    double time = 0;        ///< s
    std::int32_t body_a = -1, body_b = -1;
    std::string name_a, name_b;
    std::int32_t triangle_a = -1, triangle_b = -1;
    std::int64_t triangle_pairs = 0; ///< of an intersection
    Vec3 place;                      ///< m
    std::string reason;              ///< of a bad pose or path
};
/// One line, for people.
[[nodiscard]] std::string to_string(const VerifyFault& fault);

struct VerifyReport {
    std::int64_t bodies = 0;
    std::int64_t frames = 0;          ///< checked
    std::int64_t motions = 0;         ///< intervals between frames checked
    std::int64_t motions_skipped = 0; ///< intervals not checked: states only
    std::int64_t pairs = 0;           ///< body pairs examined in frames, all frames together
    std::int64_t motion_pairs = 0;    ///< body pairs examined between frames
    std::int64_t triangle_pairs = 0;  ///< triangle pairs tested exactly or swept
    std::int64_t intersecting_pairs = 0;
    std::int64_t crossing_pairs = 0;
    std::int64_t unproved_pairs = 0;
    std::int64_t bad_poses = 0; ///< bad poses and bad paths
    std::vector<VerifyFault> faults;
    std::vector<std::string> unreadable; ///< frames that could not be read, one message each file or frame
    std::vector<std::string> notes;      ///< what was not checked, and why

    double smallest_distance = std::numeric_limits<double>::infinity(); ///< m, over all frames
    std::int64_t smallest_distance_frame = -1;
    std::string smallest_distance_a, smallest_distance_b; ///< names of the bodies
    double seconds = 0;                                   ///< wall time

    /// Everything that was read is proved free of intersections.
    [[nodiscard]] bool proved() const { return intersecting_pairs + crossing_pairs + unproved_pairs + bad_poses == 0; }
};

/// Checks a run folder along the paths that it records, inner step by inner step where its steps have some. IoError
/// where it is no run folder; damaged segments are listed in the report and the rest is checked.
[[nodiscard]] VerifyReport verify_run(const std::filesystem::path& folder, const VerifyOptions& options = {});

/// Checks a trajectory in the CSV export format against a scene. Rotations between frames are taken as the shortest
/// arcs, vertices move straight unless the scene's `trajectory` is rigid; with `substeps` the motion is not known.
/// InputError where scene or file are not valid.
[[nodiscard]] VerifyReport verify_poses(const std::filesystem::path& scene, const std::filesystem::path& poses,
                                        const VerifyOptions& options = {});

} // namespace flotilla
