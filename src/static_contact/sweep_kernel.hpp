// SPDX-License-Identifier: MIT
// Sweeps over packets, written once for every vector width. Include after a pack header. A packet is done contact by
// contact, in groups of P::kWidth lanes where P is narrower than a packet; where P is twice as wide, two packets of one
// colour go side by side: they touch different bodies, so the bits are those of one after the other, and about thirty
// dependent operations a row are waited for once in place of twice.
#pragma once

#include <cstddef>
#include <type_traits>

#include "base/prefetch.hpp"
#include "static_contact/contact_packets.hpp"
#include "static_contact/local_contact.hpp"

namespace flotilla {
namespace {

template <class P>
struct PackSym3 {
    P xx, yy, zz, xy, xz, yz;
};
template <class P>
inline PackVec<P> operator*(const PackSym3<P>& a, const PackVec<P>& v) {
    return {(a.xx * v.x + a.xy * v.y) + a.xz * v.z, (a.xy * v.x + a.yy * v.y) + a.yz * v.z,
            (a.xz * v.x + a.yz * v.y) + a.zz * v.z};
}

/// Lanes of a packet and of one of its rows.
template <class P>
struct RowAt {
    const ContactPacket* packet;
    Lanes* field_of_row;
    const PacketExtra* extra; ///< of the row; none: zero
    int lane;                 ///< the first of P::kWidth

    [[nodiscard]] P pair(int field) const { return P::load(packet->field[field] + lane); }
    [[nodiscard]] P load(int field) const { return P::load(field_of_row[field] + lane); }
    [[nodiscard]] bool any_extra() const { return extra != nullptr; }
    [[nodiscard]] P load_extra(int field) const { return P::load(extra->field[field] + lane); }
    void store(int field, P value) const { value.store(field_of_row[field] + lane); }
};

/// The pack for the lanes of one packet, or of a part of it: P, or half of it.
template <class P>
struct OnePacket {
    using Pack = P;
};
template <class P>
requires(P::kWidth > kPacketLanes) struct OnePacket<P> {
    using Pack = typename P::Half;
    static_assert(Pack::kWidth == kPacketLanes);
};

/// The same row of two packets, side by side.
template <class P>
struct RowsAt {
    RowAt<typename P::Half> low, high;

