// SPDX-License-Identifier: MIT
// Scripts of Rigid-IPC's kinematic bodies as keyframes. All in one frame of reference, whichever it is.
#pragma once

#include <span>
#include <vector>

#include <flotilla/scene.hpp>

#include "mesh/triangle_mesh.hpp"

namespace flotilla::io {

struct Pose {
    Vec3 position; ///< of the mesh's origin
    Quat rotation;
};

struct ConstantMotion {
    Vec3 velocity;         ///< m/s, of the centre of mass
    Vec3 angular_velocity; ///< rad/s, about it, axes of the world
};

/// Keyframes until `end`: two where the body does not turn, else one a `step`, because a place off the centre moves on
/// an arc.
[[nodiscard]] std::vector<Keyframe> constant_motion_keyframes(const Pose& start, const ConstantMotion& motion,
                                                              const Vec3& center_of_mass, double step, double end);

/// A pose as Rigid-IPC keeps it: of the centre of mass, and of the frame of the principal axes that the body starts
/// with.
struct PrincipalPose {
    Vec3 position;
    Vec3 rotation; ///< rotation vector, rad
};

/// The principal axes that a closed mesh starts with, as columns: in the order and with the signs that Eigen's solver
/// gives the inertia in the world's axes, for Rigid-IPC stores them nowhere.
struct PrincipalFrame {
    Quat axes;           ///< turns the principal frame into the world's
    Vec3 center_of_mass; ///< mesh coordinates
    bool unique = true;  ///< no two of the moments are equal, so that the axes are the mesh's own
};
[[nodiscard]] PrincipalFrame principal_frame(const TriangleMesh& mesh, const Quat& rotation);

/// The pose of the mesh's origin.
[[nodiscard]] Pose pose_of(const PrincipalPose& pose, const PrincipalFrame& frame, const Quat& start);

/// Keyframes of `start` at time 0 and one pose at the end of each step, as far as `end`.
[[nodiscard]] std::vector<Keyframe> pose_keyframes(const Pose& start, std::span<const PrincipalPose> poses,
                                                   const PrincipalFrame& frame, double step, double end);

} // namespace flotilla::io
