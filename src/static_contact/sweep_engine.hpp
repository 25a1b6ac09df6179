// SPDX-License-Identifier: MIT
// Projected Gauss-Seidel (paper, section 4.3.2, eqs 15-22), carried on by Nesterov's momentum, over any set of packets:
// a whole island (sweep_island.hpp), the part of it that is not solved yet (unsolved_part.hpp), a level of a shock pass
// (shock.hpp). Those differ in what they do after a sweep and in when they end, and nothing else.
//
// One sweep maps impulses and velocities y to x(y). Plain Gauss-Seidel goes on from x. Here the next sweep starts from
//   y = x + m (x - x_before),  m = (theta - 1) / theta_next,  theta_next = (1 + sqrt(1 + 4 theta^2)) / 2,
// impulses and velocities alike, so that the velocities stay those of the impulses. m is at most
// ContactTuning::most_momentum, which makes slow modes 1 / (1 - m) times faster and leaves the fast ones bounded, and
// starts anew at 0 (theta = 1) where the path turns back: (y - x) . (x - x_before) > 0 in the metric of kinetic energy
// (O'Donoghue and Candes 2015), or the residual rises. Sums run over the bodies in one order.
//
// A packet that meets far more than others is visited several times in a row (ContactTuning::most_visits), without
// momentum: the sweep is still one map, of which the state before and after count.
//
// A sweep is no descent along a symmetric metric: contacts that are not independent, such as those of a disc that
// stands on a floor with 32 corners, answer a change by its opposite, less a part. Momentum lets such modes grow, those
// of eigenvalues below -1 / (1 + 2 m), and the sum above does not see it. So where an evaluation finds that the
// residual did not fall, and the last sweep went against the one before, (y - x_before) . (x - x_before) < 0, the solve
// goes on without momentum (end_momentum). Plain sweeps converge there. What a solve leaves behind is always some x:
// within the bounds of eqs 17-20.
//
// The law with friction is no minimum of anything, so nothing is proved about m > 0; a plain sweep after every restart
// and the residual at the end decide.
//
// Sweeps run in shares for several threads, which within a sweep wait for their neighbours alone (sweep_shares.hpp).
// Decisions fall between sweeps, on the calling thread, and rest on what does not depend on the number of shares:
// packets of one colour touch different bodies, sums of bodies are cut at fixed places and added up in their order, and
// the rest are maxima.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "parallel/sweep_record.hpp"
#include "parallel/team.hpp"
#include "static_contact/divided_sweeps.hpp"
#include "static_contact/momentum.hpp"
#include "static_contact/solver_state.hpp"
#include "static_contact/sweep_shares.hpp"

namespace flotilla {

/// Bodies whose parts of a sum are added up by one thread: sums are cut there, whatever the number of threads.
inline constexpr std::size_t kBodiesPerSum = 64;
[[nodiscard]] constexpr std::size_t num_sums(std::size_t bodies) {
    return (bodies + kBodiesPerSum - 1) / kBodiesPerSum;
}

/// Who sweeps: shares of a team, or the calling thread alone.
struct SweepCrew {
    Team* team = nullptr;
    int shares = 1;
    std::span<ContactScratch::Seen> seen{}; ///< by share
    SweepRecord* record = nullptr;
    std::size_t record_group = 0; ///< of the first group
    bool one_group = false;       ///< everything is recorded as that group
    Division* division = nullptr; ///< all ranks sweep; null: this one
    ShareMemory* memory = nullptr;
};

/// A crew of as many of the team as sweeps are worth, with its record; without a team the calling thread alone,
/// unrecorded. One with several shares at a time.
class Sharing {
  public:
    template <class Width>
    Sharing(Team* team, const char* name, Width&& width, std::size_t record_groups, ContactScratch& s)
        : crew_{of_threads(team), of_threads(team) != nullptr ? width(team->present()) : 1},
          record_(team != nullptr ? team->recorder() : nullptr, name, width, crew_.shares, record_groups) {
        if (crew_.shares > 1) s.seen.assign(static_cast<std::size_t>(crew_.shares), {});
        crew_.seen = crew_.shares > 1 ? std::span(s.seen) : std::span(&alone_, 1);
        crew_.record = &record_;
        crew_.memory = &s.whole_shares;
        if (team != nullptr) crew_.division = team->division();
    }
    Sharing(const Sharing&) = delete;
    Sharing& operator=(const Sharing&) = delete;

    [[nodiscard]] const SweepCrew& crew() const { return crew_; }
    [[nodiscard]] SweepRecord& record() { return record_; }

  private:
    /// Among ranks one thread of each sweeps.
    [[nodiscard]] static Team* of_threads(Team* team) {
        return team != nullptr && team->division() == nullptr ? team : nullptr;
    }

    ContactScratch::Seen alone_;
    SweepCrew crew_;
    SweepRecord record_;
};

/// What is swept.
struct SweepSet {
    SweepView view;                         ///< rows and bodies
    std::span<const ContactPacket> packets; ///< that groups count
    std::int32_t end = 0;                   ///< of the last group
    std::span<const PacketGroup> groups;
    bool momentum = false;                   ///< carries these on:
    std::span<const std::int32_t> bodies{};  ///< movable, ascending or as chosen
    std::span<ContactScratch::Turns> sums{}; ///< num_sums(bodies.size())
};

/// What is to be done after a sweep; restart: go on without momentum.
enum class AfterSweep : std::uint8_t { go_on, restart, done };

class SweepEngine {
  public:
    SweepEngine(const SweepSet& set, const SweepCrew& crew, Cone cone, const ContactSolveOptions& options,
                ContactScratch& scratch)
        : set_(set),
          crew_(crew),
          cone_(cone),
          options_(options),
          s_(scratch),
          shares_(crew.shares, set.groups, set.end, set.packets, scratch.movable, *crew.memory) {
        if (crew.shares > 1 || crew.record->active()) prepare_shares(); // one share needs it for the record alone
        if (crew.division == nullptr || set.groups.empty()) return;
        const auto first = static_cast<std::size_t>(set.groups.front().first);
        divided_ = std::make_unique<DividedSweeps>(
            *crew.division, set.packets.subspan(first, static_cast<std::size_t>(set.end) - first), scratch);
    }

