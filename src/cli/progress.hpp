// SPDX-License-Identifier: MIT
// Progress of long work on stderr: a bar on a terminal, otherwise a line now and then.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace flotilla::cli {

class Progress {
  public:
    /// `what` is counted up to `total`.
    Progress(std::string what, std::int64_t total, bool quiet);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void update(std::int64_t done, const std::string& note);

  private:
    void draw(std::int64_t done, const std::string& note, double elapsed) const;

    std::string what_;
    std::int64_t total_;
    bool quiet_, terminal_, drawn_ = false;
    std::chrono::steady_clock::time_point start_, last_;
};

} // namespace flotilla::cli
