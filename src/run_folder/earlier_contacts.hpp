// SPDX-License-Identifier: MIT
// What an earlier part of a run wrote of its contacts, for a later part to go on with.
#pragma once

#include <filesystem>

#include "run_folder/checkpoint.hpp"

namespace flotilla::io {

struct EarlierContacts {
    std::int64_t step = 0; ///< of the checkpoint: rows of later steps are made again
    ContactRows rows;      ///< up to that one; none: `rows.from` is the next step
    /// Where they are: under the name itself or, where a run was killed, the temporary one. Empty: nowhere.
    std::filesystem::path contacts, totals;
};

/// Looks for the files of `contacts` (RunOptions::contacts) that the run wrote until this checkpoint. Throws InputError
/// where others are there, or less than that: written over they would be lost. Changes nothing.
[[nodiscard]] EarlierContacts find_earlier_contacts(const std::filesystem::path& contacts,
                                                    const Checkpoint& checkpoint);

} // namespace flotilla::io