    /// Sweeps until after(sweeps, largest violation met, m/s) says done, at most `limit` times. Returns the number.
    /// Each row is seen at its own turn: where all passed, the state that the sweep left may not.
    template <class After>
    int run(int limit, After&& after) {
        Momentum momentum(options_.tuning.most_momentum);
        double m = 0;
        int sweeps = 0;
        for (bool done = false; !done && sweeps < limit;) {
            const double worst = sweep(m);
            repeat_above_ = std::max(options_.tolerance, options_.tuning.repeat_share * worst);
            const AfterSweep next = after(++sweeps, worst);
            done = next == AfterSweep::done;
            if (set_.momentum) m = momentum.next(next == AfterSweep::restart || !carries_on_ || added_up().back > 0);
        }
        return sweeps;
    }
    /// Whether the last sweep went against the momentum with which it began.
    [[nodiscard]] bool overshoots() const { return set_.momentum && added_up().over < 0; }
    /// From the next sweep on.
    void end_momentum() { carries_on_ = false; }
    [[nodiscard]] bool carries_on() const { return set_.momentum && carries_on_; }
    /// Adds the effect of the impulses that the rows hold.
    void apply_impulses();

    /// The largest of what found(phase, share) returns in all shares of the phases, one after the other.
    template <class Found>
    double largest(std::size_t phases, Found&& found, const PhaseChain* chain = nullptr) {
        for (auto& seen : crew_.seen) seen.worst = 0;
        for_phases(
            phases,
            [&](std::size_t phase, int share) {
                double& worst = crew_.seen[static_cast<std::size_t>(share)].worst;
                worst = std::max(worst, found(phase, share));
            },
            chain);
        double worst = 0;
        for (const auto& seen : crew_.seen) worst = std::max(worst, seen.worst);
        return worst;
    }
    template <class Work>
    void for_phases(std::size_t phases, Work&& work, const PhaseChain* chain = nullptr) {
        flotilla::for_phases(crew_.team, crew_.shares, phases, work, chain);
    }
    /// Calls work(bodies, sum) for this share's stretches of the bodies.
    template <class Work>
    void for_bodies(int share, Work&& work) {
        timed(share, body_group(), [&] {
            const auto cut = [&](int at) {
                return set_.sums.size() * static_cast<std::size_t>(at) / static_cast<std::size_t>(crew_.shares);
            };
            for (std::size_t k = cut(share); k < cut(share + 1); ++k) {
                const std::size_t begin = k * kBodiesPerSum;
                work(set_.bodies.subspan(begin, std::min(kBodiesPerSum, set_.bodies.size() - begin)), set_.sums[k]);
            }
        });
    }
    template <class Work>
    void timed(int share, std::size_t group, Work&& work) {
        crew_.record->timed(share, crew_.record_group + (crew_.one_group ? 0 : group), work);
    }

    /// Null: this rank sweeps all.
    [[nodiscard]] DividedSweeps* divided() const { return divided_.get(); }
    [[nodiscard]] SweepView view(std::span<const ContactPacket> packets, double momentum = 0) const;
    /// What a record is told of a colour of so many sweeps: after all but the last shares wait for neighbours alone.
    [[nodiscard]] GroupSpan span_of(std::size_t group, std::int64_t sweeps) const {
        return {
            .tasks = set_.groups[group].swept, .visits = sweeps, .barriers = group + 1 == num_groups() ? sweeps : 0};
    }
    [[nodiscard]] const SweepCrew& crew() const { return crew_; }
    [[nodiscard]] std::size_t num_groups() const { return set_.groups.size(); }
    // Groups of a record behind those of the colours.
    [[nodiscard]] std::size_t body_group() const { return num_groups(); }
    [[nodiscard]] std::size_t evaluation_group() const { return num_groups() + 1; } ///< and preparation of shares
    [[nodiscard]] Cone cone() const { return cone_; }
    [[nodiscard]] const ContactSolveOptions& options() const { return options_; }

  private:
    /// The sequence of m.
    double sweep(double m);
    double sweep_divided(double m);
    void prepare_shares();
    /// Remembers the velocities x of the bodies and moves them on to y.
    void move_on(int share, double m);
    /// The sums of (y - x) . (x - x_before) and of (y - x_before) . (x - x_before), twice the energies of the products;
    /// a body turns with its mean inertia.
    void add_up(int share);
    [[nodiscard]] ContactScratch::Turns added_up() const;

    SweepSet set_;
    SweepCrew crew_;
    Cone cone_;
    const ContactSolveOptions& options_;
    ContactScratch& s_;
    SweepShares shares_;
    bool carries_on_ = true;
    double repeat_above_ = std::numeric_limits<double>::infinity(); ///< m/s (SweepView)
    std::unique_ptr<DividedSweeps> divided_;
};

} // namespace flotilla
