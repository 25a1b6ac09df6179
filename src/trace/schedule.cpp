// SPDX-License-Identifier: MIT
#include "trace/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <string_view>

#include "parallel/parallel_for.hpp"
#include "parallel/sweep_width.hpp"

namespace flotilla {

CostModel::CostModel(std::vector<ThreadCosts> measured, Growth growth)
    : measured_(std::move(measured)), growth_(growth) {
    std::erase_if(measured_, [](const ThreadCosts& c) { return c.threads < 2; });
    std::stable_sort(measured_.begin(), measured_.end(),
                     [](const ThreadCosts& a, const ThreadCosts& b) { return a.threads < b.threads; });
    const auto same = [](const ThreadCosts& a, const ThreadCosts& b) { return a.threads == b.threads; };
    measured_.erase(std::unique(measured_.begin(), measured_.end(), same), measured_.end());
    assumed_ = measured_.empty();
    if (assumed_) measured_.push_back(kAssumedCosts);
}

ThreadCosts CostModel::at(int threads) const {
    if (threads <= 1) return {1, 0, 0, 0};
    const auto upper = std::lower_bound(measured_.begin(), measured_.end(), threads,
                                        [](const ThreadCosts& c, int n) { return c.threads < n; });
    if (upper == measured_.end()) {
        const ThreadCosts& last = measured_.back();
        const double factor = growth_ == Growth::log2 ? std::log2(threads) / std::log2(last.threads)
                                                      : static_cast<double>(threads) / last.threads;
        return {threads, factor * last.fork_join, factor * last.barrier, last.hand_over};
    }
    if (upper->threads == threads) return *upper;
    // Between one thread, which pays nothing, or the next narrower width, and the next wider one.
    const ThreadCosts lower = upper == measured_.begin() ? ThreadCosts{1, 0, 0, upper->hand_over} : *(upper - 1);
    const double t = static_cast<double>(threads - lower.threads) / (upper->threads - lower.threads);
    return {threads, std::lerp(lower.fork_join, upper->fork_join, t), std::lerp(lower.barrier, upper->barrier, t),
            std::lerp(lower.hand_over, upper->hand_over, t)};
}

std::int64_t RegionTasks::num_tasks() const {
    if (kind != RegionKind::sweeps) return static_cast<std::int64_t>(durations.size());
    return std::accumulate(groups.begin(), groups.end(), std::int64_t{0},
                           [](std::int64_t sum, const GroupSpan& g) { return sum + g.visits * g.tasks; });
}

RegionTable::RegionTable(const TaskRecord& record) : record_(record) {
    first_.push_back(0);
    for (const RegionRecord& region : record.regions)
        first_.push_back(first_.back() +
                         (region.kind == RegionKind::sweeps ? 0u : static_cast<std::size_t>(region.tasks)));
    durations_.assign(first_.back(), 0);
    for (const auto& list : record.threads)
        for (const TaskSpan& s : list)
            durations_[first_[static_cast<std::size_t>(s.region)] + static_cast<std::size_t>(s.task)] = s.end - s.begin;
    groups_ = record.groups;
    std::stable_sort(groups_.begin(), groups_.end(),
                     [](const GroupSpan& a, const GroupSpan& b) { return a.region < b.region; });
    std::size_t group = 0;
    for (std::size_t r = 0; r <= record.regions.size(); ++r) {
        while (group < groups_.size() && static_cast<std::size_t>(groups_[group].region) < r) ++group;
        first_group_.push_back(group);
    }
}

RegionTasks RegionTable::operator[](std::size_t region) const {
    const RegionRecord& r = record_.regions[region];
    RegionTasks tasks;
    tasks.kind = r.kind;
    tasks.durations = std::span(durations_).subspan(first_[region], first_[region + 1] - first_[region]);
    if (r.kind == RegionKind::ordered)
        tasks.successors =
            std::span(record_.links).subspan(static_cast<std::size_t>(r.first_link), static_cast<std::size_t>(r.tasks));
    if (r.kind == RegionKind::sweeps) {
        tasks.most_threads = r.tasks;
        tasks.groups =
            std::span(groups_).subspan(first_group_[region], first_group_[region + 1] - first_group_[region]);
    }
    return tasks;
}

namespace {

/// One task of a group, one visit.
double task_time(const GroupSpan& g) {
    const double tasks = static_cast<double>(g.visits) * g.tasks;
    return tasks > 0 ? static_cast<double>(g.busy) / tasks : 0;
}

double time_of(const RegionTasks& region, std::int32_t task) {
    return static_cast<double>(region.durations[static_cast<std::size_t>(task)]);
}

/// On `cores` cores without forking and joining.
double loop_time(const RegionTasks& region, std::size_t cores, ScheduleScratch& s) {
    s.free_at.assign(cores, 0);
    for (const std::int64_t duration : region.durations) {
        std::pop_heap(s.free_at.begin(), s.free_at.end(), std::greater<>());
        s.free_at.back() += static_cast<double>(duration);
        std::push_heap(s.free_at.begin(), s.free_at.end(), std::greater<>());
    }
    return *std::max_element(s.free_at.begin(), s.free_at.end());
}

/// One greedy schedule of an ordered run: cores that become free take the lowest task that is ready.
class OrderedSchedule {
  public:
    OrderedSchedule(const RegionTasks& region, std::size_t cores, double hand_over, ScheduleScratch& scratch)
        : region_(region), hand_over_(hand_over), s_(scratch) {
        const std::size_t n = region.durations.size();
        s_.waits.assign(n, 0);
        for (const Successors& next : region.successors)
            for (const std::int32_t task : next)
                if (task >= 0) ++s_.waits[static_cast<std::size_t>(task)];
        s_.releaser.assign(n, -1);
        s_.ready.clear();
        for (std::size_t i = 0; i < n; ++i)
            if (s_.waits[i] == 0) s_.ready.push_back(static_cast<std::int32_t>(i)); // sorted: a heap
        s_.idle.assign(cores, 1);
        s_.idle_cores.resize(cores);
        std::iota(s_.idle_cores.rbegin(), s_.idle_cores.rend(), 0);
        num_idle_ = cores;
        s_.running.clear();
    }

