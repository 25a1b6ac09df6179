// SPDX-License-Identifier: MIT
// How phases of a team get into a recording, as sweeps over groups of tasks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "parallel/task_recorder.hpp"

namespace flotilla {

/// What sweeps show of themselves in a recording: ns by share and group, in one region. Without a recorder nothing is
/// kept.
class SweepRecord {
  public:
    /// width(most): how many threads, at most `most`, the sweeps are worth.
    template <class Width>
    SweepRecord(TaskRecorder* recorder, const char* name, Width&& width, int shares, std::size_t groups)
        : recorder_(recorder), groups_(groups) {
        if (recorder_ == nullptr) return;
        region_ = recorder_->begin_region(name, RegionKind::sweeps, width(std::numeric_limits<int>::max()), nullptr);
        busy_.assign(static_cast<std::size_t>(shares) * groups, 0);
    }

    [[nodiscard]] bool active() const { return recorder_ != nullptr; }
    /// Does the work and adds its time to a group.
    template <class Work>
    void timed(int share, std::size_t group, Work&& work) {
        if (recorder_ == nullptr) return work();
        const std::int64_t begin = recorder_->now();
        work();
        busy_[static_cast<std::size_t>(share) * groups_ + group] += recorder_->now() - begin;
    }
    /// Ends the region. group(k) says of the k-th group what the record does not know of it.
    template <class Group>
    void end(Group&& group) {
        if (recorder_ == nullptr) return;
        for (std::size_t g = 0; g < groups_; ++g) {
            GroupSpan span = group(g);
            span.region = region_;
            span.busy = busy(g);
            recorder_->add_group(span);
        }
        recorder_->end_region(region_);
    }

  private:
    [[nodiscard]] std::int64_t busy(std::size_t group) const {
        std::int64_t sum = 0;
        for (std::size_t k = group; k < busy_.size(); k += groups_) sum += busy_[k];
        return sum;
    }

    TaskRecorder* recorder_;
    std::int32_t region_ = -1;
    std::size_t groups_;
    std::vector<std::int64_t> busy_;
};

} // namespace flotilla
