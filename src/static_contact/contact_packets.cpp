// SPDX-License-Identifier: MIT
#include "geometry/pack_scalar.hpp"

#include "static_contact/contact_packets.hpp"

#include <algorithm>
#include <iterator>

#include "static_contact/sweep_kernel.hpp"

namespace flotilla {
namespace {

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

void set_lane(Lanes (&out)[6], std::size_t lane, const Sym3& j) {
    const double values[] = {j.xx, j.yy, j.zz, j.xy, j.xz, j.yz};
    for (std::size_t i = 0; i < 6; ++i) out[i][lane] = values[i];
}

ContactPacket make_packet(std::span<const ContactBlock> blocks) {
    ContactPacket p;
    p.num_pairs = static_cast<std::int32_t>(blocks.size());
    std::fill(std::begin(p.a), std::end(p.a), blocks[0].a);
    std::fill(std::begin(p.b), std::end(p.b), blocks[0].b);
    for (std::size_t lane = 0; lane < blocks.size(); ++lane) {
        const ContactBlock& block = blocks[lane];
        p.a[lane] = block.a;
        p.b[lane] = block.b;
        p.inv_mass_a[lane] = block.inv_mass_a;
        p.inv_mass_b[lane] = block.inv_mass_b;
        set_lane(p.inv_inertia_a, lane, block.inv_inertia_a);
        set_lane(p.inv_inertia_b, lane, block.inv_inertia_b);
    }
    return p;
}

void set_lane(PacketRow& out, std::size_t lane, int field, const Vec3& v) {
    const auto f = static_cast<std::size_t>(field);
    out.field[f][lane] = v.x;
    out.field[f + 1][lane] = v.y;
    out.field[f + 2][lane] = v.z;
}

void set_lane(PacketRow& out, std::size_t lane, const ContactRow& row) {
    const LocalContact& c = row.local;
    set_lane(out, lane, PacketRow::kMassDiagonal, c.mass_diagonal);
    set_lane(out, lane, PacketRow::kInvMassDiagonal, c.inv_mass_diagonal);
    set_lane(out, lane, PacketRow::kCoupling, c.coupling);
    set_lane(out, lane, PacketRow::kImpulse, c.impulse);
    set_lane(out, lane, PacketRow::kPrevious, c.impulse);
    out.field[PacketRow::kTarget][lane] = c.target;
    out.field[PacketRow::kFriction][lane] = c.friction;
    set_lane(out, lane, PacketRow::kNormal, row.normal);
    set_lane(out, lane, PacketRow::kTangent1, row.tangent_1);
    set_lane(out, lane, PacketRow::kTangent2, row.tangent_2);
    set_lane(out, lane, PacketRow::kArmA, row.arm_a);
    set_lane(out, lane, PacketRow::kArmB, row.arm_b);
}

// Row k of each block; W = 1 keeps the divisions of an idle lane finite.
void append_row(std::span<const ContactBlock> blocks, std::int32_t k, std::span<const ContactRow> rows,
                PackedContacts& packed) {
    PacketRow& out = packed.rows.emplace_back();
    for (std::size_t lane = 0; lane < kPacketLanes; ++lane) {
        const bool idle = lane >= blocks.size() || blocks[lane].first + k >= blocks[lane].end;
        packed.source.push_back(idle ? -1 : blocks[lane].first + k);
        if (idle)
            set_lane(out, lane, PacketRow::kMassDiagonal, {1, 1, 1});
        else
            set_lane(out, lane, rows[index(blocks[lane].first + k)]);
    }
}

} // namespace

void pack(std::span<const ContactBlock> blocks, std::span<const ContactRow> rows, PackedContacts& packed) {
    for (std::size_t first = 0, end = 0; first < blocks.size(); first = end) {
        const std::size_t limit = std::min(blocks.size(), first + kPacketLanes);
        while (end < limit && blocks[end].color == blocks[first].color) ++end;
        const std::span<const ContactBlock> members = blocks.subspan(first, end - first);
        ContactPacket packet = make_packet(members);
        std::int32_t longest = 0;
        for (const ContactBlock& block : members) longest = std::max(longest, block.end - block.first);
        packet.first = static_cast<std::int32_t>(packed.rows.size());
        for (std::int32_t k = 0; k < longest; ++k) append_row(members, k, rows, packed);
        packet.end = static_cast<std::int32_t>(packed.rows.size());
        packed.packets.push_back(packet);
    }
}

void unpack_impulses(const PackedContacts& packed, std::span<ContactRow> rows) {
    for (std::size_t i = 0; i < packed.source.size(); ++i) {
        if (packed.source[i] < 0) continue;
        const PacketRow& row = packed.rows[i / kPacketLanes];
        const std::size_t lane = i % kPacketLanes;
        rows[index(packed.source[i])].local.impulse = {row.field[PacketRow::kImpulse][lane],
                                                       row.field[PacketRow::kImpulse + 1][lane],
                                                       row.field[PacketRow::kImpulse + 2][lane]};
    }
}

double sweep(Cone cone, const SweepView& view, Isa isa) {
#if defined(__x86_64__)
    if (isa != Isa::scalar) return sweep_avx2(cone, view);
#endif
    return sweep_any<ScalarPack>(cone, view);
}

double largest_violation(Cone cone, const SweepView& view, Isa isa) {
#if defined(__x86_64__)
    if (isa != Isa::scalar) return largest_violation_avx2(cone, view);
#endif
    return largest_violation_any<ScalarPack>(cone, view);
}

void apply_impulses(const SweepView& view, Isa isa) {
#if defined(__x86_64__)
    if (isa != Isa::scalar) return apply_impulses_avx2(view);
#endif
    apply_all<ScalarPack>(view);
}

} // namespace flotilla
