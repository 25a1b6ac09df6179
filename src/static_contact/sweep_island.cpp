// SPDX-License-Identifier: MIT
#include "static_contact/sweep_island.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "static_contact/assemble.hpp"
#include "static_contact/momentum.hpp"
#include "static_contact/packet_shares.hpp"
#include "static_contact/unsolved_part.hpp"

namespace flotilla {
namespace {

using Island = ContactScratch::Island;

/// Momentum can keep a turning error alive that never heads straight back; then the residual goes up and down.
constexpr double kMostRise = 2;
/// Sweeps between two looks at the residual: one costs about half a sweep.
constexpr int kLookEvery = 10;
/// Sweeps after which parked contacts are looked at before the first look: most that will be woken are violated by then.
constexpr int kFirstPeek = 2, kSecondPeek = 5;
/// An island stalls whose residual did not fall by a fifth for some time.
constexpr double kLeastFall = 0.8;
/// A jam: bodies that touch so many others that their impulses are not determined hand them round for ever, and one look after the other
/// finds the residual where it was, to a hundredth. Where bodies touch few others it may also stand, but because a slow mode of many
/// bodies (a stack that leans) is on its way.
constexpr double kStands = 0.01, kFewer = 0.9;
constexpr int kLooksAtJam = 2, kPairsOfJam = 2; // pairs a body
/// In such an island a contact is let off one tolerance, of the approach or gap that it is off its target, for every so many rest speeds
/// by which its normal impulse changes the approach, and ten at most. Deep piles were never solved without that: contacts that carry
/// ten to a hundred times a body's weight and are some um farther off than their rest distance hand it to the others of their pair at
/// the violation per sweep, 2e-4 of 27 m/s.
constexpr double kLoadPerTolerance = 5, kMostLetOff = 10;

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

std::span<const PacketGroup> groups_of(const Island& island, const ContactScratch& s) {
    return std::span(s.groups).subspan(index(island.first_group), index(island.end_group - island.first_group));
}

int width_of(const Island& island, const ContactScratch& s, int most) {
    return sweep_width_of(groups_of(island, s), island.end_packet, s.packed.packets, most);
}

/// What a look found.
struct Left {
    double residual = std::numeric_limits<double>::infinity(); ///< m/s
    int violated = 0;                                          ///< pairs; counted in islands that may jam only
};

/// One jam hides behind its residual what is still on its way elsewhere: the number of violated pairs must stand as well.
bool stands(const Left& before, const Left& now) {
    return std::abs(now.residual - before.residual) <= kStands * now.residual &&
           now.violated >= kFewer * before.violated;
}

/// Whether the residual still falls.
class Progress {
  public:
    Progress(int patience, bool jams) : patience_(patience), jams_(jams) {}

    void saw(int sweeps, const Left& left) {
        if (left.residual <= kLeastFall * mark_.residual || left.violated < kLeastFall * mark_.violated) {
            mark_ = left;
            mark_sweeps_ = sweeps;
        }
        rose_ = left.residual > kMostRise * lowest_;
        lowest_ = rose_ ? left.residual : std::min(lowest_, left.residual);
    }
    void count_standing(const Left& left) {
        looks_standing_ = stands(last_, left) ? looks_standing_ + 1 : 0;
        last_ = left;
    }
    /// Once per look that found the residual far above its lowest value since the last such look.
    bool rose() { return std::exchange(rose_, false); }
    [[nodiscard]] bool stalls(int sweeps) const {
        return patience_ > 0 && (sweeps - mark_sweeps_ >= patience_ || (jams_ && looks_standing_ >= kLooksAtJam));
    }

