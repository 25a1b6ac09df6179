// SPDX-License-Identifier: MIT
// Scripted bodies: keyframes with linear position and shortest-arc slerp; the last one holds.
//
// A body that something stops (failsafe.hpp) is behind its script. With `unsatisfiable_script: hold` the script's clock
// waits for it. It does not push on with all its speed in every step: solves would ask for what nothing can give, and
// the failsafe would hold all around. It tries again more and more rarely and slowly, by how often it was stopped of
// late (ScriptClock), and stands still in between, pressing on what is in its way (targets.cpp). With `follow` the
// clock goes on, and the body makes for the latest place on its path, between the one it made for last and the one that
// is due, that is within a step's reach at twice the script's fastest speed: it catches up along the path, and where
// the path comes back to where it stands (jaws that open again) it goes on from there. With `error` no body ever is
// behind.
//
// Over a step a body goes with its mean velocity. At the end of the step, in stage 7, it has one between that and the
// next step's, that of its path to second order: what stands on a body that accelerates evenly is so asked for half of
// the change in stage 7 and for the other half in the next stage 3, which have half of a step's friction and gravity
// each. With the mean velocity in stage 7 as well stage 3 would be asked for all of it. A body that starts at once, or
// stops, does so between two steps: stage 7 changes its velocity by no more than it changed from the step before to
// this one, and in stage 1 of the next it strikes with all of its speed.
#pragma once

#include <exception>
#include <span>
#include <utility>

#include "failsafe/failsafe.hpp"

namespace flotilla {

/// Pose of a scripted body when its own clock shows `time` (s).
[[nodiscard]] Pose scripted_pose(const RigidShape& shape, const Body& body, double time);

/// m/s, that no point of the body exceeds by its script.
[[nodiscard]] double fastest_speed(const RigidShape& shape, const Body& body);

/// The latest of the times in (from, to], to 1/64 of `reach`, at which no point of the body is farther than `reach`, m,
/// from where it is at `pose`, by its script; else `from`. Looks at no more than 64 places for every `reach` of the
/// path's length, and one a keyframe.
[[nodiscard]] double latest_within(const RigidShape& shape, const Body& body, const Pose& pose, double from, double to,
                                   double reach);

/// Thrown where scripts cannot make a step in full and the settings ask for an error.
struct BlockedScripts : std::exception {
    explicit BlockedScripts(std::vector<DelayedScript> blocked) : scripts(std::move(blocked)) {}
    std::vector<DelayedScript> scripts; ///< ascending
};

class Scripts {
  public:
    explicit Scripts(const Model& model);

    [[nodiscard]] bool any() const { return !scripted_.empty(); }

    /// Gives every scripted body its motion in the step.
    void move(const Model& model, const State& state, Trajectories& trajectories, Clusters& clusters);
    /// Whether one goes by less than its script in this step, since it was stopped of late.
    [[nodiscard]] bool waits() const { return waiting_ > 0; }
    /// By body, of scripted ones: the motion that it would have in this step if none had stopped it of late; its
    /// momentum stands for the angular velocity, rad/s.
    [[nodiscard]] std::span<const Motion> due_motion() const { return due_motion_; }
    /// Gives every scripted body in `motion`, and in due_motion(), its velocity at the end of the step in place of the
    /// mean one; not those that something stops. Once in a step, after stage 5.
    void reach_end(const Model& model, const State& state, std::span<Motion> motion);
    /// What the step leaves of it for the next, before the step is counted.
    void commit(const Model& model, const FailsafeStats& failsafe, State& state) const;

  private:
    std::vector<std::int32_t> scripted_; ///< bodies
    std::vector<double> speed_;          ///< m/s, fastest, by body; empty: nothing follows
    int waiting_ = 0;                    ///< bodies, in this step
    std::vector<double> due_;            ///< s, by body: when the place that it makes for was or is due
    std::vector<Motion> due_motion_;     ///< by body
};

} // namespace flotilla
