// SPDX-License-Identifier: MIT
// The matrix-free form of the contact system (paper, eqs 15 and 21-22) laid out for sweeping: SIMD batches (packets) of
// four body pairs of one colour side by side, their contacts one below the other.
//
// A visit computes the relative velocity at a contact once, does the three rows on it in the contact's own frame
// (local_contact.hpp) and applies the sum of their impulses once. This is the row by row sweep of [29] in exact
// arithmetic, with a third of the body updates and half of the memory. A pair's velocities stay in registers over all
// its contacts. Pairs of a packet share no movable body, so their chains of operations are independent: vectors of one,
// four or eight lanes give the same bits, and so would packets of one colour run in parallel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/ccd.hpp"
#include "parallel/large_vector.hpp"
#include "static_contact/contact_rows.hpp"

namespace flotilla {

constexpr int kPacketLanes = 4;
constexpr std::uint8_t kAllPairs = (1U << kPacketLanes) - 1; ///< of a packet, a bit each
using Lanes = double[kPacketLanes];

/// Up to four body pairs of one colour. Masses are copied in: a sweep touches packets, rows and velocities only. Lanes
/// without a pair repeat the bodies of lane 0 with inverse masses of 0, so they are read and never written.
struct alignas(64) ContactPacket {
    static constexpr int kInvMassA = 0, kInvMassB = 1;
    static constexpr int kInvInertiaA = 2, kInvInertiaB = 8; ///< xx yy zz xy xz yz
    static constexpr int kOffset = 14;                       ///< m: centre of mass of a minus that of b
    Lanes field[17] = {};
    std::int32_t a[kPacketLanes] = {}, b[kPacketLanes] = {};
    std::int32_t first = 0, end = 0;               ///< packed rows that sweeps visit
    std::int32_t first_parked = 0, end_parked = 0; ///< inactive rows: sweeps leave them out until `woken`
    std::int32_t num_pairs = 0;                    ///< lanes in use: the first ones
    std::int32_t color = 0;
    std::int32_t woken = 0;
    AxisMask locked_a[kPacketLanes] = {}, locked_b[kPacketLanes] = {}; ///< axes along which bodies do not move
    bool any_locked = false;

