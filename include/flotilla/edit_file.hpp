// SPDX-License-Identifier: MIT
// Files of edits: JSON, SI units. src/io/README.md describes the format.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <flotilla/edit.hpp>

namespace flotilla {

/// Reads edits of a scene, sorted by step, those of one step in the order of the file. Bodies and shapes are named; a
/// name means the body that has it when its turn comes. Throws IoError where the file cannot be read, and InputError
/// with one line per problem ("file: /edits/3/set_pose/body: reason"). What an edit would do is checked when it is
/// made.
[[nodiscard]] std::vector<Edit> read_edits(const std::filesystem::path& file, const SceneDescription& scene);

/// The same from text in memory. `source` names it in messages; mesh paths are relative to `folder`.
[[nodiscard]] std::vector<Edit> parse_edits(std::string_view text, const std::string& source,
                                            const std::filesystem::path& folder, const SceneDescription& scene);

/// Writes edits that were made of a World of the scene (World::recorded_edits()) as JSON that parse_edits reads back to
/// the same bits. Throws InputError where one is of a body that there cannot be.
void write_edits(std::ostream& out, std::span<const Edit> edits, const SceneDescription& scene);

} // namespace flotilla
