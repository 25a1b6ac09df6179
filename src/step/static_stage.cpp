// SPDX-License-Identifier: MIT
#include "step/static_stage.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numbers>
#include <tuple>

#include "base/index.hpp"
#include "base/rotation.hpp"
#include "base/search.hpp"
#include "parallel/compact.hpp"
#include "state/loads.hpp"
#include "state/locked_rotation.hpp"
#include "step/rolling.hpp"

namespace flotilla {
namespace {

/// Appends the features to `out` that were in contact in the last step, of a pair that is near enough to where they
/// were searched for. Which pairs are is a pure function of State: their features are those of its impulses.
void list_known_features(const StepData& data, const PairRecord& record, std::int64_t step,
                         std::vector<FeaturePair>& out) {
    const std::vector<Searched>& searched = data.state.searched;
    if (searched.empty() || searched[at(record.a)].step == step || searched[at(record.b)].step == step) return;
    const std::vector<double>& stray = data.lists.stray;
    if (!(stray[at(record.a)] + stray[at(record.b)] < data.model.settings.contact_reuse * record.lengths.rest)) return;
    const CandidatePair pair{record.a, record.b};
    const auto of = [](const WarmImpulse& w) { return CandidatePair{w.a, w.b}; };
    for (const auto* impulses : {&data.state.warm_final, &data.state.waiting_final}) {
        auto w = std::ranges::lower_bound(*impulses, pair, {}, of);
        for (; w != impulses->end() && of(*w) == pair; ++w) out.push_back(features_of(w->feature_key));
    }
}

void append_pair(const StepData& data, Worker& worker, const ListedPair& listed, std::int64_t step, ContactSet& out) {
    const CandidatePair& pair = listed.pair;
    PairRecord& record = *listed.record;
    if (far_by_bounds(data, record) || far_by_plane(data, record)) return;
    const BodyMotion a = data.trajectories.at_end(at(pair.a)), b = data.trajectories.at_end(at(pair.b));
    const double proximity = record.lengths.proximity;
    worker.points.clear();
    worker.features.clear();
    list_known_features(data, record, step, worker.features);
    double nearest = 0;
    if (!worker.features.empty() && renew_contact_points(a, b, proximity, worker.features, nearest, worker.points)) {
        out.min_distance = std::min(out.min_distance, nearest);
        record_renewed_distance(data, record, nearest);
    } else {
        const CoveringList list = kept_candidates(data, worker, record);
        const auto result = find_contact_points(a, b, proximity, data.angle_cos, list, worker.proximity, worker.points);
        if (result.near) out.min_distance = std::min(out.min_distance, result.distance);
        record_distance(data, record, result, list);
    }
    for (const ProximityPoint& p : worker.points)
        out.add(contact_of(pair.a, pair.b, p, pair_friction(data.model, pair.a, pair.b)), record.lengths.rest,
                record.processed, false);
}

constexpr std::size_t kContactGrain = 256, kBodyGrain = 64; // items of a task

/// A feature pair without its face. The face nearest to a vertex changes as the vertex slides, and between faces of
/// equal distance by rounding; what presses on the vertex stays.
std::uint64_t without_face(std::uint64_t feature_key) {
    constexpr std::uint64_t kIndex = (std::uint64_t{1} << 31) - 1;
    switch (static_cast<FeatureKind>(feature_key >> 62)) {
    case FeatureKind::vertex_face: return feature_key & ~kIndex;
    case FeatureKind::face_vertex: return feature_key & ~(kIndex << 31);
    case FeatureKind::edge_edge: break;
    }
    return feature_key;
}

/// Of a Contact or a WarmImpulse.
template <class Item>
auto group_key(const Item& x) {
    return std::tuple(x.a, x.b, without_face(x.feature_key));
}
constexpr auto kByGroup = [](const auto& x, const auto& y) { return group_key(x) < group_key(y); };

/// The impulse of the same feature pair; failing that, the only one of the same vertex. `guess`: about where it is.
const WarmImpulse* find_warm(std::span<const WarmImpulse> warm, const Contact& contact, std::size_t guess) {
    const auto same = [&](const WarmImpulse& w) {
        return w.feature_key == contact.feature_key && w.a == contact.a && w.b == contact.b;
    };
    if (guess < warm.size() && same(warm[guess]) && (guess == 0 || !same(warm[guess - 1]))) return &warm[guess];
    const auto first = warm.begin() + static_cast<std::ptrdiff_t>(lower_bound_near(warm, guess, contact, kByGroup));
    auto w = first;
    for (; w != warm.end() && group_key(*w) == group_key(contact); ++w)
        if (w->feature_key == contact.feature_key) return &*w;
    return w - first == 1 ? &*first : nullptr;
}

/// What this stage knows of a contact from the step before; of a contact that is new to it, what the other stage knows.
void load_warm(Team* team, const std::vector<Contact>& contacts, std::span<const WarmImpulse> own,
               std::span<const WarmImpulse> other, double other_factor, std::vector<Vec3>& impulses) {
    impulses.resize(contacts.size());
    for_each(team, "warm start", contacts.size(), kContactGrain, [&](std::size_t i) {
        impulses[i] = {};
        // Few contacts come and go in a step, so the list of the last one is nearly this one.
        if (const WarmImpulse* w = find_warm(own, contacts[i], i))
            impulses[i] = w->impulse;
        else if (const WarmImpulse* v = find_warm(other, contacts[i], i))
            impulses[i] = other_factor * v->impulse;
    });
}

/// Also where a shock pass went over the velocities: these are still the impulses of projected Gauss-Seidel, and with
/// them the next solve goes on where this one had to stop. Open contacts are stored too: they are not new. `left_out`:
/// contacts that are not, as flags; may be empty.
void store_warm(Team* team, StaticStageScratch& scratch, std::span<const std::uint8_t> left_out,
                std::vector<WarmImpulse>& warm) {
    const auto& contacts = scratch.selected;
    std::vector<std::int32_t>& stored = scratch.stored;
    stored.clear();
    for (std::size_t i = 0; i < contacts.size(); ++i)
        if (left_out.empty() || left_out[i] == 0) stored.push_back(static_cast<std::int32_t>(i));
    warm.resize(stored.size());
    for_each(team, "store warm impulses", stored.size(), kContactGrain, [&](std::size_t i) {
        const Contact& c = contacts[at(stored[i])];
        warm[i] = {c.a, c.b, c.feature_key, scratch.impulses[at(stored[i])]};
    });
    // Contacts come pair by pair: what is left to sort are those of one pair, by the contact that begins it.
    const auto same_pair = [&](std::size_t i, std::size_t j) {
        const Contact &p = contacts[at(stored[i])], &q = contacts[at(stored[j])];
        return p.a == q.a && p.b == q.b;
    };
    for_each(team, "sort warm impulses", warm.size(), kContactGrain, [&](std::size_t i) {
        if (i > 0 && same_pair(i - 1, i)) return;
        std::size_t end = i + 1;
        while (end < warm.size() && same_pair(i, end)) ++end;
        std::sort(warm.begin() + static_cast<std::ptrdiff_t>(i), warm.begin() + static_cast<std::ptrdiff_t>(end),
                  [](const WarmImpulse& x, const WarmImpulse& y) {
                      return std::tuple(group_key(x), x.feature_key) < std::tuple(group_key(y), y.feature_key);
                  });
    });
}

} // namespace

Contact contact_of(std::int32_t a, std::int32_t b, const ProximityPoint& p, double friction) {
    const Vec3 point = p.features.kind == FeatureKind::face_vertex ? p.b : p.a;
    return {a, b, point, p.normal, p.distance, 0, friction, feature_key(p.features)};
}

void ContactSet::add(const Contact& contact, double rest_distance, bool was_processed, bool is_ahead) {
    contacts.push_back(contact);
    rest.push_back(rest_distance);
    processed.push_back(was_processed ? 1 : 0);
    ahead.push_back(is_ahead ? 1 : 0);
}

void ContactSet::clear() {
    contacts.clear();
    rest.clear();
    processed.clear();
    ahead.clear();
    min_distance = std::numeric_limits<double>::infinity();
}

void ContactSet::resize(std::size_t size) {
    contacts.resize(size);
    rest.resize(size);
    processed.resize(size);
    ahead.resize(size);
}

void ContactSet::put(std::size_t place, const ContactSet& part) {
    const auto to = static_cast<std::ptrdiff_t>(place);
    std::copy(part.contacts.begin(), part.contacts.end(), contacts.begin() + to);
    std::copy(part.rest.begin(), part.rest.end(), rest.begin() + to);
    std::copy(part.processed.begin(), part.processed.end(), processed.begin() + to);
    std::copy(part.ahead.begin(), part.ahead.end(), ahead.begin() + to);
}

void ContactSet::append(const ContactSet& part, std::size_t begin, std::size_t end) {
    const auto copy = [&](const auto& from, auto& to) {
        const auto at_place = [&](std::size_t i) { return from.begin() + static_cast<std::ptrdiff_t>(i); };
        to.insert(to.end(), at_place(begin), at_place(end));
    };
    copy(part.contacts, contacts);
    copy(part.rest, rest);
    copy(part.processed, processed);
    copy(part.ahead, ahead);
}

void ContactSet::list_pairs(std::vector<CandidatePair>& out) const {
    out.clear();
    for (std::size_t i = 0; i < size(); ++i) {
        const CandidatePair pair{contacts[i].a, contacts[i].b};
        if (ahead[i] == 0 && (out.empty() || !(out.back() == pair))) out.push_back(pair);
    }
}

void ContactSet::mark_processed(std::span<const CandidatePair> pairs) {
    auto pair = pairs.begin();
    for (std::size_t i = 0; i < size(); ++i) {
        const CandidatePair of_contact{contacts[i].a, contacts[i].b};
        while (pair != pairs.end() && *pair < of_contact) ++pair;
        if (pair != pairs.end() && *pair == of_contact) processed[i] = 1;
    }
}

void ContactSet::merge(const ContactSet& others) {
    if (others.size() == 0) return;
    ContactSet own = std::exchange(*this, {});
    near = std::move(own.near), keeps_near = own.keeps_near, min_distance = own.min_distance, counters = own.counters;
    const auto pair_of = [](const ContactSet& set, std::size_t i) {
        return CandidatePair{set.contacts[i].a, set.contacts[i].b};
    };
    std::size_t i = 0;
    for (std::size_t k = 0; k < others.size(); ++k) {
        const std::size_t first = i;
        while (i < own.size() && pair_of(own, i) < pair_of(others, k)) ++i;
        append(own, first, i);
        append(others, k, k + 1);
    }
    append(own, i, own.size());
}

namespace {

/// The contacts of the pairs.
void search(StepData& data, const std::vector<ListedPair>& pairs, std::int64_t step, ContactSearchScratch& scratch,
            ContactSet& out) {
    constexpr std::size_t kGrain = 16;
    const std::size_t chunks = (pairs.size() + kGrain - 1) / kGrain;
    scratch.parts.resize(std::max(scratch.parts.size(), chunks));
    for (const auto& worker : data.workers) worker->proximity.counters = {}; // stage 1 counts as well
    data.team.for_chunks("contact points", pairs.size(), kGrain, [&](std::size_t begin, std::size_t end, int thread) {
        ContactSet& part = scratch.parts[begin / kGrain];
        part.clear();
        for (std::size_t i = begin; i < end; ++i) append_pair(data, data.worker(thread), pairs[i], step, part);
    });
    const std::span<const ContactSet> parts(scratch.parts.data(), chunks);
    const auto put = [&](std::size_t place, const ContactSet& part) { out.put(place, part); };
    gather_parts({&data.team, "gather contacts", kGrain, scratch.places}, parts, out, put);
    out.min_distance = std::numeric_limits<double>::infinity();
    for (const ContactSet& part : parts) out.min_distance = std::min(out.min_distance, part.min_distance);
    out.counters = {};
    for (const auto& worker : data.workers) out.counters += worker->proximity.counters;
}

void list_near(const std::vector<ListedPair>& pairs, ContactSet& out) {
    out.near.clear();
    if (out.keeps_near)
        for (const ListedPair& pair : pairs) out.near.push_back(pair.pair);
}

} // namespace

void find_contacts(StepData& data, std::int64_t step, ContactSearchScratch& scratch, ContactSet& out) {
    const std::vector<ListedPair>& pairs = end_pairs(data);
    list_near(pairs, out);
    search(data, pairs, step, scratch, out);
}

void find_contacts_of(StepData& data, std::int64_t step, const std::function<bool(const CandidatePair&)>& wanted,
                      ContactSearchScratch& scratch, ContactSet& out) {
    const std::vector<ListedPair>& pairs = end_pairs(data);
    list_near(pairs, out);
    std::vector<ListedPair> some;
    std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(some),
                 [&](const ListedPair& p) { return wanted(p.pair); });
    search(data, some, step, scratch, out);
}

