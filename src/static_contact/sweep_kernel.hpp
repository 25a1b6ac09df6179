// SPDX-License-Identifier: MIT
// Sweeps over packets, written once for every vector width. Include after a pack header. A packet is done in groups of
// P::kWidth lanes, contact by contact, the groups side by side: their chains are independent, and each alone is bound by
// the latency of about thirty dependent operations.
#pragma once

#include <cstddef>

#include "static_contact/contact_packets.hpp"
#include "static_contact/local_contact.hpp"

namespace flotilla {
namespace {

/// __builtin_prefetch(address, 1) asks for a line to write only where the target has the instruction by name; all x86-64 processors run
/// it, the oldest as one that does nothing.
inline void fetch_to_write(const void* address) {
#if defined(__x86_64__)
    asm volatile("prefetchw %0" : : "m"(*static_cast<const char*>(address)));
#else
    __builtin_prefetch(address, 1);
#endif
}

template <class P>
struct PackSym3 {
    P xx, yy, zz, xy, xz, yz;
};
template <class P>
inline PackVec<P> operator*(const PackSym3<P>& a, const PackVec<P>& v) {
    return {(a.xx * v.x + a.xy * v.y) + a.xz * v.z, (a.xy * v.x + a.yy * v.y) + a.yz * v.z,
            (a.xz * v.x + a.yz * v.y) + a.zz * v.z};
}

/// One side of a group of pairs: a body per lane.
template <class P>
struct PackBody {
    PackVec<P> linear, angular;
};

template <class P>
inline PackVec<P> load_vec(const PacketRow& row, int field, int lane) {
    return {P::load(row.field[field] + lane), P::load(row.field[field + 1] + lane),
            P::load(row.field[field + 2] + lane)};
}

template <class P>
inline PackSym3<P> load_inertia(const Lanes (&j)[6], int lane) {
    return {P::load(j[0] + lane), P::load(j[1] + lane), P::load(j[2] + lane),
            P::load(j[3] + lane), P::load(j[4] + lane), P::load(j[5] + lane)};
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

/// Writes the movable bodies of a group.
template <class P>
inline void store_bodies(const PackBody<P>& body, const std::int32_t* id, const double* inv_mass,
                         BodyVelocity* bodies) {
    double v[6][P::kWidth];
    body.linear.x.store(v[0]);
    body.linear.y.store(v[1]);
    body.linear.z.store(v[2]);
    body.angular.x.store(v[3]);
    body.angular.y.store(v[4]);
    body.angular.z.store(v[5]);
    for (int i = 0; i < P::kWidth; ++i) {
        if (!(inv_mass[i] > 0)) continue;
        BodyVelocity& out = bodies[id[i]];
        out.linear = {v[0][i], v[1][i], v[2][i]};
        out.angular = {v[3][i], v[4][i], v[5][i]};
    }
}

template <class P>
inline LocalPack<P> load_local(const PacketRow& row, int lane) {
    return {load_vec<P>(row, PacketRow::kMassDiagonal, lane), load_vec<P>(row, PacketRow::kInvMassDiagonal, lane),
            load_vec<P>(row, PacketRow::kCoupling, lane),     load_vec<P>(row, PacketRow::kImpulse, lane),
            P::load(row.field[PacketRow::kTarget] + lane),    P::load(row.field[PacketRow::kFriction] + lane)};
}

/// Where the contacts of a row are and how they lie.
template <class P>
struct PackFrame {
    PackVec<P> normal, tangent_1, tangent_2, arm_a, arm_b;
};
template <class P>
inline PackFrame<P> load_frame(const ContactPacket& packet, const PacketRow& row, int lane) {
    PackFrame<P> f;
    f.normal = load_vec<P>(row, PacketRow::kNormal, lane);
    f.tangent_1 = load_vec<P>(row, PacketRow::kTangent1, lane);
    f.tangent_2 = cross(f.normal, f.tangent_1);
    f.arm_a = load_vec<P>(row, PacketRow::kArmA, lane);
    f.arm_b = f.arm_a + PackVec<P>{P::load(packet.offset[0] + lane), P::load(packet.offset[1] + lane),
                                   P::load(packet.offset[2] + lane)};
    return f;
}

/// Velocity of b against a at the contacts of a row (eq. 15), in their frames.
template <class P>
inline PackVec<P> contact_velocity(const PackFrame<P>& f, const PackBody<P>& a, const PackBody<P>& b) {
    const PackVec<P> v = (b.linear + cross(b.angular, f.arm_b)) - (a.linear + cross(a.angular, f.arm_a));
    return {dot(f.normal, v), dot(f.tangent_1, v), dot(f.tangent_2, v)};
}

/// V += M^-1 J^T l of eq. 22 (the paper leaves out J^T), for impulses l on b and -l on a in the contacts' frames.
template <class P>
inline void apply(const ContactPacket& packet, const PackFrame<P>& f, int lane, const PackVec<P>& l, PackBody<P>& a,
                  PackBody<P>& b) {
    const PackVec<P> world = (l.x * f.normal + l.y * f.tangent_1) + l.z * f.tangent_2;
    a.linear = a.linear - P::load(packet.inv_mass_a + lane) * world;
    a.angular = a.angular - load_inertia<P>(packet.inv_inertia_a, lane) * cross(f.arm_a, world);
    b.linear = b.linear + P::load(packet.inv_mass_b + lane) * world;
    b.angular = b.angular + load_inertia<P>(packet.inv_inertia_b, lane) * cross(f.arm_b, world);
}

template <class P>
inline void store_vec(const PackVec<P>& v, int lane, int field, PacketRow& row) {
    v.x.store(row.field[field] + lane);
    v.y.store(row.field[field + 1] + lane);
    v.z.store(row.field[field + 2] + lane);
}

template <class P>
inline double largest_lane(P x) {
    double lanes[P::kWidth];
    x.store(lanes);
    double worst = 0;
    for (const double v : lanes) worst = v > worst ? v : worst;
    return worst;
}

/// Asks for the bodies of packet p, to write them: another thread may have written them in the last colour, and stores wait for one
/// another. What is not movable is only read, by all threads.
template <bool kWrite>
inline void fetch_bodies(const SweepView& view, std::int64_t p) {
    if (!kWrite || p >= view.num_packets) return;
    const ContactPacket& packet = view.packets[p];
    for (std::size_t lane = 0; lane < kPacketLanes; ++lane) {
        if (packet.inv_mass_a[lane] > 0) fetch_to_write(view.bodies + packet.a[lane]);
        if (packet.inv_mass_b[lane] > 0) fetch_to_write(view.bodies + packet.b[lane]);
    }
}

/// Calls at_row(row, lane, a, b) for every row and group of every packet, contact by contact, with the bodies' velocities
/// kept between the rows of a packet; writes them back if kWrite.
template <class P, bool kWrite, class AtRow>
inline void for_each_row(const SweepView& view, AtRow at_row) {
    constexpr std::size_t kGroups = kPacketLanes / P::kWidth;
    for (std::int64_t p = 0; p < view.num_packets; ++p) {
        const ContactPacket& packet = view.packets[p];
        fetch_bodies<kWrite>(view, p + 1);
        const auto groups = static_cast<std::size_t>((packet.num_pairs + P::kWidth - 1) / P::kWidth);
        PackBody<P> a[kGroups], b[kGroups];
        for (std::size_t g = 0; g < kGroups; ++g) {
            a[g] = load_bodies<P>(view.bodies, packet.a + g * P::kWidth);
            b[g] = load_bodies<P>(view.bodies, packet.b + g * P::kWidth);
        }
        for (std::int32_t k = packet.first; k < packet.end; ++k)
            for (std::size_t g = 0; g < groups; ++g)
                at_row(packet, view.rows[k], static_cast<int>(g) * P::kWidth, a[g], b[g]);
        for (std::size_t g = 0; kWrite && g < groups; ++g) {
            const std::size_t lane = g * P::kWidth;
            store_bodies(a[g], packet.a + lane, packet.inv_mass_a + lane, view.bodies);
            store_bodies(b[g], packet.b + lane, packet.inv_mass_b + lane, view.bodies);
        }
    }
}

template <class P, Cone kCone>
inline double sweep_packets(const SweepView& view) {
    P worst = P::all(0);
    const P momentum = P::all(view.momentum);
    for_each_row<P, true>(view,
                          [&](const ContactPacket& packet, PacketRow& row, int lane, PackBody<P>& a, PackBody<P>& b) {
                              LocalPack<P> local = load_local<P>(row, lane);
                              const PackVec<P> before = load_vec<P>(row, PacketRow::kPrevious, lane);
                              store_vec(local.impulse, lane, PacketRow::kPrevious, row);
                              local.impulse = local.impulse + momentum * (local.impulse - before);
                              const PackFrame<P> frame = load_frame<P>(packet, row, lane);
                              const LocalUpdate<P> update = visit<kCone>(local, contact_velocity(frame, a, b));
                              store_vec(local.impulse + update.change, lane, PacketRow::kImpulse, row);
                              apply(packet, frame, lane, update.change, a, b);
                              worst = max(worst, update.violation);
                          });
    return largest_lane(worst);
}

template <class P, Cone kCone>
inline double largest_violation_of(const SweepView& view) {
    P worst = P::all(0);
    for_each_row<P, false>(
        view, [&](const ContactPacket& packet, PacketRow& row, int lane, PackBody<P>& a, PackBody<P>& b) {
            const PackFrame<P> frame = load_frame<P>(packet, row, lane);
            worst = max(worst, violation<kCone>(load_local<P>(row, lane), contact_velocity(frame, a, b)));
        });
    return largest_lane(worst);
}

template <class P>
inline void apply_all(const SweepView& view) {
    for_each_row<P, true>(
        view, [&](const ContactPacket& packet, PacketRow& row, int lane, PackBody<P>& a, PackBody<P>& b) {
            apply(packet, load_frame<P>(packet, row, lane), lane, load_vec<P>(row, PacketRow::kImpulse, lane), a, b);
        });
}

template <class P>
inline double sweep_any(Cone cone, const SweepView& view) {
    switch (cone) {
    case Cone::pyramid: return sweep_packets<P, Cone::pyramid>(view);
    case Cone::disc: return sweep_packets<P, Cone::disc>(view);
    case Cone::frozen: break;
    }
    return sweep_packets<P, Cone::frozen>(view);
}

template <class P>
inline double largest_violation_any(Cone cone, const SweepView& view) {
    switch (cone) {
    case Cone::pyramid: return largest_violation_of<P, Cone::pyramid>(view);
    case Cone::disc: return largest_violation_of<P, Cone::disc>(view);
    case Cone::frozen: break;
    }
    return largest_violation_of<P, Cone::frozen>(view);
}

} // namespace
} // namespace flotilla
