// SPDX-License-Identifier: MIT
// An ensemble: the runs of a scene from several seeds and with several settings, shared out over ranks.
//
// Ranks take members by claims of files (claim.hpp), in the order of the plan, and say nothing to one another. A rank
// that is lost takes nothing with it: its claim falls back, and another one goes on with the member from its
// checkpoint. For the same reason several jobs may work on one folder at a time, and ranks may leave or join.
//
// What bounds the work of a job: a rank runs a member once at most unless it is lost or told to stop; a member that
// failed, or was stopped by its time limit, is settled for the job.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <flotilla/sweep.hpp>

#include "mpi/ensemble_files.hpp"

namespace flotilla::mpi {

struct Ensemble {
    sweep::Plan plan;
    std::filesystem::path folder;
    Job job;
    int rank = 0;
    std::function<SweepOutcome(const SweepMember&)> run; ///< makes a run and returns when it has ended
    std::function<bool()> stop;                          ///< whether to begin no further run
    std::function<void(const std::string&)> note;        ///< what the user should know, a line each
};

struct EnsembleReport {
    std::size_t members = 0, complete = 0;
    std::vector<std::string> problems; ///< members that are not complete, a line each
    std::vector<std::string> lost;     ///< ranks that were lost in this job, a line each
    int exit_code = 0;                 ///< the first failure's; 6 where members only stopped; else 0
};

/// Makes the folder ready, on one rank while the others wait, and numbers the job. InputError where the folder holds
/// something else, or members that were run with other settings.
void prepare_ensemble(Ensemble& ensemble, bool overwrite, bool resume);

/// What a rank does: runs members until none is left that nobody has settled or runs, or until it is told to stop, and
/// waits for those that others run.
[[nodiscard]] EnsembleReport work_on_ensemble(const Ensemble& ensemble);

} // namespace flotilla::mpi
