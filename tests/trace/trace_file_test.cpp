// SPDX-License-Identifier: MIT
// The file of run --trace: round trip, the viewers' format, and damage.
#include "trace/trace_file.hpp"

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <tuple>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <flotilla/error.hpp>

#include "io/file.hpp"
#include "support/temporary_folder.hpp"
#include "trace/sample_trace.hpp"

namespace flotilla::io {
namespace {

namespace fs = std::filesystem;
using test::record_sample;
using test::sample_trace_info;
using test::TemporaryFolder;

void expect_same(const TaskRecord& a, const TaskRecord& b) {
    ASSERT_EQ(a.regions.size(), b.regions.size());
    for (std::size_t i = 0; i < a.regions.size(); ++i) {
        const RegionRecord &p = a.regions[i], &q = b.regions[i];
        EXPECT_STREQ(p.name, q.name);
        EXPECT_EQ(std::tie(p.kind, p.tasks, p.begin, p.end, p.step), std::tie(q.kind, q.tasks, q.begin, q.end, q.step));
        if (p.kind != RegionKind::ordered) continue;
        for (std::int32_t k = 0; k < p.tasks; ++k) {
            Successors x = a.links[static_cast<std::size_t>(p.first_link + k)],
                       y = b.links[static_cast<std::size_t>(q.first_link + k)];
            std::sort(x.begin(), x.end()), std::sort(y.begin(), y.end());
            EXPECT_EQ(x, y);
        }
    }
    ASSERT_EQ(a.threads.size(), b.threads.size());
    for (std::size_t t = 0; t < a.threads.size(); ++t) {
        ASSERT_EQ(a.threads[t].size(), b.threads[t].size());
        for (std::size_t i = 0; i < a.threads[t].size(); ++i) {
            const TaskSpan &p = a.threads[t][i], &q = b.threads[t][i];
            EXPECT_EQ(std::tie(p.begin, p.end, p.region, p.task), std::tie(q.begin, q.end, q.region, q.task));
        }
    }
    ASSERT_EQ(a.groups.size(), b.groups.size());
    for (std::size_t i = 0; i < a.groups.size(); ++i)
        EXPECT_EQ(std::tie(a.groups[i].region, a.groups[i].tasks, a.groups[i].visits, a.groups[i].busy),
                  std::tie(b.groups[i].region, b.groups[i].tasks, b.groups[i].visits, b.groups[i].busy));
    ASSERT_EQ(a.phases.size(), b.phases.size());
    const auto sorted = [](const TaskRecord& r) {
        std::vector<std::tuple<std::int64_t, std::int64_t, std::string, std::int64_t>> out;
        for (const PhaseSpan& p : r.phases) out.emplace_back(p.begin, p.end, p.name, p.step);
        std::sort(out.begin(), out.end());
        return out;
    };
    EXPECT_EQ(sorted(a), sorted(b));
}

TEST(TraceFile, ReadsBackWhatWasWritten) {
    const TemporaryFolder folder;
    for (const int threads : {1, 3}) {
        const TaskRecorder recorder = record_sample(threads);
        const TraceInfo info = sample_trace_info(threads);
        for (const char* name : {"trace.json", "trace.json.gz"}) {
            const fs::path path = folder.path() / name;
            write_trace(path, info, recorder.record());
            const Trace read = read_trace(path);
            expect_same(recorder.record(), read.record);
            EXPECT_EQ(read.info.command_line, info.command_line);
            EXPECT_EQ(read.info.threads, threads);
            EXPECT_EQ(read.info.steps, info.steps);
            EXPECT_EQ(read.info.trace_every, info.trace_every);
            EXPECT_EQ(read.info.cpu_seconds, info.cpu_seconds);
            EXPECT_EQ(read.info.wall_seconds, info.wall_seconds);
            EXPECT_FALSE(read.info.version.empty());
            EXPECT_FALSE(read.info.commit.empty());
            EXPECT_FALSE(read.info.processor.empty());
            ASSERT_EQ(read.info.costs.size(), 2u);
            EXPECT_EQ(read.info.costs[1].threads, 4);
            EXPECT_EQ(read.info.costs[1].fork_join, 1500.25);
        }
        EXPECT_LT(fs::file_size(folder.path() / "trace.json.gz"), fs::file_size(folder.path() / "trace.json"));
        EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2) << "nothing else is left";
    }
}

// What chrome://tracing and Perfetto need: one JSON object, complete events with numbers, and on each thread nothing
// that overlaps without being nested.
TEST(TraceFile, IsInTheFormatOfTheViewers) {
    const TemporaryFolder folder;
    write_trace(folder.path() / "t.json", sample_trace_info(2), record_sample(2).record());
    const auto json = nlohmann::json::parse(read_text(folder.path() / "t.json"));
    EXPECT_TRUE(json.at("otherData").is_object());
    std::map<int, std::pair<double, double>> regions; // begin and end
    std::map<int, std::vector<std::pair<double, double>>> spans;
    std::size_t tasks = 0;
    for (const auto& event : json.at("traceEvents")) {
        if (event.at("ph") == "M") continue;
        ASSERT_EQ(event.at("ph"), "X");
        const double begin = event.at("ts").get<double>(), end = begin + event.at("dur").get<double>();
        EXPECT_GE(end, begin);
        EXPECT_EQ(event.at("pid"), 1);
        spans[event.at("tid").get<int>()].emplace_back(begin, end);
        const auto& args = event.at("args");
        if (event.at("cat") == "task") {
            ++tasks;
            const auto [first, last] = regions.at(args.at("region").get<int>());
            EXPECT_GE(begin, first - 1e-6);
            EXPECT_LE(end, last + 1e-6);
        } else if (event.at("cat") != "phase") {
            regions[args.at("region").get<int>()] = {begin, end};
        }
    }
    EXPECT_EQ(tasks, 10u + 100u);
    EXPECT_EQ(regions.size(), 3u);
    for (auto& [thread, list] : spans) {
        std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) {
            return a.first != b.first ? a.first < b.first : a.second > b.second;
        });
        std::vector<double> open;
        for (const auto& [begin, end] : list) {
            while (!open.empty() && open.back() <= begin + 1e-6) open.pop_back();
            if (!open.empty()) {
                EXPECT_LE(end, open.back() + 1e-6) << "thread " << thread;
            }
            open.push_back(end);
        }
    }
}