    [[nodiscard]] P pair(int field) const { return P::join(low.pair(field), high.pair(field)); }
    [[nodiscard]] P load(int field) const { return P::join(low.load(field), high.load(field)); }
    [[nodiscard]] bool any_extra() const { return low.any_extra(); }
    [[nodiscard]] P load_extra(int field) const { return P::join(low.load_extra(field), high.load_extra(field)); }
    void store(int field, P value) const {
        low.store(field, value.low());
        high.store(field, value.high());
    }
};

/// One side of a group of pairs: a body per lane.
template <class P>
struct PackBody {
    PackVec<P> linear, angular;
};

template <class P, class At>
inline PackVec<P> load_vec(const At& at, int field) {
    return {at.load(field), at.load(field + 1), at.load(field + 2)};
}

template <class P, class At>
inline PackSym3<P> load_inertia(const At& at, int field) {
    return {at.pair(field),     at.pair(field + 1), at.pair(field + 2),
            at.pair(field + 3), at.pair(field + 4), at.pair(field + 5)};
}

template <class P>
inline PackBody<P> load_bodies(const BodyVelocity* bodies, const std::int32_t* id) {
    const double* address[P::kWidth];
    for (int i = 0; i < P::kWidth; ++i) address[i] = &bodies[id[i]].linear.x;
    P linear[4], angular[4];
    load_transposed(address, 0, linear);
    load_transposed(address, 4, angular);
    return {{linear[0], linear[1], linear[2]}, {angular[0], angular[1], angular[2]}};
}

/// Writes the movable bodies of a group, each half of a velocity at once: a load of what narrower stores wrote waits
/// for the cache.
template <class P>
inline void store_bodies(const PackBody<P>& body, const std::int32_t* id, const double* inv_mass,
                         BodyVelocity* bodies) {
    const P zero = P::all(0);
    const unsigned movable = mask_bits(zero < P::load(inv_mass));
    double *linear[P::kWidth], *angular[P::kWidth];
    for (int i = 0; i < P::kWidth; ++i) {
        linear[i] = &bodies[id[i]].linear.x;
        angular[i] = &bodies[id[i]].angular.x;
    }
    store_transposed({body.linear.x, body.linear.y, body.linear.z, zero}, movable, linear);
    store_transposed({body.angular.x, body.angular.y, body.angular.z, zero}, movable, angular);
}

/// A vector in contact coordinates, by the fields of its normal component and of the first tangential one; without
/// friction the normal one alone.
template <Cone kCone, class P, class At>
[[gnu::always_inline]] inline PackVec<P> load_local_vec(const At& at, int normal, int tangential) {
    if constexpr (kCone == Cone::none) return {at.load(normal), P::all(0), P::all(0)};
    return {at.load(normal), at.load(tangential), at.load(tangential + 1)};
}
template <Cone kCone, class P, class At>
[[gnu::always_inline]] inline void store_local_vec(const At& at, int normal, int tangential, const PackVec<P>& v) {
    at.store(normal, v.x);
    if constexpr (kCone == Cone::none) return;
    at.store(tangential, v.y);
    at.store(tangential + 1, v.z);
}
template <Cone kCone, class P, class At>
[[gnu::always_inline]] inline PackVec<P> load_impulse(const At& at) {
    return load_local_vec<kCone, P>(at, PacketRow::kNormalImpulse, PacketRow::kTangentImpulse);
}

template <Cone kCone, class P, class At>
[[gnu::always_inline]] inline LocalPack<P> load_local(const At& at) {
    LocalPack<P> c;
    c.mass_diagonal = load_local_vec<kCone, P>(at, PacketRow::kNormalMass, PacketRow::kTangentMass);
    c.inv_mass_diagonal = load_local_vec<kCone, P>(at, PacketRow::kInvNormalMass, PacketRow::kInvTangentMass);
    c.impulse = load_impulse<kCone, P>(at);
    c.target = {at.load(PacketRow::kTarget), P::all(0), P::all(0)};
    if constexpr (kCone != Cone::none) {
        if (at.any_extra()) {
            c.target.y = at.load_extra(PacketExtra::kSlip);
            c.target.z = at.load_extra(PacketExtra::kSlip + 1);
        }
        c.coupling = load_vec<P>(at, PacketRow::kCoupling);
        c.friction = at.load(PacketRow::kFriction);
    }
    return c;
}

/// Where the contacts of a row are and how they lie; tangents only with friction.
template <class P>
struct PackFrame {
    PackVec<P> normal, tangent_1, tangent_2, arm_a, arm_b;
};
template <Cone kCone, class P, class At>
[[gnu::always_inline]] inline PackFrame<P> load_frame(const At& at) {
    PackFrame<P> f;
    f.normal = load_vec<P>(at, PacketRow::kNormal);
    if constexpr (kCone != Cone::none) {
        f.tangent_1 = load_vec<P>(at, PacketRow::kTangent1);
        f.tangent_2 = cross(f.normal, f.tangent_1);
    }
    f.arm_a = load_vec<P>(at, PacketRow::kArmA);
    constexpr int kOffset = ContactPacket::kOffset;
    f.arm_b = f.arm_a + PackVec<P>{at.pair(kOffset), at.pair(kOffset + 1), at.pair(kOffset + 2)};
    if (at.any_extra()) {
        constexpr int kAcross = PacketExtra::kAcross;
        f.arm_b = f.arm_b + PackVec<P>{at.load_extra(kAcross), at.load_extra(kAcross + 1), at.load_extra(kAcross + 2)};
    }
    return f;
}

/// Velocity of b against a at the contacts of a row (eq. 15), in their frames.
template <Cone kCone, class P>
[[gnu::always_inline]] inline PackVec<P> contact_velocity(const PackFrame<P>& f, const PackBody<P>& a,
                                                          const PackBody<P>& b) {
    const PackVec<P> v = (b.linear + cross(b.angular, f.arm_b)) - (a.linear + cross(a.angular, f.arm_a));
    if constexpr (kCone == Cone::none) return {dot(f.normal, v), P::all(0), P::all(0)};
    return {dot(f.normal, v), dot(f.tangent_1, v), dot(f.tangent_2, v)};
}

/// V += M^-1 J^T l of eq. 22 (the paper leaves out J^T), for impulses l on b and -l on a in the contacts' frames.
template <Cone kCone, class P, class At>
[[gnu::always_inline]] inline void apply(const At& at, const PackFrame<P>& f, const PackVec<P>& l, PackBody<P>& a,
                                         PackBody<P>& b) {
    PackVec<P> world = l.x * f.normal;
    if constexpr (kCone != Cone::none) world = (world + l.y * f.tangent_1) + l.z * f.tangent_2;
    a.linear = a.linear - at.pair(ContactPacket::kInvMassA) * world;
    a.angular = a.angular - load_inertia<P>(at, ContactPacket::kInvInertiaA) * cross(f.arm_a, world);
    b.linear = b.linear + at.pair(ContactPacket::kInvMassB) * world;
    b.angular = b.angular + load_inertia<P>(at, ContactPacket::kInvInertiaB) * cross(f.arm_b, world);
}

template <class P>
inline double largest_lane(P x) {
    double lanes[P::kWidth];
    x.store(lanes);
    double worst = 0;
    for (const double v : lanes) worst = v > worst ? v : worst;
    return worst;
}

/// Asks for the bodies of packet p, to write them: another thread may have written them in the last colour, and stores
/// wait for one another. What is not movable is only read, by all threads.
template <bool kWrite>
inline void fetch_bodies(const SweepView& view, std::int64_t p) {
    if (!kWrite || p >= view.num_packets) return;
    const ContactPacket& packet = view.packets[p];
    for (std::size_t lane = 0; lane < kPacketLanes; ++lane) {
        if (packet.field[ContactPacket::kInvMassA][lane] > 0) fetch_to_write(view.bodies + packet.a[lane]);
        if (packet.field[ContactPacket::kInvMassB][lane] > 0) fetch_to_write(view.bodies + packet.b[lane]);
    }
}

/// What impulses must not change of the velocities of bodies with locked axes.
template <class P>
struct LockedAxes {
    PackVec<P> locked, was; ///< 1 along an axis that is locked, else 0; velocities before

