// SPDX-License-Identifier: MIT
#include "mpi/ensemble.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>

#include <unistd.h>

#include <flotilla/error.hpp>

#include "io/file.hpp"
#include "mpi/claim.hpp"
#include "run_folder/run_files.hpp"

namespace flotilla::mpi {
namespace {

namespace fs = std::filesystem;

constexpr int kStopped = 6;               // exit code
constexpr timespec kPoll{0, 200'000'000}; // between two looks at members that others run
constexpr int kInternalError = 1;         // exit code
constexpr std::size_t kLongestHost = 256;

std::string host_name() {
    char text[kLongestHost] = {};
    return ::gethostname(text, sizeof text - 1) == 0 ? text : "unknown";
}

/// Removes what earlier jobs left of the member.
void remove_member(const sweep::Member& member) {
    const std::optional<Claim> claim = Claim::take(claim_file(member));
    if (!claim) throw InputError("run: " + member.run.name + " is running: --overwrite would take its folder away");
    std::error_code error;
    if (fs::exists(member.run.folder, error)) io::remove_run_files(member.run.folder);
    fs::remove(member.run.folder, error);
    write_member(member, {member.input, {}, {}, {}, {}, {}, {}, {}});
}

void check_same(const Ensemble& ensemble) {
    for (const sweep::Member& member : ensemble.plan.members)
        if (const MemberRecord record = read_member(member);
            record.state != MemberState::waiting && record.input != member.input)
            throw InputError("run: " + ensemble.folder.string() + ": " + member.run.name +
                             " was run with another scene, or with other settings than those varied; --overwrite " +
                             "starts anew");
}

void write_scenes(const sweep::Plan& plan) {
    for (const sweep::Start& start : plan.starts) {
        if (!start.generated) continue;
        io::create_folder(start.file.parent_path());
        io::write_file(start.file, start.text);
    }
}

std::vector<MemberRecord> read_all(const sweep::Plan& plan) {
    std::vector<MemberRecord> records;
    for (const sweep::Member& member : plan.members) records.push_back(read_member(member));
    return records;
}

class Worker {
  public:
    explicit Worker(const Ensemble& ensemble)
        : ensemble_(ensemble),
          self_{ensemble.job.number, ensemble.rank, host_name(), static_cast<std::int64_t>(::getpid())},
          settled_(ensemble.plan.members.size()) {}

    void work() {
        while (look_at_all()) {
        }
    }

  private:
    /// Returns whether there may be more to do.
    bool look_at_all() {
        bool others_run = false, ran = false;
        for (std::size_t i = 0; i < settled_.size(); ++i) {
            if (settled_[i]) continue;
            const sweep::Member& member = ensemble_.plan.members[i];
            const std::optional<Claim> claim = Claim::take(claim_file(member));
            if (!claim) {
                others_run = true;
                continue;
            }
            MemberRecord record = read_member(member);
            settled_[i] = record.settled(ensemble_.job.number);
            if (settled_[i] || ensemble_.stop()) continue;
            run(member, record);
            settled_[i] = record.settled(ensemble_.job.number);
            ran = true;
        }
        if (others_run && !ran) ::nanosleep(&kPoll, nullptr);
        return others_run || ran;
    }

    void run(const sweep::Member& member, MemberRecord& record) {
        if (record.state == MemberState::running) {
            record.lost.push_back(record.holder);
            ensemble_.note(to_text(record.holder) + " was lost while it ran " + member.run.name + "; " +
                           to_text(self_) + " goes on with it");
        }
        record.input = member.input;
        record.state = MemberState::running;
        record.holder = self_;
        write_member(member, record);
        const SweepOutcome outcome = ensemble_.run(member.run);
        record.state = outcome.exit_code == 0          ? MemberState::complete
                       : outcome.exit_code == kStopped ? MemberState::stopped
                                                       : MemberState::failed;
        record.left_to_job = record.state == MemberState::stopped && ensemble_.stop();
        record.exit_code = outcome.exit_code;
        record.reason = outcome.reason;
        record.cpu += outcome.cpu;
        write_member(member, record);
        ensemble_.note("rank " + std::to_string(self_.rank) + ": " + member.run.name + ": " +
                       std::string(to_text(record.state)));
    }

    const Ensemble& ensemble_;
    Holder self_;
    std::vector<bool> settled_;
};

EnsembleReport make_report(const Ensemble& ensemble, const std::vector<MemberRecord>& records) {
    EnsembleReport report;
    report.members = records.size();
    for (std::size_t i = 0; i < records.size(); ++i) {
        const MemberRecord& record = records[i];
        const std::string& name = ensemble.plan.members[i].run.name;
        for (const Holder& holder : record.lost)
            if (holder.job == ensemble.job.number) report.lost.push_back(to_text(holder) + " was lost in " + name);
        if (record.state == MemberState::complete) {
            ++report.complete;
            continue;
        }
        report.problems.push_back(name + ": " + std::string(to_text(record.state)) +
                                  (record.reason.empty() ? "" : ": " + record.reason));
        const bool failed = record.state == MemberState::failed;
        const int code = !failed ? kStopped : record.exit_code != 0 ? record.exit_code : kInternalError;
        if (report.exit_code == 0 || (report.exit_code == kStopped && failed)) report.exit_code = code;
    }
    return report;
}

} // namespace

void prepare_ensemble(Ensemble& ensemble, bool overwrite, bool resume) {
    const fs::path& folder = ensemble.folder;
    std::error_code error;
    const bool fresh = !fs::exists(folder, error) || fs::is_empty(folder, error);
    const std::optional<Job> before = fresh ? std::nullopt : read_job(folder);
    if (!fresh && !overwrite && !resume)
        throw InputError("run: " + folder.string() + " is not empty: --resume goes on with the ensemble in it, " +
                         "--overwrite replaces it");
    if (!fresh && !before) throw InputError("run: " + folder.string() + " holds no ensemble (ensemble.json)");
    io::create_folder(folder / "members");
    const Claim alone = Claim::wait_for(folder / kEnsembleClaim);
    if (before && overwrite)
        for (const sweep::Member& member : ensemble.plan.members) remove_member(member);
    check_same(ensemble);
    ensemble.job.number = before ? before->number + 1 : 1;
    write_scenes(ensemble.plan);
    const std::vector<MemberRecord> records = read_all(ensemble.plan);
    write_ensemble(folder, ensemble.plan, ensemble.job, records);
    const auto kept = std::count_if(records.begin(), records.end(),
                                    [](const MemberRecord& r) { return r.state == MemberState::complete; });
    if (kept > 0)
        ensemble.note(std::to_string(kept) + " of " + std::to_string(records.size()) + " runs are complete and kept");
}

EnsembleReport work_on_ensemble(const Ensemble& ensemble) {
    Worker(ensemble).work();
    // Whoever comes last writes what all have done.
    const Claim alone = Claim::wait_for(ensemble.folder / kEnsembleClaim);
    const std::vector<MemberRecord> records = read_all(ensemble.plan);
    write_ensemble(ensemble.folder, ensemble.plan, ensemble.job, records);
    return make_report(ensemble, records);
}

} // namespace flotilla::mpi
