// SPDX-License-Identifier: MIT
#include "cli/progress.hpp"

#include <cstdio>

#include <unistd.h>

namespace flotilla::cli {
namespace {

constexpr double kTerminalInterval = 0.1; // s between two drawings
constexpr double kHeartbeat = 10;         // s between two lines
constexpr int kBarWidth = 30;

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

std::string clock_text(double s) {
    char text[32];
    const auto whole = static_cast<long>(s);
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
    return text;
}

} // namespace

Progress::Progress(std::string what, std::int64_t total, bool quiet)
    : what_(std::move(what)),
      total_(total),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

Progress::~Progress() {
    if (drawn_ && terminal_) std::fputc('\n', stderr);
}

void Progress::update(std::int64_t done, const std::string& note) {
    if (quiet_) return;
    const auto now = std::chrono::steady_clock::now();
    const bool last = done >= total_;
    if (!last && seconds(now - last_) < (terminal_ ? kTerminalInterval : kHeartbeat)) return;
    last_ = now;
    drawn_ = true;
    draw(done, note, seconds(now - start_));
}

void Progress::draw(std::int64_t done, const std::string& note, double elapsed) const {
    const double part = total_ > 0 ? static_cast<double>(done) / static_cast<double>(total_) : 1;
    const std::string eta = clock_text(part > 0 ? elapsed * (1 - part) / part : 0);
    if (terminal_) {
        const int filled = static_cast<int>(part * kBarWidth);
        std::string bar(static_cast<std::size_t>(filled), '#');
        bar.resize(kBarWidth, '.');
        std::fprintf(stderr, "\r%s [%s] %ld/%ld  ETA %s  %s\x1b[K", what_.c_str(), bar.c_str(), static_cast<long>(done),
                     static_cast<long>(total_), eta.c_str(), note.c_str());
    } else {
        std::fprintf(stderr, "%s %ld of %ld, %s, ETA %s, %s\n", what_.c_str(), static_cast<long>(done),
                     static_cast<long>(total_), clock_text(elapsed).c_str(), eta.c_str(), note.c_str());
    }
    std::fflush(stderr);
}

} // namespace flotilla::cli
