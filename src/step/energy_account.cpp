// SPDX-License-Identifier: MIT
#include "step/energy_account.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/index.hpp"
#include "state/loads.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kGrain = 64; // bodies of a task
/// Of the energies that a balance subtracts: the rounding of a few operations each, and of the energy of a turn
/// (rotation_step.hpp).
constexpr double kRounding = 0x1p-44;
/// Of a body's weight times its rest distance: what resting bodies may rise in a step without account. A million steps
/// of it lift a body by a thousandth of its rest distance.
constexpr double kCreep = 0x1p-30;

double kinetic_energy(const Model& model, std::size_t i, const Pose& pose, const Motion& m) {
    return 0.5 * (model.bodies[i].mass * length_sq(m.velocity) +
                  dot(m.momentum, angular_velocity(model, i, pose.rotation, m.momentum)));
}

/// N, that pulls a body towards what it rests on: its weight, its own force, and what its torque presses with on an arm
/// of its radius.
double weight_of(const Model& model, std::size_t i) {
    const Body& body = model.bodies[i];
    const double weight = body.mass * length(model.gravity);
    return body.driven() ? weight + length(body.force) + length(body.torque) / model.shape_of(i).radius : weight;
}

/// J: a body's weight times its rest distance, of the smaller of its two diameters, that of the bounding sphere and
/// that about the centre of mass.
double most_lift_of(const Model& model, std::size_t i) {
    const double share = std::min(1.0, 2 * model.shape_of(i).radius / model.bodies[i].size);
    return weight_of(model, i) * share * body_lengths(model, i).rest;
}

} // namespace

void EnergyAccount::start(Team& team, const Model& model, std::span<const Pose> pose, std::span<const Motion> motion) {
    const std::size_t n = model.size();
    parent_.resize(n);
    kinetic_.resize(n);
    com_.resize(n);
    bodies_.resize(n);
    islands_.resize(n);
    verdicts_.resize(n);
    work_.assign(n, 0);
    loads_.assign(n, 0);
    grounded_.assign(n, 0);
    scripted_.assign(n, 0);
    team.for_each("energy before", model.active.size(), kGrain, [&](std::size_t k, int) {
        const std::size_t i = at(model.active[k]);
        parent_[i] = static_cast<std::int32_t>(i);
        com_[i] = pose[i].com;
        grounded_[i] = model.bodies[i].locked.translation != 0 ? 1 : 0;
        kinetic_[i] = model.bodies[i].movable() ? kinetic_energy(model, i, pose[i], motion[i]) : 0.0;
    });
}

std::int32_t EnergyAccount::root(std::int32_t body) {
    while (parent_[at(body)] != body) body = parent_[at(body)] = parent_[at(parent_[at(body)])];
    return body;
}

void EnergyAccount::join(const Model& model, std::int32_t a, std::int32_t b) {
    const bool movable_a = model.bodies[at(a)].movable(), movable_b = model.bodies[at(b)].movable();
    if (movable_a && movable_b) {
        const std::int32_t p = root(a), q = root(b);
        parent_[at(std::max(p, q))] = std::min(p, q);
    } else {
        const std::int32_t body = movable_a ? a : b;
        grounded_[at(body)] = 1;
        if (model.bodies[at(movable_a ? b : a)].scripted()) scripted_[at(body)] = 1;
    }
}

void EnergyAccount::keep_centers(const Model& model, std::span<Motion> late) {
    const auto each = [&](auto&& work) {
        for (const std::int32_t body : model.active)
            if (model.bodies[at(body)].movable()) work(at(body), islands_[at(root(body))]);
    };
    for (const std::int32_t body : model.active) islands_[at(body)] = {};
    each([&](std::size_t i, Balance& island) {
        island.mass += model.bodies[i].mass;
        island.momentum += model.bodies[i].mass * late[i].velocity;
        island.rounding += kRounding * model.bodies[i].mass * length(late[i].velocity);
        island.grounded = island.grounded || grounded_[i] != 0;
    });
    each([&](std::size_t i, const Balance& island) {
        if (!island.grounded && length(island.momentum) > island.rounding)
            late[i].velocity -= (1 / island.mass) * island.momentum;
    });
}