    LockedAxes() = default;
    LockedAxes(const AxisMask* axes, const PackVec<P>& velocity)
        : locked{lanes(axes, 0), lanes(axes, 1), lanes(axes, 2)}, was(velocity) {}
    void put_back(PackVec<P>& now) const {
        now.x = select(P::all(0) < locked.x, was.x, now.x);
        now.y = select(P::all(0) < locked.y, was.y, now.y);
        now.z = select(P::all(0) < locked.z, was.z, now.z);
    }

  private:
    static P lanes(const AxisMask* axes, int axis) {
        double lanes[P::kWidth];
        for (int i = 0; i < P::kWidth; ++i) lanes[i] = (axes[i] >> axis & 1) != 0 ? 1 : 0;
        return P::load(lanes);
    }
};

/// The rows that go with a cone.
template <Cone kCone>
inline auto* rows_of(const SweepView& view) {
    if constexpr (kCone == Cone::none)
        return view.normal_rows;
    else
        return view.rows;
}

/// A packet under way: the velocities of its bodies between its first row and its last.
template <class P, Cone kCone>
struct OpenPacket {
    using Row = std::remove_pointer_t<decltype(rows_of<kCone>(SweepView{}))>;
    static constexpr std::size_t kGroups = kPacketLanes / P::kWidth;
    const ContactPacket* packet;
    Row *first, *rows;          ///< of all packets, of this one
    const PacketExtra* extras;  ///< of all packets; none
    const BodyVelocity* bodies; ///< as they were before the packet, until it is closed
    PackBody<P> a[kGroups], b[kGroups];
    LockedAxes<P> locked_a[kGroups], locked_b[kGroups]; ///< set where any are

