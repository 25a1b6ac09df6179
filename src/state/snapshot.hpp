// SPDX-License-Identifier: MIT
// The state of a run as bytes, for checkpoints and for programs that embed the solver.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "state/model.hpp"

namespace flotilla {

/// 64-bit hash of everything that a run starts from: settings, gravity, shapes, bodies and their initial state. Two
/// runs with the same hash have the same bits.
[[nodiscard]] std::uint64_t scene_hash(const Model& model, const State& initial);

/// `state`, bit for bit, with the hash of the scene that it belongs to and its own. Little-endian.
[[nodiscard]] std::vector<std::byte> write_snapshot(const State& state, std::uint64_t scene);

/// InputError: a snapshot is of another scene.
[[noreturn]] void refuse_other_scene();

/// What write_snapshot wrote of a run of the model. Throws InputError where `bytes` is no snapshot, is damaged, or
/// belongs to another scene. A hash can be made to fit: whatever is read has a place for every body, names only
/// bodies that there are, and is within reach of a run.
[[nodiscard]] State read_snapshot(std::span<const std::byte> bytes, std::uint64_t scene, const Model& model);

} // namespace flotilla
