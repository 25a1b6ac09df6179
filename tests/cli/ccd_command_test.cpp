// SPDX-License-Identifier: MIT
// flotilla ccd: columns, counts and exit codes, on files written here.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <sstream>
#include <vector>

#include "support/command.hpp"

namespace flotilla::test {
namespace {

const std::string kHeader =
    "kind,x0,y0,z0,x1,y1,z1,x2,y2,z2,x3,y3,z3,x0,y0,z0,x1,y1,z1,x2,y2,z2,x3,y3,z3,expected,toi,source\n";
const std::string kColumns = "file,rows,positives,missed,late,false_hits,ns_per_query";

/// A vertex moving along z over a still triangle, from height z0 to z1.
std::string vertex_row(const std::string& z0, const std::string& z1, const std::string& answer) {
    const std::string face = "0,0,0,1,0,0,0,1,0,";
    return "VF,0.25,0.25," + z0 + "," + face + "0.25,0.25," + z1 + "," + face + answer + ",made here\n";
}
const std::string kFall = vertex_row("1", "-1", "1,0.5");
const std::string kStay = vertex_row("1", "1", "0,");
const std::string kEdges = "EE,-1,0,1,1,0,1,0,-1,0,0,1,0,-1,0,-3,1,0,-3,0,-1,0,0,1,0,1,0.25,made here\n";

std::vector<std::string> lines(const std::string& text) {
    std::vector<std::string> out;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) out.push_back(line);
    return out;
}

/// The fields between the file name and the time, which differs from run to run.
std::string counts(const std::string& line) {
    const std::size_t first = line.find(','), last = line.rfind(',');
    return line.substr(first + 1, last - first - 1);
}

std::string binary_row(double kind, const std::vector<double>& coordinates, double expected, double toi) {
    std::string bytes;
    const auto put = [&](double value) {
        auto bits = std::bit_cast<std::uint64_t>(value);
        for (int i = 0; i < 8; ++i, bits >>= 8) bytes += static_cast<char>(bits & 0xff);
    };
    put(kind);
    for (const double c : coordinates) put(c);
    put(expected);
    put(toi);
    return bytes;
}
std::vector<double> falling_vertex() {
    return {0.25, 0.25, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25, 0.25, -1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
}

TEST(CcdCommand, PrintsTheContractsColumnsAsCsv) {
    const TemporaryFolder folder;
    const std::string file = folder.write("queries.csv", kHeader + kFall + kStay + kEdges);
    const CommandOutput r = run_flotilla("ccd --csv " + file);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_EQ(r.err, "");
    const auto out = lines(r.out);
    ASSERT_EQ(out.size(), 2U);
    EXPECT_EQ(out[0], kColumns);
    EXPECT_TRUE(out[1].starts_with(file + ","));
    EXPECT_EQ(counts(out[1]), "3,2,0,0,0");
    EXPECT_GT(std::stod(out[1].substr(out[1].rfind(',') + 1)), 0);
}

TEST(CcdCommand, PrintsAnAlignedTableByDefault) {
    const TemporaryFolder folder;
    const std::string a = folder.write("a.csv", kHeader + kFall), b = folder.write("longer_name.csv", kHeader + kStay);
    const CommandOutput r = run_flotilla("ccd " + a + " " + b);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    const auto out = lines(r.out);
    ASSERT_EQ(out.size(), 3U);
    EXPECT_EQ(out[0].size(), out[1].size());
    EXPECT_EQ(out[0].size(), out[2].size());
    EXPECT_NE(out[0].find("false_hits"), std::string::npos);
}

TEST(CcdCommand, ReadsTheBinaryForm) {
    const TemporaryFolder folder;
    const std::string file = folder.write("queries.bin", binary_row(0, falling_vertex(), 1, 0.5));
    const CommandOutput r = run_flotilla("ccd --csv " + file);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_EQ(counts(lines(r.out).at(1)), "1,1,0,0,0");
}

TEST(CcdCommand, FailsWithThreeWhereAnExpectedHitIsMissedOrLate) {
    // Wrong answers in the file stand in for a wrong method: a hit that is none, and a time before the true one.
    const TemporaryFolder folder;
    const std::string miss = folder.write("miss.csv", kHeader + vertex_row("1", "1", "1,"));
    const CommandOutput r = run_flotilla("ccd --csv " + miss);
    EXPECT_EQ(r.exit_code, 3);
    EXPECT_EQ(counts(lines(r.out).at(1)), "1,1,1,0,0");
    const std::string late = folder.write("late.csv", kHeader + vertex_row("1", "-1", "1,0.25"));
    const CommandOutput l = run_flotilla("ccd --csv " + late);
    EXPECT_EQ(l.exit_code, 3);
    EXPECT_EQ(counts(lines(l.out).at(1)), "1,1,0,1,0");
    EXPECT_EQ(run_flotilla("ccd --method cubic " + miss).exit_code, 0) << "the cubic promises nothing";
}

TEST(CcdCommand, CountsFalseHits) {
    const TemporaryFolder folder;
    const std::string file = folder.write("false.csv", kHeader + vertex_row("1", "-1", "0,"));
    const CommandOutput r = run_flotilla("ccd --csv " + file);
    EXPECT_EQ(r.exit_code, 0) << "a false hit is a cost, not a broken promise";
    EXPECT_EQ(counts(lines(r.out).at(1)), "1,0,0,0,1");
}

TEST(CcdCommand, JudgesRowsBySeparation) {
    // Minimum distance 0.5: due at separation 0.6, nothing at 0.4; at 0.499 a hit is neither due nor false.
    const TemporaryFolder folder;
    const std::string file = folder.write("near.csv", kHeader + vertex_row("1", "0.5", "0,"));
    for (const char* separation : {"0.4", "0.499", "0.6"}) {
        const CommandOutput r = run_flotilla("ccd --csv --separation " + std::string(separation) + " " + file);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        EXPECT_EQ(counts(lines(r.out).at(1)), "1,0,0,0,0") << separation;
    }
    // The cubic looks at coplanar times and the end only: a vertex that starts near and leaves escapes it.
    const std::string leave = folder.write("leave.csv", kHeader + vertex_row("0.5", "1", "0,"));
    const CommandOutput r = run_flotilla("ccd --csv --method cubic --separation 0.6 " + leave);
    EXPECT_EQ(counts(lines(r.out).at(1)), "1,0,1,0,0");
}

TEST(CcdCommand, NamesFileLineAndReasonOfBadRows) {
    const TemporaryFolder folder;
    const struct {
        const char* name;
        std::string content;
        const char* place;
        const char* reason;
    } cases[] = {
        {"short.csv", kHeader + "VF,1,2,3\n", "short.csv:2", "columns"},
        {"kind.csv", kHeader + kFall + "XX" + kFall.substr(2), "kind.csv:3", "VF or EE"},
        {"number.csv", kHeader + vertex_row("one", "1", "0,"), "number.csv:2", "'one'"},
        {"trailing.csv", kHeader + vertex_row("1x", "1", "0,"), "trailing.csv:2", "'1x'"},
        {"infinite.csv", kHeader + vertex_row("inf", "1", "0,"), "infinite.csv:2", "finite"},
        {"nan.csv", kHeader + vertex_row("nan", "1", "0,"), "nan.csv:2", "finite"},
        {"huge.csv", kHeader + vertex_row("1e999", "1", "0,"), "huge.csv:2", "finite"},
        {"answer.csv", kHeader + vertex_row("1", "1", "2,"), "answer.csv:2", "0 or 1"},
        {"toi.csv", kHeader + vertex_row("1", "-1", "1,1.5"), "toi.csv:2", "[0, 1]"},
        {"toi_miss.csv", kHeader + vertex_row("1", "1", "0,0.5"), "toi_miss.csv:2", "no hit"},
        {"header.csv", kFall, "header.csv:1", "header"},
        {"empty.csv", "", "empty.csv:1", "empty"},
        {"blank.csv", kHeader + "\n" + kFall, "blank.csv:2", "columns"},
        {"cut.bin", binary_row(0, falling_vertex(), 1, 0.5) + "rest", "cut.bin:2", "ends inside"},
        {"kind.bin", binary_row(2, falling_vertex(), 1, 0.5), "kind.bin:1", "kind"},
        {"nan.bin", binary_row(NAN, falling_vertex(), 1, 0.5), "nan.bin:1", "kind"},
        {"expected.bin", binary_row(0, falling_vertex(), 0.5, -1), "expected.bin:1", "0 or 1"},
        {"toi.bin", binary_row(0, falling_vertex(), 1, -0.5), "toi.bin:1", "[0, 1]"},
        {"queries.txt", kHeader + kFall, "queries.txt", ".csv or .bin"},
    };
    for (const auto& c : cases) {
        const CommandOutput r = run_flotilla("ccd " + folder.write(c.name, c.content));
        EXPECT_EQ(r.exit_code, 2) << c.name;
        EXPECT_NE(r.err.find(c.place), std::string::npos) << c.name << ": " << r.err;
        EXPECT_NE(r.err.find(c.reason), std::string::npos) << c.name << ": " << r.err;
        EXPECT_EQ(r.out, "") << c.name;
    }
}

TEST(CcdCommand, AcceptsWindowsLineEndsAndAMissingLastOne) {
    const TemporaryFolder folder;
    std::string crlf;
    for (const char c : kHeader + kFall) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
    EXPECT_EQ(run_flotilla("ccd " + folder.write("crlf.csv", crlf)).exit_code, 0);
    const std::string open_end = (kHeader + kFall).substr(0, (kHeader + kFall).size() - 1);
    EXPECT_EQ(run_flotilla("ccd " + folder.write("open.csv", open_end)).exit_code, 0);
}

TEST(CcdCommand, TellsUsageFromInputFromFailureToRead) {
    const TemporaryFolder folder;
    const std::string file = folder.write("queries.csv", kHeader + kFall);
    EXPECT_EQ(run_flotilla("").exit_code, 2);
    EXPECT_EQ(run_flotilla("ccd").exit_code, 2);
    EXPECT_EQ(run_flotilla("nonsense").exit_code, 2);
    EXPECT_EQ(run_flotilla("ccd --nonsense " + file).exit_code, 2);
    EXPECT_EQ(run_flotilla("ccd --method exact " + file).exit_code, 2);
    EXPECT_EQ(run_flotilla("ccd --separation=-1 " + file).exit_code, 2);
    EXPECT_EQ(run_flotilla("ccd --separation=nan " + file).exit_code, 2);
    EXPECT_EQ(run_flotilla("ccd --separation=inf " + file).exit_code, 2);
    EXPECT_EQ(run_flotilla("ccd --separation=wide " + file).exit_code, 2);
    EXPECT_EQ(run_flotilla("--help").exit_code, 0);
    EXPECT_EQ(run_flotilla("ccd --help").exit_code, 0);
    const CommandOutput missing = run_flotilla("ccd " + folder.path().string() + "/absent.csv");
    EXPECT_EQ(missing.exit_code, 5);
    EXPECT_NE(missing.err.find("absent.csv"), std::string::npos);
    EXPECT_EQ(run_flotilla("ccd " + folder.path().string()).exit_code, 5) << "a folder is no file";
}

TEST(CcdCommand, FailsWithFiveWhereItsOutputIsLost) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    const TemporaryFolder folder;
    const std::string file = folder.write("queries.csv", kHeader + kFall);
    const int status =
        std::system((std::string(FLOTILLA_COMMAND) + " ccd " + file + " >/dev/full 2>/dev/null").c_str());
    EXPECT_EQ(WEXITSTATUS(status), 5);
}

} // namespace
} // namespace flotilla::test