std::string problem_of(const fs::path& path) {
    try {
        (void)read_trace(path);
    } catch (const InputError& e) {
        EXPECT_EQ(std::string(e.what()).find(path.string() + ": "), 0u) << e.what();
        return std::string("input: ") + e.what();
    } catch (const IoError& e) {
        EXPECT_EQ(std::string(e.what()).find(path.string() + ": "), 0u) << e.what();
        return std::string("io: ") + e.what();
    }
    return "none";
}

TEST(TraceFile, RefusesWhatIsNoTraceOfOurs) {
    const TemporaryFolder folder;
    const auto problem = [&](const std::string& content) { return problem_of(folder.write("x.json", content)); };
    EXPECT_NE(problem("").find("input: "), std::string::npos);
    EXPECT_NE(problem("not json").find("no JSON from byte"), std::string::npos);
    EXPECT_NE(problem("[]").find("not an object"), std::string::npos);
    EXPECT_NE(problem("[{\"name\": \"a\", \"ph\": \"X\", \"ts\": 1, \"dur\": 2}]").find("not an object"),
              std::string::npos);
    EXPECT_NE(problem("17").find("not an object"), std::string::npos);
    EXPECT_NE(problem("{}").find("no flotilla_trace"), std::string::npos);
    EXPECT_NE(problem("{\"traceEvents\": [{\"name\": \"a\", \"ph\": \"X\", \"ts\": 1, \"dur\": 2}]}")
                  .find("no flotilla_trace"),
              std::string::npos);
    EXPECT_NE(problem("{\"otherData\": {\"flotilla_trace\": 1}}").find("of format 1"), std::string::npos);
    EXPECT_NE(problem("{\"otherData\": {\"flotilla_trace\": \"2\"}}").find("no flotilla_trace"), std::string::npos);
    EXPECT_EQ(problem_of(folder.path() / "none.json").find("io: "), 0u);
    EXPECT_EQ(problem_of(folder.path()).find("io: "), 0u);
}

