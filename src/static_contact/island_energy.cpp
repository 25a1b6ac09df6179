// SPDX-License-Identifier: MIT
#include "static_contact/island_energy.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Dense>

#include "base/index.hpp"

namespace flotilla {
namespace {

// w . I w for angular velocity w and inverse inertia J, by Cramer's rule; 0 for a body that cannot turn.
double angular_energy_twice(Mat3 j, const Vec3& w) {
    if (j == Mat3{}) return 0;
    for (const std::size_t k : {0U, 4U, 8U}) // nothing turns about a locked axis: any inertia does
        if (j.m[k] == 0) j.m[k] = 1;
    const Vec3 r0 = row(j, 0), r1 = row(j, 1), r2 = row(j, 2);
    const double det = dot(r0, cross(r1, r2));
    if (!(det > 0)) return 0;
    const Vec3 momentum{dot(w, cross(r1, r2)) / det, dot(w, cross(r2, r0)) / det, dot(w, cross(r0, r1)) / det};
    return dot(w, momentum);
}

constexpr std::size_t kItemsPerSum = 64;

/// The sum of term(k) for k in [0, n): of kItemsPerSum terms each, whatever the team, and then of these sums.
template <class Term>
double sum_in_parts(Team* team, const char* name, std::size_t n, std::span<double> sums, Term&& term) {
    const std::size_t parts = (n + kItemsPerSum - 1) / kItemsPerSum;
    for_each(team, name, parts, 1, [&](std::size_t part) {
        const std::size_t begin = part * kItemsPerSum, end = std::min(n, begin + kItemsPerSum);
        double sum = 0;
        for (std::size_t k = begin; k < end; ++k) sum += term(k);
        sums[part] = sum;
    });
    double sum = 0;
    for (const double part : sums.first(parts)) sum += part;
    return sum;
}

} // namespace

bool prescribed_at_rest(const ContactScratch::Island& island, const ContactScratch& s) {
    for (std::int32_t k = island.first; k < island.end; ++k)
        for (const std::int32_t body : {s.blocks[at(k)].a, s.blocks[at(k)].b}) {
            const BodyVelocity& v = s.velocity[at(body)];
            if (!s.movable[at(body)] && !(v.linear == Vec3{} && v.angular == Vec3{})) return false;
        }
    return true;
}

double kinetic_energy(const ContactScratch::Island& island, const ContactBodies& bodies, Team* team,
                      ContactScratch& s) {
    const auto twice = [&](std::size_t k) {
        const std::int32_t body = s.island_bodies[at(island.first_body) + k];
        const std::size_t id = at(s.bodies[at(body)]);
        const BodyVelocity& v = s.velocity[at(body)];
        return length_sq(v.linear) / bodies.inv_mass[id] + angular_energy_twice(bodies.inv_inertia[id], v.angular);
    };
    const std::span<double> sums = std::span(s.energy_sums).subspan(at(island.first_body));
    return sum_in_parts(team, "energy of bodies", at(island.end_body - island.first_body), sums, twice) / 2;
}

double inner_speed(const ContactScratch::Island& island, const ContactBodies& bodies, const ContactScratch& s) {
    const auto movable =
        std::span(s.island_bodies).subspan(at(island.first_body), at(island.end_body - island.first_body));
    const auto place = [&](std::int32_t body) { return bodies.position[at(s.bodies[at(body)])]; };
    double mass = 0;
    Vec3 center, momentum;
    for (const std::int32_t body : movable) {
        const double m = s.weight[at(body)].linear;
        mass += m;
        center += m * place(body);
        momentum += m * s.velocity[at(body)].linear;
    }
    center = center / mass;
    const Vec3 common = momentum / mass;
    double energy_twice = 0;
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (const std::int32_t body : movable) {
        const ContactScratch::Weight& m = s.weight[at(body)];
        const Vec3 r = place(body) - center, v = s.velocity[at(body)].linear - common;
        const Vec3& w = s.velocity[at(body)].angular;
        energy_twice += m.linear * length_sq(v) + m.angular * length_sq(w);
        const Vec3 l = m.linear * cross(r, v) + m.angular * w;
        const Eigen::Vector3d arm(r.x, r.y, r.z);
        spin += Eigen::Vector3d(l.x, l.y, l.z);
        inertia +=
            (m.linear * length_sq(r) + m.angular) * Eigen::Matrix3d::Identity() - m.linear * arm * arm.transpose();
    }
    const double turning_twice = spin.dot(inertia.ldlt().solve(spin));
    return std::sqrt(std::max(0.0, energy_twice - turning_twice) / mass);
}

double work_of_targets(const ContactScratch::Island& island, Team* team, ContactScratch& s) {
    const auto work = [&](std::size_t k) {
        const ContactPacket& packet = s.packed.packets[at(island.first_packet) + k];
        double sum = 0;
        const auto add_rows = [&](std::int32_t first, std::int32_t end) {
            for (auto r = at(first); r < at(end); ++r) {
                const Lanes* field = s.packed.frictionless ? s.packed.normal_rows[r].field : s.packed.rows[r].field;
                for (std::size_t lane = 0; lane < kPacketLanes; ++lane)
                    sum += field[PacketRow::kNormalImpulse][lane] * field[PacketRow::kTarget][lane];
                if (!s.packed.any_extras || s.packed.frictionless) continue;
                for (const int t : {0, 1})
                    for (std::size_t lane = 0; lane < kPacketLanes; ++lane)
                        sum += field[PacketRow::kTangentImpulse + t][lane] *
                               s.packed.extras[r].field[PacketExtra::kSlip + t][lane];
            }
        };
        add_rows(packet.first, packet.end);
        add_rows(packet.first_parked, packet.end_parked);
        return sum;
    };
    const std::span<double> sums = std::span(s.work_sums).subspan(at(island.first_packet));
    return sum_in_parts(team, "work of targets", at(island.end_packet - island.first_packet), sums, work);
}

namespace {

constexpr std::size_t kBlockGrain = 64; // body pairs of a task

/// Scales the island's impulses, and what they changed of velocities.
void scale_impulses(const ContactScratch::Island& island, double share, ContactScratch& s) {
    for (const ContactBlock& block : std::span(s.blocks).subspan(at(island.first), at(island.end - island.first)))
        for (std::int32_t r = block.first; r < block.end; ++r) {
            Vec3& impulse = s.rows[at(r)].local.impulse;
            impulse = share > 0 ? share * impulse : Vec3{};
        }
    for (std::int32_t k = island.first_body; k < island.end_body; ++k) {
        const std::size_t body = at(s.island_bodies[at(k)]);
        const BodyVelocity& start = s.start_velocity[body];
        BodyVelocity& v = s.velocity[body];
        if (share > 0) {
            v.linear = start.linear + share * (v.linear - start.linear);
            v.angular = start.angular + share * (v.angular - start.angular);
        } else {
            v = start;
        }
    }
}

} // namespace

void take_back_gain(const ContactScratch::Island& island, Team* team, ContactScratch& s) {
    const std::size_t first = at(island.first), n = at(island.end) - first;
    s.gain.resize(std::max(s.gain.size(), n));
    const auto find_gain = [&](std::size_t k) {
        const ContactBlock& block = s.blocks[first + k];
        ContactScratch::Gain gain;
        for (std::int32_t r = block.first; r < block.end; ++r) {
            const ContactRow& row = s.rows[at(r)];
            const auto velocity = [&](std::span<const BodyVelocity> of) {
                return to_contact(row, relative_velocity(row, of[at(block.a)], of[at(block.b)]));
            };
            const Vec3 start = velocity(s.start_velocity), &l = row.local.impulse;
            gain.given += dot(l, velocity(s.velocity) - start);
            gain.from_start += dot(l, start) - dot(l, row.local.target);
        }
        s.gain[k] = gain;
    };
    for_each(team, "gain of energy", n, kBlockGrain, find_gain);
    ContactScratch::Gain sum;
    for (const ContactScratch::Gain& gain : std::span(s.gain).first(n)) {
        sum.given += gain.given;
        sum.from_start += gain.from_start;
    }
    if (0.5 * sum.given + sum.from_start <= 0) return;
    const bool numbers = std::isfinite(sum.given) && std::isfinite(sum.from_start);
    scale_impulses(island, numbers && sum.given > 0 ? std::clamp(-sum.from_start / sum.given, 0.0, 1.0) : 0, s);
}

} // namespace flotilla
