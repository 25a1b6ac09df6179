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

/// The sweeps of a part by one of the threads. All come to the same decisions: packets of a colour touch different bodies, sums are cut
/// at fixed places and added up in their order, and the rest are maxima.
class PartSweeps {
  public:
    PartSweeps(const Sweeper& sweeper, Cone cone, const ContactSolveOptions& options, const SweepView& view,
               ContactScratch& s)
        : me_(sweeper), cone_(cone), options_(options), view_(view), s_(s), part_(s.part) {
        const auto end = static_cast<std::int32_t>(part_.packets.size());
        sharers_ = sweep_width_of(part_.groups, end, part_.packets, me_.threads);
    }

    int run(bool momentum, int limit) {
        if (sharers_ == 1 && me_.thread > 0) return 0; // one thread alone, which says afterwards how many there were
        Momentum sequence;
        int sweeps = 0;
        for (bool done = false; !done && sweeps < limit; ++sweeps) {
            if (momentum) {
                for_my_bodies(
                    [&](std::span<const std::int32_t> bodies, double&) { extrapolate(bodies, view_.momentum, s_); });
                wait();
            }
            done = sweep_groups(sweeps % 2) <= options_.tolerance;
            if (momentum) view_.momentum = sequence.next(turned_back_sum() > 0);
        }
        return sweeps;
    }

  private:
    void wait() {
        if (sharers_ > 1) me_.barrier.wait();
    }
    /// Adds the time of a scope to the record.
    template <class Work>
    void timed(Work&& work) {
        if (me_.recorder == nullptr) return work();
        const std::int64_t begin = me_.recorder->now();
        work();
        *me_.busy += me_.recorder->now() - begin;
    }
    template <class Work>
    void for_my_bodies(Work&& work) {
        if (me_.thread >= sharers_) return;
        timed([&] {
            const std::size_t first = part_.sums.size() * index(me_.thread) / index(sharers_);
            const std::size_t end = part_.sums.size() * index(me_.thread + 1) / index(sharers_);
            const std::span<const std::int32_t> bodies = part_.bodies;
            for (std::size_t k = first; k < end; ++k) {
                const std::size_t begin = k * kBodiesPerSum;
                work(bodies.subspan(begin, std::min(kBodiesPerSum, bodies.size() - begin)), part_.sums[k]);
            }
        });
    }
    double turned_back_sum() {
        for_my_bodies([&](std::span<const std::int32_t> bodies, double& sum) { sum = turned_back(bodies, s_); });
        wait();
        double sum = 0;
        for (const double part : part_.sums) sum += part;
        return sum;
    }
    /// Returns the largest violation that any thread met.
    double sweep_groups(int parity) {
        double& worst = me_.seen[index(me_.thread)].worst[parity];
        worst = 0;
        const auto end = static_cast<std::int32_t>(part_.packets.size());
        for (std::size_t g = 0; g < part_.groups.size(); ++g) {
            if (me_.thread < sharers_)
                timed([&] {
                    const auto share = packets_of(part_.groups, g, end, part_.packets).share(me_.thread, sharers_);
                    view_.packets = share.data();
                    view_.num_packets = static_cast<std::int64_t>(share.size());
                    worst = std::max(worst, sweep(cone_, view_, options_.isa));
                });
            wait();
        }
        double largest = 0;
        for (int t = 0; t < sharers_; ++t) largest = std::max(largest, me_.seen[index(t)].worst[parity]);
        return largest;
    }

    const Sweeper& me_;
    Cone cone_;
    const ContactSolveOptions& options_;
    SweepView view_;
    ContactScratch& s_;
    ContactScratch::Unsolved& part_;
    int sharers_; ///< threads that share the work; where there are several, the others wait with them
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
    const int sweeps = PartSweeps(sweeper, cone, options, view, s)
                           .run(momentum, static_cast<int>(std::min<std::int64_t>(most, kMostSweeps)));
    if (sweeper.thread == 0) s.part.sweeps = sweeps;
    sweeper.barrier.wait();
    return s.part.sweeps;
}

} // namespace flotilla