EnergyAccount::Balance EnergyAccount::balance(const Model& model, std::size_t i, const Pose& end, const Motion& motion,
                                              double lift) const {
    const Body& body = model.bodies[i];
    Balance out;
    out.kinetic = kinetic_energy(model, i, end, motion);
    out.gain = out.kinetic - kinetic_[i] - body.mass * dot(model.gravity, end.com - com_[i]) - loads_[i];
    const double weight = weight_of(model, i);
    const double place = std::max(max_component(abs(end.com)), max_component(abs(com_[i])));
    out.rounding = kRounding * (out.kinetic + kinetic_[i]) + 0x1p-50 * weight * place;
    out.mass = body.mass;
    out.momentum = body.mass * motion.velocity;
    out.lift = lift;
    out.most_lift = most_lift_of(model, i);
    out.rounding += kCreep * out.most_lift;
    out.grounded = grounded_[i] != 0;
    return out;
}

EnergyAccount::Verdict EnergyAccount::judge(const Balance& island, EnergyCorrections& out) const {
    Verdict v;
    const double gain = island.gain - std::max(island.work, 0.0);
    if (gain <= island.rounding) {
        v.draw = -std::min(std::max(-gain, 0.0), island.lift);
        return v;
    }
    v.draw = std::min(gain, std::max(island.most_lift - island.lift, 0.0));
    const double excess = gain - v.draw;
    if (excess <= island.rounding) return v;
    if (!island.grounded) v.center = island.momentum / island.mass;
    const double of_center = 0.5 * island.mass * length_sq(v.center), relative = island.kinetic - of_center;
    const double removed = std::clamp(excess, 0.0, std::max(relative, 0.0));
    v.scale = relative > 0 ? std::sqrt(std::max(0.0, 1 - removed / relative)) : 1.0;
    v.debt = (excess - removed) / island.mass;
    ++out.islands;
    out.removed += removed;
    return v;
}

void EnergyAccount::weigh_islands(const Model& model, std::span<const double> lift) {
    for (const std::int32_t i : model.active) islands_[at(i)] = {};
    for (const std::int32_t body : model.active) {
        const std::size_t i = at(body);
        if (!model.bodies[i].movable()) continue;
        Balance& island = islands_[at(root(body))];
        island.kinetic += kinetic_[i];
        const double most = most_lift_of(model, i);
        island.lift += most;
        island.most_lift += std::max(most - lift[i], 0.0) + kCreep * most;
        island.grounded = island.grounded || scripted_[i] != 0;
    }
}

void EnergyAccount::find_scripted(const Model& model) {
    for (const std::int32_t i : model.active) {
        if (!model.bodies[at(i)].movable()) continue;
        Balance& island = islands_[at(root(i))];
        island.grounded = island.grounded || scripted_[at(i)] != 0;
    }
}

double EnergyAccount::cost_of(const Model& model, std::size_t i, const Vec3& way) {
    const double cost = -model.bodies[i].mass * dot(model.gravity, way);
    return model.bodies[i].force_acts() ? cost - dot(model.bodies[i].force, way) : cost;
}

std::span<const double> EnergyAccount::paid(const Model& model, std::span<const Vec3> way,
                                            std::span<const double> lift) {
    shares_.assign(model.size(), 1);
    weigh_islands(model, lift);
    for (const std::int32_t body : model.active)
        if (model.bodies[at(body)].movable()) islands_[at(root(body))].gain += cost_of(model, at(body), way[at(body)]);
    for (const std::int32_t body : model.active) {
        if (!model.bodies[at(body)].movable()) continue;
        const Balance& island = islands_[at(root(body))];
        const double budget = island.kinetic + island.most_lift;
        if (!island.grounded && island.gain > budget) shares_[at(body)] = budget / island.gain;
    }
    return shares_;
}

std::span<const std::int32_t> EnergyAccount::overdrawn(const Model& model, std::span<const Vec3> way,
                                                       std::span<const double> lift) {
    overdrawn_.clear();
    const std::span<const double> shares = paid(model, way, lift);
    std::ranges::copy_if(model.active, std::back_inserter(overdrawn_),
                         [&](std::int32_t body) { return shares[at(body)] < 1; });
    return overdrawn_;
}