void VelocityArrays::load(Team* team, const Model& model, std::uint64_t version, std::span<const Pose> poses,
                          std::span<const Motion> motion) {
    const std::size_t n = model.size();
    position.resize(n);
    velocity.resize(n);
    angular_velocity.resize(n);
    inverse_mass.resize(n);
    inverse_inertia.resize(n);
    inertia.resize(n);
    locked.resize(n);
    const bool all = std::exchange(still_version, version) != version;
    for_each(team, "load velocities", all ? n : model.active.size(), kBodyGrain, [&](std::size_t k) {
        const std::size_t i = all ? k : at(model.active[k]);
        const RigidShape& shape = model.shape_of(i);
        const bool movable = model.bodies[i].movable();
        position[i] = poses[i].com;
        velocity[i] = motion[i].velocity;
        inverse_mass[i] = movable ? model.bodies[i].inverse_mass : 0.0;
        const AxisLocks locks = model.bodies[i].locked;
        const WorldInertia world = movable ? world_inertia(shape, locks.rotation, poses[i].rotation) : WorldInertia{};
        inverse_inertia[i] = world.inverse;
        inertia[i] = locks.rotation == 0 ? world.tensor : free_block(locks.rotation, world.tensor);
        locked[i] = movable ? locks.translation : AxisMask{0};
        angular_velocity[i] = movable ? inverse_inertia[i] * motion[i].momentum : motion[i].momentum;
    });
}

