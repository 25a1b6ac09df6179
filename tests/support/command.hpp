// SPDX-License-Identifier: MIT
// Runs the flotilla command as a user does. The test's target defines FLOTILLA_COMMAND, the path of the executable.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

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

/// arguments: as typed after `flotilla`, for the shell; standard input is empty where they do not redirect it.
/// `before`: what the shell does first, such as setting limits.
inline CommandOutput run_flotilla(const std::string& arguments, const std::string& before = ":") {
    const TemporaryFolder folder;
    const auto read = [&](const char* name) {
        std::ifstream in(folder.path() / name, std::ios::binary);
        return std::string{std::istreambuf_iterator<char>(in), {}};
    };
    const std::string to = folder.path().string();
    const std::string line = before + "; exec </dev/null " + std::string(FLOTILLA_COMMAND) + " " + arguments + " >" +
                             to + "/out 2>" + to + "/err";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("out"), read("err")};
}

/// A command that runs while the test goes on; its output goes to a file.
class RunningFlotilla {
  public:
    /// arguments: as typed after `flotilla`, for the shell. `before`: what the shell does first.
    explicit RunningFlotilla(const std::string& arguments, const std::string& before = ":") {
        const std::string line = before + "; exec " + std::string(FLOTILLA_COMMAND) + " " + arguments;
        const std::string log = (folder_.path() / "log").string();
        process_ = ::fork();
        if (process_ != 0) return;
        const int file = ::open(log.c_str(), O_WRONLY | O_CREAT, 0600);
        ::dup2(file, STDOUT_FILENO);
        ::dup2(file, STDERR_FILENO);
        ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
        ::_exit(127);
    }
    ~RunningFlotilla() {
        if (process_ > 0) send(SIGKILL), wait();
    }
    RunningFlotilla(const RunningFlotilla&) = delete;
    RunningFlotilla& operator=(const RunningFlotilla&) = delete;

    void send(int signal) const { ::kill(process_, signal); }
    /// Returns the exit code, or minus the signal that ended it.
    int wait() {
        int status = 0;
        ::waitpid(process_, &status, 0);
        process_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    }
    [[nodiscard]] std::string output() const {
        std::ifstream in(folder_.path() / "log", std::ios::binary);
        return std::string{std::istreambuf_iterator<char>(in), {}};
    }

  private:
    TemporaryFolder folder_;
    pid_t process_ = -1;
};

} // namespace flotilla::test
