// SPDX-License-Identifier: MIT
#include "io/rigid_ipc_script.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

#include "base/rotation.hpp"
#include "base/vec3.hpp"
#include "mesh/mass_properties.hpp"

namespace flotilla::io {

namespace {

// Moments that differ by less are equal but for rounding: a symmetric mesh of coordinates with seven digits.
constexpr double kEqualMoments = 1e-6;

using Matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

} // namespace

std::vector<Keyframe> constant_motion_keyframes(const Pose& start, const ConstantMotion& motion,
                                                const Vec3& center_of_mass, double step, double end) {
    const Vec3 center = start.position + rotate(start.rotation, center_of_mass);
    const auto at = [&](double time) {
        const Quat q = normalized(rotation_from_vector(time * motion.angular_velocity) * start.rotation);
        return Keyframe{time, center + time * motion.velocity - rotate(q, center_of_mass), q};
    };
    std::vector<Keyframe> keyframes{{0, start.position, start.rotation}};
    if (motion.angular_velocity == Vec3{}) {
        if (end > 0 && motion.velocity != Vec3{})
            keyframes.push_back({end, start.position + end * motion.velocity, start.rotation});
        return keyframes;
    }
    const auto steps = static_cast<std::int64_t>(std::ceil(end / step - 1e-9));
    for (std::int64_t k = 1; k <= steps; ++k) keyframes.push_back(at(static_cast<double>(k) * step));
    return keyframes;
}

PrincipalFrame principal_frame(const TriangleMesh& mesh, const Quat& rotation) {
    const MassProperties solid = solid_mass_properties(mesh, 1, "kinematic");
    const Mat3 r = matrix(rotation), world = r * solid.inertia * transpose(r);
    Matrix inertia = Eigen::Map<const Matrix>(world.m.data());
    // As Rigid-IPC does: what rounding left beside a diagonal must not turn the axes.
    const double largest = inertia.cwiseAbs().maxCoeff();
    inertia = (inertia.array().abs() > largest * 1e-16).select(inertia, 0.0);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver{Eigen::Matrix3d(inertia)};
    Matrix axes = solver.eigenvectors();
    if (axes.determinant() < 0) axes.col(0) *= -1;
    Mat3 columns;
    Eigen::Map<Matrix>(columns.m.data()) = axes;
    const Eigen::Vector3d moments = solver.eigenvalues();
    const bool unique =
        moments[1] - moments[0] > kEqualMoments * moments[2] && moments[2] - moments[1] > kEqualMoments * moments[2];
    return {quaternion(columns), solid.center_of_mass, unique};
}

Pose pose_of(const PrincipalPose& pose, const PrincipalFrame& frame, const Quat& start) {
    const Quat q = normalized(rotation_from_vector(pose.rotation) * conjugate(frame.axes) * start);
    return {pose.position - rotate(q, frame.center_of_mass), q};
}

std::vector<Keyframe> pose_keyframes(const Pose& start, std::span<const PrincipalPose> poses,
                                     const PrincipalFrame& frame, double step, double end) {
    std::vector<Keyframe> keyframes{{0, start.position, start.rotation}};
    for (std::size_t k = 0; k < poses.size() && static_cast<double>(k) * step < end; ++k) {
        const Pose pose = pose_of(poses[k], frame, start.rotation);
        keyframes.push_back({static_cast<double>(k + 1) * step, pose.position, pose.rotation});
    }
    return keyframes;
}

} // namespace flotilla::io
