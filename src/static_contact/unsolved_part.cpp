// SPDX-License-Identifier: MIT
#include "static_contact/unsolved_part.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"

namespace flotilla {
namespace {

std::size_t most_packets(const ContactScratch::Island& island, const ContactTuning& tuning) {
    return static_cast<std::size_t>(island.end_packet - island.first_packet) /
           static_cast<std::size_t>(tuning.part_divisor);
}

// Only the island's own marks are read.
void clear_marks(const ContactScratch::Island& island, const ContactScratch& s, std::vector<std::uint8_t>& marks) {
    for (std::int32_t k = island.first_body; k < island.end_body; ++k) marks[at(s.island_bodies[at(k)])] = 0;
}

// Marks the bodies of violated pairs; false if those are in more than `most` packets.
bool mark_violated(std::size_t first, std::size_t end, std::size_t most, const ContactScratch& s, UnsolvedPart& part) {
    std::size_t violated = 0;
    for (std::size_t p = first; p < end; ++p) {
        if (s.violated[p] == 0) continue;
        if (++violated > most) return false;
        for_bodies(s.packed.packets[p], s.violated[p], s, [&](std::int32_t body) { part.near[at(body)] = 1; });
    }
    return true;
}

} // namespace

std::int64_t num_contacts(const ContactScratch& s, std::size_t packet) {
    const ContactPacket& p = s.packed.packets[packet];
    const std::size_t first = at(s.packed.first_block[packet]);
    std::int64_t contacts = 0;
    for (std::size_t k = first; k < first + at(p.num_pairs); ++k)
        contacts += (p.woken != 0 ? s.blocks[k].end : s.blocks[k].parked) - s.blocks[k].first;
    return contacts;
}

void reserve_unsolved(const ContactScratch::Island& island, const ContactTuning& tuning, const ContactScratch& s,
                      UnsolvedPart& part) {
    const std::size_t most = most_packets(island, tuning);
    part.near.resize(s.bodies.size());
    part.chosen.resize(s.bodies.size());
    part.touches.resize(s.packed.packets.size());
    part.packets.reserve(most);
    part.groups.reserve(most);
    const std::size_t most_bodies = std::min(2 * kPacketLanes * most, at(island.end_body - island.first_body));
    part.bodies.reserve(most_bodies);
    part.sums.reserve(num_sums(most_bodies));
}

bool mark_unsolved(const ContactScratch::Island& island, const ContactTuning& tuning, bool anew,
                   const ContactScratch& s, UnsolvedPart& part) {
    if (anew) clear_marks(island, s, part.near);
    return mark_violated(at(island.first_packet), at(island.end_packet), most_packets(island, tuning), s, part);
}

IslandMotion mark_moving(const ContactScratch::Island& island, const ContactTuning& tuning, const ContactScratch& s,
                         UnsolvedPart& part) {
    const double limit = tuning.settle_above * island.tolerance;
    bool any = false;
    double mass = 0, energy = 0; // twice that
    for (std::int32_t k = island.first_body; k < island.end_body; ++k) {
        const std::size_t body = at(s.island_bodies[at(k)]);
        // Twice the energy, by the harmonic mean of the principal inertias (list_island_bodies).
        const double twice = s.weight[body].linear * length_sq(s.velocity[body].linear) +
                             s.weight[body].angular * length_sq(s.velocity[body].angular);
        part.near[body] = twice > s.weight[body].linear * limit * limit ? 1 : 0;
        any |= part.near[body] != 0;
        mass += s.weight[body].linear;
        energy += twice;
    }
    return {any, std::sqrt(energy / mass)};
}

void find_touching(std::size_t first, std::size_t end, const ContactScratch& s, UnsolvedPart& part) {
    for (std::size_t p = first; p < end; ++p) {
        const ContactPacket& packet = s.packed.packets[p];
        bool touches = false;
        for_bodies(packet, kAllPairs, s, [&](std::int32_t body) { touches |= part.near[at(body)] != 0; });
        part.touches[p] = touches && packet.swept() ? 1 : 0;
    }
}

bool choose_unsolved(const ContactScratch::Island& island, const ContactTuning& tuning, const ContactScratch& s,
                     UnsolvedPart& part) {
    const std::size_t most = most_packets(island, tuning);
    part.packets.clear();
    part.bodies.clear();
    part.contacts = 0;
    clear_marks(island, s, part.chosen);
    for (std::size_t p = at(island.first_packet); p < at(island.end_packet); ++p) {
        if (part.touches[p] == 0) continue;
        if (part.packets.size() == most) return false;
        const ContactPacket& packet = s.packed.packets[p];
        part.packets.push_back(packet);
        part.contacts += num_contacts(s, p);
        for_bodies(packet, kAllPairs, s, [&](std::int32_t body) {
            if (part.chosen[at(body)] == 0) part.bodies.push_back(body);
            part.chosen[at(body)] = 1;
        });
    }
    part.groups.clear();
    group_packets(part.packets, 0, part.groups);
    part.sums.resize(num_sums(part.bodies.size()));
    return !part.packets.empty();
}

int sweep_unsolved(const SweepEngine& whole, bool momentum, std::int64_t most, const ContactSolveOptions& options,
                   ContactScratch& s, UnsolvedPart& part) {
    const auto end = static_cast<std::int32_t>(part.packets.size());
    SweepCrew crew = whole.crew();
    crew.shares = sweep_width_of(part.groups, end, crew.shares); // that the part is worth
    crew.seen = crew.seen.first(at(crew.shares));
    crew.record_group = part_group(whole);
    crew.one_group = true;
    crew.memory = &s.part_shares;
    SweepEngine engine({whole.view({}), part.packets, end, part.groups, momentum, part.bodies, part.sums}, crew,
                       whole.cone(), options, s);
    return engine.run(
        static_cast<int>(std::min<std::int64_t>(most, options.tuning.part_sweeps)),
        [&](int, double worst) { return worst <= options.tolerance ? AfterSweep::done : AfterSweep::go_on; });
}

} // namespace flotilla
