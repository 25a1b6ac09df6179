// SPDX-License-Identifier: MIT
#include "static_contact/sweep_island.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "static_contact/assemble.hpp"

namespace flotilla {
namespace {

using Island = ContactScratch::Island;

constexpr double kMostMomentum = 0.9;
/// Momentum can keep a turning error alive that never heads straight back; then the residual goes up and down.
constexpr double kMostRise = 2;
/// Sweeps between two looks at the residual: one costs about half a sweep.
constexpr int kLookEvery = 10;
/// An island that stalls: its least residual fell by less than a fifth in `patience` sweeps.
constexpr double kLeastFall = 0.8;

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

std::span<const std::int32_t> bodies_of(const Island& island, const ContactScratch& s) {
    return std::span(s.island_bodies).subspan(index(island.first_body), index(island.end_body - island.first_body));
}

// Remembers the velocities x and moves them on to y.
void extrapolate(std::span<const std::int32_t> bodies, double m, ContactScratch& s) {
    for (const std::int32_t body : bodies) {
        BodyVelocity &v = s.velocity[index(body)], &before = s.before_sweep[index(body)];
        const BodyVelocity x = v;
        v.linear = x.linear + m * (x.linear - before.linear);
        v.angular = x.angular + m * (x.angular - before.angular);
        before = x;
        s.sweep_start[index(body)] = v;
    }
}

// (y - x) . (x - x_before), twice the energy of the product; a body turns with its mean inertia.
double turned_back(std::span<const std::int32_t> bodies, const ContactScratch& s) {
    double sum = 0;
    for (const std::int32_t body : bodies) {
        const BodyVelocity &x = s.velocity[index(body)], &y = s.sweep_start[index(body)],
                           &before = s.before_sweep[index(body)];
        const ContactScratch::Weight& w = s.weight[index(body)];
        sum += w.linear * dot(y.linear - x.linear, x.linear - before.linear) +
               w.angular * dot(y.angular - x.angular, x.angular - before.angular);
    }
    return sum;
}

/// The sequence of m, and whether the residual still falls.
class Progress {
  public:
    explicit Progress(const ContactSolveOptions& options) : patience_(options.patience) {}

    double momentum(bool restart) {
        const double next = (1 + std::sqrt(1 + 4 * theta_ * theta_)) / 2;
        const double m = restart ? 0.0 : std::min(kMostMomentum, (theta_ - 1) / next);
        theta_ = restart ? 1.0 : next;
        return m;
    }
    void saw(double residual) {
        least_ = std::min(least_, residual);
        rose_ = residual > kMostRise * lowest_;
        lowest_ = rose_ ? residual : std::min(lowest_, residual);
    }
    /// Once per look that found the residual far above its lowest value since the last such look.
    bool rose() { return std::exchange(rose_, false); }
    bool stalls(int sweeps) {
        if (patience_ <= 0 || sweeps % patience_ != 0) return false;
        const bool stalls = least_ > kLeastFall * least_before_;
        least_before_ = least_;
        return stalls;
    }

  private:
    static constexpr double kNone = std::numeric_limits<double>::infinity();
    int patience_;
    double theta_ = 1;
    double least_ = kNone, least_before_ = kNone, lowest_ = kNone;
    bool rose_ = false;
};

} // namespace

void list_island_bodies(const ContactBodies& bodies, ContactScratch& s) {
    s.island_bodies.clear();
    s.before_sweep.resize(s.bodies.size());
    s.sweep_start.resize(s.bodies.size());
    s.weight.resize(s.bodies.size());
    s.listed.assign(s.bodies.size(), 0);
    for (Island& island : s.islands) {
        island.first_body = static_cast<std::int32_t>(s.island_bodies.size());
        for (std::int32_t k = island.first; k < island.end; ++k)
            for (const std::int32_t body : {s.blocks[index(k)].a, s.blocks[index(k)].b}) {
                if (!s.movable[index(body)] || s.listed[index(body)]) continue;
                s.listed[index(body)] = 1;
                s.island_bodies.push_back(body);
                const std::size_t id = index(s.bodies[index(body)]);
                const Mat3& j = bodies.inv_inertia[id];
                const double trace = j.m[0] + j.m[4] + j.m[8];
                s.weight[index(body)] = {1 / bodies.inv_mass[id], trace > 0 ? 3 / trace : 0.0};
            }
        island.end_body = static_cast<std::int32_t>(s.island_bodies.size());
    }
}

SweepView view_of(const Island& island, ContactScratch& s) {
    return {.packets = s.packed.packets.data() + island.first_packet,
            .num_packets = island.end_packet - island.first_packet,
            .rows = s.packed.rows.data(),
            .bodies = s.velocity.data()};
}

// A sweep sees every row at its own turn, which may be just inside the tolerance while the end state is not; so a sweep that passes
// is confirmed on the state that it left. With momentum it also sees what the extrapolation added, so that one that does not pass is
// looked at now and then.
void sweep_island(Island& island, const ContactSolveOptions& options, bool momentum, ContactScratch& s) {
    SweepView view = view_of(island, s);
    const Cone cone = cone_of(options);
    const std::span<const std::int32_t> bodies = bodies_of(island, s);
    for (const std::int32_t body : bodies) s.before_sweep[index(body)] = s.velocity[index(body)];
    Progress progress(options);
    bool known = false, stalled = false;
    int sweeps = 0;
    while (sweeps < options.iterations && !stalled) {
        if (momentum) extrapolate(bodies, view.momentum, s);
        const double seen = sweep(cone, view, options.isa);
        ++sweeps;
        known = seen <= options.tolerance || sweeps % kLookEvery == 0;
        if (known) {
            island.residual = largest_violation(cone, view, options.isa);
            if (island.residual <= options.tolerance) break;
            progress.saw(island.residual);
        }
        stalled = progress.stalls(sweeps);
        if (momentum) view.momentum = progress.momentum(progress.rose() || turned_back(bodies, s) > 0);
    }
    if (!known) island.residual = largest_violation(cone, view, options.isa);
    island.iterations += sweeps;
    const std::int64_t contacts = s.blocks[index(island.end - 1)].end - s.blocks[index(island.first)].first;
    island.visits += sweeps * contacts;
}

} // namespace flotilla