  private:
    int patience_;
    bool jams_; ///< whether the island may be jammed
    Left mark_; ///< what was left when it last had fallen by so much, and when that was
    int mark_sweeps_ = 0;
    Left last_;
    double lowest_ = std::numeric_limits<double>::infinity();
    int looks_standing_ = 0;
    bool rose_ = false;
};

} // namespace

void list_island_bodies(const ContactBodies& bodies, ContactScratch& s) {
    const std::size_t n = s.bodies.size();
    s.change.assign(n, {});
    s.before_sweep.resize(n);
    s.sweep_start.resize(n);
    s.weight.resize(n);
    s.sums.resize(n);
    s.violated.resize(s.packed.packets.size());
    s.island_bodies.clear();
    for (std::size_t body = 0; body < n; ++body) {
        if (!s.movable[body]) continue;
        s.island_bodies.push_back(static_cast<std::int32_t>(body));
        const std::size_t id = index(s.bodies[body]);
        const Mat3& j = bodies.inv_inertia[id];
        const double trace = j.m[0] + j.m[4] + j.m[8];
        s.weight[body] = {1 / bodies.inv_mass[id], trace > 0 ? 3 / trace : 0.0};
    }
    stable_sort_by_key(s.island_of_body, static_cast<int>(s.islands.size()), s.island_bodies, s.counts, s.sorted);
    for (std::size_t k = 0; k < s.island_bodies.size(); ++k) {
        Island& island = s.islands[index(s.island_of_body[index(s.island_bodies[k])])];
        if (island.end_body == 0) island.first_body = static_cast<std::int32_t>(k);
        island.end_body = static_cast<std::int32_t>(k + 1);
    }
}

bool is_large(const Island& island, const ContactScratch& s) { return width_of(island, s, 2) > 1; }

using Seen = ContactScratch::Seen;

/// The sweeps of one island, in shares for several threads. Decisions fall between phases, on the calling thread, and rest on what does not
/// depend on the number of shares: packets of one colour touch different bodies, sums of bodies are cut at fixed places and added up
/// in their order, and the rest are maxima.
class IslandSweeps {
  public:
    IslandSweeps(Island& island, const ContactSolveOptions& options, const SweepStart& start, int threads,
                 ContactScratch& s)
        : island_(island),
          options_(options),
          start_(start),
          threads_(threads),
          cone_(cone_of(options, s)),
          s_(s),
          bodies_(
              std::span(s.island_bodies).subspan(index(island.first_body), index(island.end_body - island.first_body))),
          packets_(std::span(s.packed.packets)
                       .subspan(index(island.first_packet), index(island.end_packet - island.first_packet))),
          violated_(std::span(s.violated)
                        .subspan(index(island.first_packet), index(island.end_packet - island.first_packet))),
          groups_(groups_of(island, s)),
          jams_(options.patience > 0 && island.rests &&
                index(island.end - island.first) > kPairsOfJam * bodies_.size()),
          load_share_(jams_ ? options.tolerance / (kLoadPerTolerance * options.rest_speed) : 0),
          may_use_parts_(island.rests && is_large(island, s)),
          seen_(threads > 1 ? std::span(s.seen) : std::span(&alone_, 1)),
          recorder_(options.team != nullptr ? options.team->recorder() : nullptr) {
        if (may_use_parts_) reserve_unsolved(island, s);
        if (recorder_ != nullptr) busy_.assign(index(threads) * num_groups(), 0);
    }

    void run() {
        if (start_.apply_impulses) apply_impulses();
        if (start_.momentum) for_phases(1, [&](std::size_t, int share) { remember(share); });
        Course course{.progress = Progress(options_.patience, jams_)};
        Momentum momentum;
        double m = 0;
        bool known = false, stalled = false;
        while (course.sweeps() < options_.iterations && !stalled) {
            const double worst = sweep_groups(m);
            ++course.whole;
            known = worst <= options_.tolerance || course.whole % kLookEvery == 0;
            const bool peek = !known && (course.whole == kFirstPeek || course.whole == kSecondPeek);
            if (known) look(load_share_);
            if (peek) wake_violated();
            const bool turns = start_.momentum && turned_back_sum() > 0;
            bool used_parts = false;
            if (known) {
                course.saw(seen_left());
                used_parts = may_use_parts_ && course.whole >= course.parts_from && solve_parts(course);
                if (course.left.residual <= options_.tolerance) break;
            }
            stalled = course.stalls();
            if (start_.momentum) m = momentum.next(course.progress.rose() || used_parts || turns);
        }
        if (!known) course.left.residual = look_again(load_share_);
        const bool solved = course.left.residual <= options_.tolerance;
        if (load_share_ > 0) course.left.residual = look_again(0);
        finish(course, solved);
    }