    double run() {
        double now = 0;
        start_tasks(now);
        while (!s_.running.empty()) {
            std::pop_heap(s_.running.begin(), s_.running.end(), later);
            const ScheduleScratch::Running done = s_.running.back();
            s_.running.pop_back();
            now = done.end;
            s_.idle[static_cast<std::size_t>(done.core)] = 1;
            s_.idle_cores.push_back(done.core);
            ++num_idle_;
            release(done);
            start_tasks(now);
        }
        return now;
    }

  private:
    static bool later(const ScheduleScratch::Running& a, const ScheduleScratch::Running& b) {
        return a.end != b.end ? a.end > b.end : a.task > b.task;
    }

    void release(const ScheduleScratch::Running& done) {
        for (const std::int32_t next : region_.successors[static_cast<std::size_t>(done.task)])
            if (next >= 0 && --s_.waits[static_cast<std::size_t>(next)] == 0) {
                s_.releaser[static_cast<std::size_t>(next)] = done.core;
                s_.ready.push_back(next);
                std::push_heap(s_.ready.begin(), s_.ready.end(), std::greater<>());
            }
    }

    /// The core that released the task where it idles, else any.
    std::int32_t take_core(std::int32_t releaser) {
        --num_idle_;
        if (releaser >= 0 && s_.idle[static_cast<std::size_t>(releaser)] != 0) {
            s_.idle[static_cast<std::size_t>(releaser)] = 0; // its entry in the list is stale now
            return releaser;
        }
        for (;;) {
            const std::int32_t core = s_.idle_cores.back();
            s_.idle_cores.pop_back();
            if (s_.idle[static_cast<std::size_t>(core)] == 0) continue;
            s_.idle[static_cast<std::size_t>(core)] = 0;
            return core;
        }
    }

    void start_tasks(double now) {
        while (num_idle_ > 0 && !s_.ready.empty()) {
            std::pop_heap(s_.ready.begin(), s_.ready.end(), std::greater<>());
            const std::int32_t task = s_.ready.back();
            s_.ready.pop_back();
            const std::int32_t releaser = s_.releaser[static_cast<std::size_t>(task)];
            const std::int32_t core = take_core(releaser);
            const double cost = releaser >= 0 && core != releaser ? hand_over_ : 0;
            s_.running.push_back({now + cost + time_of(region_, task), core, task});
            std::push_heap(s_.running.begin(), s_.running.end(), later);
        }
    }

