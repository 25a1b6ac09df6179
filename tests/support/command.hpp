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

/// Runs a line in the shell, its output kept; standard input is empty where it does not redirect it. `before`: what the
/// shell does first, such as setting limits.
inline CommandOutput run_line(const std::string& line, const std::string& before = ":") {
    const TemporaryFolder folder;
    const auto read = [&](const char* name) {
        std::ifstream in(folder.path() / name, std::ios::binary);
        return std::string{std::istreambuf_iterator<char>(in), {}};
    };
    const std::string to = folder.path().string();
    const std::string all = before + "; exec </dev/null " + line + " >" + to + "/out 2>" + to + "/err";
    const int status = std::system(all.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("out"), read("err")};
}

/// arguments: as typed after `flotilla`.
inline CommandOutput run_flotilla(const std::string& arguments, const std::string& before = ":") {
    return run_line(std::string(FLOTILLA_COMMAND) + " " + arguments, before);
}

/// A command that runs while the test goes on; its output goes to a file.
class RunningLine {
  public:
    /// For the shell. `before`: what the shell does first.
    explicit RunningLine(const std::string& command, const std::string& before = ":") {
        const std::string line = before + "; exec " + command;
        const std::string log = (folder_.path() / "log").string();
        process_ = ::fork();
        if (process_ != 0) return;
        const int file = ::open(log.c_str(), O_WRONLY | O_CREAT, 0600);
        ::dup2(file, STDOUT_FILENO);
        ::dup2(file, STDERR_FILENO);
        ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
        ::_exit(127);
    }
    ~RunningLine() {
        if (process_ > 0) send(SIGKILL), wait();
    }
    RunningLine(const RunningLine&) = delete;
    RunningLine& operator=(const RunningLine&) = delete;

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

class RunningFlotilla : public RunningLine {
  public:
    /// arguments: as typed after `flotilla`.
    explicit RunningFlotilla(const std::string& arguments, const std::string& before = ":")
        : RunningLine(std::string(FLOTILLA_COMMAND) + " " + arguments, before) {}
};

} // namespace flotilla::test