void VelocityArrays::store(Team* team, const Model& model, std::span<const Vec3> angular_before,
                           std::span<Motion> motion) const {
    for_each(team, "store velocities", model.active.size(), kBodyGrain, [&](std::size_t k) {
        const std::size_t i = at(model.active[k]);
        if (!model.bodies[i].movable()) return;
        motion[i].velocity = velocity[i];
        if (angular_velocity[i] != angular_before[i])
            motion[i].momentum += inertia[i] * (angular_velocity[i] - angular_before[i]);
    });
}

// The dead band of equation 16, m/s: targets within it are zero, others lose it. A target below the tolerance asks for
// less than a solve may leave undone, and would cost many sweeps: bodies that touch at many points cannot approach each
// other a little at some of them and not at others, and contacts that hold more than the tiny target allows hand their
// load to the others so slowly that the sweeps never end. So a contact within tolerance * time step of its rest
// distance (8 um at the defaults) is at rest, and a farther one may come that near. The band is at most a share of the
// rest distance, which scales with the bodies: what keeps small ones off each other must not be lost. A rolling body is
// not at rest: the side that lands next would brake it from where the band begins, so a tolerance above the default one
// (Settings::tolerance_share) widens no band there.
double rest_band(double rest, double time_step, double tolerance, const ContactTuning& tuning) {
    return std::min(tolerance, tuning.most_of_rest * rest / time_step);
}

