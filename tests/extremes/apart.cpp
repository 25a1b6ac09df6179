// SPDX-License-Identifier: MIT
#include "extremes/apart.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <sstream>

namespace flotilla::extremes {
namespace {

/// Of the processor's time, on a machine with much else to do: what takes longer waits for something that never comes.
constexpr unsigned kMostWall = 30;

std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    std::replace(text.begin(), text.end(), '|', '/');
    return text;
}

void write_outcome(int pipe_end, const Outcome& o) {
    std::ostringstream out;
    out << static_cast<int>(o.verdict) << ' ' << o.steps << ' ' << o.seconds << ' ' << o.slowest_step << ' ' << o.rise
        << ' ' << o.drift << ' ' << one_line(o.message);
    const std::string text = out.str();
    if (write(pipe_end, text.data(), text.size()) < 0) std::_Exit(2);
}

Outcome read_outcome(const std::string& text) {
    std::istringstream in(text);
    int verdict = 0;
    Outcome o;
    in >> verdict >> o.steps >> o.seconds >> o.slowest_step >> o.rise >> o.drift;
    o.verdict = static_cast<Verdict>(verdict);
    std::getline(in >> std::ws, o.message);
    return o;
}

std::string read_all(int pipe_end) {
    std::string text;
    std::array<char, 4096> buffer;
    for (ssize_t n = 0; (n = read(pipe_end, buffer.data(), buffer.size())) > 0;)
        text.append(buffer.data(), static_cast<std::size_t>(n));
    return text;
}

} // namespace

Outcome run_apart(const std::function<Outcome()>& run, int most_seconds) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) std::abort();
    const pid_t child = fork();
    if (child == 0) {
        const auto seconds = static_cast<rlim_t>(most_seconds);
        const rlimit limit{seconds, seconds};
        setrlimit(RLIMIT_CPU, &limit);
        alarm(kMostWall * static_cast<unsigned>(most_seconds));
        write_outcome(ends[1], run());
        std::_Exit(0);
    }
    close(ends[1]);
    const std::string text = read_all(ends[0]);
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return read_outcome(text);
    const bool slow = WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL);
    const bool hangs = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
    Outcome o{Verdict::broken, slow ? "more than " + std::to_string(most_seconds) + " s" : hangs ? "hangs" : "crashed"};
    o.late = slow;
    if (slow) o.seconds = o.slowest_step = most_seconds;
    return o;
}

} // namespace flotilla::extremes
