// SPDX-License-Identifier: MIT
#include "trace/trace_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string_view>

#include <flotilla/build_info.hpp>
#include <flotilla/error.hpp>

#include "io/json_document.hpp"
#include "io/number.hpp"
#include "run_folder/file_stream.hpp"
#include "run_folder/run_files.hpp"

namespace flotilla::io {
namespace {

namespace fs = std::filesystem;

constexpr int kFormat = 2;
constexpr std::array<std::string_view, 3> kRegionKinds{"loop", "ordered", "sweeps"};

/// ns as us with three decimals.
void append_us(std::string& text, std::int64_t ns) {
    append_number(text, ns / 1000);
    const auto rest = static_cast<int>(ns % 1000);
    text += {'.', static_cast<char>('0' + rest / 100), static_cast<char>('0' + rest / 10 % 10),
             static_cast<char>('0' + rest % 10)};
}

void append_integers(std::string& text, std::string_view key, std::initializer_list<std::int64_t> values) {
    text += key;
    bool first = true;
    for (const std::int64_t v : values) {
        text += first ? "[" : ",";
        append_number(text, v);
        first = false;
    }
    text += ']';
}

class TraceWriter {
  public:
    TraceWriter(const fs::path& path, const TaskRecord& record) : out_(path), record_(record) {}

    void write(const TraceInfo& info) {
        out_.write("{\"displayTimeUnit\":\"ns\",\n\"otherData\":");
        out_.write(other_data(info).dump(-1, ' ', true, Json::error_handler_t::replace));
        out_.write(",\n\"traceEvents\":[\n"
                   "{\"name\":\"process_name\",\"ph\":\"M\",\"pid\":1,\"args\":{\"name\":\"flotilla\"}}");
        for (std::size_t t = 0; t < record_.threads.size(); ++t) {
            text_ = ",\n{\"name\":\"thread_name\",\"ph\":\"M\",\"pid\":1,\"tid\":";
            append_number(text_, t);
            text_ += ",\"args\":{\"name\":\"thread ";
            append_number(text_, t);
            text_ += "\"}}";
            out_.write(text_);
        }
        write_phases();
        write_regions();
        for (std::size_t t = 0; t < record_.threads.size(); ++t)
            for (const TaskSpan& s : record_.threads[t]) write_task(s, t);
        out_.write("\n]}\n");
        out_.close();
    }

  private:
    static Json other_data(const TraceInfo& info) {
        const BuildInfo build = build_info();
        Json threads = Json::array(), fork_join = threads, barrier = threads, hand_over = threads;
        for (const ThreadCosts& c : info.costs) {
            threads.push_back(c.threads);
            fork_join.push_back(c.fork_join);
            barrier.push_back(c.barrier);
            hand_over.push_back(c.hand_over);
        }
        return {{"flotilla_trace", kFormat},
                {"version", build.version},
                {"commit", build.commit},
                {"processor", processor_name()},
                {"threads", info.threads},
                {"command_line", info.command_line},
                {"steps", info.steps},
                {"trace_every", info.trace_every},
                {"cpu_seconds", info.cpu_seconds},
                {"wall_seconds", info.wall_seconds},
                {"cost_threads", threads},
                {"cost_fork_join_ns", fork_join},
                {"cost_barrier_ns", barrier},
                {"cost_hand_over_ns", hand_over}};
    }

    /// Everything up to the arguments.
    void begin_event(const char* name, std::string_view category, std::int64_t begin, std::int64_t end,
                     std::size_t thread) {
        text_ = ",\n{\"name\":";
        text_ += quoted(name);
        text_ += ",\"cat\":\"";
        text_ += category;
        text_ += "\",\"ph\":\"X\",\"ts\":";
        append_us(text_, begin);
        text_ += ",\"dur\":";
        append_us(text_, end - begin);
        text_ += ",\"pid\":1,\"tid\":";
        append_number(text_, thread);
        text_ += ",\"args\":{";
    }

