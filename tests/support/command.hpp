// SPDX-License-Identifier: MIT
// Runs the flotilla command as a user does. The test's target defines FLOTILLA_COMMAND, the path of the executable.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

namespace flotilla::test {

/// A folder of its own, removed with everything in it at the end.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "flotilla-test-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create " + name);
        path_ = name;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

    /// Writes a file into the folder and returns its path.
    std::string write(const std::string& name, const std::string& content) const {
        const auto file = path_ / name;
        std::ofstream(file, std::ios::binary) << content;
        return file.string();
    }

  private:
    std::filesystem::path path_;
};

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