    OpenPacket(const SweepView& view, std::int64_t p)
        : packet(view.packets + p),
          first(rows_of<kCone>(view)),
          rows(first + packet->first),
          extras(view.extras),
          bodies(view.bodies) {
        for (std::size_t g = 0; g < kGroups; ++g) {
            a[g] = load_bodies<P>(view.bodies, packet->a + g * P::kWidth);
            b[g] = load_bodies<P>(view.bodies, packet->b + g * P::kWidth);
        }
        if (packet->any_locked) find_locked();
    }
    [[gnu::noinline]] void find_locked() {
        for (std::size_t g = 0; g < kGroups; ++g) {
            locked_a[g] = {packet->locked_a + g * P::kWidth, a[g].linear};
            locked_b[g] = {packet->locked_b + g * P::kWidth, b[g].linear};
        }
    }
    [[nodiscard]] std::int32_t num_rows() const { return packet->end - packet->first; }
    [[nodiscard]] RowAt<P> row_at(Row* row, int lane) const {
        return {packet, row->field, extras == nullptr ? nullptr : extras + (row - first), lane};
    }
    /// Groups that have a pair.
    [[nodiscard]] std::size_t num_groups() const {
        return kGroups == 1 ? 1 : static_cast<std::size_t>((packet->num_pairs + P::kWidth - 1) / P::kWidth);
    }
    /// Calls at_row for the rows [from, to) of those that begin at `begin`.
    template <class AtRow>
    void do_rows(Row* begin, std::int32_t from, std::int32_t to, AtRow&& at_row) {
        for (std::int32_t k = from; k < to; ++k)
            for (std::size_t g = 0; g < num_groups(); ++g) {
                at_row(row_at(begin + k, static_cast<int>(g) * P::kWidth), a[g], b[g]);
                if (!packet->any_locked) continue;
                locked_a[g].put_back(a[g].linear);
                locked_b[g].put_back(b[g].linear);
            }
    }
    /// The active rows from `done` on, then those that were parked.
    template <class AtRow>
    void do_rest(const SweepView& view, std::int32_t done, AtRow&& at_row) {
        do_rows(rows, done, num_rows(), at_row);
        if (packet->woken != 0) do_parked(at_row);
    }
    template <class AtRow>
    void do_parked(AtRow&& at_row) {
        do_rows(first + packet->first_parked, 0, packet->end_parked - packet->first_parked, at_row);
    }
    void close(BodyVelocity* to) const {
        for (std::size_t g = 0; g < num_groups(); ++g) {
            const std::size_t lane = g * P::kWidth;
            store_bodies(a[g], packet->a + lane, packet->field[ContactPacket::kInvMassA] + lane, to);
            store_bodies(b[g], packet->b + lane, packet->field[ContactPacket::kInvMassB] + lane, to);
        }
    }
};

template <class P>
inline PackVec<P> join(const PackVec<typename P::Half>& low, const PackVec<typename P::Half>& high) {
    return {P::join(low.x, high.x), P::join(low.y, high.y), P::join(low.z, high.z)};
}
template <class P>
inline PackBody<P> join(const PackBody<typename P::Half>& low, const PackBody<typename P::Half>& high) {
    return {join<P>(low.linear, high.linear), join<P>(low.angular, high.angular)};
}
template <class P>
inline PackVec<typename P::Half> low_of(const PackVec<P>& v) {
    return {v.x.low(), v.y.low(), v.z.low()};
}
template <class P>
inline PackVec<typename P::Half> high_of(const PackVec<P>& v) {
    return {v.x.high(), v.y.high(), v.z.high()};
}

/// Asks for a row to read: the processor foresees one stream of them, not two.
template <class Row>
inline void fetch_row(const Row* row) {
    for (std::size_t i = 0; i < sizeof(Row); i += 64) __builtin_prefetch(reinterpret_cast<const char*>(row) + i);
}

/// The rows that both packets have, side by side. Returns their number.
template <class P, Cone kCone, class AtRow>
inline std::int32_t do_common_rows(OpenPacket<typename P::Half, kCone>& low, OpenPacket<typename P::Half, kCone>& high,
                                   AtRow&& at_row) {
    const std::int32_t rows = low.num_rows() < high.num_rows() ? low.num_rows() : high.num_rows();
    PackBody<P> a = join<P>(low.a[0], high.a[0]), b = join<P>(low.b[0], high.b[0]);
    const std::int32_t both = low.num_rows() + high.num_rows();
    for (std::int32_t k = 0; k < rows; ++k) {
        fetch_row(low.rows + k + both);
        fetch_row(high.rows + k + both);
        at_row(RowsAt<P>{low.row_at(low.rows + k, 0), high.row_at(high.rows + k, 0)}, a, b);
    }
    low.a[0] = {low_of(a.linear), low_of(a.angular)};
    low.b[0] = {low_of(b.linear), low_of(b.angular)};
    high.a[0] = {high_of(a.linear), high_of(a.angular)};
    high.b[0] = {high_of(b.linear), high_of(b.angular)};
    return rows;
}

/// Calls at_row(rows, a, b) for the rows that two packets have side by side, and finish(packet, rows that are done,
/// first) for every packet that is swept, which does its others; `first`: of two, then after the second, or the only
/// one. Writes the bodies' velocities back if kWrite.
template <class P, Cone kCone, bool kWrite, class AtRow, class Finish>
inline void for_each_packet(const SweepView& view, AtRow at_row, Finish finish) {
    using One = typename OnePacket<P>::Pack;
    for (std::int64_t p = 0; p < view.num_packets; ++p) {
        if (!view.packets[p].swept()) continue;
        OpenPacket<One, kCone> open(view, p);
        std::int32_t done = 0;
        if constexpr (P::kWidth > kPacketLanes) {
            const auto alone = [&](const ContactPacket& packet) { return packet.any_locked || !packet.swept(); };
            if (p + 1 < view.num_packets && view.packets[p + 1].color == open.packet->color && !alone(*open.packet) &&
                !alone(view.packets[p + 1])) {
                OpenPacket<One, kCone> second(view, ++p);
                fetch_bodies<kWrite>(view, p + 1);
                fetch_bodies<kWrite>(view, p + 2);
                done = do_common_rows<P, kCone>(open, second, at_row);
                finish(second, done, false);
                if constexpr (kWrite) second.close(view.bodies);
            }
        }
        fetch_bodies<kWrite>(view, p + 1);
        finish(open, done, true);
        if constexpr (kWrite) open.close(view.bodies);
    }
}

/// Calls at_row(rows, a, b) for every row that is swept, packet by packet, with the bodies' velocities kept between the
/// rows of a packet; writes them back if kWrite.
template <class P, Cone kCone, bool kWrite, class AtRow>
inline void for_each_row(const SweepView& view, AtRow at_row) {
    for_each_packet<P, kCone, kWrite>(
        view, at_row, [&](auto& packet, std::int32_t done, bool) { packet.do_rest(view, done, at_row); });
}

/// In every lane the larger one of `worst` and of what a row of one packet, or of two, found.
template <class One, class Q>
inline void keep_largest(One& worst, Q found) {
    if constexpr (One::kWidth == Q::kWidth)
        worst = max(worst, found);
    else
        worst = max(worst, max(found.low(), found.high()));
}

/// The impulse moves on by a share of its last change.
template <Cone kCone, class P>
[[gnu::always_inline]] inline void move_on(PackVec<P>& impulse, const PackVec<P>& before, P momentum) {
    if constexpr (kCone == Cone::none)
        impulse.x = impulse.x + momentum * (impulse.x - before.x);
    else
        impulse = impulse + momentum * (impulse - before);
}

/// Visits a row with its impulse, in a first visit moved on. Returns the violations met.
template <Cone kCone, bool kFirst, class P, class At>
[[gnu::always_inline]] inline P visit_row(const SweepView& view, const At& at, PackBody<P>& a, PackBody<P>& b) {
    constexpr int kNormalPrevious = PacketRow::kNormalPrevious, kTangentPrevious = PacketRow::kTangentPrevious;
    LocalPack<P> local = load_local<kCone, P>(at);
    if constexpr (kFirst) {
        const PackVec<P> before = load_local_vec<kCone, P>(at, kNormalPrevious, kTangentPrevious);
        store_local_vec<kCone>(at, kNormalPrevious, kTangentPrevious, local.impulse);
        move_on<kCone>(local.impulse, before, P::all(view.momentum));
    }
    const PackFrame<P> frame = load_frame<kCone, P>(at);
    const LocalUpdate<P> update = visit<kCone>(local, contact_velocity<kCone>(frame, a, b));
    store_local_vec<kCone>(at, PacketRow::kNormalImpulse, PacketRow::kTangentImpulse, local.impulse + update.change);
    apply<kCone>(at, frame, update.change, a, b);
    return update.violation;
}

/// The rows of a packet again and again, while they meet more than they may. `met`: in the visit before, by lane.
template <Cone kCone, class P, class Packet>
inline void repeat_packet(const SweepView& view, Packet& packet, P met) {
    for (int visits = 1; visits < view.most_visits && largest_lane(met) > view.repeat_above; ++visits) {
        met = P::all(0);
        packet.do_rest(view, 0, [&](const RowAt<P>& at, PackBody<P>& a, PackBody<P>& b) {
            met = max(met, visit_row<kCone, false>(view, at, a, b));
        });
    }
}

template <class P, Cone kCone>
inline double sweep_packets(const SweepView& view) {
    using One = typename OnePacket<P>::Pack;
    One worst = One::all(0);
    P common = P::all(0); // of two packets side by side
    for_each_packet<P, kCone, true>(
        view,
        [&](const auto& at, PackBody<P>& a, PackBody<P>& b)
            __attribute__((always_inline)) { common = max(common, visit_row<kCone, true>(view, at, a, b)); },
        [&](OpenPacket<One, kCone> & packet, std::int32_t done, bool first) __attribute__((always_inline)) {
            One met = One::all(0);
            if constexpr (P::kWidth > One::kWidth) met = first ? common.low() : common.high();
            if (first) common = P::all(0);
            packet.do_rest(
                view,
                done, [&](const RowAt<One>& at, PackBody<One>& a, PackBody<One>& b) __attribute__((always_inline)) {
                    met = max(met, visit_row<kCone, true>(view, at, a, b));
                });
            worst = max(worst, met);
            repeat_packet<kCone>(view, packet, met);
        });
    return largest_lane(worst);
}

/// Of a row as it stands.
template <Cone kCone, class P, class At>
[[gnu::always_inline]] inline P violation_at(const At& at, const PackBody<P>& a, const PackBody<P>& b) {
    const PackFrame<P> frame = load_frame<kCone, P>(at);
    return violation<kCone>(load_local<kCone, P>(at), contact_velocity<kCone>(frame, a, b));
}

template <class P, Cone kCone>
inline double largest_violation_of(const SweepView& view) {
    typename OnePacket<P>::Pack worst = OnePacket<P>::Pack::all(0);
    for_each_row<P, kCone, false>(
        view, [&]<class At, class Q>(const At& at, PackBody<Q>& a, PackBody<Q>& b)
                  __attribute__((always_inline)) { keep_largest(worst, violation_at<kCone, Q>(at, a, b)); });
    return largest_lane(worst);
}

/// As largest_violation_of, and sets bit k of violated[p] where a row of pair k of packet p is violated by more than
/// `tolerance`.
template <class P, Cone kCone>
inline double find_violated_in(const SweepView& view, double tolerance, std::uint8_t* violated) {
    using One = typename OnePacket<P>::Pack;
    One worst = One::all(0);
    const One limit = One::all(tolerance);
    for (std::int64_t p = 0; p < view.num_packets; ++p) {
        unsigned lanes = 0;
        if (view.packets[p].swept())
            OpenPacket<One, kCone>(view, p).do_rest(
                view, 0, [&](const RowAt<One>& at, PackBody<One>& a, PackBody<One>& b) {
                    const One found = violation_at<kCone, One>(at, a, b);
                    worst = max(worst, found);
                    lanes |= static_cast<unsigned>(mask_bits(limit < found)) << at.lane;
                });
        violated[p] = static_cast<std::uint8_t>(lanes);
    }
    return largest_lane(worst);
}

template <class P, Cone kCone>
inline double largest_parked_violation_of(const SweepView& view) {
    using One = typename OnePacket<P>::Pack;
    One worst = One::all(0);
    for (std::int64_t p = 0; p < view.num_packets; ++p) {
        const ContactPacket& packet = view.packets[p];
        if (packet.woken != 0 || packet.first_parked == packet.end_parked) continue;
        OpenPacket<One, kCone>(view, p).do_parked([&](const RowAt<One>& at, PackBody<One>& a, PackBody<One>& b) {
            worst = max(worst, violation_at<kCone, One>(at, a, b));
        });
    }
    return largest_lane(worst);
}

template <class P, Cone kCone>
inline void apply_all(const SweepView& view) {
    for_each_row<P, kCone, true>(
        view, [&]<class At, class Q>(const At& at, PackBody<Q>& a, PackBody<Q>& b) __attribute__((always_inline)) {
            apply<kCone>(at, load_frame<kCone, Q>(at), load_impulse<kCone, Q>(at), a, b);
        });
}

/// call.operator()<cone>().
template <class Call>
inline auto with_cone(Cone cone, Call&& call) {
    switch (cone) {
    case Cone::pyramid: return call.template operator()<Cone::pyramid>();
    case Cone::disc: return call.template operator()<Cone::disc>();
    case Cone::bounded: return call.template operator()<Cone::bounded>();
    case Cone::none: return call.template operator()<Cone::none>();
    case Cone::frozen: break;
    }
    return call.template operator()<Cone::frozen>();
}
template <class P>
inline void apply_any(Cone cone, const SweepView& view) {
    with_cone(cone, [&]<Cone kCone>() { apply_all<P, kCone>(view); });
}
template <class P>
inline double sweep_any(Cone cone, const SweepView& view) {
    return with_cone(cone, [&]<Cone kCone>() { return sweep_packets<P, kCone>(view); });
}
template <class P>
inline double largest_violation_any(Cone cone, const SweepView& view) {
    return with_cone(cone, [&]<Cone kCone>() { return largest_violation_of<P, kCone>(view); });
}
template <class P>
inline double find_violated_any(Cone cone, const SweepView& view, double tolerance, std::uint8_t* violated) {
    return with_cone(cone, [&]<Cone kCone>() { return find_violated_in<P, kCone>(view, tolerance, violated); });
}
template <class P>
inline double largest_parked_violation_any(Cone cone, const SweepView& view) {
    return with_cone(cone, [&]<Cone kCone>() { return largest_parked_violation_of<P, kCone>(view); });
}

} // namespace
} // namespace flotilla