double equation_16(double gap, double time_step, double band) { // gap: to the rest distance, m
    const double target = gap / time_step;
    return target > 0 ? std::max(target - band, 0.0) : std::min(target + band, 0.0);
}

/// Velocities of the last step, and of bodies whose motion is prescribed those of this one.
void load_last_velocities(const Model& model, std::span<const Motion> motion, const StaticStageOptions& options,
                          StaticStageScratch& scratch) {
    scratch.last_velocity.resize(model.size());
    scratch.last_angular_velocity.resize(model.size());
    for_each(options.team, "last velocities", model.size(), kBodyGrain, [&](std::size_t i) {
        const bool movable = model.bodies[i].movable();
        const Motion& m = movable ? options.last_motion[i] : motion[i];
        scratch.last_velocity[i] = m.velocity;
        scratch.last_angular_velocity[i] = movable ? scratch.bodies.inverse_inertia[i] * m.momentum : m.momentum;
    });
}

/// A friction pyramid of random direction holds more along its diagonals than along its sides. Drawn anew in every step
/// it therefore cuts the friction of contacts that stick, a different part of them each time, and the sweeps of a pile
/// at rest do little but hand their load to others. What the paper's random tangents are for, that no direction is
/// preferred, needs new ones in every step only where bodies slide. So contacts keep theirs that slid by less than a
/// tenth of what gravity adds in a step, nor more than the rest distance in a step.
bool sticks(const Contact& c, double rest, double most_slip, double time_step, const StaticStageScratch& s) {
    const auto point_velocity = [&](std::int32_t body) {
        return s.last_velocity[at(body)] +
               cross(s.last_angular_velocity[at(body)], c.point - s.bodies.position[at(body)]);
    };
    const Vec3 v = point_velocity(c.b) - point_velocity(c.a);
    const double limit = std::min(most_slip, rest / time_step);
    return length_sq(v - dot(v, c.normal) * c.normal) < limit * limit;
}

