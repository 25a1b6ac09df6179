// SPDX-License-Identifier: MIT
// flotilla trace on files written here: tables, CSV, exit codes and messages.
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/command.hpp"
#include "trace/sample_trace.hpp"
#include "trace/trace_file.hpp"

namespace flotilla::test {
namespace {

std::vector<std::string> split(const std::string& text, char by) {
    std::vector<std::string> parts;
    std::istringstream in(text);
    for (std::string part; std::getline(in, part, by);) parts.push_back(part);
    return parts;
}

std::string write_sample(const TemporaryFolder& folder, const std::string& name, int threads) {
    const auto path = folder.path() / name;
    io::write_trace(path, sample_trace_info(threads), record_sample(threads).record());
    return path.string();
}

TEST(TraceCommand, PrintsATableOfPhasesAndRegions) {
    const TemporaryFolder folder;
    const CommandOutput r = run_flotilla("trace " + write_sample(folder, "t.json.gz", 1));
    EXPECT_EQ(r.exit_code, 0) << r.err;
    for (const char* part :
         {"7 steps (every 3)", "covered:", "fork and join", "measured up to 4 cores", "log2 of the cores", "step ",
          "  collisions", "    pairs", "ordered", "sweeps", "critical path", "x256", "\ntotal "})
        EXPECT_NE(r.out.find(part), std::string::npos) << part << '\n' << r.out;
    EXPECT_NE(r.err.find("below 95 %"), std::string::npos) << "the sample says 0.125 s of CPU time";
}

TEST(TraceCommand, PrintsCsv) {
    const TemporaryFolder folder;
    const CommandOutput r = run_flotilla("trace --csv --cores 1,2,1000 " + write_sample(folder, "t.json", 1));
    EXPECT_EQ(r.exit_code, 0) << r.err;
    const auto lines = split(r.out, '\n');
    ASSERT_EQ(lines.size(), 8u) << r.out;
    EXPECT_EQ(lines[0],
              "phase,kind,number,regions,tasks,wall_ms,serial_ms,work_ms,critical_path_ms,parallelism,speedup_1,"
              "speedup_2,speedup_1000");
    EXPECT_EQ(lines[1].find("step,phase,1,3,146,"), 0u) << lines[1];
    EXPECT_EQ(lines.back().find("total,phase,"), 0u);
    EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const std::string& l) {
        return l.find("step/collisions/pairs,ordered,1,1,100,") == 0;
    }));
    for (const std::string& line : lines) EXPECT_EQ(std::count(line.begin(), line.end(), ','), 12) << line;
    const auto total = split(lines.back(), ',');
    EXPECT_DOUBLE_EQ(std::stod(total[10]), 1) << "on one core nothing is gained or lost";
}

TEST(TraceCommand, SaysWhatToKeepInMind) {
    const TemporaryFolder folder;
    const CommandOutput two = run_flotilla("trace --growth linear " + write_sample(folder, "two.json", 2));
    EXPECT_EQ(two.exit_code, 0) << two.err;
    EXPECT_NE(two.err.find("recorded on 2 threads"), std::string::npos) << two.err;
    EXPECT_NE(two.out.find("grow with the cores"), std::string::npos) << two.out;
    io::TraceInfo info = sample_trace_info(1);
    info.cpu_seconds = 1e-9;
    io::write_trace(folder.path() / "covered.json", info, record_sample(1).record());
    EXPECT_EQ(run_flotilla("trace " + (folder.path() / "covered.json").string()).err.find("below 95 %"),
              std::string::npos);
    info = sample_trace_info(1);
    info.costs.clear();
    io::write_trace(folder.path() / "one.json", info, record_sample(1).record());
    EXPECT_NE(run_flotilla("trace " + (folder.path() / "one.json").string()).err.find("assumed"), std::string::npos);
    const CommandOutput assumed = run_flotilla("trace --assume-costs " + write_sample(folder, "three.json", 1));
    EXPECT_NE(assumed.out.find("assumed for 2 cores"), std::string::npos) << assumed.out;
    EXPECT_EQ(assumed.err.find("assumed"), std::string::npos) << "was asked for: " << assumed.err;
    info.costs = {{2, 2e6, 1e6, 1e6}};
    io::write_trace(folder.path() / "busy.json", info, record_sample(1).record());
    EXPECT_NE(run_flotilla("trace " + (folder.path() / "busy.json").string()).err.find("too busy"), std::string::npos);
    EXPECT_NE(run_flotilla("trace --help").out.find("log2"), std::string::npos);
}

