// SPDX-License-Identifier: MIT
// What a recorded task graph would take on other numbers of cores.
//
// Work W is the time of all tasks, the critical path C the time on as many cores as one likes with all costs zero. Any
// greedy schedule (no core idles while a task is ready) on P cores takes at most W/P + C (Graham 1969) and none takes
// less than max(W/P, C). Here the greedy schedule is built task by task, with costs: what brings threads together for a
// region, what a barrier takes, and what a task waits for longer because the task it waited for ran on another thread.
// The last also stands for what a share of a sweep waits for its neighbours.
//
// Regions follow one another, so their times add up; what lies between them runs on one core. Times are ns.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "parallel/task_recorder.hpp"

namespace flotilla {

/// What a number of threads pays beside its tasks, ns.
struct ThreadCosts {
    int threads = 2;
    double fork_join = 0; ///< a parallel section without work
    double barrier = 0;   ///< one round
    double hand_over = 0; ///< from the end of a task to the start of one that waited for it on another thread
};

/// Measured costs, and a law for widths beyond the widest of them.
class CostModel {
  public:
    /// How fork-join and barrier grow beyond the widest measured: as a tree of signals does, or as one after the other
    /// does. A hand-over concerns two threads and stays.
    enum class Growth { log2, linear };

    /// `measured` at two threads or more, in any order; where there is none, kAssumedCosts stand in.
    explicit CostModel(std::vector<ThreadCosts> measured, Growth growth = Growth::log2);

    /// One thread pays nothing; between measured widths costs are interpolated.
    [[nodiscard]] ThreadCosts at(int threads) const;
    [[nodiscard]] int widest() const { return measured_.back().threads; }
    [[nodiscard]] bool assumed() const { return assumed_; }

  private:
    std::vector<ThreadCosts> measured_; ///< sorted, one of each width, never empty
    Growth growth_;
    bool assumed_ = false;
};

/// Of two threads on a machine that has no second core to measure them: a few cache misses each.
inline constexpr ThreadCosts kAssumedCosts{2, 1000, 300, 300};

/// The tasks of one region.
struct RegionTasks {
    RegionKind kind = RegionKind::loop;
    std::span<const std::int64_t> durations;      ///< loop, ordered: by task, ns
    std::span<const Successors> successors;       ///< ordered; a successor has a higher number than its task
    std::span<const GroupSpan> groups;            ///< sweeps
    std::int32_t most_threads = 0;                ///< sweeps; 0: by sweep_width of all groups
    [[nodiscard]] std::int64_t num_tasks() const; ///< sweeps: visits of tasks
};

/// The tasks of a record, by region. The record must outlive it.
class RegionTable {
  public:
    explicit RegionTable(const TaskRecord& record);
    [[nodiscard]] RegionTasks operator[](std::size_t region) const;

  private:
    const TaskRecord& record_;
    std::vector<std::size_t> first_; ///< by region, one more: its tasks in durations_
    std::vector<std::int64_t> durations_;
    std::vector<std::size_t> first_group_; ///< by region, one more
    std::vector<GroupSpan> groups_;
};

/// ns of all tasks together.
[[nodiscard]] double region_work(const RegionTasks& region);
/// ns of the longest chain of tasks that wait for each other.
[[nodiscard]] double region_critical_path(const RegionTasks& region);

/// Memory of a schedule, kept between calls.
struct ScheduleScratch {
    struct Running {
        double end = 0;
        std::int32_t core = 0, task = 0;
    };
    std::vector<double> free_at;
    std::vector<std::int32_t> ready, releaser;
    std::vector<std::uint8_t> waits, idle;
    std::vector<std::int32_t> idle_cores;
    std::vector<Running> running;
};

/// ns that the region takes on `cores` cores under a greedy schedule that takes the lowest ready task. As the team
/// does, a region never takes more threads than it has tasks; sweeps never take more than the solver gives them. The
/// order in which a loop's chunks go to threads, own stretch first, is simplified to list order.
[[nodiscard]] double region_time(const RegionTasks& region, int cores, const CostModel& costs,
                                 ScheduleScratch& scratch);

/// A row of the result: a phase, the part of it outside its parts, or the regions of one name in it.
struct ScheduleRow {
    enum class Kind { phase, rest, loop, ordered, sweeps };
    std::string name;
    Kind kind = Kind::phase;
    int depth = 0;            ///< 0: a phase within no other; rows follow the row that they are part of
    std::int64_t count = 0;   ///< phases; regions
    std::int64_t regions = 0; ///< in it, parts included
    std::int64_t tasks = 0;
    double wall = 0;          ///< as recorded
    double serial = 0;        ///< outside regions
    double work = 0;          ///< serial and all tasks
    double critical_path = 0; ///< serial and that of all regions
    std::vector<double> time; ///< by width

    [[nodiscard]] double parallelism() const { return critical_path > 0 ? work / critical_path : 1; }
    [[nodiscard]] double speedup(std::size_t width) const { return time[width] > 0 ? work / time[width] : 1; }
};

struct Schedule {
    std::vector<int> widths; ///< cores
    ScheduleRow total;
    std::vector<ScheduleRow> rows; ///< each phase, then its parts in order of their first appearance
    double tasks_time = 0;         ///< of all recorded tasks
};

/// Phases of one name within the same phase are one row. Recorded on one thread, what sweeps spend outside their groups
/// counts as serial; what loops and ordered runs spend between their tasks is the recording itself and counts as
/// nothing.
[[nodiscard]] Schedule make_schedule(const TaskRecord& record, const CostModel& costs, std::vector<int> widths);

} // namespace flotilla