/// m/s, for a contact of the rest distance `rest` (Settings::static_tolerance).
double tolerance_of(const Model& model, const Contact& c, double rest, const ContactTuning& tuning) {
    const Settings& s = model.settings;
    if (s.static_tolerance >= 0) return s.static_tolerance;
    const double moves = tuning.of_rest * rest / s.time_step;
    double gravity = length(model.gravity) * s.time_step;
    if (!(gravity > 0)) gravity = most_acceleration(model, c.a, c.b) * s.time_step;
    return s.tolerance_share * (gravity > 0 ? std::min(moves, tuning.of_gravity * gravity) : moves);
}

/// Arcs of the contacts of one pair. Whether one of its bodies rolls over the other: by more than `still` in the step,
/// m; then those within `band` of the lowest carry.
bool arcs_of_pair(const Model& model, std::span<const Contact> pair, double still, double band, double angle_cos,
                  const VelocityArrays& bodies, std::span<ArcContact> arcs) {
    const double dt = model.settings.time_step;
    const Contact& c = pair.front();
    const auto point = [&](const Contact& x, std::int32_t body) {
        return TurningPoint{bodies.angular_velocity[at(body)], x.point - bodies.position[at(body)]};
    };
    for (std::size_t i = 0; i < pair.size(); ++i)
        arcs[i] = meet_on_arcs(point(pair[i], c.a), point(pair[i], c.b), pair[i].normal, dt);
    const auto lower = [](const Contact& x, const Contact& y) { return x.distance < y.distance; };
    const auto lowest = static_cast<std::size_t>(std::min_element(pair.begin(), pair.end(), lower) - pair.begin());
    if (!(arcs[lowest].apart > 0)) return false;
    const Vec3& n = pair[lowest].normal;
    const TurningPoint a = point(pair[lowest], c.a), b = point(pair[lowest], c.b);
    const TurningPoint& roller = 2 * dot(n, arc_acceleration(b.omega, b.arm)) >= arcs[lowest].apart ? b : a;
    const Vec3 way = cross(roller.omega, roller.arm), along = way - dot(way, n) * n;
    const double speed = length(along);
    // What moves less than static contact leaves undone does not roll.
    if (!(speed * dt > still)) return false;
    share_load(pair, lowest,
               {b.omega - a.omega, along / speed, speed, length(roller.arm), most_acceleration(model, c.a, c.b), dt,
                band, angle_cos},
               arcs);
    return true;
}

