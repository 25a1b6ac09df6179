// SPDX-License-Identifier: MIT
#include "step/scripts.hpp"

#include <algorithm>

namespace flotilla {
namespace {

Quat slerp(const Quat& from, const Quat& to, double t) {
    const Vec3 turn = rotation_vector(to * conjugate(from));
    return normalized(rotation_from_vector(t * turn) * from);
}

} // namespace

Pose scripted_pose(const RigidShape& shape, const Body& body, double time) {
    const auto& keys = body.keyframes;
    const auto after =
        std::upper_bound(keys.begin(), keys.end(), time, [](double t, const Keyframe& k) { return t < k.time; });
    if (after == keys.begin()) return pose_at_origin(shape, keys.front().position, keys.front().rotation);
    const Keyframe& from = *(after - 1);
    if (after == keys.end()) return pose_at_origin(shape, from.position, from.rotation);
    const double t = (time - from.time) / (after->time - from.time);
    return pose_at_origin(shape, from.position + t * (after->position - from.position),
                          slerp(from.rotation, after->rotation, t));
}

} // namespace flotilla