TEST(TraceFile, RefusesDamage) {
    const TemporaryFolder folder;
    const fs::path good = folder.path() / "good.json";
    write_trace(good, sample_trace_info(1), record_sample(1).record());
    const std::string text = read_text(good);
    const auto changed = [&](const std::string& from, const std::string& to) {
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        std::string copy = text;
        return problem_of(folder.write("bad.json", copy.replace(at, from.size(), to)));
    };
    EXPECT_EQ(changed("\"steps\":7", "\"steps\":7"), "none");
    EXPECT_NE(changed("\"steps\":7", "\"stops\":7").find("no steps in otherData"), std::string::npos);
    EXPECT_NE(changed("\"region\":0", "\"region\":4").find("is not region 0"), std::string::npos);
    EXPECT_NE(changed("\"task\":3", "\"task\":4").find("again"), std::string::npos);
    EXPECT_NE(changed("\"tasks\":10", "\"tasks\":2147483647").find("2147483637 tasks are missing"), std::string::npos);
    EXPECT_NE(changed("\"task\":3", "\"task\":-1").find("out of range"), std::string::npos);
    EXPECT_NE(changed("\"task\":3", "\"tusk\":3").find("has no task"), std::string::npos);
    EXPECT_NE(changed("\"tid\":0,\"args\":{\"region\":0,\"task\"", "\"tid\":5,\"args\":{\"region\":0,\"task\"")
                  .find("more threads"),
              std::string::npos);
    EXPECT_NE(changed("\"task\":99,\"next\":[]", "\"task\":99,\"next\":[98]").find("lower number"), std::string::npos);
    EXPECT_NE(changed("\"groups\":[[8,", "\"groups\":[[").find("fours"), std::string::npos);
    EXPECT_NE(changed("\"ts\":", "\"ts\":-").find("out of range"), std::string::npos);
    const std::size_t line = text.find("\"task\":5");
    std::string copy = text;
    copy.erase(text.rfind('\n', line), text.find('\n', line) - text.rfind('\n', line));
    EXPECT_NE(problem_of(folder.write("bad.json", copy)).find("1 tasks are missing"), std::string::npos);
    EXPECT_NE(problem_of(folder.write("bad.json", text.substr(0, text.size() / 2))).find("no JSON from byte"),
              std::string::npos);

    const fs::path compressed = folder.path() / "t.json.gz";
    write_trace(compressed, sample_trace_info(1), record_sample(1).record());
    std::string bytes = read_text(compressed);
    fs::resize_file(compressed, bytes.size() / 2);
    EXPECT_EQ(problem_of(compressed).find("io: "), 0u);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
    EXPECT_EQ(problem_of(folder.write("flipped.json.gz", bytes)).find("i"), 0u);
}

TEST(TraceFile, FailsToWriteWithTheNameAndLeavesNothing) {
    const TemporaryFolder folder;
    fs::create_directories(folder.path() / "taken" / "inside");
    const TaskRecorder recorder = record_sample(1);
    EXPECT_THROW(write_trace(folder.path() / "none" / "t.json", sample_trace_info(1), recorder.record()), IoError);
    EXPECT_THROW(write_trace(folder.path() / "taken", sample_trace_info(1), recorder.record()), IoError);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

} // namespace
} // namespace flotilla::io