/// rad/s, without what the body's own torque added in the step.
Vec3 turn_before(const Model& model, const VelocityArrays& bodies, std::int32_t body) {
    const Vec3& omega = bodies.angular_velocity[at(body)];
    const Vec3 torque = turning_torque(model, at(body));
    return torque == Vec3{} ? omega : omega - model.settings.time_step * (bodies.inverse_inertia[at(body)] * torque);
}

/// m/s, by body (ContactBodies::rest_speed); none where no body that moves has loads of its own.
void list_rest_speeds(const Model& model, const ContactTuning& tuning, std::vector<double>& speed) {
    speed.clear();
    const auto driven = [&](std::int32_t i) { return model.bodies[at(i)].driven(); };
    if (std::none_of(model.active.begin(), model.active.end(), driven)) return;
    speed.assign(model.size(), 0);
    for (const std::int32_t i : model.active)
        if (driven(i)) speed[at(i)] = tuning.rest_speed * most_acceleration(model, at(i)) * model.settings.time_step;
}

/// The approach, m/s, that a pair which stage 1 has not seen takes into the next step. Stage 5 may have kept the bodies
/// from moving as far as their velocities say, which count the whole acceleration of the step: a body that is held up
/// would go on accelerating. What they keep is the approach that they began the step with and what gravity adds on the
/// way that they really made.
double kept_approach(const Model& model, const Contact& c, std::span<const Pose> start, std::span<const Pose> end,
                     const VelocityArrays& bodies) {
    const auto gained = [&](std::int32_t body) {
        return bodies.inverse_mass[at(body)] > 0 ? acceleration(model, at(body)) : Vec3{};
    };
    const auto before = [&](std::int32_t body) {
        const Vec3 added = model.settings.time_step * gained(body);
        return (bodies.velocity[at(body)] - added) +
               cross(turn_before(model, bodies, body), c.point - bodies.position[at(body)]);
    };
    const auto start_of = [&](std::int32_t body) { // of the body's point that is at the contact now
        const Pose &from = start[at(body)], &to = end[at(body)];
        return from.com + rotate(from.rotation * conjugate(to.rotation), c.point - to.com);
    };
    const double approach = std::max(0.0, -dot(c.normal, before(c.b) - before(c.a)));
    const double way = std::max(0.0, dot(c.normal, start_of(c.b) - start_of(c.a)));
    const double pull = std::max({std::abs(dot(c.normal, model.gravity)), std::abs(dot(c.normal, gained(c.a))),
                                  std::abs(dot(c.normal, gained(c.b)))});
    return std::sqrt(approach * approach + 2 * pull * way);
}

/// The contacts that the stage acts on, with its targets.
void select_contacts(const Model& model, const ContactSet& set, std::span<const Pose> poses,
                     std::span<const Motion> motion, const StaticStageOptions& options, StaticStageScratch& scratch) {
    const Settings& s = model.settings;
    const double most_slip = options.tuning.most_slip * length(model.gravity) * s.time_step;
    const bool random = s.tangents == Tangents::random;
    if (random) load_last_velocities(model, motion, options, scratch);
    const double angle_cos = sin_cos(s.proximity_angle * std::numbers::pi / 180).cos;
    const auto complete = [&](std::size_t i, double band) {
        Contact& c = scratch.selected[i];
        const ArcContact& arcs = scratch.arcs[i];
        const double full = equation_16(set.rest[i] - (c.distance - arcs.closer), s.time_step, band) + arcs.approach;
        // Arcs that bring points together do so by the end of the step. More than the rest distance is not to be lost
        // there.
        const double together = std::clamp(-0.5 * s.time_step * arcs.apart, 0.0, set.rest[i] / s.time_step);
        const bool stays_level = !options.level.empty() && (options.level[at(c.a)] != 0 || options.level[at(c.b)] != 0);
        c.target = options.final_stage || stays_level ? std::min(0.0, full) : full + together;
        if (options.keep_approach && set.processed[i] == 0)
            c.target = std::min(c.target, -kept_approach(model, c, options.start, poses, scratch.bodies));
        c.point += arcs.shift;
        c.sticks = random && sticks(c, set.rest[i], most_slip, s.time_step, scratch);
    };
    const auto same_pair = [&](std::size_t i, std::size_t j) {
        return set.contacts[i].a == set.contacts[j].a && set.contacts[i].b == set.contacts[j].b;
    };
    scratch.selected.resize(set.size());
    scratch.arcs.resize(set.size());
    for_each(options.team, "select contacts", set.size(), kContactGrain, [&](std::size_t i) {
        if (i > 0 && same_pair(i - 1, i)) return;
        std::size_t end = i;
        for (; end < set.size() && same_pair(i, end); ++end) {
            scratch.selected[end] = set.contacts[end];
            scratch.selected[end].tolerance = tolerance_of(model, set.contacts[end], set.rest[end], options.tuning);
        }
        const auto band = [&](std::size_t j, double widened) {
            return rest_band(set.rest[j], s.time_step, scratch.selected[j].tolerance / widened, options.tuning);
        };
        const double share = std::max(1.0, s.tolerance_share);
        const bool rolls = arcs_of_pair(model, std::span(scratch.selected).subspan(i, end - i),
                                        s.time_step * band(i, 1), s.time_step * band(i, share), angle_cos,
                                        scratch.bodies, std::span(scratch.arcs).subspan(i, end - i));
        for (std::size_t j = i; j < end; ++j) complete(j, band(j, rolls ? share : 1));
    });
}

