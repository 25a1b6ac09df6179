// SPDX-License-Identifier: MIT
// What a team of threads did, task by task: the executed task graph of a run.
//
// A region is one parallel section: a loop over chunks, an ordered run of tasks, or sweeps over groups one after
// another. Regions follow one another; what lies between them ran on one thread. Recording changes times and nothing
// else.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace flotilla {

enum class RegionKind : std::uint8_t {
    loop,    ///< independent tasks
    ordered, ///< tasks with successors
    sweeps,  ///< groups of equal tasks, in order; all of it repeated
};

/// One task of a loop or an ordered run.
struct TaskSpan {
    std::int64_t begin = 0, end = 0; ///< ns since the recorder was made
    std::int32_t region = 0;
    std::int32_t task = 0; ///< number within its region
};

/// All visits of one group of a region of sweeps.
struct GroupSpan {
    std::int32_t region = 0;
    std::int32_t tasks = 0; ///< that may run side by side
    std::int64_t visits = 0;
    std::int64_t barriers = 0; ///< visits after which all threads wait for all; after the others for their neighbours
    std::int64_t busy = 0;     ///< ns, all visits and threads together
};

/// The tasks that wait for a task; -1: none.
using Successors = std::array<std::int32_t, 2>;

struct RegionRecord {
    const char* name = "";
    RegionKind kind = RegionKind::loop;
    std::int32_t tasks = 0;          ///< sweeps: the most threads that they are given, 0: by sweep_width of all groups
    std::int64_t begin = 0, end = 0; ///< ns, on the thread that began it
    std::int64_t first_link = 0;     ///< ordered: its tasks' successors, in TaskRecord::links
    std::int64_t step = 0;
};

/// A stretch of the calling thread's time that has a name: a step, or a part of one.
struct PhaseSpan {
    const char* name = "";
    std::int64_t begin = 0, end = 0; ///< ns
    std::int64_t step = 0;
};

/// Everything that was recorded.
struct TaskRecord {
    std::vector<RegionRecord> regions;
    std::vector<std::vector<TaskSpan>> threads; ///< by thread, in the order in which it ran them
    std::vector<GroupSpan> groups;
    std::vector<Successors> links;
    std::vector<PhaseSpan> phases; ///< in the order in which they ended
};

/// Phases by their begin, outer ones before those inside them; of two equal ones that which ended later is the outer.
[[nodiscard]] std::vector<const PhaseSpan*> phases_in_order(const TaskRecord& record);

/// Owned by whoever asked for the record; written by the team's threads, each to its own list.
class TaskRecorder {
  public:
    explicit TaskRecorder(int threads);

    /// ns since the recorder was made.
    [[nodiscard]] std::int64_t now() const;
    /// Whether steps are recorded at present.
    [[nodiscard]] bool active() const { return active_; }
    void set_active(bool active) { active_ = active; }
    void set_step(std::int64_t step) { step_ = step; }
    /// Forgets what was recorded since set_step(): the step was undone. Between regions only.
    void drop_step();

    /// Begins a region; only the thread that calls the team does. `successors` of ordered tasks, else null.
    std::int32_t begin_region(const char* name, RegionKind kind, std::int32_t tasks, const Successors* successors);
    void end_region(std::int32_t region) { record_.regions[static_cast<std::size_t>(region)].end = now(); }
    void add_task(int thread, const TaskSpan& span) {
        record_.threads[static_cast<std::size_t>(thread)].push_back(span);
    }
    void add_group(const GroupSpan& group) { record_.groups.push_back(group); }
    void add_phase(const char* name, std::int64_t begin, std::int64_t end) {
        record_.phases.push_back({name, begin, end, step_});
    }

    [[nodiscard]] const TaskRecord& record() const { return record_; }

  private:
    std::int64_t start_;
    bool active_ = true;
    std::int64_t step_ = 0;
    TaskRecord record_;
};

} // namespace flotilla