    void record(std::int32_t region) const {
        if (recorder_ == nullptr) return;
        for (std::size_t g = 0; g < num_groups(); ++g) {
            GroupSpan span{region, tasks_of(g), whole_sweeps_, 0};
            if (g == choice_group()) span.visits = part_rounds_;
            if (g == part_group()) span.visits = part_visits_;
            for (std::size_t t = 0; t < index(threads_); ++t) span.busy += busy_[t * num_groups() + g];
            recorder_->add_group(span);
        }
    }

  private:
    /// How far the solve has come.
    struct Course {
        Progress progress;
        int whole = 0, of_parts = 0; ///< sweeps; those of parts in sweeps of the whole that cost as much
        /// Parts interrupt the momentum of the whole and leave its slow modes alone. So wherever they did not solve it at the cost of
        /// four `wait`, they have to wait for that many sweeps of the whole, and each time for twice as many.
        int parts_from = 0, wait = kLookEvery;
        Left left{};

        [[nodiscard]] int sweeps() const { return whole + of_parts; }
        [[nodiscard]] bool stalls() const { return progress.stalls(sweeps()); }
        void saw(const Left& found) {
            saw_after_part(found);
            progress.count_standing(found);
        }
        /// Does not count towards a jam: the whole may have been swept a few times only.
        void saw_after_part(const Left& found) {
            left = found;
            progress.saw(sweeps(), found);
        }
    };
    // Groups of the record: those of packets, then the loops over bodies (a task per kBodiesPerSum of them), the looks, the choice of
    // parts and their sweeps.
    [[nodiscard]] std::size_t num_groups() const { return part_group() + 1; }
    [[nodiscard]] std::size_t body_group() const { return groups_.size(); }
    [[nodiscard]] std::size_t look_group() const { return groups_.size() + 1; }
    [[nodiscard]] std::size_t choice_group() const { return groups_.size() + 2; }
    [[nodiscard]] std::size_t part_group() const { return groups_.size() + 3; }
    [[nodiscard]] std::int32_t tasks_of(std::size_t group) const {
        if (group == choice_group()) return 1;
        if (group == part_group())
            return static_cast<std::int32_t>(part_visits_ > 0 ? std::max(part_tasks_ / part_visits_, std::int64_t{1})
                                                              : 1);
        if (group == look_group()) return static_cast<std::int32_t>(packets_.size());
        return group == body_group() ? static_cast<std::int32_t>(num_sums()) : packets_of(group).num_tasks();
    }
    /// Adds the time of a scope to a group of the record.
    template <class Work>
    void timed(int thread, std::size_t group, Work&& work) {
        if (recorder_ == nullptr) return work();
        const std::int64_t begin = recorder_->now();
        work();
        busy_[index(thread) * num_groups() + group] += recorder_->now() - begin;
    }

    [[nodiscard]] GroupPackets packets_of(std::size_t group) const {
        return flotilla::packets_of(groups_, group, island_.end_packet, s_.packed.packets);
    }
    [[nodiscard]] SweepView view_of(std::span<const ContactPacket> packets, double momentum) const {
        return {.packets = packets.data(),
                .num_packets = static_cast<std::int64_t>(packets.size()),
                .rows = s_.packed.rows.data(),
                .normal_rows = s_.packed.normal_rows.data(),
                .bodies = s_.velocity.data(),
                .load_share = load_share_,
                .most_let_off = kMostLetOff * options_.tolerance,
                .momentum = momentum};
    }