    [[nodiscard]] bool swept() const { return first < end || woken != 0; }
};
static_assert(sizeof(ContactPacket) == 640);

/// One contact of each pair: fields of ContactRow and the impulse before the last sweep, 26 doubles per contact, read
/// in order once per visit; only the impulses are written. A big pile is bound by this stream, so the second tangent
/// (normal x first) and the arm from b (the pair's offset + the arm from a, + across) are computed. A pair with fewer
/// contacts than others of its packet has idle rows below: no direction, no arm, no impulse, W = 1. What the normal's
/// row needs comes first.
struct alignas(64) PacketRow {
    static constexpr int kNormalMass = 0, kInvNormalMass = 1, kNormalImpulse = 2, kNormalPrevious = 3, kTarget = 4;
    static constexpr int kNormal = 5, kArmA = 8;                                        ///< a vector each
    static constexpr int kNormalFields = 11;                                            ///< those above
    static constexpr int kTangentMass = 11, kInvTangentMass = 13, kTangentImpulse = 15; ///< of both tangents
    static constexpr int kTangentPrevious = 17, kCoupling = 19;                         ///< likewise; W_n1, W_n2, W_12
    static constexpr int kFriction = 22, kTangent1 = 23;                                ///< mu; a vector
    Lanes field[26] = {};
};
static_assert(sizeof(PacketRow) == 832);

/// What is left of it where no contact has friction.
struct alignas(64) NormalRow {
    Lanes field[PacketRow::kNormalFields] = {};
};
static_assert(sizeof(NormalRow) == 384);

/// Targets of both tangents of a packed row, and where the point of b is from that of a. Most solves have neither.
struct alignas(64) PacketExtra {
    static constexpr int kSlip = 0, kAcross = 2;
    Lanes field[5] = {};
};
static_assert(sizeof(PacketExtra) == 192);

struct PackedContacts {
    LargeVector<ContactPacket> packets;
    bool frictionless = false;             ///< rows are normal_rows
    LargeVector<PacketRow> rows;           ///< active ones of all packets, then parked ones
    LargeVector<NormalRow> normal_rows;    ///< likewise, where there is no friction
    bool any_extras = false;               ///< whether there are any
    LargeVector<PacketExtra> extras;       ///< by row
    LargeVector<std::int32_t> source;      ///< row of each lane of a packed row it was packed from; -1: idle
    std::vector<std::int32_t> first_block; ///< by packet
    std::vector<double> parked_reach;      ///< m, by packet: the longest arm of its parked rows
    /// Keeps the rows, which fill_packet() writes over.
    void clear() {
        packets.clear();
        first_block.clear();
    }
    [[nodiscard]] const PacketExtra* extras_if_any() const { return any_extras ? extras.data() : nullptr; }
    [[nodiscard]] std::size_t num_rows() const { return frictionless ? normal_rows.size() : rows.size(); }
};

/// The packets of a colour, which threads may sweep side by side.
struct PacketGroup {
    std::int32_t first = 0; ///< packet
    std::int32_t swept = 0; ///< packets with active rows
};

/// Appends packets, without their contents, for the blocks [first, end) given in colour order: neighbours of one colour
/// share a packet. Appends their groups to `groups`.
void lay_out_packets(std::span<const ContactBlock> blocks, std::int32_t first, std::int32_t end, PackedContacts& packed,
                     std::vector<PacketGroup>& groups);
/// Appends the groups of packets given in colour order; `first` is the place of the first one.
void group_packets(std::span<const ContactPacket> packets, std::int32_t first, std::vector<PacketGroup>& groups);
/// Room for the rows of all packets laid out; gives the parked ones their places behind the others.
void resize_rows(PackedContacts& packed);
/// Room for their extras, or none; before they are filled or refilled.
void resize_extras(bool any, PackedContacts& packed);
/// Copies the contents of a packet that was laid out; different packets may be filled side by side.
void fill_packet(std::span<const ContactBlock> blocks, std::span<const ContactRow> rows, std::size_t packet,
                 PackedContacts& packed);
/// The same for a packet that holds these rows already, with other targets and impulses.
void refill_packet(std::span<const ContactRow> rows, std::size_t packet, PackedContacts& packed);
/// Copies the impulses of the packed row `row` back to the rows that they came from; different ones may be copied side
/// by side.
void unpack_impulses(const PackedContacts& packed, std::size_t row, std::span<ContactRow> rows);

/// The other way: the impulses of `rows`, also as those before the last sweep.
void repack_impulses(std::span<const ContactRow> rows, std::size_t row, PackedContacts& packed);

/// What a sweep works on: some packets, the rows of all, the velocities of all bodies in contact. Bare pointers,
/// because the kernels compiled for one instruction set must not instantiate inline functions that other files share.
struct SweepView {
    const ContactPacket* packets = nullptr;
    std::int64_t num_packets = 0;
    PacketRow* rows = nullptr;
    NormalRow* normal_rows = nullptr;    ///< those in use with Cone::none
    const PacketExtra* extras = nullptr; ///< by row; none: all are zero
    BodyVelocity* bodies = nullptr;
    double momentum = 0; ///< a sweep visits every row with its impulse + momentum * (impulse - the one before)
    /// A packet that meets more than this (m/s) is visited again at once, without momentum, up to so many times in all.
    double repeat_above = 0;
    int most_visits = 1;
};

/// One sweep in packet order. Returns the largest violation met in first visits, m/s.
double sweep(Cone cone, const SweepView& view, Isa isa);

/// The largest violation at the present velocities of rows that are swept, and of parked ones that are not; m/s;
/// changes nothing.
double largest_violation(Cone cone, const SweepView& view, Isa isa);
double largest_parked_violation(Cone cone, const SweepView& view, Isa isa);
/// As largest_violation(), and which pairs: bit k of violated[p] is set where a row of pair k of packet p is violated
/// by more than `tolerance`, m/s.
double find_violated(Cone cone, const SweepView& view, double tolerance, std::uint8_t* violated, Isa isa);

/// V += M^-1 J^T lambda for the impulses that the rows hold: the warm start.
void apply_impulses(Cone cone, const SweepView& view, Isa isa);

/// Kernels compiled for AVX2 and for AVX-512 (F, DQ, VL); call only where the processor has it.
double sweep_avx2(Cone cone, const SweepView& view);
double sweep_avx512(Cone cone, const SweepView& view);
double largest_violation_avx2(Cone cone, const SweepView& view);
double largest_violation_avx512(Cone cone, const SweepView& view);
double find_violated_avx2(Cone cone, const SweepView& view, double tolerance, std::uint8_t* violated);
double find_violated_avx512(Cone cone, const SweepView& view, double tolerance, std::uint8_t* violated);
double largest_parked_violation_avx2(Cone cone, const SweepView& view);
double largest_parked_violation_avx512(Cone cone, const SweepView& view);
void apply_impulses_avx2(Cone cone, const SweepView& view);
void apply_impulses_avx512(Cone cone, const SweepView& view);

} // namespace flotilla