    /// Names are few and used often.
    const std::string& quoted(const char* name) {
        std::string& text = quoted_[name];
        if (text.empty()) text = Json(name).dump(-1, ' ', true, Json::error_handler_t::replace);
        return text;
    }

    /// Outer ones first, which viewers rely on where two begin at once.
    void write_phases() {
        for (const PhaseSpan* p : phases_in_order(record_)) {
            begin_event(p->name, "phase", p->begin, p->end, 0);
            text_ += "\"step\":";
            append_number(text_, p->step);
            text_ += "}}";
            out_.write(text_);
        }
    }

    void write_regions() {
        std::vector<std::string> groups(record_.regions.size());
        for (const GroupSpan& g : record_.groups) {
            std::string& text = groups[static_cast<std::size_t>(g.region)];
            append_integers(text, text.empty() ? "" : ",", {g.tasks, g.visits, g.barriers, g.busy});
        }
        for (std::size_t r = 0; r < record_.regions.size(); ++r) {
            const RegionRecord& region = record_.regions[r];
            begin_event(region.name, kRegionKinds[static_cast<std::size_t>(region.kind)], region.begin, region.end, 0);
            text_ += "\"region\":";
            append_number(text_, r);
            text_ += ",\"tasks\":";
            append_number(text_, region.tasks);
            text_ += ",\"step\":";
            append_number(text_, region.step);
            if (region.kind == RegionKind::sweeps) text_ += ",\"groups\":[" + groups[r] + "]";
            text_ += "}}";
            out_.write(text_);
        }
    }

    void write_task(const TaskSpan& span, std::size_t thread) {
        const RegionRecord& region = record_.regions[static_cast<std::size_t>(span.region)];
        begin_event(region.name, "task", span.begin, span.end, thread);
        text_ += "\"region\":";
        append_number(text_, span.region);
        text_ += ",\"task\":";
        append_number(text_, span.task);
        if (region.kind == RegionKind::ordered) {
            const Successors& next = record_.links[static_cast<std::size_t>(region.first_link + span.task)];
            if (next[0] >= 0 && next[1] >= 0)
                append_integers(text_, ",\"next\":", {next[0], next[1]});
            else if (next[0] >= 0 || next[1] >= 0)
                append_integers(text_, ",\"next\":", {std::max(next[0], next[1])});
            else
                text_ += ",\"next\":[]";
        }
        text_ += "}}";
        out_.write(text_);
    }

    OutputStream out_;
    const TaskRecord& record_;
    std::string text_; ///< of one event
    std::map<const char*, std::string> quoted_;
};

/// One event, as far as it matters here.
struct Event {
    std::string name, category, kind;
    double ts = 0, dur = 0; ///< us
    std::optional<std::int64_t> thread, region, task, tasks, step;
    std::vector<std::int64_t> next, groups;
    void clear() {
        name.clear(), category.clear(), kind.clear();
        ts = dur = 0;
        thread = region = task = tasks = step = std::nullopt;
        next.clear(), groups.clear();
    }
};

/// Takes the file apart while it is parsed: millions of events are never a document in memory.
class TraceReader : public nlohmann::json_sax<Json> {
  public:
    TraceReader(const fs::path& path, Trace& trace) : path_(path), trace_(trace) {}

