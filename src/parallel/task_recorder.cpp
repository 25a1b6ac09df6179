// SPDX-License-Identifier: MIT
#include "parallel/task_recorder.hpp"

#include <algorithm>
#include <chrono>

namespace flotilla {
namespace {

std::int64_t clock_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

} // namespace

std::vector<const PhaseSpan*> phases_in_order(const TaskRecord& record) {
    std::vector<const PhaseSpan*> phases;
    for (auto it = record.phases.rbegin(); it != record.phases.rend(); ++it) phases.push_back(&*it);
    std::stable_sort(phases.begin(), phases.end(), [](const PhaseSpan* a, const PhaseSpan* b) {
        return a->begin != b->begin ? a->begin < b->begin : a->end > b->end;
    });
    return phases;
}

TaskRecorder::TaskRecorder(int threads) : start_(clock_ns()) {
    record_.threads.resize(static_cast<std::size_t>(threads));
}

std::int64_t TaskRecorder::now() const { return clock_ns() - start_; }

std::int32_t TaskRecorder::begin_region(const char* name, RegionKind kind, std::int32_t tasks,
                                        const Successors* successors) {
    const auto first = static_cast<std::int64_t>(record_.links.size());
    if (successors != nullptr) record_.links.insert(record_.links.end(), successors, successors + tasks);
    record_.regions.push_back({name, kind, tasks, now(), 0, first, step_});
    return static_cast<std::int32_t>(record_.regions.size()) - 1;
}

} // namespace flotilla
