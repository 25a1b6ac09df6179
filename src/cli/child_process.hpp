// SPDX-License-Identifier: MIT
// The command as a process of its own: what it breaks, fills or wastes is its own.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace flotilla::cli {

struct ChildResult {
    int exit_code = 0; ///< 128 + signal where one ended it, as the shell says it
    double cpu = 0;    ///< s, of all its threads
};

/// Runs `program` with `arguments` (without its own name), with messages and output in `log`, and waits for the end.
/// Where `stop` begins to return true the process is asked to end with SIGTERM, as it is where this one dies. Threads
/// of OpenMP are not bound to cores: several processes would all bind to the same ones. May be called on several
/// threads at a time. IoError where it cannot be started.
[[nodiscard]] ChildResult run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                                    const std::filesystem::path& log, const std::function<bool()>& stop);

} // namespace flotilla::cli
