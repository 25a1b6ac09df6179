// SPDX-License-Identifier: MIT
#include "static_contact/sweep_island.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "base/index.hpp"
#include "static_contact/assemble.hpp"
#include "static_contact/exact_islands.hpp"
#include "static_contact/packed_part.hpp"
#include "static_contact/unsolved_part.hpp"

namespace flotilla {
namespace {

using Island = ContactScratch::Island;
using Seen = ContactScratch::Seen;

std::span<const PacketGroup> groups_of(const Island& island, const ContactScratch& s) {
    return std::span(s.groups).subspan(at(island.first_group), at(island.end_group - island.first_group));
}

int width_of(const Island& island, const ContactScratch& s, int most) {
    return sweep_width_of(groups_of(island, s), island.end_packet, most);
}

/// What an evaluation of the residual found.
struct Left {
    double residual = std::numeric_limits<double>::infinity(); ///< m/s
    int violated = 0; ///< pairs; counted only in islands that may be over-constrained
};

/// The residual of an over-constrained spot hides progress elsewhere: the number of violated pairs must stand as well.
bool stands(const Left& before, const Left& now, const ContactTuning& tuning) {
    return std::abs(now.residual - before.residual) <= tuning.stands * now.residual &&
           now.violated >= tuning.fewer * before.violated;
}

/// Whether the residual still falls.
class FallOfResidual {
  public:
    FallOfResidual(const ContactSolveOptions& options, bool jams)
        : tuning_(options.tuning),
          patience_(options.patience),
          most_residual_(options.tolerance > 0 ? options.tolerance / std::numeric_limits<double>::epsilon()
                                               : std::numeric_limits<double>::max()),
          jams_(jams && options.tuning.looks_at_jam > 0) {}

    void saw(int sweeps, const Left& left) {
        if (left.residual <= tuning_.least_fall * mark_.residual ||
            left.violated < tuning_.least_fall * mark_.violated) {
            mark_ = left;
            mark_sweeps_ = sweeps;
        }
        lost_ = !(left.residual < most_residual_);
        rose_ = left.residual > tuning_.most_rise * lowest_;
        lowest_ = rose_ ? left.residual : std::min(lowest_, left.residual);
    }
    /// What follows has all the patience to itself.
    void begin_again(int sweeps, const Left& left) {
        mark_ = left;
        mark_sweeps_ = sweeps;
        looks_standing_ = 0;
    }
    void count_standing(const Left& left) {
        looks_standing_ = stands(last_, left, tuning_) ? looks_standing_ + 1 : 0;
        last_ = left;
    }
    /// Whether the island looks over-constrained.
    [[nodiscard]] bool jams() const { return jams_ && looks_standing_ >= tuning_.looks_at_jam; }
    /// Once for each evaluation that found the residual far above its lowest value since the last such one.
    bool rose() { return std::exchange(rose_, false); }
    /// Whether it did not fall in the sweeps of the patience.
    [[nodiscard]] bool stalls(int sweeps) const {
        return lost_ || (patience_ > 0 && sweeps - mark_sweeps_ >= patience_);
    }

  private:
    const ContactTuning& tuning_;
    int patience_;
    double most_residual_; ///< m/s: beyond it velocities are not known to the tolerance, and do not come back to it
    bool jams_;            ///< whether the island may be over-constrained
    Left mark_;            ///< what was left when it last had fallen by so much, and when that was
    int mark_sweeps_ = 0;
    Left last_;
    double lowest_ = std::numeric_limits<double>::infinity();
    int looks_standing_ = 0;
    bool rose_ = false, lost_ = false;
};

/// How far the solve of an island has come.
struct Course {
    FallOfResidual fall;
    int whole = 0, of_parts = 0; ///< sweeps; those of parts in sweeps of the whole that cost as much
    int packed = 0;              ///< sweeps of packed parts, one by one
    /// Parts interrupt the momentum of the whole and leave its slow modes alone. So wherever they did not solve it, the
    /// whole is swept by itself until the next evaluation.
    int parts_from = 0;
    Left left{};

