// SPDX-License-Identifier: MIT
#include "static_contact/unsolved_part.hpp"

#include <algorithm>

#include "static_contact/momentum.hpp"
#include "static_contact/packet_shares.hpp"

namespace flotilla {
namespace {

/// Sweeps between two looks at the whole island, of which each costs half a sweep of it.
constexpr int kMostSweeps = 100;
/// A part is at most the island's packets divided by this.
constexpr std::size_t kMostPartDivisor = 8;

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

/// Calls work(body) for the movable bodies of the packet's pairs whose bits are set.
template <class Work>
void for_bodies(const ContactPacket& packet, unsigned pairs, const ContactScratch& s, Work&& work) {
    for (std::size_t lane = 0; lane < index(packet.num_pairs); ++lane) {
        if ((pairs >> lane & 1U) == 0) continue;
        for (const std::int32_t body : {packet.a[lane], packet.b[lane]})
            if (s.movable[index(body)] != 0) work(body);
    }
}

// Marks the bodies of violated pairs; false if those are in more than `most` packets.
bool mark_violated(std::size_t first, std::size_t end, std::size_t most, ContactScratch& s) {
    std::size_t violated = 0;
    for (std::size_t p = first; p < end; ++p) {
        if (s.violated[p] == 0) continue;
        if (++violated > most) return false;
        for_bodies(s.packed.packets[p], s.violated[p], s, [&](std::int32_t body) { s.part.near[index(body)] = 1; });
    }
    return true;
}

/// The sweeps of a part, in shares for several threads. Decisions rest on what does not depend on their number: packets of a colour
/// touch different bodies, sums are cut at fixed places and added up in their order, and the rest are maxima.
class PartSweeps {
  public:
    PartSweeps(const Sweeper& sweeper, Cone cone, const ContactSolveOptions& options, const SweepView& view,
               ContactScratch& s)
        : by_(sweeper), cone_(cone), options_(options), view_(view), s_(s), part_(s.part) {
        const auto end = static_cast<std::int32_t>(part_.packets.size());
        threads_ = sweep_width_of(part_.groups, end, part_.packets, by_.threads);
    }

    int run(bool momentum, int limit) {
        Momentum sequence;
        int sweeps = 0;
        for (bool done = false; !done && sweeps < limit; ++sweeps) {
            done = sweep_groups(momentum) <= options_.tolerance;
            if (momentum) view_.momentum = sequence.next(turned_back_sum() > 0);
        }
        return sweeps;
    }

  private:
    /// Adds the time of a scope to the record.
    template <class Work>
    void timed(int share, Work&& work) {
        if (by_.recorder == nullptr) return work();
        const std::int64_t begin = by_.recorder->now();
        work();
        by_.busy[index(share) * by_.busy_stride] += by_.recorder->now() - begin;
    }
    /// Calls work(bodies, slot) for the parts of the sum that are this share's.
    template <class Work>
    void for_bodies_of(int share, Work&& work) {
        timed(share, [&] {
            const std::size_t first = part_.sums.size() * index(share) / index(threads_);
            const std::size_t end = part_.sums.size() * index(share + 1) / index(threads_);
            const std::span<const std::int32_t> bodies = part_.bodies;
            for (std::size_t k = first; k < end; ++k) {
                const std::size_t begin = k * kBodiesPerSum;
                work(bodies.subspan(begin, std::min(kBodiesPerSum, bodies.size() - begin)), part_.sums[k]);
            }
        });
    }
    void move_on(int share) {
        for_bodies_of(share,
                      [&](std::span<const std::int32_t> bodies, double&) { extrapolate(bodies, view_.momentum, s_); });
    }
    void add_up(int share) {
        for_bodies_of(share, [&](std::span<const std::int32_t> bodies, double& sum) { sum = turned_back(bodies, s_); });
    }
    [[nodiscard]] double turned_back_sum() const {
        double sum = 0;
        for (const double part : part_.sums) sum += part;
        return sum;
    }
    /// Returns the largest violation that was met.
    double sweep_groups(bool momentum) {
        const auto seen = by_.seen.first(index(threads_));
        for (auto& s : seen) s.worst = 0;
        const std::size_t before = momentum ? 1 : 0;
        for_phases(by_.team, threads_, part_.groups.size() + 2 * before, [&](std::size_t phase, int share) {
            if (phase < before) return move_on(share);
            if (phase - before == part_.groups.size()) return add_up(share);
            timed(share, [&] { sweep_group(phase - before, share); });
        });
        double largest = 0;
        for (const auto& s : seen) largest = std::max(largest, s.worst);
        return largest;
    }
    void sweep_group(std::size_t group, int share) {
        const auto end = static_cast<std::int32_t>(part_.packets.size());
        const auto packets = packets_of(part_.groups, group, end, part_.packets).share(share, threads_);
        SweepView view = view_;
        view.packets = packets.data();
        view.num_packets = static_cast<std::int64_t>(packets.size());
        double& worst = by_.seen[index(share)].worst;
        worst = std::max(worst, sweep(cone_, view, options_.isa));
    }

