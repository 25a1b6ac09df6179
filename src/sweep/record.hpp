// SPDX-License-Identifier: MIT
// sweep.json, which says what a campaign is and how far it is, and the tables for other programs.
//   sweep.json    the campaign: version, commit, processor, time, threads; members with their state; once some are
//                 complete points, changes and advice
//   sweep.csv     a row per point: its settings, complete starts, cost and, by metric, mean, spread over the starts,
//                 error and the error's own standard error
//   members.csv   a row per run: point, start, state, steps, cost and, by metric, its value
//   members/NAME  run folders, with what the run said in NAME.log; scenes/ holds scenes of the library
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <flotilla/sweep.hpp>

#include "sweep/judge.hpp"
#include "sweep/plan.hpp"

namespace flotilla::sweep {

inline constexpr std::string_view kSweepJson = "sweep.json", kSweepCsv = "sweep.csv", kMembersCsv = "members.csv",
                                  kSweepHtml = "sweep.html", kMembers = "members", kScenes = "scenes";

struct MemberState {
    std::uint64_t input = 0;
    bool begun = false;
    SweepOutcome outcome;
    [[nodiscard]] bool complete() const { return begun && outcome.exit_code == 0; }
};

/// What a campaign's folder remembers.
struct Record {
    double duration = 0; ///< s
    int threads = 0;
    std::string commit;                         ///< of the build that began it
    std::vector<std::string> command_line;      ///< that wrote it last
    std::map<std::string, MemberState> members; ///< by name; those of earlier lists of values as well
};

/// IoError where it cannot be read or is damaged.
[[nodiscard]] Record read_record(const std::filesystem::path& folder);
/// `report`: what is known by now, or null.
void write_record(const std::filesystem::path& folder, const Record& record, const SweepReport* report);

void write_tables(const std::filesystem::path& folder, const Plan& plan, const Record& record, const Measured& measured,
                  const SweepReport& report);

/// A field of a CSV file; commas and quotes are kept inside quotes.
[[nodiscard]] std::string csv_field(std::string_view text);
/// "complete", "stopped", "failed (4)" or "not begun".
[[nodiscard]] std::string state_text(const MemberState& state);

} // namespace flotilla::sweep
