// SPDX-License-Identifier: MIT
// Checkpoints: the last two are kept, so that damage to the newest costs one interval and not the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace flotilla::io {

/// A readable copy of part of the state, for tools; resuming uses the bytes only.
struct CheckpointArray {
    std::string name; ///< of the dataset, without slashes
    std::vector<double> values;
};

struct Checkpoint {
    std::int64_t step = 0;
    std::vector<std::byte> state;      ///< the solver's snapshot, opaque here
    std::vector<std::string> warnings; ///< newer checkpoints that were damaged and passed over
};

/// Writes checkpoint-<step>.h5 durably, then removes all but the newest two. RunWriter::flush comes first: a checkpoint
/// may not be newer than the frames.
void write_checkpoint(const std::filesystem::path& folder, std::int64_t step, std::span<const std::byte> state,
                      std::span<const CheckpointArray> arrays = {});

/// The newest valid checkpoint; nothing where there is none at all. IoError where there are some and all are damaged.
[[nodiscard]] std::optional<Checkpoint> read_last_checkpoint(const std::filesystem::path& folder);

} // namespace flotilla::io
