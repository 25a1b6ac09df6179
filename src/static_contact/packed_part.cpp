// SPDX-License-Identifier: MIT
#include "static_contact/packed_part.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "static_contact/unsolved_part.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kGrain = 32; // packets of a task

/// Calls work(packed row) for the rows of a packet that sweeps visit.
template <class Work>
void for_swept_rows(const ContactPacket& packet, Work&& work) {
    for (std::int32_t r = packet.first; r < packet.end; ++r) work(at(r));
    if (packet.woken == 0) return;
    for (std::int32_t r = packet.first_parked; r < packet.end_parked; ++r) work(at(r));
}

bool is_near(const ContactPacket& packet, std::size_t lane, const ContactScratch& s) {
    bool near = false;
    for_bodies(packet, 1U << lane, s, [&](std::int32_t body) { near |= s.packed_part.near[at(body)] != 0; });
    return near;
}

/// The pair with the rows that sweeps visit as its only ones.
ContactBlock swept_rows_of(ContactBlock block, bool woken) {
    block.parked = block.end = woken ? block.end : block.parked;
    return block;
}

/// Copies the near pairs, in the order of the packets: colour by colour, equally many contacts together.
void choose_pairs(std::size_t first, std::size_t end, ContactScratch& s) {
    ContactScratch::PackedPart& part = s.packed_part;
    part.packets.clear();
    part.blocks.clear();
    part.contacts = 0;
    for (std::size_t p = first; p < end; ++p) {
        if (part.near_pairs[p] == 0) continue;
        const ContactPacket& packet = s.packed.packets[p];
        const std::size_t before = part.blocks.size();
        for (std::size_t lane = 0; lane < at(packet.num_pairs); ++lane) {
            if ((part.near_pairs[p] >> lane & 1) == 0) continue;
            const ContactBlock& pair = s.blocks[at(s.packed.first_block[p]) + lane];
            const ContactBlock swept = swept_rows_of(pair, packet.woken != 0);
            if (swept.first == swept.end) continue;
            part.blocks.push_back(swept);
            part.contacts += swept.end - swept.first;
        }
        if (part.blocks.size() > before) part.packets.push_back(static_cast<std::int32_t>(p));
    }
}

void list_bodies(ContactScratch& s) {
    ContactScratch::PackedPart& part = s.packed_part;
    part.bodies.clear();
    std::fill(part.near.begin(), part.near.end(), std::uint8_t{0});
    for (const ContactBlock& block : part.blocks)
        for (const std::int32_t body : {block.a, block.b}) {
            if (s.movable[at(body)] == 0 || part.near[at(body)] != 0) continue;
            part.near[at(body)] = 1;
            part.bodies.push_back(body);
        }
    part.sums.resize(num_sums(part.bodies.size()));
}

void write_impulses_back(Team* team, ContactScratch& s) {
    const ContactScratch::PackedPart& part = s.packed_part;
    for_each(team, "unpack part", part.packed.packets.size(), kGrain, [&](std::size_t p) {
        for_swept_rows(part.packed.packets[p], [&](std::size_t row) { unpack_impulses(part.packed, row, s.rows); });
    });
    for_each(team, "repack impulses", part.packets.size(), kGrain, [&](std::size_t k) {
        for_swept_rows(s.packed.packets[at(part.packets[k])],
                       [&](std::size_t row) { repack_impulses(s.rows, row, s.packed); });
    });
}

} // namespace

void mark_near(const ContactScratch::Island& island, ContactScratch& s) {
    ContactScratch::PackedPart& part = s.packed_part;
    part.near.assign(s.bodies.size(), 0);
    part.near_pairs.resize(s.packed.packets.size());
    for (std::size_t p = at(island.first_packet); p < at(island.end_packet); ++p)
        if (s.violated[p] != 0)
            for_bodies(s.packed.packets[p], s.violated[p], s, [&](std::int32_t body) { part.near[at(body)] = 1; });
}

void find_near_pairs(std::size_t first, std::size_t end, ContactScratch& s) {
    for (std::size_t p = first; p < end; ++p) {
        const ContactPacket& packet = s.packed.packets[p];
        unsigned near = 0;
        for (std::size_t lane = 0; packet.swept() && lane < at(packet.num_pairs); ++lane)
            if (is_near(packet, lane, s)) near |= 1U << lane;
        s.packed_part.near_pairs[p] = static_cast<std::uint8_t>(near);
    }
}

bool choose_near(const ContactScratch::Island& island, const ContactTuning& tuning, ContactScratch& s) {
    choose_pairs(at(island.first_packet), at(island.end_packet), s);
    const std::size_t most = at(island.end - island.first) / at(tuning.packed_divisor);
    if (s.packed_part.blocks.empty() || s.packed_part.blocks.size() > most) return false;
    list_bodies(s);
    return true;
}

void pack_part(Team* team, ContactScratch& s) {
    ContactScratch::PackedPart& part = s.packed_part;
    for_each(team, "unpack impulses", part.packets.size(), kGrain, [&](std::size_t k) {
        for_swept_rows(s.packed.packets[at(part.packets[k])],
                       [&](std::size_t row) { unpack_impulses(s.packed, row, s.rows); });
    });
    part.packed.clear();
    part.packed.frictionless = s.packed.frictionless;
    part.groups.clear();
    lay_out_packets(part.blocks, 0, static_cast<std::int32_t>(part.blocks.size()), part.packed, part.groups);
    resize_rows(part.packed);
    resize_extras(s.packed.any_extras, part.packed);
    for_each(team, "pack part", part.packed.packets.size(), kGrain,
             [&](std::size_t p) { fill_packet(part.blocks, s.rows, p, part.packed); });
}

int sweep_packed_part(const SweepEngine& whole, bool momentum, std::int64_t most, double enough, ContactScratch& s) {
    const ContactSolveOptions& options = whole.options();
    ContactScratch::PackedPart& part = s.packed_part;
    const std::span<const ContactPacket> packets = part.packed.packets;
    const auto end = static_cast<std::int32_t>(packets.size());
    SweepCrew crew = whole.crew();
    crew.shares = sweep_width_of(part.groups, end, crew.shares); // that the part is worth
    crew.seen = crew.seen.first(at(crew.shares));
    crew.record_group = part_group(whole);
    crew.one_group = true;
    crew.memory = &s.part_shares;
    crew.division = nullptr;
    const SweepView view{.rows = part.packed.rows.data(),
                         .normal_rows = part.packed.normal_rows.data(),
                         .extras = part.packed.extras_if_any(),
                         .bodies = s.velocity.data()};
    SweepEngine engine({view, packets, end, part.groups, momentum, part.bodies, part.sums}, crew, whole.cone(), options,
                       s);
    const int sweeps =
        engine.run(static_cast<int>(std::min<std::int64_t>(most, options.tuning.packed_sweeps)),
                   [&](int, double worst) { return worst <= enough ? AfterSweep::done : AfterSweep::go_on; });
    write_impulses_back(options.team, s);
    return sweeps;
}

} // namespace flotilla