    bool null() override { return scalar(nullptr); }
    bool boolean(bool value) override { return scalar(value); }
    bool number_integer(std::int64_t value) override { return number(static_cast<double>(value), value); }
    bool number_unsigned(std::uint64_t value) override {
        return number(static_cast<double>(value), static_cast<std::int64_t>(value));
    }
    bool number_float(double value, const std::string&) override { return number(value, std::nullopt); }
    bool string(std::string& value) override {
        if (in_event() && depth_ == kEvent) {
            if (key_ == "name") event_.name = value;
            if (key_ == "cat") event_.category = value;
            if (key_ == "ph") event_.kind = value;
        }
        return scalar(value);
    }
    bool binary(Json::binary_t&) override { return false; }
    bool key(std::string& name) override {
        if (depth_ == kTop) top_ = name;
        if (depth_ == kEvent) in_args_ = name == "args";
        if (depth_ == kOther || depth_ == kEvent || depth_ == kArgs) key_ = name;
        return true;
    }
    bool start_object(std::size_t) override {
        ++depth_;
        if (in_event() && depth_ == kEvent) event_.clear(), key_.clear(), in_args_ = false;
        return true;
    }
    bool end_object() override {
        if (in_event() && depth_ == kEvent) take_event();
        --depth_;
        return true;
    }
    bool start_array(std::size_t) override {
        if (++depth_ == kTop) refuse("not an object"); // a bare list of events is a trace, not one of ours
        return true;
    }
    bool end_array() override {
        --depth_;
        return true;
    }
    bool parse_error(std::size_t byte, const std::string&, const Json::exception&) override {
        refuse("no JSON from byte " + std::to_string(byte) + " on");
    }

    void finish() {
        read_info();
        check_complete();
    }

  private:
    // How deep values are: {"otherData": {2}, "traceEvents": [2 {3 "args": {4 "groups": [5 [6]]}}]}.
    static constexpr int kTop = 1, kOther = 2, kEvent = 3, kArgs = 4;

    [[noreturn]] void refuse(const std::string& reason) const {
        throw InputError(path_.string() + ": not a trace of flotilla run: " + reason);
    }
    [[noreturn]] void refuse_event(const std::string& reason) const {
        throw InputError(path_.string() + ": event " + std::to_string(events_) + " (" + event_.name + "): " + reason);
    }

    [[nodiscard]] bool in_event() const { return depth_ >= kEvent && top_ == "traceEvents"; }

    bool scalar(const Json& value) {
        if (depth_ == 0) refuse("not an object");
        if (top_ == "otherData" && depth_ >= kOther) other_[key_].push_back(value);
        return true;
    }

    bool number(double value, std::optional<std::int64_t> integer) {
        if (!in_event()) return integer ? scalar(*integer) : scalar(value);
        if (depth_ == kEvent) {
            if (key_ == "ts") event_.ts = value;
            if (key_ == "dur") event_.dur = value;
            if (key_ == "tid") event_.thread = integer;
        } else if (in_args_ && depth_ == kArgs) {
            if (key_ == "region") event_.region = integer;
            if (key_ == "task") event_.task = integer;
            if (key_ == "tasks") event_.tasks = integer;
            if (key_ == "step") event_.step = integer;
        } else if (in_args_ && integer) {
            if (key_ == "next") event_.next.push_back(*integer);
            if (key_ == "groups") event_.groups.push_back(*integer);
        }
        return true;
    }

    void take_event() {
        ++events_;
        if (event_.kind != "X") return;
        const auto kind = std::find(kRegionKinds.begin(), kRegionKinds.end(), event_.category);
        if (event_.category == "task")
            take_task();
        else if (event_.category == "phase")
            take_phase();
        else if (kind != kRegionKinds.end())
            take_region(static_cast<RegionKind>(kind - kRegionKinds.begin()));
    }

    /// ns. Doubles hold times of days to a fraction of a ns.
    [[nodiscard]] std::int64_t nanoseconds(double us) const {
        constexpr double kMost = 1e12; // us, 11 days
        if (!(us >= 0) || us > kMost) refuse_event("a time is out of range");
        return std::llround(1000 * us);
    }
    [[nodiscard]] std::int64_t begin() const { return nanoseconds(event_.ts); }
    [[nodiscard]] std::int64_t end() const { return begin() + nanoseconds(event_.dur); }