StaticStageStats solve_static_contact(const Model& model, const ContactSet& set, std::span<const Pose> poses,
                                      std::span<Motion> motion, std::vector<WarmImpulse>& warm,
                                      std::span<const WarmImpulse> other, const StaticStageOptions& options,
                                      StaticStageScratch& scratch) {
    const Settings& s = model.settings;
    VelocityArrays& b = scratch.bodies;
    b.load(options.team, model, options.still_version, poses, motion);
    select_contacts(model, set, poses, motion, options, scratch);
    load_warm(options.team, scratch.selected, warm, other, options.warm_factor, scratch.impulses);
    scratch.angular_before.resize(model.size());
    for (const std::int32_t i : model.active) scratch.angular_before[at(i)] = b.angular_velocity[at(i)];
    const ContactTuning& tuning = options.tuning;
    list_rest_speeds(model, tuning, b.rest_speed);
    ContactSolveOptions solve;
    solve.tuning = tuning;
    solve.normal_rows = options.normal_rows;
    solve.iterations = s.static_iterations;
    solve.tolerance = std::numeric_limits<double>::infinity(); // that of the contacts
    solve.warm_start = s.warm_start;
    // A tolerance that was asked for is meant: then nothing but the limit of sweeps ends a solve above it.
    const bool given = s.static_tolerance >= 0 || s.tolerance_share < 1;
    if (!given) solve.patience = std::max(tuning.patience, s.static_iterations / tuning.patience_share);
    solve.rest_speed = tuning.rest_speed * length(model.gravity) * s.time_step;
    solve.exact = s.contact_solver != ContactSolver::pgs;
    solve.exact_few = s.contact_solver == ContactSolver::exact_few;
    solve.shock = s.shock_propagation;
    solve.tangents = s.tangents;
    solve.seed = s.seed;
    solve.team = options.team;
    solve.step = 2 * static_cast<std::uint64_t>(options.step) + (options.final_stage ? 1 : 0);
    const ContactSolveStats stats = solve_contacts(
        scratch.selected,
        {b.position, b.velocity, b.angular_velocity, b.inverse_mass, b.inverse_inertia, b.locked, b.rest_speed}, solve,
        scratch.impulses, scratch.solver);
    b.store(options.team, model, scratch.angular_before, motion);
    // The impulses of stage 7 in State are those of the contacts at its poses, whose features the next step may reuse.
    store_warm(options.team, scratch,
               options.final_stage ? std::span<const std::uint8_t>(set.ahead) : std::span<const std::uint8_t>(), warm);
    return {stats, static_cast<std::int64_t>(scratch.selected.size())};
}

} // namespace flotilla