/// 20 boats that fall for a while and hit the bowl.
std::string write_boats(const TemporaryFolder& folder) {
    return folder.write("boats.json", run_flotilla("scene boats-in-bowl --bodies 22 --seed 3").out);
}

std::string hash_line(const std::string& out) {
    const std::size_t at = out.find("state hash:");
    return at == std::string::npos ? "none" : out.substr(at, out.find('\n', at) - at);
}

/// Every instant of each of `steps` steps is a region's, within which its tasks lie, or serial: nothing is counted
/// twice, nothing lies outside. How much recording costs is time's matter, and of no test.
void expect_whole_steps(const TaskRecord& record, std::int64_t steps) {
    std::vector<PhaseSpan> whole;
    for (const PhaseSpan& p : record.phases)
        if (std::string(p.name) == "step") whole.push_back(p);
    ASSERT_EQ(std::ssize(whole), steps);
    EXPECT_GT(std::ssize(record.regions), steps);
    std::int64_t last_end = 0;
    for (const RegionRecord& region : record.regions) {
        ASSERT_GE(region.step, 1);
        ASSERT_LE(region.step, steps);
        const PhaseSpan& step = whole[static_cast<std::size_t>(region.step - 1)];
        EXPECT_EQ(step.step, region.step);
        EXPECT_LE(std::max(step.begin, last_end), region.begin) << region.name;
        EXPECT_LE(region.end, step.end) << region.name;
        last_end = region.end;
    }
    for (const auto& tasks : record.threads)
        for (const TaskSpan& s : tasks) {
            const RegionRecord& region = record.regions[static_cast<std::size_t>(s.region)];
            EXPECT_LE(region.begin, s.begin);
            EXPECT_LE(s.end, region.end);
        }
}

TEST(RunTrace, RecordsWhatAnalysisAndViewersUnderstand) {
    const TemporaryFolder folder;
    const std::string scene = write_boats(folder), file = (folder.path() / "t.json").string();
    const std::string run = "run --steps 40 --threads ";
    const CommandOutput plain = run_flotilla(run + "1 " + scene);
    const CommandOutput traced = run_flotilla(run + "1 --trace " + file + " " + scene);
    ASSERT_EQ(traced.exit_code, 0) << traced.err;
    EXPECT_EQ(hash_line(traced.out), hash_line(plain.out)) << "recording changes no bit";
    EXPECT_NE(traced.out.find("trace of 40 steps: " + file), std::string::npos) << traced.out;

    const CommandOutput table = run_flotilla("trace " + file);
    EXPECT_EQ(table.exit_code, 0) << table.err;
    for (const char* part : {"40 steps (every 1)", "1 thread\n", "stage1_collisions", "stage7_static_contact"})
        EXPECT_NE(table.out.find(part), std::string::npos) << part << '\n' << table.out;

    const io::Trace trace = io::read_trace(file);
    const TaskRecord& record = trace.record;
    expect_whole_steps(record, 40);
    // A second recording of the same run has the same graph.
    const std::string again = (folder.path() / "again.json.gz").string();
    ASSERT_EQ(run_flotilla(run + "1 --trace " + again + " " + scene).exit_code, 0);
    const CommandOutput both = run_flotilla("trace " + file + " " + again);
    EXPECT_EQ(both.exit_code, 0) << both.err;
    EXPECT_NE(both.out.find("40 steps (every 1) in 2 recordings, "), std::string::npos) << both.out;
    const std::string other = write_sample(folder, "other.json", 1);
    const CommandOutput refused = run_flotilla("trace " + file + " " + other);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.err.find(other + ": not a recording of the same run"), std::string::npos) << refused.err;

    const auto lines = split(run_flotilla("trace --csv --cores 1,8 " + file).out, '\n');
    const auto total = split(lines.back(), ',');
    ASSERT_EQ(total.size(), 12u);
    EXPECT_DOUBLE_EQ(std::stod(total[10]), 1);
    EXPECT_GT(std::stod(total[9]), 1) << "there is something to do side by side";
}

