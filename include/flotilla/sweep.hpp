// SPDX-License-Identifier: MIT
// Campaigns: the runs of one problem with the product of some settings, what each cost and how far it is from a
// reference, and which setting is worth changing first.
//
// A point is one choice of settings; a start is one scene, or one seed of it; every point is run from every start.
// Piles are chaotic: two runs that differ in the last bit soon differ in every pose, so points are compared by
// quantities that a pile has whatever its poses, as mean and spread over the starts. Where runs stay together, poses
// are compared with those of the reference at the same times.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace flotilla {

/// What is measured of a run. "The end" is the last tenth of its time.
struct SweepMetric {
    std::string_view name, unit;
    std::string_view description;
    enum class Truth : std::uint8_t {
        reference, ///< the reference's value, start by start
        zero,      ///< the value is the error
    } truth = Truth::reference;
    bool needs_reference = false; ///< has no value without one
};
/// Every metric, in the order of the tables.
[[nodiscard]] std::span<const SweepMetric> sweep_metrics();

struct SweepAxis {
    std::string key; ///< a setting, "preset", or "seed", whose values are starts; "dt" is time_step
    std::vector<std::string> values;
};

/// A run to be made: what `flotilla run` takes.
struct SweepMember {
    std::string name;
    std::filesystem::path scene, folder,
        log; ///< scene file; run folder, gone on with where it has a checkpoint; messages
    std::string preset;
    std::vector<std::pair<std::string, std::string>> overrides;
    std::int64_t steps = 0;
    int frame_every = 1, threads = 1;
};
struct SweepOutcome {
    int exit_code = 0;  ///< as the command's: 0 complete, 6 stopped early but resumable, others failed
    std::string reason; ///< of what is not complete
    double cpu = 0;     ///< s, of all its threads; 0: not known
};

struct SweepOptions {
    /// Scene files, or names of the library. Several are several starts of one problem.
    std::vector<std::string> scenes;
    int bodies = 0; ///< of scenes of the library; 0: their default
    std::string preset = "balanced";
    std::vector<std::pair<std::string, std::string>> overrides; ///< of every run, the reference's included
    std::vector<SweepAxis> vary;
    std::string reference;            ///< preset; empty: none. Where time_step is varied, it takes half of the shortest
    std::vector<std::string> metrics; ///< empty: all. The first is the error of the front, unless empty
    std::int64_t steps = -1; ///< of the time step that is not varied; others cover the same time. < 0: duration
    double duration = 10;    ///< s
    int threads = 1;         ///< of each run
    int jobs = 0; ///< runs at a time; 0: as many as the usable cores have room for. At most one per usable core
    std::vector<std::string> command_line; ///< for the record
    std::filesystem::path output;
    bool overwrite = false;
    /// Goes on with the campaign in the folder: members that are complete are kept, stopped ones go on from their
    /// checkpoints. Other values of `vary` add members; a changed scene, setting, time or number of threads is
    /// refused.
    bool resume = false;
    /// Makes a run and returns when it has ended. Called side by side, on threads of oneTBB.
    std::function<SweepOutcome(const SweepMember&)> run;
    std::function<bool()> stop; ///< whether to begin no further run; may be empty
    std::function<void(std::size_t done, std::size_t total, const std::string& member)> progress; ///< may be empty
    std::function<void(const std::string&)> note; ///< what the user should know, a line each; may be empty
};

/// Over the starts; nan where there is none.
struct SweepValue {
    double mean = 0;
    double spread = 0; ///< standard deviation; 0 of a single start
    int starts = 0;    ///< that have a value
};

struct SweepPoint {
    std::string label;               ///< "preset=preview time_step=0.01"
    std::vector<std::string> values; ///< by axis, the seeds left out; empty for a reference of its own
    bool reference = false;
    int complete = 0; ///< starts
    /// s, wall time of the steps; of a run on one thread that had no core to itself, its CPU time
    SweepValue cost;
    std::vector<SweepValue> values_of; ///< by metric
    /// By metric: the mean's distance from the truth, and as spread the standard error of that (0 of a single start).
    std::vector<SweepValue> errors;
    bool on_front = false; ///< no other point has less of both cost and error
};

/// What one change of one setting brings, against the base.
struct SweepChange {
    std::string key, from, to;
    double cost_ratio = 1;  ///< new / old; 1 where within kSameCost
    double error_ratio = 1; ///< new / old; 1 where within the uncertainty
    double gain = 0;        ///< -log of the product: by how much the work, cost times error, shrinks
    SweepValue cost_from, cost_to, error_from, error_to;
};

struct SweepReport {
    std::vector<SweepAxis> axes;       ///< without seeds
    std::vector<std::string> starts;   ///< names
    std::vector<SweepMetric> metrics;  ///< those asked for
    std::size_t headline = 0;          ///< the metric that front and advice go by
    bool chaotic = false;              ///< runs do not stay with the reference: poses say nothing
    double size = 0;                   ///< m, mean size of the moving bodies
    double duration = 0;               ///< s
    std::vector<SweepPoint> points;    ///< a reference of its own is the last
    std::size_t base = 0;              ///< the point that `changes` start from
    std::vector<SweepChange> changes;  ///< sorted, the largest gain first
    std::vector<std::string> advice;   ///< in words, a line each
    std::vector<std::string> problems; ///< members that failed or are not complete, a line each
    std::vector<std::string> remarks;  ///< what to know of the figures, a line each
    std::size_t members = 0, complete = 0;
    bool stopped = false; ///< some member can go on
    int exit_code = 0;    ///< the first failure's; 6 where only `stopped`; else 0
};

/// Costs that differ by less than this part are called equal: what wall times of one run repeated differ by on a
/// quiet machine.
inline constexpr double kSameCost = 0.1;

/// Makes the runs that the folder lacks, and writes there sweep.csv (a row per point), members.csv, sweep.json and
/// sweep.html. Throws InputError with everything that is wrong with the options before the first run, and IoError.
[[nodiscard]] SweepReport run_sweep(const SweepOptions& options);

} // namespace flotilla
