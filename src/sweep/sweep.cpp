// SPDX-License-Identifier: MIT
#include <flotilla/sweep.hpp>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>

#include <flotilla/build_info.hpp>
#include <flotilla/error.hpp>
#include <flotilla/names.hpp>

#include "base/floating_point.hpp"
#include "base/text.hpp"
#include "io/file.hpp"
#include "parallel/parallel_for.hpp"
#include "run_folder/run_files.hpp"
#include "sweep/judge.hpp"
#include "sweep/measure.hpp"
#include "sweep/page.hpp"
#include "sweep/plan.hpp"
#include "sweep/record.hpp"

namespace flotilla {

namespace sweep {
namespace {

namespace fs = std::filesystem;

constexpr int kIoError = 5, kStopped = 6; // exit codes
/// CPU time of a run by the wall time of its steps, below which it must have waited for a core. On a core of its own
/// it is above 1: what is written costs as well.
constexpr double kOwnCore = 0.95;

void note(const SweepOptions& options, const std::string& text) {
    if (options.note) options.note(text);
}

std::vector<std::size_t> wanted_metrics(const SweepOptions& options) {
    std::vector<std::string_view> names;
    for (const SweepMetric& m : sweep_metrics()) names.push_back(m.name);
    std::vector<std::size_t> wanted;
    for (const std::string& name : options.metrics) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) throw InputError("sweep: " + unknown_name("metric", name, names));
        const auto m = static_cast<std::size_t>(found - names.begin());
        if (sweep_metrics()[m].needs_reference && options.reference.empty())
            throw InputError("sweep: the metric " + name + " needs --reference");
        if (std::find(wanted.begin(), wanted.end(), m) == wanted.end()) wanted.push_back(m);
    }
    return wanted;
}

/// The folder's record, or that of a new campaign; what an earlier one left is removed where that was asked for.
Record open_folder(const SweepOptions& options, const Plan& plan) {
    const Record fresh{plan.duration, options.threads, std::string(build_info().commit), {}, {}};
    const fs::path& folder = options.output;
    std::error_code error;
    if (!fs::exists(folder, error) || fs::is_empty(folder, error)) return fresh;
    const bool has_record = fs::exists(folder / kSweepJson);
    if (options.overwrite) {
        for (const auto& entry : fs::directory_iterator(folder / kMembers, error)) {
            if (!entry.is_directory()) continue;
            io::remove_run_files(entry.path());
            fs::remove(entry.path(), error);
        }
        return fresh;
    }
    if (!options.resume)
        throw InputError("sweep: " + folder.string() + " is not empty: --resume goes on with the campaign in it, " +
                         "--overwrite replaces it");
    if (!has_record) throw InputError("sweep: " + folder.string() + " holds no campaign to resume (sweep.json)");
    return read_record(folder);
}

/// The record with every member of the plan. InputError where it is that of other runs.
void check_same(const Plan& plan, const SweepOptions& options, Record& record) {
    const std::string folder = options.output.string(), anew = "; --overwrite starts anew";
    if (record.duration != plan.duration)
        throw InputError("sweep: " + folder + " holds runs of " + to_text(record.duration) + " s, not of " +
                         to_text(plan.duration) + " s" + anew);
    if (record.threads != options.threads)
        throw InputError("sweep: " + folder + " holds runs on " + std::to_string(record.threads) +
                         " threads, whose cost does not compare with that on " + std::to_string(options.threads) +
                         anew);
    for (const Member& member : plan.members) {
        MemberState& state = record.members[member.run.name];
        const bool there = state.begun || (state.input != 0 && fs::exists(member.run.folder / io::kRunJson));
        if (there && state.input != member.input)
            throw InputError("sweep: " + folder + ": " + member.run.name +
                             " was run with another scene, or with other settings than those varied" + anew);
        state.input = member.input;
    }
    if (const std::size_t others = record.members.size() - plan.members.size(); others > 0)
        note(options, std::to_string(others) + " runs of the folder are not in this campaign; they stay there");
    if (record.commit != build_info().commit)
        note(options, "the runs that are there were made by another build (" + record.commit + ")");
}

void write_scenes(const Plan& plan, const fs::path& folder) {
    io::create_folder(folder / kMembers);
    for (const Start& start : plan.starts) {
        if (!start.generated) continue;
        io::create_folder(start.file.parent_path());
        io::write_file(start.file, start.text);
    }
}

/// The runs that are missing, some at a time.
class Campaign {
  public:
    Campaign(const SweepOptions& options, const Plan& plan, Record& record) : options_(options), record_(record) {
        for (const Member& member : plan.members) {
            const MemberState& state = record.members.at(member.run.name);
            if (state.complete() && fs::exists(member.run.folder / io::kRunJson))
                ++done_;
            else
                missing_.push_back(&member);
        }
        total_ = plan.members.size();
        if (done_ > 0)
            note(options, std::to_string(done_) + " of " + std::to_string(total_) + " runs are complete and kept");
    }

    void run() {
        const int cores = usable_cores();
        const int asked = options_.jobs > 0 ? options_.jobs : std::max(1, cores / options_.threads);
        if (asked > cores)
            note(options_,
                 std::to_string(cores) + " runs at a time: more would share cores, and no time would be true");
        const auto jobs = static_cast<std::size_t>(std::min(asked, cores));
        parallel_for(jobs, static_cast<int>(jobs), [this](std::size_t) {
            for (std::size_t k = next_++; k < missing_.size() && !(options_.stop && options_.stop()); k = next_++)
                run_member(*missing_[k]);
        });
    }

