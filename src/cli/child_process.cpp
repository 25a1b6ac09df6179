// SPDX-License-Identifier: MIT
#include "cli/child_process.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <flotilla/error.hpp>

namespace flotilla::cli {
namespace {

constexpr timespec kPoll{0, 20'000'000}; // between two looks at the process; its times are its own
constexpr int kNoStart = 127;

double seconds(const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> out;
    for (std::string& text : texts) out.push_back(text.data());
    out.push_back(nullptr);
    return out;
}

std::vector<std::string> unbound_environment() {
    std::vector<std::string> out;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string text = *entry;
        if (!text.starts_with("OMP_PROC_BIND=") && !text.starts_with("OMP_PLACES=")) out.push_back(text);
    }
    return out;
}

/// Between fork and exec of a process with several threads: calls of the system alone.
[[noreturn]] void become(const char* program, char* const* arguments, char* const* environment, int log, pid_t parent) {
    ::setpgid(0, 0); // a signal to the group of who started it would reach it twice: the first is passed on
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(kNoStart);
    const int nothing = ::open("/dev/null", O_RDONLY);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(log, STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    ::execve(program, arguments, environment);
    ::_exit(kNoStart);
}

[[noreturn]] void fail(const std::string& what) { throw IoError(what + ": " + std::strerror(errno)); }

} // namespace

ChildResult run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                      const std::filesystem::path& log, const std::function<bool()>& stop) {
    std::vector<std::string> words{"flotilla"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<std::string> environment = unbound_environment();
    const std::vector<char*> argv = pointers(words), envp = pointers(environment);
    const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) fail("cannot write " + log.string());
    const pid_t parent = ::getpid(), child = ::fork();
    if (child == 0) become(program.c_str(), argv.data(), envp.data(), file, parent);
    ::close(file);
    if (child < 0) fail("cannot start a run");
    int status = 0;
    rusage used{};
    bool asked = false;
    for (pid_t ended = 0; ended != child; ended = ::wait4(child, &status, WNOHANG, &used)) {
        if (ended < 0 && errno != EINTR) fail("cannot wait for a run");
        if (!asked && stop()) asked = ::kill(child, SIGTERM) == 0;
        ::nanosleep(&kPoll, nullptr);
    }
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            seconds(used.ru_utime) + seconds(used.ru_stime)};
}

} // namespace flotilla::cli
