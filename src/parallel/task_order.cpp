// SPDX-License-Identifier: MIT
#include "parallel/task_order.hpp"

namespace flotilla {

void TaskOrder::start(std::size_t num_things) {
    for (const std::int32_t thing : used_) last_[static_cast<std::size_t>(thing)] = -1;
    used_.clear();
    last_.resize(num_things, -1);
    things_.clear();
    successors_.clear();
    waits_.clear();
}

std::int32_t TaskOrder::add(std::int32_t a, std::int32_t b) {
    const auto task = static_cast<std::int32_t>(successors_.size());
    things_.push_back({a, b});
    successors_.push_back({-1, -1});
    waits_.push_back(0);
    const std::int32_t before = a >= 0 ? last_[static_cast<std::size_t>(a)] : -1;
    int waits = follow(task, a) ? 1 : 0;
    // A task that had both things before is waited for once.
    const bool same = b >= 0 && before >= 0 && last_[static_cast<std::size_t>(b)] == before;
    if (same)
        last_[static_cast<std::size_t>(b)] = task;
    else if (b != a)
        waits += follow(task, b) ? 1 : 0;
    waits_.back() = static_cast<std::uint8_t>(waits);
    return task;
}

bool TaskOrder::follow(std::int32_t task, std::int32_t thing) {
    if (thing < 0) return false;
    std::int32_t& last = last_[static_cast<std::size_t>(thing)];
    const std::int32_t before = last;
    last = task;
    if (before < 0) {
        used_.push_back(thing);
        return false;
    }
    const auto i = static_cast<std::size_t>(before);
    successors_[i][things_[i][0] == thing ? 0 : 1] = task;
    return true;
}

} // namespace flotilla