    [[nodiscard]] int sweeps() const { return whole + of_parts; }
    /// Sweeps in which the residual should have fallen. A part in motion holds the worst of it, and each of its sweeps
    /// is a try: what does not converge there costs little, and is given up as early as in the whole.
    [[nodiscard]] int tries() const { return packed > 0 ? whole + packed : sweeps(); }
    [[nodiscard]] bool stalls() const { return fall.stalls(tries()); }
    void saw(const Left& found) {
        saw_after_part(found);
        fall.count_standing(found);
    }
    /// Does not count as standing: the whole may have been swept a few times only.
    void saw_after_part(const Left& found) {
        left = found;
        fall.saw(tries(), found);
    }
};

/// What goes on between the sweeps of one island: evaluations of the residual, parts swept alone, the decision when to
/// end.
class IslandSweeps {
  public:
    IslandSweeps(Island& island, const ContactSolveOptions& options, const SweepStart& start, Sharing& sharing,
                 ContactScratch& s)
        : island_(island),
          options_(options),
          start_(start),
          s_(s),
          bodies_(std::span(s.island_bodies).subspan(at(island.first_body), at(island.end_body - island.first_body))),
          packets_(std::span(s.packed.packets)
                       .subspan(at(island.first_packet), at(island.end_packet - island.first_packet))),
          violated_(
              std::span(s.violated).subspan(at(island.first_packet), at(island.end_packet - island.first_packet))),
          jams_(options.patience > 0 && island.rests && may_be_over_constrained(island)),
          may_use_parts_(island.rests && tuning().part_divisor > 0 &&
                         (is_large(island, s) || !may_solve_exactly(island, options, s))),
          packs_parts_(!island.rests && options.patience > 0 && tuning().packed_divisor > 0 && is_large(island, s)),
          course_{.fall = FallOfResidual(options, jams_)},
          sharing_(sharing),
          engine_(sweep_set(), sharing.crew(), cone_of(options, s), options, s) {
        if (may_use_parts_) reserve_unsolved(island, tuning(), s, part());
    }

    void run() {
        if (start_.apply_impulses) engine_.apply_impulses();
        engine_.run(options_.iterations, [&](int, double worst) { return after_sweep(worst); });
        if (!known_) evaluate_again();
        if (engine_.divided() != nullptr) engine_.divided()->share_impulses(s_.packed);
        finish();
    }

  private:
    [[nodiscard]] const ContactTuning& tuning() const { return options_.tuning; }
    [[nodiscard]] UnsolvedPart& part() const { return s_.parts[at(start_.thread)]; }
    [[nodiscard]] SweepSet sweep_set() const {
        return {.view = {.rows = s_.packed.rows.data(),
                         .normal_rows = s_.packed.normal_rows.data(),
                         .extras = s_.packed.extras_if_any(),
                         .bodies = s_.velocity.data()},
                .packets = s_.packed.packets,
                .end = island_.end_packet,
                .groups = groups_of(island_, s_),
                .momentum = start_.momentum,
                .bodies = bodies_,
                .sums = std::span(s_.sums).subspan(at(island_.first_body), num_sums(bodies_.size()))};
    }

    // A sweep that met no violation is confirmed on the state that it left. With momentum it also meets what the
    // extrapolation added; so the state is evaluated now and then where sweeps do meet some.
    AfterSweep after_sweep(double worst) {
        ++course_.whole;
        known_ = worst <= aim_ || course_.whole % tuning().look_every == 0;
        bool used_parts = false;
        if (known_) {
            if (packs_parts_) choose_above(worst);
            const double before = course_.left.residual;
            evaluate();
            course_.saw(seen_left());
            // Plain sweeps bring such contacts together all the same: momentum ends for this solve.
            if (!(course_.left.residual < before) && engine_.overshoots()) engine_.end_momentum();
            used_parts = (may_use_parts_ || packs_parts_) && course_.whole >= course_.parts_from && solve_parts();
            const bool settled = settle();
            used_parts |= settled;
            // What settling changes at the border of its part is within the tolerance, mostly.
            if (course_.left.residual <= (settled ? island_.tolerance : aim_)) return AfterSweep::done;
        } else if (course_.whole == tuning().peek) {
            activate_violated();
        }
        if (gives_up() || course_.sweeps() >= options_.iterations) return AfterSweep::done;
        return course_.fall.rose() || used_parts ? AfterSweep::restart : AfterSweep::go_on;
    }

