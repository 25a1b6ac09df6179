// SPDX-License-Identifier: MIT
// Tasks in a fixed order, run so that only those wait for one another that use something in common.
//
// Each task uses at most two resources (in a sweep: the two movable clusters of a pair). A task waits for the last
// earlier one that uses each of its resources. Running the tasks in any order that keeps to these waits gives the bits
// of the plain loop, if a task is a pure function of data that only tasks with a common resource write (and of data
// that none writes): by induction over the list, every task finds its resources as the plain loop would leave them,
// because the tasks that wrote them before are the same, and their order among each other is that of the list.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "parallel/task_recorder.hpp"

namespace flotilla {

class Team;

class TaskOrder {
  public:
    /// Forgets all tasks. Resources are numbered [0, num_resources).
    void start(std::size_t num_resources);
    /// Appends a task that uses `a` and `b`; a negative number stands for none. Returns its number.
    std::int32_t add(std::int32_t a, std::int32_t b);

    /// The same in parts: room for so many tasks, and what add() would have found of each, in any order, side by side.
    /// `successors`: numbers of tasks. Afterwards list_first().
    void resize(std::size_t tasks);
    void set(std::size_t task, const Successors& successors, std::uint8_t waits) {
        successors_[task] = successors;
        waits_[task] = waits;
    }
    void list_first(Team& team, std::vector<std::size_t>& places);

    [[nodiscard]] std::size_t size() const { return successors_.size(); }
    /// How many tasks each task waits for: 0 to 2.
    [[nodiscard]] std::span<const std::uint8_t> waits() const { return waits_; }
    [[nodiscard]] std::span<const Successors> successors() const { return successors_; }
    /// The tasks that wait for none, ascending.
    [[nodiscard]] std::span<const std::int32_t> first() const { return first_; }

  private:
    std::vector<std::int32_t> last_; ///< by resource: 2 task + its place in the task that used it last; -1: none
    std::vector<Successors> successors_;
    std::vector<std::uint8_t> waits_;
    std::vector<std::int32_t> first_;
};

} // namespace flotilla
