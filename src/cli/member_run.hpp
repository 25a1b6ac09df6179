// SPDX-License-Identifier: MIT
// Runs of a campaign as processes of the command.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include <flotilla/sweep.hpp>

namespace flotilla::cli {

/// "key=a,b,..." of --vary taken apart; an empty value is left for the library to refuse. InputError where it has
/// another form.
[[nodiscard]] SweepAxis parse_axis(const std::string& text);

/// Makes a run with `flotilla run --resume` as a process of `program` and returns when it has ended; as run_child.
/// `time_limit`: H:M:S of the run; empty: none.
[[nodiscard]] SweepOutcome run_member(const std::filesystem::path& program, const SweepMember& member,
                                      const std::string& time_limit, const std::function<bool()>& stop);

inline constexpr const char* kThisProgram = "/proc/self/exe";

} // namespace flotilla::cli