    [[nodiscard]] std::size_t num_sums() const { return (bodies_.size() + kBodiesPerSum - 1) / kBodiesPerSum; }
    /// Calls work(bodies, slot) for the parts of the sum that are this thread's.
    template <class Work>
    void for_my_bodies(int thread, Work&& work) {
        timed(thread, body_group(), [&] {
            const std::size_t first = num_sums() * index(thread) / index(threads_);
            const std::size_t end = num_sums() * index(thread + 1) / index(threads_);
            for (std::size_t k = first; k < end; ++k) {
                const std::size_t begin = k * kBodiesPerSum;
                work(bodies_.subspan(begin, std::min(kBodiesPerSum, bodies_.size() - begin)),
                     s_.sums[index(island_.first_body) + begin]);
            }
        });
    }

    void remember(int thread) {
        for_my_bodies(thread, [&](std::span<const std::int32_t> bodies, double&) {
            for (const std::int32_t body : bodies) s_.before_sweep[index(body)] = s_.velocity[index(body)];
        });
    }
    void move_on(int thread, double m) {
        for_my_bodies(thread, [&](std::span<const std::int32_t> bodies, double&) { extrapolate(bodies, m, s_); });
    }
    void add_up(int thread) {
        for_my_bodies(thread,
                      [&](std::span<const std::int32_t> bodies, double& sum) { sum = turned_back(bodies, s_); });
    }
    [[nodiscard]] double turned_back_sum() const {
        double sum = 0;
        for (std::size_t k = 0; k < bodies_.size(); k += kBodiesPerSum) sum += s_.sums[index(island_.first_body) + k];
        return sum;
    }

    template <class Work>
    void for_phases(std::size_t phases, Work&& work) {
        flotilla::for_phases(options_.team, threads_, phases, work);
    }
    void apply_impulses() {
        for_phases(groups_.size(), [&](std::size_t g, int share) {
            flotilla::apply_impulses(cone_, view_of(packets_of(g).share(share, threads_), 0), options_.isa);
        });
    }