    [[nodiscard]] bool gives_up() const {
        const bool solved = aim_ < options_.tolerance; // nothing contradicts itself
        return course_.stalls() || (!solved && course_.fall.jams());
    }

    /// Evaluates the residual, and activates violated parked contacts.
    void evaluate() {
        if (engine_.divided() != nullptr) return evaluate_divided();
        looks_ += 2;
        engine_.for_phases(2, [&](std::size_t phase, int share) {
            Seen& seen = engine_.crew().seen[at(share)];
            if (phase == 0) {
                seen.residual = find_left(share);
                return note_changes(share);
            }
            seen.residual = std::max(seen.residual, activate_violated(share));
            if (jams_) seen.violated = count_violated(share_of_packets(share));
        });
    }
    /// By all ranks, each of its own packets.
    void evaluate_divided() {
        Seen& seen = engine_.crew().seen[0];
        double residual = 0;
        const std::int64_t begin = engine_.divided()->clock();
        for (const auto& packets : engine_.divided()->own()) residual = std::max(residual, residual_of(packets));
        note_changes(0);
        for (const auto& packets : engine_.divided()->own())
            residual = std::max(residual, activate_violated_of(packets));
        engine_.divided()->add_evaluation(engine_.divided()->clock() - begin);
        seen.residual = engine_.divided()->share_found(residual, packets_, violated_);
        if (jams_) seen.violated = count_violated(packets_);
    }
    double find_left(int share) {
        double residual = 0;
        engine_.timed(share, engine_.evaluation_group(), [&] { residual = residual_of(share_of_packets(share)); });
        return residual;
    }
    double residual_of(std::span<const ContactPacket> packets) {
        const SweepView view = engine_.view(packets);
        return marks_violated() ? find_violated(engine_.cone(), view, chosen_above_,
                                                violated_.data() + first_of(packets), options_.isa)
                                : largest_violation(engine_.cone(), view, options_.isa);
    }
    [[nodiscard]] bool marks_violated() const { return island_.rests || packs_parts_; }
    /// Which pairs the next evaluation marks: in motion those near the worst, by what a sweep or an evaluation found.
    void choose_above(double worst) { chosen_above_ = std::max(options_.tolerance, tuning().packed_above * worst); }
    void evaluate_again() {
        evaluate();
        course_.left.residual = seen_left().residual;
    }
    [[nodiscard]] Left seen_left() const {
        Left left{.residual = 0};
        for (const Seen& seen : engine_.crew().seen) {
            left.residual = std::max(left.residual, seen.residual);
            if (jams_) left.violated += seen.violated;
        }
        return left;
    }
    [[nodiscard]] int count_violated(std::span<const ContactPacket> share) const {
        int pairs = 0;
        for (const std::uint8_t bits : violated_.subspan(first_of(share), share.size())) pairs += std::popcount(bits);
        return pairs;
    }

