// SPDX-License-Identifier: MIT
#include "mpi/one_scene.hpp"

#include <iostream>

#include <flotilla/error.hpp>

#include "api/world_access.hpp"
#include "cli/run_action.hpp"
#include "mpi/mpi_ranks.hpp"
#include "parallel/division.hpp"

namespace flotilla::mpi {
namespace {

/// Throws where ranks do not have the same state.
void compare(Ranks& ranks, const StepReport& report) {
    std::vector<std::uint64_t> hashes(static_cast<std::size_t>(ranks.size()));
    const std::vector<std::size_t> sizes(hashes.size(), sizeof report.state_hash);
    ranks.gather(std::as_bytes(std::span(&report.state_hash, 1)), sizes, std::as_writable_bytes(std::span(hashes)));
    for (std::size_t rank = 1; rank < hashes.size(); ++rank)
        if (hashes[rank] != hashes[0])
            throw BrokenPromise("step " + std::to_string(report.step) + ": the state of rank " + std::to_string(rank) +
                                    " is not that of rank 0",
                                report.step, {});
}

/// What rank 0 and the others have in common.
class Stepping {
  public:
    explicit Stepping(const Session& session) : session_(session), division_(ranks_) {}

    void begin(World& world) { WorldAccess::team(world).divide(&division_); }
    /// After a step of all ranks; `goes_on` is rank 0's. Whether all go on.
    bool after_step(const StepReport& report, bool goes_on) {
        compare(ranks_, report);
        return session_.from_first(goes_on ? 1 : 0) != 0;
    }
    [[nodiscard]] const Division& division() const { return division_; }

  private:
    const Session& session_;
    MpiRanks ranks_;
    Division division_;
};

/// Says what the exception under way says. The others may be waiting for this rank.
[[noreturn]] void end_job(const Session& session) {
    std::cerr << "flotilla-mpi: rank " + std::to_string(session.rank()) + " cannot go on\n";
    session.abort(cli::run_action([]() -> int { throw; }));
}

RunTotals lead(const OneScene& one, const Session& session, Stepping& stepping) {
    bool begun = false;
    RunOptions run = one.run;
    run.begun = [&](World& world) {
        std::vector<std::byte> snapshot = world.snapshot();
        (void)session.from_first(world.steps() < run.steps ? 1 : 0);
        session.from_first(snapshot);
        stepping.begin(world);
        begun = true;
    };
    run.after_step = [&](const StepReport& report) {
        const bool wanted = !one.run.after_step || one.run.after_step(report);
        return stepping.after_step(report, wanted && report.step < run.steps);
    };
    try {
        return run_scene(one.scene, one.source, run);
    } catch (const ScriptError&) {
        throw; // on all ranks, after the same step
    } catch (...) {
        if (begun) end_job(session);
        (void)session.from_first(-1);
        throw;
    }
}

void follow(const OneScene& one, const Session& session, Stepping& stepping) {
    const std::int64_t goes_on = session.from_first(0);
    if (goes_on < 0) return;
    std::vector<std::byte> snapshot;
    session.from_first(snapshot);
    if (goes_on == 0) return;
    World world(one.scene, snapshot, one.source, one.run.world);
    stepping.begin(world);
    try {
        while (stepping.after_step(world.step(), false)) {
        }
    } catch (const ScriptError&) {
        throw;
    } catch (...) {
        end_job(session);
    }
}

} // namespace

OneSceneTotals run_one_scene(const OneScene& one, Session& session) {
    Stepping stepping(session);
    OneSceneTotals totals;
    if (session.first())
        totals.run = lead(one, session, stepping);
    else
        follow(one, session, stepping);
    totals.traffic = stepping.division().ranks().traffic();
    totals.imbalance = stepping.division().imbalance();
    return totals;
}

} // namespace flotilla::mpi