    /// One sweep; returns the largest violation that it met. With momentum bodies move on before it, and it says which turned back.
    double sweep_groups(double m) {
        for (Seen& seen : seen_) seen.worst = 0;
        const std::size_t before = start_.momentum ? 1 : 0;
        for_phases(groups_.size() + 2 * before, [&](std::size_t phase, int share) {
            if (phase < before) return move_on(share, m);
            if (phase - before == groups_.size()) return add_up(share);
            timed(share, phase - before, [&] {
                const SweepView view = view_of(packets_of(phase - before).share(share, threads_), m);
                double& worst = seen_[index(share)].worst;
                worst = std::max(worst, sweep(cone_, view, options_.isa));
            });
        });
        return largest([](const Seen& seen) { return seen.worst; });
    }
    /// Tells seen_ what is left.
    void look(double load_share) {
        for_phases(2, [&](std::size_t phase, int share) {
            if (phase == 0) {
                seen_[index(share)].residual = find_left(share, load_share);
                return note_changes(share);
            }
            Seen& seen = seen_[index(share)];
            seen.residual = std::max(seen.residual, wake_violated(share));
            if (jams_) seen.violated = count_violated(share_of(packets_, share, threads_));
        });
    }
    double find_left(int share, double load_share) {
        double residual = 0;
        timed(share, look_group(), [&] {
            const auto packets = share_of(packets_, share, threads_);
            SweepView view = view_of(packets, 0);
            view.load_share = load_share;
            residual = island_.rests
                           ? find_violated(cone_, view, options_.tolerance,
                                           violated_.data() + (packets.data() - packets_.data()), options_.isa)
                           : largest_violation(cone_, view, options_.isa);
        });
        return residual;
    }
    double look_again(double load_share) {
        look(load_share);
        return seen_residual();
    }
    /// Sweeps what is not solved yet alone, after a look, for as long as that is a small part and helps; with a look at the whole
    /// after every round. Whether there was one.
    bool solve_parts(Course& course) {
        bool swept = false;
        const int most = std::min(options_.iterations, course.sweeps() + 4 * course.wait);
        while (course.left.residual > options_.tolerance && course.sweeps() < most && !course.stalls() &&
               sweep_part(!swept, most - course.sweeps(), course)) {
            swept = true;
            look(load_share_);
            const Left before = course.left;
            course.saw_after_part(seen_left());
            if (stands(before, course.left)) break;
        }
        if (swept) {
            course.parts_from = course.whole + course.wait;
            course.wait *= 2;
        }
        return swept;
    }
    /// One round; false where the part is too large.
    bool sweep_part(bool anew, int most_cost, Course& course) {
        bool chosen = false;
        timed(0, choice_group(), [&] { chosen = choose_unsolved(island_, anew, s_); });
        if (!chosen) return false;
        const auto part = static_cast<std::int64_t>(s_.part.packets.size());
        const auto whole = static_cast<std::int64_t>(packets_.size());
        const Sweeper sweeper{options_.team,
                              threads_,
                              seen_,
                              recorder_,
                              recorder_ != nullptr ? std::span(busy_).subspan(part_group()) : std::span(busy_),
                              num_groups()};
        const int sweeps =
            sweep_unsolved(sweeper, cone_, options_, start_.momentum, most_cost * whole / part, view_of({}, 0), s_);
        island_.visits += sweeps * s_.part.contacts;
        course.of_parts += static_cast<int>(std::max<std::int64_t>(1, sweeps * part / whole));
        part_tasks_ += sweeps * part;
        part_visits_ += sweeps * static_cast<std::int64_t>(s_.part.groups.size());
        ++part_rounds_;
        return true;
    }
    /// Wakes packets whose parked contacts are violated.
    void wake_violated() {
        for_phases(2, [&](std::size_t phase, int share) {
            if (phase == 0) return note_changes(share);
            wake_violated(share);
        });
    }
    /// After note_changes() of all; returns the largest violation of those that were parked.
    double wake_violated(int thread) {
        double worst = 0;
        timed(thread, look_group(), [&] {
            const auto share = share_of(packets_, thread, threads_); // as in look(), which reads what this changes
            const auto first = static_cast<std::size_t>(share.data() - packets_.data()), end = first + share.size();
            for (std::size_t p = first; p < end; ++p) {
                if (packets_[p].first_parked == packets_[p].end_parked || packets_[p].woken != 0) continue;
                if (parked_hold(p)) continue;
                const double violation =
                    largest_parked_violation(cone_, view_of(packets_.subspan(p, 1), 0), options_.isa);
                if (violation > options_.tolerance) {
                    packets_[p].woken = 1;
                    if (island_.rests) violated_[p] = kAllPairs;
                }
                worst = std::max(worst, violation);
            }
        });
        return worst;
    }
    void note_changes(int thread) {
        for_my_bodies(thread, [&](std::span<const std::int32_t> bodies, double&) {
            for (const std::int32_t body : bodies) {
                const BodyVelocity &v = s_.velocity[index(body)], &start = s_.start_velocity[index(body)];
                s_.change[index(body)] = {v.linear - start.linear, length(v.angular - start.angular)};
            }
        });
    }
    /// Whether the velocities of the packet's bodies changed too little for any of its parked contacts to be violated.
    [[nodiscard]] bool parked_hold(std::size_t packet) const {
        constexpr double kRoom = 0.9; // far more than rounding takes
        const ContactPacket& p = packets_[packet];
        const double reach = s_.packed.parked_reach[index(island_.first_packet) + packet];
        bool hold = true;
        for (std::size_t lane = 0; lane < kPacketLanes; ++lane) { // those without a pair repeat another's bodies
            const ContactScratch::Change &a = s_.change[index(p.a[lane])], &b = s_.change[index(p.b[lane])];
            const double least = kRoom * kParkedMargin * options_.tolerance - reach * (a.turn + b.turn);
            hold &= least > 0 && length_sq(b.linear - a.linear) < least * least;
        }
        return hold;
    }
    [[nodiscard]] int count_violated(std::span<const ContactPacket> share) const {
        int pairs = 0;
        for (std::size_t p = 0; p < share.size(); ++p)
            pairs += std::popcount(violated_[static_cast<std::size_t>(share.data() - packets_.data()) + p]);
        return pairs;
    }
    [[nodiscard]] double seen_residual() const {
        return largest([](const Seen& seen) { return seen.residual; });
    }
    [[nodiscard]] Left seen_left() const {
        Left left{.residual = seen_residual()};
        if (jams_)
            for (const Seen& seen : seen_) left.violated += seen.violated;
        return left;
    }
    template <class Value>
    [[nodiscard]] double largest(Value&& value) const {
        double out = 0;
        for (const Seen& seen : seen_) out = std::max(out, value(seen));
        return out;
    }

