// SPDX-License-Identifier: MIT
// What edits change of a scene, and how a snapshot holds it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <flotilla/edit.hpp>

namespace flotilla {

struct EditedBodies {
    Vec3 gravity; ///< m/s^2
    /// By the number that AddBody gives: those of the scene without meshes, then those added. See was_removed().
    std::vector<ShapeDescription> shapes;
    std::size_t scene_shapes = 0;
    /// By place. Poses and velocities are those of the start.
    std::vector<BodyDescription> bodies;
    std::vector<std::uint8_t> present;
    std::vector<std::uint32_t> generation;
    std::vector<std::uint64_t> user_data;
    std::vector<NamedPair> ignored_groups, ignored_bodies;
    /// Forces for the next step, by place, ascending.
    struct Push {
        std::int32_t body = -1;
        std::int32_t unused = 0; ///< no padding: pushes are written as they lie in memory
        Vec3 force, torque;
    };
    std::vector<Push> pushes;
    /// What bodies that are not dynamic now had as such and get back with it, by place, ascending.
    struct Kept {
        std::int32_t body = -1;
        std::uint32_t locked = 0; ///< bits 0 to 2: translations along x, y, z; 3 to 5: turns about them
        Vec3 force, torque;
    };
    std::vector<Kept> kept;
    std::vector<std::uint8_t> moved; ///< by place: placed since the last step; of a snapshot alone
    std::uint64_t hash = 0;          ///< of all edits, one after the other; 0: there was none
};

/// What is left of a removed shape is its number.
[[nodiscard]] inline bool was_removed(const ShapeDescription& shape) { return shape.name.empty(); }

/// The hash of one edit more, that is made after a step.
[[nodiscard]] std::uint64_t chained(std::uint64_t hash, const Edit& edit, std::int64_t step);

/// A snapshot of an edited scene: the edited part, then `state`, which is a snapshot of what moves
/// (state/snapshot.hpp).
[[nodiscard]] std::vector<std::byte> join_snapshot(const EditedBodies& bodies, std::span<const std::byte> state);

struct SplitSnapshot {
    bool edited = false;
    EditedBodies bodies; ///< where it is
    std::span<const std::byte> state;
};
/// What join_snapshot() made, or a plain snapshot of the scene that `start` describes. Throws InputError where it is
/// damaged: whatever is read is a scene that an edit could have left.
[[nodiscard]] SplitSnapshot split_snapshot(std::span<const std::byte> snapshot, const EditedBodies& start);

} // namespace flotilla
