// SPDX-License-Identifier: MIT
// Changes of a World between steps, as values: what World::apply() takes, what a World records, and what a file of
// edits holds.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <flotilla/scene.hpp>

namespace flotilla {

/// A body of a World. The place of a removed body is given to the next one that comes, with another generation: an id
/// that outlives its body is refused, never mistaken.
struct BodyId {
    std::int32_t index = -1;
    std::uint32_t generation = 0;
    friend bool operator==(const BodyId&, const BodyId&) = default;
};

/// What an Edit changes. Bodies are those of the World at that time. SI units, world axes.
namespace edits {

/// It gets the lowest number that is free: the scene's description has the first ones, then come those added.
struct AddShape {
    ShapeDescription shape;
};
/// `body.shape` is the number of a shape.
struct AddBody {
    BodyDescription body;
};
struct RemoveBody {
    BodyId body;
};
/// The body is there without having been on the way; its velocities stay.
struct SetPose {
    BodyId body;
    Vec3 position; ///< of the mesh's origin
    Quat rotation;
};
struct SetVelocity {
    BodyId body;
    Vec3 velocity, angular_velocity;
};
/// Dynamic or fixed; a kinematic body comes from SetScript. What becomes dynamic is at rest, what becomes fixed stops.
struct SetType {
    BodyId body;
    BodyType type = BodyType::dynamic;
};
/// The body becomes kinematic and goes from where it is to these places, whose times are all later than the World's.
struct SetScript {
    BodyId body;
    std::vector<Keyframe> keyframes;
};
struct SetMaterial {
    BodyId body;
    double friction = 0, restitution = 0;
};
/// Until it is set again. At the centre of mass.
struct SetForce {
    BodyId body;
    Vec3 force, torque;
};
/// For the next step, beside what else is applied.
struct ApplyForce {
    BodyId body;
    Vec3 force, torque; ///< about the centre of mass
};
/// Velocities change at once.
struct ApplyImpulse {
    BodyId body;
    Vec3 impulse, angular_impulse; ///< N s, and N m s about the centre of mass
};
struct SetGravity {
    Vec3 gravity;
};
/// Empty: of no group.
struct SetGroup {
    BodyId body;
    std::string group;
};
/// Whether bodies of two groups, or of one, may pass through each other.
struct IgnoreGroups {
    std::string a, b;
    bool ignored = true;
};
struct IgnorePair {
    BodyId a, b;
    bool ignored = true;
};
struct Wake {
    BodyId body;
};
/// One that was added and that no body has. Its number is given to the next one that comes; those of others stay.
struct RemoveShape {
    std::int32_t shape = -1;
};

} // namespace edits

struct Edit {
    std::int64_t step = 0; ///< after so many steps; World::apply() does not look at it
    std::variant<edits::AddShape, edits::AddBody, edits::RemoveBody, edits::SetPose, edits::SetVelocity, edits::SetType,
                 edits::SetScript, edits::SetMaterial, edits::SetForce, edits::ApplyForce, edits::ApplyImpulse,
                 edits::SetGravity, edits::SetGroup, edits::IgnoreGroups, edits::IgnorePair, edits::Wake,
                 edits::RemoveShape>
        change;
    std::string place{}; ///< "file: /edits/3" of one that was read, for messages; no part of what it does
};

} // namespace flotilla