    /// An argument in [0, limit).
    [[nodiscard]] std::int32_t argument(std::optional<std::int64_t> value, std::int64_t limit, const char* name) const {
        if (!value) refuse_event(std::string("has no ") + name);
        if (*value < 0 || *value >= limit)
            refuse_event(std::string(name) + " " + std::to_string(*value) + " out of range");
        return static_cast<std::int32_t>(*value);
    }

    const char* interned() {
        const auto found = trace_.names.find(event_.name);
        return (found != trace_.names.end() ? found : trace_.names.insert(event_.name).first)->c_str();
    }

    void take_phase() { trace_.record.phases.push_back({interned(), begin(), end(), event_.step.value_or(0)}); }

    void take_region(RegionKind kind) {
        TaskRecord& record = trace_.record;
        const auto next = static_cast<std::int64_t>(record.regions.size());
        if (event_.region != next) refuse_event("is not region " + std::to_string(next));
        const std::int32_t tasks = argument(event_.tasks, kMostTasks, "tasks");
        if (!record.regions.empty() && begin() < record.regions.back().begin) refuse_event("begins before the last");
        record.regions.push_back({interned(), kind, tasks, begin(), end(), num_links_, event_.step.value_or(0)});
        if (kind == RegionKind::sweeps)
            take_groups(static_cast<std::int32_t>(next));
        else
            num_tasks_ += tasks;
        if (kind == RegionKind::ordered) num_links_ += tasks;
    }

    void take_groups(std::int32_t region) {
        if (event_.groups.size() % 4 != 0) refuse_event("groups are not in fours");
        for (std::size_t i = 0; i < event_.groups.size(); i += 4) {
            GroupSpan group{region, argument(event_.groups[i], kMostTasks, "group")};
            group.visits = event_.groups[i + 1];
            group.barriers = event_.groups[i + 2];
            group.busy = event_.groups[i + 3];
            if (group.barriers < 0 || group.visits < group.barriers || group.busy < 0)
                refuse_event("a group is out of range");
            trace_.record.groups.push_back(group);
        }
    }

    void take_task() {
        TaskRecord& record = trace_.record;
        const std::int32_t r = argument(event_.region, static_cast<std::int64_t>(record.regions.size()), "region");
        const RegionRecord& region = record.regions[static_cast<std::size_t>(r)];
        if (region.kind == RegionKind::sweeps) refuse_event("is a task of sweeps");
        const std::int32_t task = argument(event_.task, region.tasks, "task");
        const auto thread = static_cast<std::size_t>(argument(event_.thread, kMostThreads, "tid"));
        if (record.threads.size() <= thread) record.threads.resize(thread + 1);
        record.threads[thread].push_back({begin(), end(), r, task});
        if (region.kind == RegionKind::ordered) take_links(region, task);
    }

    void take_links(const RegionRecord& region, std::int32_t task) {
        if (event_.next.empty()) return;
        Successors links{-1, -1};
        if (event_.next.size() > links.size()) refuse_event("more than two tasks wait for it");
        for (std::size_t k = 0; k < event_.next.size(); ++k) {
            links[k] = argument(event_.next[k], region.tasks, "next");
            if (links[k] <= task) refuse_event("a task that waits for it has a lower number");
        }
        links_.emplace_back(region.first_link + task, links);
    }

    /// The value of a key of otherData.
    template <class T>
    [[nodiscard]] T other(const char* key) const {
        const auto found = other_.find(key);
        try {
            if (found != other_.end() && found->second.size() == 1) return found->second[0].template get<T>();
        } catch (const Json::exception&) { // of another type
        }
        refuse(std::string("no ") + key + " in otherData");
    }
    template <class T>
    [[nodiscard]] std::vector<T> others(const char* key) const {
        const auto found = other_.find(key);
        std::vector<T> values;
        if (found == other_.end()) return values;
        try {
            for (const Json& value : found->second) values.push_back(value.template get<T>());
        } catch (const Json::exception&) {
            refuse(std::string(key) + " of otherData has elements of the wrong type");
        }
        return values;
    }