TEST(RunTrace, EveryKthStepOnSeveralThreads) {
    const TemporaryFolder folder;
    const std::string scene = write_boats(folder), file = (folder.path() / "t.json.gz").string();
    const CommandOutput one = run_flotilla("run --steps 10 --threads 1 " + scene);
    const CommandOutput two = run_flotilla("run --steps 10 --threads 2 --trace-every 4 --trace " + file + " " + scene);
    ASSERT_EQ(two.exit_code, 0) << two.err;
    EXPECT_EQ(hash_line(one.out), hash_line(two.out));
    const io::Trace trace = io::read_trace(file);
    EXPECT_EQ(trace.info.steps, 3);
    EXPECT_EQ(trace.info.threads, 2);
    EXPECT_EQ(trace.record.regions.front().step, 1);
    EXPECT_EQ(trace.record.regions.back().step, 9);
    EXPECT_GT(trace.info.wall_seconds, 0);
    EXPECT_GT(trace.info.cpu_seconds, 0);
}

TEST(RunTrace, AStepThatAScriptUndoesLeavesNothing) {
    const TemporaryFolder folder;
    const std::string scene = folder.write("walls.json", run_flotilla("scene closing-walls").out);
    const std::string file = (folder.path() / "t.json").string();
    const std::string run = "run --threads 1 --set unsatisfiable_script=error " + scene + " --trace " + file;
    ASSERT_EQ(run_flotilla(run + " --steps 100").exit_code, 7);
    const io::Trace stopped = io::read_trace(file);
    ASSERT_GT(stopped.info.steps, 0);
    ASSERT_EQ(run_flotilla(run + " --steps " + std::to_string(stopped.info.steps)).exit_code, 0);
    const io::Trace whole = io::read_trace(file);
    EXPECT_EQ(stopped.record.phases.size(), whole.record.phases.size());
    EXPECT_EQ(stopped.record.regions.size(), whole.record.regions.size());
    EXPECT_EQ(stopped.record.threads.front().size(), whole.record.threads.front().size());
    EXPECT_EQ(stopped.record.groups.size(), whole.record.groups.size());
    EXPECT_EQ(stopped.record.links.size(), whole.record.links.size());
}

TEST(RunTrace, RefusesBeforeTheFirstStep) {
    const TemporaryFolder folder;
    const std::string scene = write_boats(folder);
    const CommandOutput r =
        run_flotilla("run --steps 2 --trace " + (folder.path() / "none" / "t.json").string() + " " + scene);
    EXPECT_EQ(r.exit_code, 5);
    EXPECT_EQ(r.err.find("step"), std::string::npos) << r.err;
    EXPECT_EQ(run_flotilla("run --steps 2 --trace-every 2 " + scene).exit_code, 2) << "needs --trace";
    EXPECT_EQ(run_flotilla("run --steps 2 --trace t.json --trace-every 0 " + scene).exit_code, 2);
}

TEST(TraceCommand, RefusesOtherFiles) {
    const TemporaryFolder folder;
    const std::string bad = folder.write("bad.json", R"({"traceEvents": []})");
    const CommandOutput r = run_flotilla("trace " + bad);
    EXPECT_EQ(r.exit_code, 2);
    EXPECT_NE(r.err.find("flotilla: " + bad + ": not a trace of flotilla run"), std::string::npos) << r.err;
    EXPECT_EQ(run_flotilla("trace " + folder.write("boat.obj", "v 0 0 0\n")).exit_code, 2);
    EXPECT_EQ(run_flotilla("trace none.json").exit_code, 5);
    EXPECT_EQ(run_flotilla("trace").exit_code, 2);
    EXPECT_EQ(run_flotilla("trace --cores 0 " + bad).exit_code, 2);
    EXPECT_EQ(run_flotilla("trace --growth fast " + bad).exit_code, 2);
}

} // namespace
} // namespace flotilla::test
