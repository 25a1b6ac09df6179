// SPDX-License-Identifier: MIT
#include "cli/stop_request.hpp"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <csignal>

#include <unistd.h>

#include <flotilla/error.hpp>

namespace flotilla::cli {
namespace {

std::atomic<int> g_signal{0}; // a signal handler can reach nothing else
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void on_signal(int signal) {
    g_signal = signal;
    // The next one has its usual effect.
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
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
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, on_signal);
}

StopRequest::~StopRequest() {
    if (!catch_signals_) return;
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
}

bool StopRequest::signalled() const { return g_signal != 0; }

bool StopRequest::asked(double step_seconds) {
    if (g_signal != 0) {
        reason_ = g_signal == SIGINT ? "SIGINT" : "SIGTERM";
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