    /// Activates batches whose parked contacts are violated.
    void activate_violated() {
        if (engine_.divided() != nullptr) {
            note_changes(0);
            for (const auto& packets : engine_.divided()->own()) activate_violated_of(packets);
            engine_.divided()->share_found(0, packets_, violated_);
            return;
        }
        looks_ += 2;
        engine_.for_phases(2, [&](std::size_t phase, int share) {
            if (phase == 0) return note_changes(share);
            activate_violated(share);
        });
    }
    /// After note_changes() of all shares; returns the largest violation of contacts that were parked.
    double activate_violated(int share) {
        double worst = 0;
        engine_.timed(share, engine_.evaluation_group(), [&] {
            worst = activate_violated_of(share_of_packets(share)); // as in evaluate(), which reads what this changes
        });
        return worst;
    }
    double activate_violated_of(std::span<const ContactPacket> packets) {
        double worst = 0;
        const std::size_t first = first_of(packets);
        for (std::size_t p = first; p < first + packets.size(); ++p) {
            if (packets_[p].first_parked == packets_[p].end_parked || packets_[p].woken != 0) continue;
            if (parked_contacts_hold(p)) continue;
            const double violation =
                largest_parked_violation(engine_.cone(), engine_.view(packets_.subspan(p, 1)), options_.isa);
            if (violation > options_.tolerance) {
                packets_[p].woken = 1;
                if (marks_violated()) violated_[p] = kAllPairs;
            }
            worst = std::max(worst, violation);
        }
        return worst;
    }
    void note_changes(int share) {
        engine_.for_bodies(share, [&](std::span<const std::int32_t> bodies, ContactScratch::Turns&) {
            for (const std::int32_t body : bodies) {
                const BodyVelocity &v = s_.velocity[at(body)], &start = s_.start_velocity[at(body)];
                s_.change[at(body)] = {v.linear - start.linear, length(v.angular - start.angular)};
            }
        });
    }
    /// Whether the velocities of the batch's bodies changed too little for any of its parked contacts to be violated.
    [[nodiscard]] bool parked_contacts_hold(std::size_t packet) const {
        const ContactPacket& p = packets_[packet];
        const double reach = s_.packed.parked_reach[at(island_.first_packet) + packet];
        bool hold = true;
        for (std::size_t lane = 0; lane < kPacketLanes; ++lane) { // those without a pair repeat another's bodies
            const ContactScratch::Change &a = s_.change[at(p.a[lane])], &b = s_.change[at(p.b[lane])];
            const double margin = tuning().parked_margin * std::min(options_.tolerance, island_.asked);
            const double least = tuning().parked_room * margin - reach * (a.turn + b.turn);
            hold &= least > 0 && length_sq(b.linear - a.linear) < least * least;
        }
        return hold;
    }