std::span<const double> EnergyAccount::affordable(const Model& model, std::span<const Pose> pose,
                                                  std::span<const Motion> kept, std::span<const Motion> raised,
                                                  std::span<const double> lift) {
    const double dt = model.settings.time_step;
    shares_.assign(model.size(), 1);
    weigh_islands(model, lift);
    for (const std::int32_t body : model.active) {
        const std::size_t i = at(body);
        if (!model.bodies[i].movable()) continue;
        Balance& island = islands_[at(root(body))];
        // Stage 7 takes away some of what stage 6 adds, and adds nothing.
        const Motion end{kept[i].velocity + 0.5 * dt * acceleration(model, i),
                         kept[i].momentum + 0.5 * dt * turning_torque(model, i)};
        island.work += cost_of(model, i, dt * kept[i].velocity) + kinetic_energy(model, i, pose[i], end);
        island.gain += cost_of(model, i, dt * (raised[i].velocity - kept[i].velocity));
    }
    for (const std::int32_t body : model.active) {
        if (!model.bodies[at(body)].movable()) continue;
        const Balance& island = islands_[at(root(body))];
        const double budget = island.most_lift + std::max(0.0, island.kinetic - island.work);
        if (!island.grounded && island.gain > budget) shares_[at(body)] = budget / island.gain;
    }
    return shares_;
}

std::span<const std::int32_t> EnergyAccount::spent(const Model& model, double share, std::span<const double> lift) {
    overdrawn_.clear();
    weigh_islands(model, lift);
    for (const std::int32_t body : model.active) {
        if (!model.bodies[at(body)].movable()) continue;
        const Balance& island = islands_[at(root(body))];
        if (!island.grounded && island.kinetic + island.most_lift < share * island.lift) overdrawn_.push_back(body);
    }
    return overdrawn_;
}

EnergyCorrections EnergyAccount::settle(Team& team, const Model& model, std::span<const Pose> end,
                                        std::span<Motion> motion, std::span<double> lift) {
    const std::vector<std::int32_t>& active = model.active;
    const auto movable = [&](std::size_t i) { return model.bodies[i].movable(); };
    team.for_each("energy after", active.size(), kGrain, [&](std::size_t k, int) {
        const std::size_t i = at(active[k]);
        islands_[i] = {};
        verdicts_[i] = {};
        if (movable(i)) bodies_[i] = balance(model, i, end[i], motion[i], lift[i]);
    });
    for (const std::int32_t id : active) {
        const std::size_t i = at(id);
        if (!movable(i)) continue;
        const Balance& body = bodies_[i];
        Balance& island = islands_[at(root(id))];
        island.gain += body.gain;
        island.work += work_[i];
        island.kinetic += body.kinetic;
        island.rounding += body.rounding;
        island.mass += body.mass;
        island.momentum += body.momentum;
        island.lift += body.lift;
        island.most_lift += body.most_lift;
        island.grounded = island.grounded || body.grounded;
    }
    EnergyCorrections out;
    for (const std::int32_t i : active)
        if (movable(at(i)) && parent_[at(i)] == i) verdicts_[at(i)] = judge(islands_[at(i)], out);
    for (const std::int32_t id : active) {
        const std::size_t i = at(id);
        if (!movable(i)) continue;
        Verdict& v = verdicts_[at(root(id))];
        // Lift is written down body by body, as far as each has room, and written off in the same order.
        const double room = v.draw > 0 ? std::clamp(v.draw, 0.0, std::max(bodies_[i].most_lift - lift[i], 0.0))
                                       : std::clamp(v.draw, -lift[i], 0.0);
        lift[i] += room + v.debt * bodies_[i].mass;
        v.draw -= room;
        out.lift += lift[i];
        if (v.scale == 1) continue;
        motion[i].velocity = v.center + v.scale * (motion[i].velocity - v.center);
        motion[i].momentum = v.scale * motion[i].momentum;
    }
    return out;
}

} // namespace flotilla
