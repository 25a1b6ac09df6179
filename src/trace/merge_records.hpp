// SPDX-License-Identifier: MIT
// Several recordings of one run, made on one thread, as one in which nothing was interrupted.
//
// A run does the same tasks whenever it is repeated. Other work on the machine only ever adds to their times, now to
// one, now to another; so of each task, each region and each stretch between them the shortest of its times is the one
// to keep.
#pragma once

#include "parallel/task_recorder.hpp"

namespace flotilla {

/// Replaces every duration of `record` by that of `other` where this is shorter; times of events then follow from the
/// durations. Phases and regions must be nested. False, and no change, where the two have not recorded the same graph
/// on one thread each.
[[nodiscard]] bool keep_shortest(TaskRecord& record, const TaskRecord& other);

} // namespace flotilla