    /// After an evaluation, sweeps alone what is not solved yet, for as long as that is a small part and helps; the
    /// whole is evaluated after every round. Returns whether there was a round.
    bool solve_parts() {
        bool swept = false;
        const int most = std::min(options_.iterations, course_.sweeps() + tuning().part_waits * tuning().look_every);
        while (course_.left.residual > options_.tolerance && course_.sweeps() < most && !gives_up() &&
               (packs_parts_ ? sweep_packed(most - course_.sweeps()) : sweep_part(!swept, most - course_.sweeps()))) {
            swept = true;
            if (packs_parts_) choose_above(course_.left.residual);
            evaluate();
            const Left before = course_.left;
            course_.saw_after_part(seen_left());
            if (!packs_parts_ && stands(before, course_.left, tuning())) break;
        }
        if (swept) course_.parts_from = course_.whole + tuning().look_every;
        return swept;
    }
    /// Once, where an island at rest is solved: sweeps what still moves to less than the tolerance, or has the whole
    /// swept on where that is most of it. Returns whether a part was swept.
    bool settle() {
        if (settled_ || !may_use_parts_ || options_.patience == 0 || tuning().settle_above <= 0) return false;
        if (!(course_.left.residual <= options_.tolerance)) return false;
        // The whole must be left the sweeps until its next evaluation, for what this changes at the part's border.
        const int most = options_.iterations - course_.sweeps() - tuning().look_every;
        if (most <= 0) return false;
        settled_ = true;
        IslandMotion motion;
        engine_.timed(0, choice_group(engine_), [&] { motion = mark_moving(island_, tuning(), s_, part()); });
        if (!motion.any) return false;
        ContactSolveOptions finer = options_;
        finer.tolerance *= tuning().settle_to;
        if (!sweep_marked(most, finer)) {
            const bool most_moves = !part().packets.empty();
            if (most_moves && motion.mean <= tuning().settle_whole_below * island_.tolerance)
                aim_ *= tuning().settle_whole_to;
            return false;
        }
        evaluate();
        course_.saw_after_part(seen_left());
        course_.fall.begin_again(course_.tries(), course_.left);
        course_.parts_from = course_.whole + tuning().look_every;
        return true;
    }
    /// Calls work(first, end) for each share of the packets, as places in those of all islands.
    template <class Work>
    void look(Work&& work) {
        ++looks_;
        engine_.for_phases(1, [&](std::size_t, int share) {
            engine_.timed(share, engine_.evaluation_group(), [&] {
                const auto packets = share_of_packets(share);
                const std::size_t first = at(island_.first_packet) + first_of(packets);
                work(first, first + packets.size());
            });
        });
    }
    /// Sweeps the batches of marked bodies; false where those are too many.
    bool sweep_marked(int most_cost, const ContactSolveOptions& options) {
        look([&](std::size_t first, std::size_t end) { find_touching(first, end, s_, part()); });
        bool chosen = false;
        engine_.timed(0, choice_group(engine_), [&] { chosen = choose_unsolved(island_, tuning(), s_, part()); });
        if (!chosen) return false;
        const auto packets = static_cast<std::int64_t>(part().packets.size());
        const auto whole = static_cast<std::int64_t>(packets_.size());
        const int sweeps =
            sweep_unsolved(engine_, engine_.carries_on(), most_cost * whole / packets, options, s_, part());
        count_part(sweeps, packets, part().contacts, part().groups.size());
        return true;
    }
    /// One round; false where the part is too large.
    bool sweep_part(bool anew, int most_cost) {
        bool chosen = false;
        engine_.timed(0, choice_group(engine_), [&] { chosen = mark_unsolved(island_, tuning(), anew, s_, part()); });
        return chosen && sweep_marked(most_cost, options_);
    }
    /// One round in an island in motion; false where the part is too large.
    bool sweep_packed(int most_cost) {
        if (engine_.divided() != nullptr) engine_.divided()->share_impulses(s_.packed); // each rank sweeps all of it
        bool chosen = false;
        engine_.timed(0, choice_group(engine_), [&] { mark_near(island_, s_); });
        look([&](std::size_t first, std::size_t end) { find_near_pairs(first, end, s_); });
        engine_.timed(0, choice_group(engine_), [&] { chosen = choose_near(island_, tuning(), s_); });
        if (!chosen) return false;
        pack_part(options_.team, s_);
        const auto part = static_cast<std::int64_t>(s_.packed_part.packed.packets.size());
        const std::int64_t most = most_cost * static_cast<std::int64_t>(packets_.size()) / part;
        const int sweeps = sweep_packed_part(engine_, engine_.carries_on(), most, chosen_above_, s_);
        count_part(sweeps, part, s_.packed_part.contacts, s_.packed_part.groups.size());
        course_.packed += sweeps;
        return true;
    }
    void count_part(int sweeps, std::int64_t packets, std::int64_t contacts, std::size_t groups) {
        const auto whole = static_cast<std::int64_t>(packets_.size());
        island_.visits += sweeps * contacts;
        course_.of_parts += static_cast<int>(std::max<std::int64_t>(1, sweeps * packets / whole));
        part_tasks_ += sweeps * packets;
        part_visits_ += sweeps * static_cast<std::int64_t>(groups);
        part_sweeps_ += sweeps;
        ++part_rounds_;
    }

    void finish() {
        island_.residual = course_.left.residual;
        island_.solved = island_.residual <= options_.tolerance;
        island_.iterations += course_.sweeps();
        for (std::int32_t p = island_.first_packet; p < island_.end_packet; ++p)
            island_.visits += course_.whole * num_contacts(s_, at(p));
        island_.part_rounds += part_rounds_;
        sharing_.record().end([&](std::size_t group) { return span_of(group); });
    }
    /// What a record is told of a group.
    [[nodiscard]] GroupSpan span_of(std::size_t group) const {
        if (group < engine_.num_groups())
            return engine_.span_of(group, course_.whole + (start_.apply_impulses ? 1 : 0));
        if (group == engine_.body_group()) // before and after a sweep with momentum
            return all_wait(num_sums(bodies_.size()), start_.momentum ? 2 * course_.whole : 0);
        if (group == engine_.evaluation_group()) return all_wait(packets_.size(), looks_ + SweepShares::kPreparations);
        if (group == choice_group(engine_)) return all_wait(1, part_rounds_);
        const std::int64_t wait = (start_.momentum ? 3 : 1) * part_sweeps_ + part_rounds_ * SweepShares::kPreparations;
        const std::int64_t visits = part_visits_ + wait - part_sweeps_;
        return {.tasks = static_cast<std::int32_t>(
                    std::max<std::int64_t>(1, part_tasks_ / std::max<std::int64_t>(1, visits))),
                .visits = visits,
                .barriers = wait};
    }
    [[nodiscard]] static GroupSpan all_wait(std::size_t tasks, std::int64_t visits) {
        return {.tasks = static_cast<std::int32_t>(tasks), .visits = visits, .barriers = visits};
    }

