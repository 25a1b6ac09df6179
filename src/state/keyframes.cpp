// SPDX-License-Identifier: MIT
#include "state/keyframes.hpp"

#include <algorithm>

#include "base/rotation.hpp"
#include "base/vec3.hpp"

namespace flotilla {
namespace {

Quat slerp(const Quat& from, const Quat& to, double t) {
    const Vec3 turn = rotation_vector(to * conjugate(from));
    return normalized(rotation_from_vector(t * turn) * from);
}

} // namespace

KeyframePlace keyframe_place(std::span<const Keyframe> keyframes, double time) {
    const auto after = std::upper_bound(keyframes.begin(), keyframes.end(), time,
                                        [](double t, const Keyframe& k) { return t < k.time; });
    if (after == keyframes.begin()) return {keyframes.front().position, keyframes.front().rotation};
    const Keyframe& from = *(after - 1);
    if (after == keyframes.end()) return {from.position, from.rotation};
    const double t = (time - from.time) / (after->time - from.time);
    return {from.position + t * (after->position - from.position), slerp(from.rotation, after->rotation, t)};
}

} // namespace flotilla