    void finish(const Course& course, bool solved) {
        island_.solved = solved;
        island_.residual = course.left.residual;
        // Without a load that is let off, what is above the island's tolerance and solved is rounding (kOfSpeed).
        island_.let_off =
            solved && load_share_ > 0 && island_.residual > std::max(island_.tolerance, options_.tolerance);
        island_.iterations += course.sweeps();
        island_.visits += course.whole * num_swept();
        island_.part_rounds += part_rounds_;
        whole_sweeps_ = course.whole;
    }
    [[nodiscard]] std::int64_t num_swept() const {
        std::int64_t contacts = 0;
        for (std::int32_t p = island_.first_packet; p < island_.end_packet; ++p) contacts += num_contacts(s_, index(p));
        return contacts;
    }

    Island& island_;
    const ContactSolveOptions& options_;
    SweepStart start_;
    int threads_;
    Cone cone_;
    ContactScratch& s_;
    std::span<const std::int32_t> bodies_;
    std::span<ContactPacket> packets_;
    std::span<std::uint8_t> violated_; ///< as find_violated() sets it, by packet of the island
    std::span<const PacketGroup> groups_;
    bool jams_;          ///< whether it may be jammed
    double load_share_;  ///< see kLoadPerTolerance
    bool may_use_parts_; ///< whether what is not solved may be swept alone
    int part_rounds_ = 0, whole_sweeps_ = 0;
    std::int64_t part_tasks_ = 0, part_visits_ = 0; ///< of packets and of groups
    Seen alone_;
    std::span<Seen> seen_; ///< by share
    TaskRecorder* recorder_;
    std::vector<std::int64_t> busy_; ///< ns, by share and group
};

// A sweep sees every row at its own turn, which may be just inside the tolerance while the end state is not; so a sweep that passes
// is confirmed on the state that it left. With momentum it also sees what the extrapolation added, so that one that does not pass is
// looked at now and then.
void sweep_island(Island& island, const ContactSolveOptions& options, const SweepStart& start, ContactScratch& s) {
    const bool together = options.team != nullptr && is_large(island, s);
    const int threads = together ? width_of(island, s, options.team->present()) : 1;
    if (threads > 1) s.seen.assign(index(threads), {}); // one large island at a time
    IslandSweeps sweeps(island, options, start, threads, s);
    TaskRecorder* recorder = together ? options.team->recorder() : nullptr;
    const int most_threads = width_of(island, s, std::numeric_limits<int>::max());
    const std::int32_t region =
        recorder != nullptr ? recorder->begin_region("contact sweeps", RegionKind::sweeps, most_threads, nullptr) : -1;
    sweeps.run();
    if (recorder == nullptr) return;
    sweeps.record(region);
    recorder->end_region(region);
}

} // namespace flotilla
