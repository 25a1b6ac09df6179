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
    const std::int64_t begin = now(); // to copy the links is no work of the step
    const auto first = static_cast<std::int64_t>(record_.links.size());
    if (successors != nullptr) record_.links.insert(record_.links.end(), successors, successors + tasks);
    record_.regions.push_back({name, kind, tasks, begin, 0, first, step_});
    return static_cast<std::int32_t>(record_.regions.size()) - 1;
}

void TaskRecorder::drop_step() {
    TaskRecord& r = record_;
    for (; !r.regions.empty() && r.regions.back().step == step_; r.regions.pop_back())
        r.links.resize(static_cast<std::size_t>(r.regions.back().first_link));
    const auto gone = [&](const auto& span) { return span.region >= static_cast<std::int32_t>(r.regions.size()); };
    for (std::vector<TaskSpan>& tasks : r.threads) std::erase_if(tasks, gone);
    std::erase_if(r.groups, gone);
    std::erase_if(r.phases, [&](const PhaseSpan& phase) { return phase.step == step_; });
}

} // namespace flotilla
