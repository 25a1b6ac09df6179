// SPDX-License-Identifier: MIT
#include "step/look_ahead.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/index.hpp"
#include "base/rotation.hpp"
#include "pair/impulses.hpp"
#include "state/loads.hpp"

namespace flotilla {
namespace {

constexpr double kMostTurn = 1; // rad: what turns farther is not where its velocity points
/// Of the rest distance: several times what a solve may leave undone (Settings::static_tolerance).
constexpr double kUndone = 1.0 / 256;

struct Reach {
    double distance = 0, angle = 0; ///< m, rad
};

double proximity_angle(const Model& model) { return model.settings.proximity_angle * std::numbers::pi / 180; }

/// What gravity and loads of its own alone may do to a body from rest in one step. It turns a body most that is held at
/// its radius of gyration k to the side of the centre of mass, by g dt^2 / (4 k).
Reach reach_of_gravity(const Model& model, std::size_t i) {
    const double dt = model.settings.time_step;
    const Vec3& inverse = model.shape_of(i).principal.inverse;
    const double gyration = 1 / std::sqrt(model.bodies[i].mass * std::max({inverse.x, inverse.y, inverse.z}));
    return {fall_in_step(model, i), std::min(0.25 * most_acceleration(model, i) * dt * dt / gyration, kMostTurn)};
}

/// How far two bodies move and turn against each other at most, m and rad a second.
Reach speeds_of(const Model& model, const VelocityArrays& v, std::int32_t a, std::int32_t b) {
    const double turn_a = length(v.angular_velocity[at(a)]), turn_b = length(v.angular_velocity[at(b)]);
    return {length(v.velocity[at(b)] - v.velocity[at(a)]) + turn_a * model.shape_of(at(a)).radius +
                turn_b * model.shape_of(at(b)).radius,
            turn_a + turn_b};
}

/// No more than both gravity and the velocities may do.
Reach reach_of(const Model& model, const PairRecord& pair, const Reach& ways) {
    Reach gravity;
    double size = std::numeric_limits<double>::infinity();
    for (const std::int32_t i : {pair.a, pair.b}) {
        if (!model.bodies[at(i)].movable()) continue;
        const Reach own = reach_of_gravity(model, at(i));
        gravity = {std::max(gravity.distance, own.distance), std::max(gravity.angle, own.angle)};
        size = std::min(size, model.bodies[at(i)].size);
    }
    return {std::min({gravity.distance, size, pair.lengths.rest + ways.distance}), std::min(gravity.angle, ways.angle)};
}

/// The pairs to be searched. Those near each other and the contacts are both sorted.
void list_pairs(const StepView& view, const PairTable& pairs, const VelocityArrays& v, const ContactSet& set,
                std::vector<LookAheadScratch::Pair>& out) {
    const double least_angle = proximity_angle(view.model);
    const auto pair_of = [&](std::size_t i) { return CandidatePair{set.contacts[i].a, set.contacts[i].b}; };
    out.clear();
    std::size_t end = 0;
    for (const CandidatePair& c : set.near) {
        std::size_t i = end;
        while (i < set.size() && pair_of(i) < c) ++i;
        end = i;
        while (end < set.size() && pair_of(end) == c) ++end;
        if (!view.model.bodies[at(c.a)].movable() && !view.model.bodies[at(c.b)].movable()) continue; // asleep
        const PairRecord* const pair = pairs.find(c.a, c.b);
        if (pair == nullptr) continue;
        const Reach speeds = speeds_of(view.model, v, c.a, c.b);
        const double time = speeds.angle * view.dt > kMostTurn ? kMostTurn / speeds.angle : view.dt;
        const Reach reach = reach_of(view.model, *pair, {time * speeds.distance, time * speeds.angle});
        if (!(reach.distance > pair->lengths.proximity || reach.angle > least_angle)) continue;
        out.push_back({pair, i, end, std::max(reach.distance, pair->lengths.proximity),
                       sin_cos(std::max(reach.angle, least_angle)).cos, time});
    }
}

void look(const StepView& view, Worker& worker, const SolvedAt& solved, const ContactSet& set,
          const LookAheadScratch::Pair& pair, ContactSet& out) {
    const std::span<const Contact> known = std::span(set.contacts).subspan(pair.begin, pair.end - pair.begin);
    const PairRecord& record = *pair.record;
    const double rest = record.lengths.rest, friction = pair_friction(view.model, record.a, record.b);
    const auto body = [&](std::int32_t i) {
        return solved.poses == StepEnd::start ? view.trajectories.at_start(at(i)) : view.trajectories.at_end(at(i));
    };
    const VelocityArrays& v = solved.velocities;
    const auto ways = [&](std::int32_t i) {
        return PointWays{v.position[at(i)], pair.time * v.velocity[at(i)], pair.time * v.angular_velocity[at(i)]};
    };
    const auto nearest = std::ranges::min_element(known, {}, &Contact::distance);
    worker.points.clear();
    find_passing_points(body(record.a), body(record.b),
                        {.a = ways(record.a),
                         .b = ways(record.b),
                         .rest = (1 - kUndone) * rest,
                         .across = nearest != known.end() ? nearest->normal : Vec3{}},
                        pair.distance, pair.angle_cos, worker.proximity, worker.points);
    out.clear();
    for (const ProximityPoint& p : worker.points) {
        const Contact found = contact_of(record.a, record.b, p, friction);
        const auto same = [&](const Contact& c) { return c.feature_key == found.feature_key; };
        if (std::none_of(known.begin(), known.end(), same)) out.add(found, rest, false, true);
    }
}

} // namespace

bool may_look_ahead(const Model& model) {
    for (std::size_t i = 0; i < model.size(); ++i)
        if (may_look_ahead(model, i)) return true;
    return false;
}

bool may_look_ahead(const Model& model, std::size_t body) {
    if (!model.bodies[body].dynamic()) return false;
    const Reach reach = reach_of_gravity(model, body);
    return reach.distance > body_lengths(model, body).proximity || reach.angle > proximity_angle(model);
}

bool add_contacts_ahead(const StepView& view, const PairTable& pairs, Workers& workers, const SolvedAt& solved,
                        LookAheadScratch& scratch, ContactSet& set) {
    constexpr std::size_t kGrain = 4;
    list_pairs(view, pairs, solved.velocities, set, scratch.pairs);
    if (scratch.found.size() < scratch.pairs.size()) scratch.found.resize(scratch.pairs.size());
    workers.team.for_each("contacts ahead", scratch.pairs.size(), kGrain, [&](std::size_t i, int thread) {
        look(view, workers[thread], solved, set, scratch.pairs[i], scratch.found[i]);
    });
    ContactSet& merged = scratch.merged;
    merged.clear();
    std::size_t done = 0;
    bool found = false;
    for (std::size_t i = 0; i < scratch.pairs.size(); ++i) {
        if (scratch.found[i].size() == 0) continue;
        merged.append(set, done, scratch.pairs[i].end);
        done = scratch.pairs[i].end;
        found = true;
        merged.append(scratch.found[i], 0, scratch.found[i].size());
    }
    if (!found) return false;
    merged.append(set, done, set.size());
    merged.min_distance = set.min_distance;
    merged.counters = set.counters;
    merged.near = set.near;
    merged.keeps_near = set.keeps_near;
    std::swap(set, merged);
    return true;
}

} // namespace flotilla