  private:
    void run_member(const Member& member) {
        const bool goes_on = fs::exists(member.run.folder / io::kRunJson);
        SweepOutcome outcome = options_.run(member.run);
        const std::lock_guard held(lock_);
        MemberState& state = record_.members[member.run.name];
        // Of a run in parts all of them; what a campaign that was killed began is not known.
        if (goes_on) outcome.cpu = state.outcome.cpu > 0 ? outcome.cpu + state.outcome.cpu : 0;
        state.begun = true;
        state.outcome = std::move(outcome);
        write_record(options_.output, record_, nullptr);
        if (state.complete()) ++done_;
        if (options_.progress) options_.progress(done_, total_, member.run.name);
    }

    const SweepOptions& options_;
    Record& record_;
    std::vector<const Member*> missing_;
    std::size_t done_ = 0, total_ = 0;
    std::atomic<std::size_t> next_{0};
    std::mutex lock_;
};

/// Replaces the wall time of steps that waited for a core.
void correct_costs(const Plan& plan, const Record& record, Measured& measured, SweepReport& report) {
    std::size_t waited = 0;
    double least = 1;
    for (const Member& member : plan.members) {
        std::optional<Measures>& m = measured[member.point][member.start];
        const double cpu = record.members.at(member.run.name).outcome.cpu;
        if (!m || cpu == 0 || cpu >= kOwnCore * m->cost) continue;
        ++waited;
        least = std::min(least, cpu / m->cost);
        if (record.threads == 1) m->cost = cpu;
    }
    if (waited == 0) return;
    report.remarks.push_back(
        std::to_string(waited) + (waited == 1 ? " run" : " runs") + " had to wait for a core (the most delayed had " +
        std::to_string(static_cast<int>(100 * least)) +
        " % of one): " + (record.threads == 1 ? "their cost is CPU time" : "their cost is that of a busy machine"));
}

std::vector<Problem> problems_of(const Plan& plan) {
    std::vector<Problem> problems;
    for (const Member& m : plan.members)
        if (m.start == problems.size()) problems.emplace_back(scene_of(plan, m)); // members come start by start
    return problems;
}

Measured measure_all(const Plan& plan, const std::vector<Problem>& problems, const Record& record,
                     SweepReport& report) {
    Measured measured(plan.points.size(), std::vector<std::optional<Measures>>(plan.starts.size()));
    const auto complete = [&](const Member& m) { return record.members.at(m.run.name).complete(); };
    const std::optional<std::size_t> truth = plan.reference();
    std::vector<std::string> faults(plan.members.size());
    parallel_for(plan.members.size(), free_threads(), [&](std::size_t i) {
        const Member& member = plan.members[i];
        if (!complete(member)) return;
        fs::path reference;
        for (const Member& m : plan.members)
            if (truth && m.point == *truth && m.start == member.start && complete(m)) reference = m.run.folder;
        try {
            measured[member.point][member.start] =
                measure(problems[member.start], scene_of(plan, member), member.run.folder, reference);
        } catch (const Error& e) {
            faults[i] = e.what();
        }
    });
    for (const std::string& fault : faults)
        if (!fault.empty()) {
            report.problems.push_back(fault);
            report.exit_code = kIoError;
        }
    correct_costs(plan, record, measured, report);
    return measured;
}

/// What is not complete, and the exit code that says so.
void count_members(const Plan& plan, const Record& record, SweepReport& report) {
    report.members = plan.members.size();
    int failure = 0;
    for (const Member& member : plan.members) {
        const MemberState& state = record.members.at(member.run.name);
        if (state.complete()) {
            ++report.complete;
            continue;
        }
        const bool failed = state.begun && state.outcome.exit_code != kStopped;
        if (failed && failure == 0) failure = state.outcome.exit_code;
        report.stopped = report.stopped || !failed;
        report.problems.push_back(member.run.name + ": " + state_text(state) +
                                  (state.outcome.reason.empty() ? "" : ": " + state.outcome.reason));
    }
    if (failure != 0)
        report.exit_code = failure;
    else if (report.stopped && report.exit_code == 0)
        report.exit_code = kStopped;
}

} // namespace
} // namespace sweep

SweepReport run_sweep(const SweepOptions& options) {
    using namespace sweep;
    const DefaultFloatingPoint environment;
    const std::vector<std::size_t> wanted = wanted_metrics(options);
    const Plan plan = make_plan(options);
    const std::vector<Problem> problems = problems_of(plan);
    io::create_folder(options.output);
    const io::FolderLock lock(options.output);
    Record record = open_folder(options, plan);
    check_same(plan, options, record);
    record.command_line = options.command_line;
    for (const std::string& text : plan.notes) note(options, text);
    write_scenes(plan, options.output);
    write_record(options.output, record, nullptr);
    Campaign(options, plan, record).run();

    SweepReport report;
    report.axes = plan.axes;
    report.duration = plan.duration;
    for (const Start& start : plan.starts) report.starts.push_back(start.name);
    count_members(plan, record, report);
    for (const Problem& problem : problems) report.size += problem.size / static_cast<double>(problems.size());
    const Measured measured = measure_all(plan, problems, record, report);
    judge(plan, problems.front(), measured, wanted, report);
    write_record(options.output, record, &report);
    write_tables(options.output, plan, record, measured, report);
    write_sweep_page(options.output, plan, record, report);
    return report;
}

} // namespace flotilla
