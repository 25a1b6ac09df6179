// SPDX-License-Identifier: MIT
#include "cli/stop_request.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <csignal>

#include <unistd.h>

#include <flotilla/error.hpp>

namespace flotilla::cli {
namespace {

std::atomic<int> g_signal{0}; // a signal handler can reach nothing else
static_assert(std::atomic<int>::is_always_lock_free);

constexpr std::array kStops{SIGINT, SIGTERM, SIGHUP};
constexpr std::array kNames{"SIGINT", "SIGTERM", "SIGHUP"};

extern "C" void on_signal(int signal) {
    g_signal = signal;
    for (const int other : kStops) // the next one has its usual effect
        if (std::signal(other, SIG_DFL) == SIG_IGN) std::signal(other, SIG_IGN);
    constexpr char kText[] = "\nflotilla: stopping after this step; once more ends it at once\n";
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kText, sizeof kText - 1);
}

// What a step may take more than those before it: the impact of a pile comes within some ten steps.
constexpr double kGrowth = 2;
constexpr double kFading = 0.9; // of the slowest step, with every later one

} // namespace

std::optional<std::chrono::seconds> parse_time_limit(const std::string& text) {
    if (text.empty()) return {};
    const auto fail = [&]() { throw InputError("--time-limit " + text + ": not of the form H:M:S"); };
    long total = 0;
    int parts = 0;
    for (const char *at = text.data(), *end = at + text.size();; ++at) {
        long value = 0;
        const auto [stop, error] = std::from_chars(at, end, value);
        if (error != std::errc{} || value < 0 || value > 1'000'000 || (parts > 0 && value >= 60) || ++parts > 3) fail();
        total = 60 * total + value;
        at = stop;
        if (at == end) return std::chrono::seconds(total);
        if (*at != ':') fail();
    }
}

StopRequest::StopRequest(std::optional<std::chrono::seconds> limit, bool catch_signals)
    : limit_(limit), catch_signals_(catch_signals) {
    if (!catch_signals_) return;
    g_signal = 0;
    for (const int signal : kStops)
        if (std::signal(signal, on_signal) == SIG_IGN) std::signal(signal, SIG_IGN); // as nohup wants it
}

StopRequest::~StopRequest() {
    if (!catch_signals_) return;
    for (const int signal : kStops)
        if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
}

bool StopRequest::signalled() const { return g_signal != 0; }

bool StopRequest::asked(double step_seconds) {
    if (g_signal != 0) {
        reason_ = kNames[static_cast<std::size_t>(std::find(kStops.begin(), kStops.end(), g_signal) - kStops.begin())];
        return true;
    }
    if (!limit_) return false;
    slowest_ = std::max(step_seconds, kFading * slowest_);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    if (elapsed.count() + kGrowth * slowest_ < static_cast<double>(limit_->count())) return false;
    reason_ = "time limit";
    return true;
}

} // namespace flotilla::cli
