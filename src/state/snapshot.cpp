// SPDX-License-Identifier: MIT
#include "state/snapshot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <flotilla/error.hpp>

#include "base/byte_stream.hpp"
#include "base/hasher.hpp"
#include "base/index.hpp"
#include "base/vec3.hpp"
#include "scene/description_checks.hpp"
#include "state/feature_pair.hpp"

namespace flotilla {
namespace {

// Arrays are copied as they lie in memory, so none may have padding: those bytes would be anything.
static_assert(sizeof(Pose) == 10 * sizeof(double) && sizeof(Motion) == 6 * sizeof(double));
static_assert(sizeof(Sleep) == 8 && sizeof(RestDistance) == 16 && sizeof(WarmImpulse) == 40);
static_assert(sizeof(SqueezedPair) == 24);
static_assert(sizeof(Searched) == sizeof(Pose) + 8);

constexpr std::uint64_t kMagic = 0x50414e534c464c46; // "FLFLSNAP"
constexpr std::uint64_t kVersion = 7;

void add(Hasher& h, const Mat3& m) {
    for (const double x : m.m) h.add(x);
}

void add(Hasher& h, const RigidShape& shape) {
    h.add(static_cast<std::uint64_t>(shape.mesh.vertices.size()));
    for (const Vec3& x : shape.mesh.vertices) h.add(x);
    for (const Triangle& t : shape.mesh.triangles)
        for (const std::int32_t corner : t) h.add(static_cast<std::uint64_t>(corner));
    h.add(shape.center_of_mass);
    h.add(shape.mass);
    add(h, shape.inertia);
}

void add(Hasher& h, const Body& body) {
    h.add(static_cast<std::uint64_t>(body.shape));
    h.add(static_cast<std::uint64_t>(body.type));
    h.add(body.friction);
    h.add(body.restitution);
    for (const Keyframe& k : body.keyframes) h.add(k.time), h.add(k.position), h.add(k.rotation);
    if (body.locked.any()) h.add(std::uint64_t{body.locked.translation} << 8 | body.locked.rotation);
    if (body.driven()) h.add(body.force), h.add(body.torque);
}

/// What may pass through what.
void add(Hasher& h, const Model& model) {
    for (const auto* list : {&model.filter.groups, &model.filter.bodies}) {
        h.add(static_cast<std::uint64_t>(list->size()));
        for (const auto& [a, b] : *list) h.add(static_cast<std::uint64_t>(a)), h.add(static_cast<std::uint64_t>(b));
    }
    for (const Body& body : model.bodies) h.add(static_cast<std::uint64_t>(body.group));
}

/// The parts of a state in the order of their bytes.
template <typename S, typename Visit>
void visit(S& state, Visit&& part) {
    part(state.step), part(state.time), part(state.pose), part(state.motion), part(state.sleep);
    part(state.script_clock), part(state.lift), part(state.rest_distances), part(state.squeezed);
    for (auto& impulses : state.warm) part(impulses);
    for (auto& impulses : state.waiting) part(impulses);
    part(state.searched), part(state.earlier);
}

/// Of all that a snapshot holds.
std::uint64_t whole_hash(const State& state) {
    const std::uint64_t hash = state_hash(state);
    if (state.earlier.empty()) return hash;
    Hasher h;
    h.add(hash);
    for (const WarmImpulse& w : state.earlier) {
        h.add(static_cast<std::uint64_t>(w.a)), h.add(static_cast<std::uint64_t>(w.b));
        h.add(w.feature_key), h.add(w.impulse);
    }
    return h.value();
}

/// m, m/s, rad/s and N s: far beyond where any run gets, and products of seven such numbers are doubles.
constexpr double kMost = 1e30;

bool within_reach(const Vec3& v) { return max_component(abs(v)) <= kMost && is_finite(v); }

bool sound(const Pose& pose) {
    const Quat& q = pose.rotation;
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return within_reach(pose.com) && within_reach(pose.origin) && std::abs(length - 1) <= kRotationTolerance;
}

bool sound_motion(const State& s, const Model& model, std::size_t i) {
    const Motion& motion = s.motion[i];
    if (!within_reach(motion.velocity) || !within_reach(motion.momentum)) return false;
    return !model.bodies[i].movable() || within_reach(angular_velocity(model, i, s.pose[i].rotation, motion.momentum));
}

/// Pairs of bodies that there are, in order.
template <class T>
bool sound_pairs(const std::vector<T>& list, std::size_t bodies) {
    const auto in_order = [](const T& x, const T& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); };
    return std::is_sorted(list.begin(), list.end(), in_order) && std::all_of(list.begin(), list.end(), [&](const T& x) {
               return x.a >= 0 && x.a < x.b && static_cast<std::size_t>(x.b) < bodies;
           });
}

bool sound_squeezed(const std::vector<SqueezedPair>& list, std::size_t bodies) {
    return sound_pairs(list, bodies) && std::all_of(list.begin(), list.end(), [](const SqueezedPair& s) {
               constexpr std::int32_t kMostSteps = SqueezedPair::kMostWait;
               return s.distance >= 0 && s.distance <= kMost && s.waits >= 0 && s.waits <= kMostSteps &&
                      std::abs(std::int64_t{s.steps}) <= kMostSteps;
           });
}

/// Contacts are searched for at the features that these were found at.
bool sound_impulses(const std::vector<WarmImpulse>& list, const Model& model) {
    const auto shape_of = [&](std::int32_t body) -> const RigidShape& { return model.shape_of(at(body)); };
    return sound_pairs(list, model.size()) && std::all_of(list.begin(), list.end(), [&](const WarmImpulse& w) {
               return within_reach(w.impulse) && is_feature_key(w.feature_key, shape_of(w.a), shape_of(w.b));
           });
}

bool sound_sleep(const Sleep& sleep, const Body& body, std::size_t bodies) {
    const bool awake = sleep.island == -1;
    return sleep.quiet_steps >= 0 &&
           (awake || (body.dynamic() && sleep.island >= 0 && static_cast<std::size_t>(sleep.island) < bodies));
}

static_assert(sizeof(ScriptClock) == 16, "no padding");
bool sound(const ScriptClock& clock) {
    return std::abs(clock.delay) <= kMost && clock.stops >= 0 && clock.stops <= ScriptClock::kMostStops;
}

/// What the hash itself relies on.
bool has_every_body(const State& s, std::size_t n) {
    return s.pose.size() == n && s.motion.size() == n && s.sleep.size() == n && s.script_clock.size() == n &&
           s.lift.size() == n && (s.searched.empty() || s.searched.size() == n);
}

bool sound(const State& s, const Model& model) {
    const std::size_t n = model.size();
    if (s.step < 0 || !(s.time >= 0) || !(s.time <= kMost)) return false;
    for (std::size_t i = 0; i < n; ++i) {
        if (!sound(s.pose[i]) || !sound_motion(s, model, i) || !sound_sleep(s.sleep[i], model.bodies[i], n))
            return false;
        if (!sound(s.script_clock[i]) || !(std::abs(s.lift[i]) <= kMost)) return false;
        if (!s.searched.empty() && !sound(s.searched[i].pose)) return false;
    }
    const auto all_sound = [&](const WarmImpulses& impulses) {
        return std::all_of(impulses.begin(), impulses.end(), [&](const auto& x) { return sound_impulses(x, model); });
    };
    return sound_pairs(s.rest_distances, n) && sound_squeezed(s.squeezed, n) && all_sound(s.warm) &&
           all_sound(s.waiting) && sound_impulses(s.earlier, model) &&
           std::all_of(s.rest_distances.begin(), s.rest_distances.end(),
                       [](const RestDistance& r) { return r.distance >= 0 && std::isfinite(r.distance); });
}

} // namespace