    const RegionTasks& region_;
    double hand_over_;
    ScheduleScratch& s_;
    std::size_t num_idle_ = 0;
};

double sweeps_time(const RegionTasks& region, int cores, const CostModel& costs) {
    std::size_t tasks = 0;
    for (const GroupSpan& g : region.groups) tasks += static_cast<std::size_t>(g.tasks);
    const int width = region.most_threads > 0 ? std::clamp(cores, 1, region.most_threads)
                                              : sweep_width(tasks, region.groups.size(), cores);
    const ThreadCosts c = costs.at(width);
    double time = c.fork_join;
    for (const GroupSpan& g : region.groups) {
        const std::int64_t rounds = (g.tasks + width - 1) / width;
        time += static_cast<double>(g.visits * rounds) * task_time(g);
        time += static_cast<double>(g.barriers) * c.barrier + static_cast<double>(g.visits - g.barriers) * c.hand_over;
    }
    return time;
}

} // namespace

double region_work(const RegionTasks& region) {
    double sum = 0;
    for (const std::int64_t d : region.durations) sum += static_cast<double>(d);
    for (const GroupSpan& g : region.groups) sum += static_cast<double>(g.busy);
    return sum;
}

double region_critical_path(const RegionTasks& region) {
    double longest = 0;
    if (region.kind == RegionKind::sweeps) {
        for (const GroupSpan& g : region.groups) longest += static_cast<double>(g.visits) * task_time(g);
        return longest;
    }
    if (region.kind == RegionKind::loop) {
        for (const std::int64_t d : region.durations) longest = std::max(longest, static_cast<double>(d));
        return longest;
    }
    // Successors have higher numbers, so one pass in list order meets every task after all that it waits for.
    std::vector<double> start(region.durations.size(), 0);
    for (std::size_t i = 0; i < start.size(); ++i) {
        const double end = start[i] + static_cast<double>(region.durations[i]);
        longest = std::max(longest, end);
        for (const std::int32_t next : region.successors[i])
            if (next >= 0) start[static_cast<std::size_t>(next)] = std::max(start[static_cast<std::size_t>(next)], end);
    }
    return longest;
}

double region_time(const RegionTasks& region, int cores, const CostModel& costs, ScheduleScratch& scratch) {
    if (region.kind == RegionKind::sweeps) return sweeps_time(region, cores, costs);
    const std::size_t width =
        std::clamp<std::size_t>(region.durations.size(), 1, static_cast<std::size_t>(std::max(cores, 1)));
    if (width == 1) return region_work(region);
    const ThreadCosts c = costs.at(static_cast<int>(width));
    return c.fork_join + (region.kind == RegionKind::loop ? loop_time(region, width, scratch)
                                                          : OrderedSchedule(region, width, c.hand_over, scratch).run());
}

namespace {

using Kind = ScheduleRow::Kind;

Kind kind_of(RegionKind kind) {
    return kind == RegionKind::loop ? Kind::loop : kind == RegionKind::ordered ? Kind::ordered : Kind::sweeps;
}

/// The rows as a tree, and the phases that are open while the record is walked through in time.
class RowTree {
  public:
    explicit RowTree(std::size_t num_widths) : num_widths_(num_widths) { add_node(-1, "total", Kind::phase); }

    static constexpr int kRoot = 0;
    static constexpr double kLeastRest = 1e-3; // of the phase's work

    [[nodiscard]] ScheduleRow& row(int node) { return nodes_[static_cast<std::size_t>(node)].row; }
    [[nodiscard]] int parent(int node) const { return nodes_[static_cast<std::size_t>(node)].parent; }

    /// The part of `node` of this name and kind.
    int part(int node, std::string_view name, Kind kind) {
        for (const int p : nodes_[static_cast<std::size_t>(node)].parts)
            if (row(p).kind == kind && row(p).name == name) return p;
        const int added = add_node(node, name, kind);
        nodes_[static_cast<std::size_t>(node)].parts.push_back(added);
        return added;
    }

    /// Adds to a row and to everything that it is part of.
    template <class F>
    void up(int node, F&& add) {
        for (; node >= 0; node = parent(node)) add(row(node));
    }

    /// Where a phase has phases as parts, what is in none of them becomes a part of its own, unless that is next to
    /// nothing.
    void add_rests() {
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            const auto parts = nodes_[i].parts;
            const bool split = i != kRoot && std::any_of(parts.begin(), parts.end(),
                                                         [&](int p) { return row(p).kind == Kind::phase; });
            if (!split) continue;
            double serial = nodes_[i].row.serial;
            for (const int p : parts) serial -= row(p).serial;
            if (serial < kLeastRest * nodes_[i].row.work) continue;
            const int rest = part(static_cast<int>(i), "rest", Kind::rest);
            ScheduleRow& r = row(rest);
            r.wall = r.serial = r.work = r.critical_path = serial;
            std::fill(r.time.begin(), r.time.end(), serial);
            r.count = nodes_[i].row.count;
        }
    }

    void write(int node, int depth, std::vector<ScheduleRow>& out) {
        for (const int p : nodes_[static_cast<std::size_t>(node)].parts) {
            row(p).depth = depth;
            out.push_back(row(p));
            write(p, depth + 1, out);
        }
    }

  private:
    struct Node {
        ScheduleRow row;
        int parent = -1;
        std::vector<int> parts;
    };

    int add_node(int parent, std::string_view name, Kind kind) {
        Node node;
        node.row.name = name;
        node.row.kind = kind;
        node.row.time.assign(num_widths_, 0);
        node.parent = parent;
        nodes_.push_back(std::move(node));
        return static_cast<int>(nodes_.size()) - 1;
    }