    [[nodiscard]] std::span<const ContactPacket> share_of_packets(int share) const {
        return share_of(packets_, share, engine_.crew().shares);
    }
    [[nodiscard]] std::size_t first_of(std::span<const ContactPacket> share) const {
        return static_cast<std::size_t>(share.data() - packets_.data());
    }

    Island& island_;
    const ContactSolveOptions& options_;
    SweepStart start_;
    ContactScratch& s_;
    std::span<const std::int32_t> bodies_;
    std::span<ContactPacket> packets_;
    std::span<std::uint8_t> violated_; ///< as find_violated() sets it, by packet of the island
    bool jams_;                        ///< whether it may be over-constrained
    bool may_use_parts_;               ///< whether what is not solved may be swept alone
    bool packs_parts_;                 ///< whether it may be, and is packed anew: in motion
    Course course_;
    double aim_ = options_.tolerance;          ///< m/s, the residual at which sweeps of the whole end
    double chosen_above_ = options_.tolerance; ///< m/s: violations that evaluations mark
    bool known_ = false;                       ///< course_.left is that of the last sweep
    bool settled_ = false;                     ///< what moves was swept alone
    int part_rounds_ = 0;
    std::int64_t looks_ = 0;                                          ///< phases over all packets, beside the sweeps
    std::int64_t part_tasks_ = 0, part_visits_ = 0, part_sweeps_ = 0; ///< of packets, of groups, of all
    Sharing& sharing_;
    SweepEngine engine_;
};

} // namespace

void list_island_bodies(const ContactBodies& bodies, ContactScratch& s) {
    const std::size_t n = s.bodies.size();
    s.change.assign(n, {});
    s.before_sweep.resize(n);
    s.sweep_start.resize(n);
    s.weight.resize(n);
    s.sums.resize(n);
    s.energy_sums.resize(n);
    s.work_sums.resize(s.packed.packets.size());
    s.violated.resize(s.packed.packets.size());
    s.island_bodies.clear();
    for (std::size_t body = 0; body < n; ++body) {
        if (!s.movable[body]) continue;
        s.island_bodies.push_back(static_cast<std::int32_t>(body));
        const std::size_t id = at(s.bodies[body]);
        const Mat3& j = bodies.inv_inertia[id];
        const double trace = j.m[0] + j.m[4] + j.m[8];
        s.weight[body] = {1 / bodies.inv_mass[id], trace > 0 ? 3 / trace : 0.0};
    }
    stable_sort_by_key(s.island_of_body, static_cast<int>(s.islands.size()), s.island_bodies, s.counts, s.sorted);
    for (std::size_t k = 0; k < s.island_bodies.size(); ++k) {
        Island& island = s.islands[at(s.island_of_body[at(s.island_bodies[k])])];
        if (island.end_body == 0) island.first_body = static_cast<std::int32_t>(k);
        island.end_body = static_cast<std::int32_t>(k + 1);
    }
    for (Island& island : s.islands)
        for (std::int32_t k = island.first; k < island.end; ++k) {
            const std::int32_t active = s.blocks[at(k)].parked - s.blocks[at(k)].first;
            island.active_contacts += active;
            island.active_pairs += active > 0 ? 1 : 0;
        }
}

bool is_large(const Island& island, const ContactScratch& s) { return width_of(island, s, 2) > 1; }

void sweep_island(Island& island, const ContactSolveOptions& options, const SweepStart& start, ContactScratch& s) {
    const bool together = options.team != nullptr && is_large(island, s);
    const auto width = [&](int most) { return width_of(island, s, most); };
    const std::size_t groups = groups_of(island, s).size() + kGroupsOfWhole;
    Sharing sharing(together ? options.team : nullptr, "contact sweeps", width, groups, s);
    IslandSweeps(island, options, start, sharing, s).run();
}

} // namespace flotilla