std::uint64_t scene_hash(const Model& model, const State& initial) {
    Hasher h;
    Settings settings = model.settings;
    // The same bits as far as it goes: whoever was stopped by a script may go on and hold the body.
    if (settings.unsatisfiable_script == UnsatisfiableScript::error)
        settings.unsatisfiable_script = UnsatisfiableScript::hold;
    for (const SettingInfo& setting : list_settings())
        for (const char c : setting_value(settings, setting.key)) h.add(static_cast<std::uint64_t>(c));
    h.add(model.gravity);
    for (const RigidShape& shape : model.shapes) add(h, shape);
    for (const Body& body : model.bodies) add(h, body);
    if (!model.filter.empty()) add(h, model);
    h.add(state_hash(initial));
    return h.value();
}

std::vector<std::byte> write_snapshot(const State& state, std::uint64_t scene) {
    ByteWriter out;
    out.add(kMagic), out.add(kVersion), out.add(scene);
    visit(state, [&out](const auto& part) { out.add(part); });
    out.add(whole_hash(state));
    return out.take();
}

void refuse_other_scene() { throw InputError("snapshot of another scene or other settings"); }

State read_snapshot(std::span<const std::byte> bytes, std::uint64_t scene, const Model& model) {
    std::uint64_t magic = 0, version = 0, of_scene = 0;
    if (bytes.size() < 3 * sizeof magic) throw InputError("no snapshot");
    ByteReader in(bytes, [] { throw InputError("damaged snapshot: its arrays do not fit its size"); });
    in.read(magic), in.read(version), in.read(of_scene);
    if (magic != kMagic) throw InputError("no snapshot");
    if (version != kVersion) throw InputError("snapshot of another version of flotilla");
    if (of_scene != scene) refuse_other_scene();
    State state;
    visit(state, [&in](auto& part) { in.read(part); });
    std::uint64_t hash = 0;
    in.read(hash);
    if (!in.rest().empty()) throw InputError("damaged snapshot: its arrays do not fit its size");
    if (!has_every_body(state, model.size())) throw InputError("damaged snapshot: its arrays do not fit the scene");
    if (hash != whole_hash(state)) throw InputError("damaged snapshot: its content does not match its hash");
    if (!sound(state, model)) throw InputError("damaged snapshot: its content is no state of the scene");
    return state;
}

} // namespace flotilla
