// SPDX-License-Identifier: MIT
// Runs the flotilla command as a user does. The test's target defines FLOTILLA_COMMAND, the path of the executable.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "support/temporary_folder.hpp"

namespace flotilla::test {

struct CommandOutput {
    int exit_code; ///< -1 where the command did not exit by itself
    std::string out, err;
};

/// arguments: as typed after `flotilla`, for the shell.
inline CommandOutput run_flotilla(const std::string& arguments) {
    const TemporaryFolder folder;
    const auto read = [&](const char* name) {
        std::ifstream in(folder.path() / name, std::ios::binary);
        return std::string{std::istreambuf_iterator<char>(in), {}};
    };
    const std::string to = folder.path().string();
    const std::string line =
        std::string(FLOTILLA_COMMAND) + " " + arguments + " >" + to + "/out 2>" + to + "/err </dev/null";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("out"), read("err")};
}

} // namespace flotilla::test
