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

/// How many rows the files of ContactsCsv had.
struct ContactRows {
    std::int64_t from = 1; ///< the first step whose contacts they were to have
    std::int64_t contacts = 0, totals = 0;
};

struct Checkpoint {
    std::int64_t step = 0;
    std::vector<std::byte> state;          ///< the solver's snapshot, opaque here
    std::vector<std::string> warnings;     ///< newer checkpoints that were damaged and passed over
    std::optional<ContactRows> contacts{}; ///< none: they were not written
};

/// Writes checkpoint-<step>.h5 durably, then removes all but the newest two. RunWriter::flush comes first, and
/// ContactsCsv::sync: a checkpoint may not be newer than frames and contacts.
void write_checkpoint(const std::filesystem::path& folder, std::int64_t step, std::span<const std::byte> state,
                      std::span<const CheckpointArray> arrays = {}, const std::optional<ContactRows>& contacts = {});

/// The newest valid checkpoint; nothing where there is none at all. IoError where there are some and all are damaged.
[[nodiscard]] std::optional<Checkpoint> read_last_checkpoint(const std::filesystem::path& folder);

} // namespace flotilla::io