    const Sweeper& by_;
    Cone cone_;
    const ContactSolveOptions& options_;
    SweepView view_;
    ContactScratch& s_;
    ContactScratch::Unsolved& part_;
    int threads_; ///< that the part is worth
};

} // namespace

std::int64_t num_contacts(const ContactScratch& s, std::size_t packet) {
    const ContactPacket& p = s.packed.packets[packet];
    const std::size_t first = index(s.packed.first_block[packet]);
    std::int64_t contacts = 0;
    for (std::size_t k = first; k < first + index(p.num_pairs); ++k)
        contacts += (p.woken != 0 ? s.blocks[k].end : s.blocks[k].parked) - s.blocks[k].first;
    return contacts;
}

void reserve_unsolved(const ContactScratch::Island& island, ContactScratch& s) {
    ContactScratch::Unsolved& part = s.part;
    const std::size_t packets = index(island.end_packet - island.first_packet), most = packets / kMostPartDivisor;
    part.near.resize(s.bodies.size());
    part.chosen.resize(s.bodies.size());
    part.packets.reserve(most);
    part.groups.reserve(most);
    const std::size_t most_bodies = std::min(2 * kPacketLanes * most, index(island.end_body - island.first_body));
    part.bodies.reserve(most_bodies);
    part.sums.reserve(most_bodies / kBodiesPerSum + 1);
}

bool choose_unsolved(const ContactScratch::Island& island, bool anew, ContactScratch& s) {
    ContactScratch::Unsolved& part = s.part;
    if (anew) part.near.assign(s.bodies.size(), 0);
    const std::size_t first = index(island.first_packet);
    const auto packets = std::span(s.packed.packets).subspan(first, index(island.end_packet) - first);
    const std::size_t most = packets.size() / kMostPartDivisor;
    if (!mark_violated(first, index(island.end_packet), most, s)) return false;
    part.packets.clear();
    part.bodies.clear();
    part.contacts = 0;
    part.chosen.assign(s.bodies.size(), 0);
    for (std::size_t p = 0; p < packets.size(); ++p) {
        bool touches = false;
        for_bodies(packets[p], kAllPairs, s, [&](std::int32_t body) { touches |= part.near[index(body)] != 0; });
        if (!touches || !packets[p].swept()) continue;
        if (part.packets.size() == most) return false;
        part.packets.push_back(packets[p]);
        part.contacts += num_contacts(s, first + p);
        for_bodies(packets[p], kAllPairs, s, [&](std::int32_t body) {
            if (part.chosen[index(body)] == 0) part.bodies.push_back(body);
            part.chosen[index(body)] = 1;
        });
    }
    part.groups.clear();
    group_packets(part.packets, 0, part.groups);
    part.sums.resize((part.bodies.size() + kBodiesPerSum - 1) / kBodiesPerSum);
    return !part.packets.empty();
}

int sweep_unsolved(const Sweeper& sweeper, Cone cone, const ContactSolveOptions& options, bool momentum,
                   std::int64_t most, const SweepView& view, ContactScratch& s) {
    return PartSweeps(sweeper, cone, options, view, s)
        .run(momentum, static_cast<int>(std::min<std::int64_t>(most, kMostSweeps)));
}

} // namespace flotilla
