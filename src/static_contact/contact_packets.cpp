// SPDX-License-Identifier: MIT
#include "base/index.hpp"
#include "geometry/pack_scalar.hpp"

#include "static_contact/contact_packets.hpp"

#include <algorithm>
#include <iterator>
#include <type_traits>

#include "static_contact/sweep_kernel.hpp"

namespace flotilla {
namespace {

template <class Fields>
void set_lane(Fields& out, std::size_t lane, int field, const Vec3& v) {
    const auto f = static_cast<std::size_t>(field);
    out.field[f][lane] = v.x;
    out.field[f + 1][lane] = v.y;
    out.field[f + 2][lane] = v.z;
}

void set_lane(ContactPacket& out, std::size_t lane, int field, const Sym3& j) {
    set_lane(out, lane, field, Vec3{j.xx, j.yy, j.zz});
    set_lane(out, lane, field + 3, Vec3{j.xy, j.xz, j.yz});
}

void set_bodies(std::span<const ContactBlock> blocks, ContactPacket& p) {
    std::fill(std::begin(p.a), std::end(p.a), blocks[0].a);
    std::fill(std::begin(p.b), std::end(p.b), blocks[0].b);
    p.any_locked = false;
    for (std::size_t lane = 0; lane < blocks.size(); ++lane) {
        const ContactBlock& block = blocks[lane];
        p.a[lane] = block.a;
        p.b[lane] = block.b;
        p.locked_a[lane] = block.locked_a;
        p.locked_b[lane] = block.locked_b;
        p.any_locked = p.any_locked || (block.locked_a | block.locked_b) != 0;
        p.field[ContactPacket::kInvMassA][lane] = block.inv_mass_a;
        p.field[ContactPacket::kInvMassB][lane] = block.inv_mass_b;
        set_lane(p, lane, ContactPacket::kInvInertiaA, block.inv_inertia_a);
        set_lane(p, lane, ContactPacket::kInvInertiaB, block.inv_inertia_b);
        set_lane(p, lane, ContactPacket::kOffset, block.offset);
    }
}

// Tangential components of a vector.
template <class Row>
void set_tangential(Row& out, std::size_t lane, int field, const Vec3& v) {
    const auto f = static_cast<std::size_t>(field);
    out.field[f][lane] = v.y;
    out.field[f + 1][lane] = v.z;
}

template <class Row>
void set_lane(Row& out, std::size_t lane, const ContactRow& row) {
    const LocalContact& c = row.local;
    out.field[PacketRow::kNormalMass][lane] = c.mass_diagonal.x;
    out.field[PacketRow::kInvNormalMass][lane] = c.inv_mass_diagonal.x;
    out.field[PacketRow::kNormalImpulse][lane] = out.field[PacketRow::kNormalPrevious][lane] = c.impulse.x;
    out.field[PacketRow::kTarget][lane] = c.target.x;
    set_lane(out, lane, PacketRow::kNormal, row.normal);
    set_lane(out, lane, PacketRow::kArmA, row.arm_a);
    if constexpr (std::is_same_v<Row, PacketRow>) {
        set_tangential(out, lane, PacketRow::kTangentMass, c.mass_diagonal);
        set_tangential(out, lane, PacketRow::kInvTangentMass, c.inv_mass_diagonal);
        set_tangential(out, lane, PacketRow::kTangentImpulse, c.impulse);
        set_tangential(out, lane, PacketRow::kTangentPrevious, c.impulse);
        set_lane(out, lane, PacketRow::kCoupling, c.coupling);
        out.field[PacketRow::kFriction][lane] = c.friction;
        set_lane(out, lane, PacketRow::kTangent1, row.tangent_1);
    }
}

// Also as that before the last sweep.
void set_impulse(Lanes* field, std::size_t lane, const Vec3& impulse, bool frictionless) {
    field[PacketRow::kNormalImpulse][lane] = field[PacketRow::kNormalPrevious][lane] = impulse.x;
    if (frictionless) return;
    for (const int f : {PacketRow::kTangentImpulse, PacketRow::kTangentPrevious}) {
        field[f][lane] = impulse.y;
        field[f + 1][lane] = impulse.z;
    }
}

// W = 1 keeps the divisions of an idle lane finite.
template <class Row>
void set_idle(Row& out, std::size_t lane) {
    out.field[PacketRow::kNormalMass][lane] = 1;
    if constexpr (std::is_same_v<Row, PacketRow>) set_tangential(out, lane, PacketRow::kTangentMass, {1, 1, 1});
}

// Row k of each block, awake or parked.
template <class Row>
void fill_row(std::span<const ContactBlock> blocks, std::int32_t k, bool parked, std::span<const ContactRow> rows,
              Row& out, std::int32_t* source) {
    out = {};
    for (std::size_t lane = 0; lane < kPacketLanes; ++lane) {
        source[lane] = -1;
        if (lane < blocks.size()) {
            const ContactBlock& block = blocks[lane];
            const std::int32_t row = k + (parked ? block.parked : block.first);
            if (row < (parked ? block.end : block.parked)) source[lane] = row;
        }
        if (source[lane] < 0)
            set_idle(out, lane);
        else
            set_lane(out, lane, rows[at(source[lane])]);
    }
}

// Of a packed row, from those that it was packed from.
void set_extra(std::span<const ContactRow> rows, std::size_t row, PackedContacts& packed) {
    PacketExtra& extra = packed.extras[row];
    for (std::size_t lane = 0; lane < kPacketLanes; ++lane) {
        const std::int32_t source = packed.source[row * kPacketLanes + lane];
        set_tangential(extra, lane, PacketExtra::kSlip, source < 0 ? Vec3{} : rows[at(source)].local.target);
        set_lane(extra, lane, PacketExtra::kAcross, source < 0 ? Vec3{} : rows[at(source)].across);
    }
}

} // namespace

void lay_out_packets(std::span<const ContactBlock> blocks, std::int32_t first_block, std::int32_t end_block,
                     PackedContacts& packed, std::vector<PacketGroup>& groups) {
    const std::size_t first_packet = packed.packets.size();
    std::int32_t rows = packed.packets.empty() ? 0 : packed.packets.back().end;
    std::int32_t parked = packed.packets.empty() ? 0 : packed.packets.back().end_parked;
    for (std::int32_t first = first_block, end = first; first < end_block; first = end) {
        const std::int32_t color = blocks[at(first)].color;
        const std::int32_t limit = std::min(end_block, first + kPacketLanes);
        std::int32_t longest = 0, longest_parked = 0;
        for (; end < limit && blocks[at(end)].color == color; ++end) {
            const ContactBlock& block = blocks[at(end)];
            longest = std::max(longest, block.parked - block.first);
            longest_parked = std::max(longest_parked, block.end - block.parked);
        }
        ContactPacket& packet = packed.packets.emplace_back();
        packet.num_pairs = end - first;
        packet.color = color;
        packet.first = rows;
        packet.end = rows += longest;
        packet.first_parked = parked;
        packet.end_parked = parked += longest_parked;
        packed.first_block.push_back(first);
    }
    group_packets(std::span(packed.packets).subspan(first_packet), static_cast<std::int32_t>(first_packet), groups);
}

void group_packets(std::span<const ContactPacket> packets, std::int32_t first, std::vector<PacketGroup>& groups) {
    for (std::size_t p = 0; p < packets.size(); ++p) {
        if (p == 0 || packets[p].color != packets[p - 1].color)
            groups.push_back({first + static_cast<std::int32_t>(p), 0});
        groups.back().swept += packets[p].swept() ? 1 : 0;
    }
}

void resize_rows(PackedContacts& packed) {
    const std::int32_t awake = packed.packets.empty() ? 0 : packed.packets.back().end;
    for (ContactPacket& packet : packed.packets) {
        packet.first_parked += awake;
        packet.end_parked += awake;
    }
    const std::size_t rows = packed.packets.empty() ? 0 : at(packed.packets.back().end_parked);
    packed.parked_reach.resize(packed.packets.size());
    packed.rows.resize(packed.frictionless ? 0 : rows);
    packed.normal_rows.resize(packed.frictionless ? rows : 0);
    packed.source.resize(rows * kPacketLanes);
}

void resize_extras(bool any, PackedContacts& packed) {
    packed.any_extras = any;
    packed.extras.resize(any ? packed.num_rows() : 0);
}

void fill_packet(std::span<const ContactBlock> blocks, std::span<const ContactRow> rows, std::size_t p,
                 PackedContacts& packed) {
    ContactPacket& packet = packed.packets[p];
    const auto members = blocks.subspan(at(packed.first_block[p]), at(packet.num_pairs));
    set_bodies(members, packet);
    packet.woken = 0;
    const auto fill = [&](std::int32_t first, std::int32_t end, bool parked) {
        for (std::int32_t k = 0; k < end - first; ++k) {
            const std::size_t row = at(first + k);
            std::int32_t* source = packed.source.data() + row * kPacketLanes;
            if (packed.frictionless)
                fill_row(members, k, parked, rows, packed.normal_rows[row], source);
            else
                fill_row(members, k, parked, rows, packed.rows[row], source);
            if (packed.any_extras) set_extra(rows, row, packed);
        }
    };
    fill(packet.first, packet.end, false);
    fill(packet.first_parked, packet.end_parked, true);
    double reach = 0;
    for (const ContactBlock& block : members)
        for (std::int32_t k = block.parked; k < block.end; ++k)
            reach = std::max({reach, length(rows[at(k)].arm_a), length(rows[at(k)].arm_b)});
    packed.parked_reach[p] = reach;
}

void refill_packet(std::span<const ContactRow> rows, std::size_t p, PackedContacts& packed) {
    ContactPacket& packet = packed.packets[p];
    packet.woken = 0;
    const auto refill = [&](std::int32_t first, std::int32_t end) {
        for (std::size_t row = at(first); row < at(end); ++row) {
            Lanes* field = packed.frictionless ? packed.normal_rows[row].field : packed.rows[row].field;
            for (std::size_t lane = 0; lane < kPacketLanes; ++lane) {
                const std::int32_t source = packed.source[row * kPacketLanes + lane];
                const LocalContact c = source < 0 ? LocalContact{} : rows[at(source)].local;
                field[PacketRow::kTarget][lane] = c.target.x;
                set_impulse(field, lane, c.impulse, packed.frictionless);
                if (!packed.frictionless) field[PacketRow::kFriction][lane] = c.friction;
            }
            if (packed.any_extras) set_extra(rows, row, packed);
        }
    };
    refill(packet.first, packet.end);
    refill(packet.first_parked, packet.end_parked);
}

void unpack_impulses(const PackedContacts& packed, std::size_t row, std::span<ContactRow> rows) {
    const Lanes* field = packed.frictionless ? packed.normal_rows[row].field : packed.rows[row].field;
    for (std::size_t lane = 0; lane < kPacketLanes; ++lane) {
        const std::int32_t source = packed.source[row * kPacketLanes + lane];
        if (source < 0) continue;
        Vec3& impulse = rows[at(source)].local.impulse;
        impulse.x = field[PacketRow::kNormalImpulse][lane];
        if (packed.frictionless) continue;
        impulse.y = field[PacketRow::kTangentImpulse][lane];
        impulse.z = field[PacketRow::kTangentImpulse + 1][lane];
    }
}

void repack_impulses(std::span<const ContactRow> rows, std::size_t row, PackedContacts& packed) {
    Lanes* field = packed.frictionless ? packed.normal_rows[row].field : packed.rows[row].field;
    for (std::size_t lane = 0; lane < kPacketLanes; ++lane) {
        const std::int32_t source = packed.source[row * kPacketLanes + lane];
        if (source < 0) continue;
        set_impulse(field, lane, rows[at(source)].local.impulse, packed.frictionless);
    }
}

double sweep(Cone cone, const SweepView& view, Isa isa) {
#if defined(__x86_64__)
    if (isa == Isa::avx512) return sweep_avx512(cone, view);
    if (isa == Isa::avx2) return sweep_avx2(cone, view);
#endif
    return sweep_any<ScalarPack>(cone, view);
}

double largest_violation(Cone cone, const SweepView& view, Isa isa) {
#if defined(__x86_64__)
    if (isa == Isa::avx512) return largest_violation_avx512(cone, view);
    if (isa == Isa::avx2) return largest_violation_avx2(cone, view);
#endif
    return largest_violation_any<ScalarPack>(cone, view);
}

double find_violated(Cone cone, const SweepView& view, double tolerance, std::uint8_t* violated, Isa isa) {
#if defined(__x86_64__)
    if (isa == Isa::avx512) return find_violated_avx512(cone, view, tolerance, violated);
    if (isa == Isa::avx2) return find_violated_avx2(cone, view, tolerance, violated);
#endif
    return find_violated_any<ScalarPack>(cone, view, tolerance, violated);
}

double largest_parked_violation(Cone cone, const SweepView& view, Isa isa) {
#if defined(__x86_64__)
    if (isa == Isa::avx512) return largest_parked_violation_avx512(cone, view);
    if (isa == Isa::avx2) return largest_parked_violation_avx2(cone, view);
#endif
    return largest_parked_violation_any<ScalarPack>(cone, view);
}

void apply_impulses(Cone cone, const SweepView& view, Isa isa) {
#if defined(__x86_64__)
    if (isa == Isa::avx512) return apply_impulses_avx512(cone, view);
    if (isa == Isa::avx2) return apply_impulses_avx2(cone, view);
#endif
    apply_any<ScalarPack>(cone, view);
}

} // namespace flotilla
