// SPDX-License-Identifier: MIT
// Times of phases, for the report and for the record of the team's tasks.
#pragma once

#include <flotilla/report.hpp>

#include "base/stopwatch.hpp"
#include "parallel/team.hpp"

namespace flotilla {

/// A named stretch of the step in the record of the team's tasks, where there is one.
class RecordedSpan {
  public:
    RecordedSpan(const char* name, const Team& team)
        : name_(name), recorder_(team.recorder()), begin_(recorder_ != nullptr ? recorder_->now() : 0) {}
    RecordedSpan(const RecordedSpan&) = delete;
    RecordedSpan& operator=(const RecordedSpan&) = delete;
    ~RecordedSpan() {
        if (recorder_ != nullptr) recorder_->add_phase(name_, begin_, recorder_->now());
    }

  private:
    const char* name_;
    TaskRecorder* recorder_;
    std::int64_t begin_;
};

/// Times a phase for the report and the record.
class PhaseWatch {
  public:
    PhaseWatch(StepReport& report, Phase phase, const Team& team)
        : watch_(report.ms(phase)), span_(kPhaseNames[static_cast<std::size_t>(phase)].data(), team) {}

  private:
    Stopwatch watch_;
    RecordedSpan span_;
};

} // namespace flotilla