    std::size_t num_widths_;
    std::vector<Node> nodes_;
};

class ScheduleMaker {
  public:
    ScheduleMaker(const TaskRecord& record, const CostModel& costs, std::vector<int> widths)
        : record_(record),
          costs_(costs),
          table_(record),
          phases_(phases_in_order(record)),
          rows_(widths.size()),
          one_thread_(record.threads.size() == 1),
          scratch_(widths.size()) {
        out_.widths = std::move(widths);
    }

    Schedule make() {
        for (std::size_t r = 0; r < record_.regions.size(); ++r) {
            open_phases(record_.regions[r].begin);
            add_region(r);
        }
        open_phases(std::numeric_limits<std::int64_t>::max());
        rows_.add_rests();
        rows_.write(RowTree::kRoot, 0, out_.rows);
        out_.total = rows_.row(RowTree::kRoot);
        return std::move(out_);
    }

  private:
    struct Open {
        std::int64_t end;
        int node;
    };

    [[nodiscard]] int innermost() const { return open_.empty() ? RowTree::kRoot : open_.back().node; }

    /// Adds the phases that begin by `time` and forgets those that have ended.
    void open_phases(std::int64_t time) {
        for (; next_ < phases_.size() && phases_[next_]->begin <= time; ++next_) {
            const PhaseSpan& phase = *phases_[next_];
            close_phases(phase.begin, phase.end);
            const int node = rows_.part(innermost(), phase.name, Kind::phase);
            const auto wall = static_cast<double>(phase.end - phase.begin);
            ++rows_.row(node).count;
            rows_.row(node).wall += wall;
            add_serial(rows_.row(node), wall);
            if (open_.empty()) { // else this time was added with the phase around it
                ++rows_.row(RowTree::kRoot).count;
                rows_.row(RowTree::kRoot).wall += wall;
                add_serial(rows_.row(RowTree::kRoot), wall);
            }
            open_.push_back({phase.end, node});
        }
        close_phases(time, time);
    }

    /// Those that do not hold (begin, end].
    void close_phases(std::int64_t begin, std::int64_t end) {
        while (!open_.empty() && (open_.back().end < end || open_.back().end <= begin)) open_.pop_back();
    }

    static void add_serial(ScheduleRow& row, double time) {
        row.serial += time;
        row.work += time;
        row.critical_path += time;
        for (double& t : row.time) t += time;
    }

    /// ns of the regions that begin before this one ends: they follow it in the record.
    [[nodiscard]] double inner_wall(std::size_t index) const {
        double sum = 0;
        for (std::size_t r = index + 1;
             r < record_.regions.size() && record_.regions[r].begin < record_.regions[index].end; ++r)
            sum += static_cast<double>(record_.regions[r].end - record_.regions[r].begin);
        return sum;
    }

    void add_region(std::size_t index) {
        const RegionRecord& record = record_.regions[index];
        const RegionTasks region = table_[index];
        const auto wall = static_cast<double>(record.end - record.begin);
        const double work = region_work(region), path = region_critical_path(region);
        // Between its sweeps a region may have others, whose time is added with themselves.
        const double of_others = region.kind == RegionKind::sweeps ? inner_wall(index) : 0;
        const double gaps =
            one_thread_ && region.kind == RegionKind::sweeps ? std::max(0.0, wall - of_others - work) : 0;
        std::vector<double> time(out_.widths.size());
        constexpr std::int64_t kLarge = 1 << 14; // tasks that are worth threads
        parallel_for(time.size(), region.durations.size() < kLarge ? 1 : default_threads(),
                     [&](std::size_t w) { time[w] = region_time(region, out_.widths[w], costs_, scratch_[w]); });
        const int phase = innermost();
        if (phase == RowTree::kRoot)
            rows_.row(phase).wall += wall - of_others;
        else // was added as serial with its phase
            rows_.up(phase, [&](ScheduleRow& row) { add_serial(row, of_others - wall); });
        const int node = rows_.part(phase, record.name, kind_of(record.kind));
        ++rows_.row(node).count;
        rows_.row(node).wall += wall;
        rows_.up(node, [&](ScheduleRow& row) {
            ++row.regions;
            row.tasks += region.num_tasks();
            row.work += work;
            row.critical_path += path;
            for (std::size_t w = 0; w < time.size(); ++w) row.time[w] += time[w];
            add_serial(row, gaps);
        });
        out_.tasks_time += work;
    }

    const TaskRecord& record_;
    const CostModel& costs_;
    RegionTable table_;
    std::vector<const PhaseSpan*> phases_;
    std::size_t next_ = 0;
    std::vector<Open> open_;
    RowTree rows_;
    bool one_thread_;
    std::vector<ScheduleScratch> scratch_; ///< by width
    Schedule out_;
};

} // namespace

Schedule make_schedule(const TaskRecord& record, const CostModel& costs, std::vector<int> widths) {
    return ScheduleMaker(record, costs, std::move(widths)).make();
}

} // namespace flotilla