    void read_info() {
        if (!other_.contains("flotilla_trace")) refuse("no flotilla_trace in otherData");
        if (const int format = other<int>("flotilla_trace"); format != kFormat)
            throw InputError(path_.string() + ": a trace of format " + std::to_string(format) +
                             "; this program reads " + std::to_string(kFormat));
        TraceInfo& info = trace_.info;
        info.version = other<std::string>("version");
        info.commit = other<std::string>("commit");
        info.processor = other<std::string>("processor");
        info.threads = other<int>("threads");
        info.command_line = others<std::string>("command_line");
        info.steps = other<std::int64_t>("steps");
        info.trace_every = other<int>("trace_every");
        info.cpu_seconds = other<double>("cpu_seconds");
        info.wall_seconds = other<double>("wall_seconds");
        const auto threads = others<int>("cost_threads");
        const auto fork_join = others<double>("cost_fork_join_ns"), barrier = others<double>("cost_barrier_ns"),
                   hand_over = others<double>("cost_hand_over_ns");
        if (fork_join.size() != threads.size() || barrier.size() != threads.size() ||
            hand_over.size() != threads.size())
            refuse("the costs in otherData are not of equal length");
        for (std::size_t i = 0; i < threads.size(); ++i)
            info.costs.push_back({threads[i], fork_join[i], barrier[i], hand_over[i]});
    }

    void check_complete() {
        if (trace_.info.threads < 1 || trace_.info.threads > kMostThreads) refuse("threads out of range");
        const auto threads = static_cast<std::size_t>(trace_.info.threads);
        if (trace_.record.threads.size() > threads)
            throw InputError(path_.string() + ": has tasks of more threads than it says");
        trace_.record.threads.resize(threads);
        check_tasks();
        trace_.record.links.assign(static_cast<std::size_t>(num_links_), {-1, -1});
        for (const auto& [place, links] : links_) trace_.record.links[static_cast<std::size_t>(place)] = links;
    }

    /// Every task of every region is there once. What regions say of their tasks' number is a number in a file:
    /// nothing of that size is made before the tasks were counted.
    void check_tasks() const {
        std::vector<std::pair<std::int32_t, std::int32_t>> tasks;
        for (const auto& thread : trace_.record.threads)
            for (const TaskSpan& t : thread) tasks.emplace_back(t.region, t.task);
        std::sort(tasks.begin(), tasks.end());
        const auto twice = std::adjacent_find(tasks.begin(), tasks.end());
        if (twice != tasks.end())
            throw InputError(path_.string() + ": task " + std::to_string(twice->second) + " of region " +
                             std::to_string(twice->first) + " again");
        const std::int64_t missing = num_tasks_ - static_cast<std::int64_t>(tasks.size());
        if (missing > 0) throw InputError(path_.string() + ": " + std::to_string(missing) + " tasks are missing");
    }

    static constexpr std::int64_t kMostTasks = std::int64_t{1} << 31, kMostThreads = 1 << 16;

    const fs::path& path_;
    Trace& trace_;
    int depth_ = 0;
    std::string top_, key_;
    bool in_args_ = false;
    Event event_;
    std::int64_t events_ = 0;
    std::map<std::string, std::vector<Json>, std::less<>> other_;
    std::int64_t num_tasks_ = 0, num_links_ = 0; ///< that regions say
    std::vector<std::pair<std::int64_t, Successors>>
        links_; ///< of ordered tasks that others wait for, by their place in the record
};

} // namespace

void write_trace(const fs::path& path, const TraceInfo& info, const TaskRecord& record) {
    TraceWriter(path, record).write(info);
}

Trace read_trace(const fs::path& path) {
    Trace trace;
    TraceReader reader(path, trace);
    InputStream in(path);
    Json::sax_parse(in.stream(), &reader);
    reader.finish();
    return trace;
}

} // namespace flotilla::io
