// SPDX-License-Identifier: MIT
// Reasons to end a run before its last step: SIGINT, SIGTERM, SIGHUP, and a limit of time.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace flotilla::cli {

/// "H:M:S", "M:S" or "S" (whole numbers, each part after the first below 60) as a duration; nothing for an empty text.
/// Throws InputError.
[[nodiscard]] std::optional<std::chrono::seconds> parse_time_limit(const std::string& text);

/// One at a time in a process.
class StopRequest {
  public:
    /// The clock of `limit` starts now. With `catch_signals` the first signal asks to stop; a second one ends the
    /// process at once. Signals that the process ignores stay so.
    StopRequest(std::optional<std::chrono::seconds> limit, bool catch_signals);
    ~StopRequest();
    StopRequest(const StopRequest&) = delete;
    StopRequest& operator=(const StopRequest&) = delete;

    /// Whether to stop now, after a step of `step_seconds`: the limit would pass in the next one, or a signal came.
    [[nodiscard]] bool asked(double step_seconds);
    /// Whether a signal came; may be asked on any thread.
    [[nodiscard]] bool signalled() const;
    /// Why.
    [[nodiscard]] const std::string& reason() const { return reason_; }

  private:
    std::optional<std::chrono::seconds> limit_;
    bool catch_signals_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    double slowest_ = 0; ///< s, recent steps
    std::string reason_;
};

} // namespace flotilla::cli
