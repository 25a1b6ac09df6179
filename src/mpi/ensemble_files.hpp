// SPDX-License-Identifier: MIT
// What the folder of an ensemble remembers.
//   ensemble.json       the ensemble: version, commit, command line, ranks; members with their state and end
//   ensemble.csv        a row per member: settings, state, and the last row of its steps.csv
//   members/NAME        run folders, with what the run said in NAME.log
//   members/NAME.json   who runs or ran the member, and what came of it; members/NAME.claim is locked meanwhile
//   scenes/             scenes of the library
// A member's record is written by whoever has its claim. So no process writes what another one writes, and what a lost
// one leaves is one record that says "running" though nobody has the claim.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sweep/plan.hpp"

namespace flotilla::mpi {

inline constexpr std::string_view kEnsembleJson = "ensemble.json", kEnsembleCsv = "ensemble.csv",
                                  kEnsembleClaim = "ensemble.claim";

/// A process of a job.
struct Holder {
    std::int64_t job = 0; ///< the ensemble's first start is 1, each --resume one more
    int rank = 0;
    std::string host;
    std::int64_t process = 0;
};
/// "rank 2 (host, process 123)".
[[nodiscard]] std::string to_text(const Holder& holder);

enum class MemberState : std::uint8_t { waiting, running, stopped, failed, complete };
[[nodiscard]] std::string_view to_text(MemberState state);

struct MemberRecord {
    std::uint64_t input = 0; ///< sweep::Member::input
    MemberState state = MemberState::waiting;
    Holder holder;            ///< that began it last
    bool left_to_job = false; ///< stopped, and to be gone on with by other ranks of the same job
    int exit_code = 0;
    std::string reason;       ///< of what is not complete
    double cpu = 0;           ///< s
    std::vector<Holder> lost; ///< that ended without a word while they ran it

    /// Whether a rank of `job` has nothing to do with it.
    [[nodiscard]] bool settled(std::int64_t job) const;
};

[[nodiscard]] std::filesystem::path claim_file(const sweep::Member& member);
/// That of a member that nobody has begun where there is none. IoError where it is damaged.
[[nodiscard]] MemberRecord read_member(const sweep::Member& member);
void write_member(const sweep::Member& member, const MemberRecord& record);

/// The last step of a member.
struct MemberEnd {
    std::int64_t step = 0;
    double time = 0, energy = 0, kinetic_energy = 0; ///< s, J
    std::string state_hash;
};
/// Nothing before its first step. IoError where the folder cannot be read.
[[nodiscard]] std::optional<MemberEnd> read_end(const sweep::Member& member);

/// A start of ranks on the folder.
struct Job {
    std::int64_t number = 1;
    int ranks = 1;
    std::vector<std::string> command_line;
};
/// That wrote the folder last; nothing where there is no ensemble in it.
[[nodiscard]] std::optional<Job> read_job(const std::filesystem::path& folder);
/// Both tables, from the members' records.
void write_ensemble(const std::filesystem::path& folder, const sweep::Plan& plan, const Job& job,
                    const std::vector<MemberRecord>& records);

} // namespace flotilla::mpi
