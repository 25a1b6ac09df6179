// SPDX-License-Identifier: MIT
#include "parallel/task_order.hpp"

#include "parallel/compact.hpp"

namespace flotilla {

void TaskOrder::start(std::size_t num_resources) {
    last_.assign(num_resources, -1);
    successors_.clear();
    waits_.clear();
    first_.clear();
}

void TaskOrder::resize(std::size_t tasks) {
    successors_.resize(tasks);
    waits_.resize(tasks);
}

void TaskOrder::list_first(Team& team, std::vector<std::size_t>& places) {
    constexpr std::size_t kGrain = 4096;
    compact_if(
        {&team, "first tasks", kGrain, places}, waits_.size(), [&](std::size_t i) { return waits_[i] == 0; }, first_, 0,
        [](std::size_t i) { return static_cast<std::int32_t>(i); });
}

// A task costs a few loads and stores.
std::int32_t TaskOrder::add(std::int32_t a, std::int32_t b) {
    const auto task = static_cast<std::int32_t>(successors_.size());
    if (b == a) b = -1;
    const auto before = [&](std::int32_t resource) {
        return resource >= 0 ? last_[static_cast<std::size_t>(resource)] : -1;
    };
    const auto follow = [&](std::int32_t last) {
        successors_[static_cast<std::size_t>(last / 2)][static_cast<std::size_t>(last % 2)] = task;
    };
    const std::int32_t before_a = before(a), before_b = before(b);
    std::uint8_t waits = 0;
    if (before_a >= 0) follow(before_a), ++waits;
    // A task that had both resources before is waited for once.
    if (before_b >= 0 && (before_a < 0 || before_a / 2 != before_b / 2)) follow(before_b), ++waits;
    if (a >= 0) last_[static_cast<std::size_t>(a)] = 2 * task;
    if (b >= 0) last_[static_cast<std::size_t>(b)] = 2 * task + 1;
    successors_.push_back({-1, -1});
    waits_.push_back(waits);
    if (waits == 0) first_.push_back(task);
    return task;
}

} // namespace flotilla
