// SPDX-License-Identifier: MIT
#include "state/trajectories.hpp"

#include "base/rotation.hpp"
#include "mesh/placement.hpp"

namespace flotilla {
namespace {

// Allowance for the rounding of a turning path, in parts of its lengths. u = 2^-53, M the largest coordinate, l the
// largest distance of a vertex from the mesh's origin or the centre of mass, w the turn. The centre's interpolation
// errs by 4 u M; the angle t |w| is known to 2 u |w|, the quaternion of the turn, its product with q0 and the matrix to
// 40 u more, all times l; the sums that place a vertex err by 4 u (M + l). The committed end misses R(w) q0 by the
// rounding of w, 16 u (1 + |w|) l, and coordinates have three components. Together below 200 u (M + l (1 + |w|)).
constexpr double kPathRounding = 0x1p-45; // 256 u

} // namespace

Pose BodyMotion::pose(double t) const {
    const Vec3 com = at0.pose->com + t * (at1.pose->com - at0.pose->com);
    const Quat& start = at0.pose->rotation;
    return make_pose(*shape, com, straight() ? start : normalized(rotation_from_vector(t * turn) * start));
}

// A vertex at distance r from the centre has an acceleration of r |turn|^2 against the straight line, so it leaves the
// chord of a part of length h by at most r (|turn| h)^2 / 8 (the arc's own height, r (1 - cos(|turn| h / 2)), is barely
// less). Nor can it be farther than 2 r from a convex combination of its places, for all are within r of the centre.
double BodyMotion::arc_gap(int segments) const {
    if (straight()) return 0;
    const double whole = length(turn), angle = whole / segments,
                 reach = shape->radius + 2 * length(shape->center_of_mass);
    const double rounding = kPathRounding * (max_abs() + reach * (1 + whole));
    return 1.0001 * shape->radius * std::min(0.125 * angle * angle, 2.0) + rounding;
}

Box BodyMotion::swept() const {
    const Box ends = merged(*at0.box, *at1.box);
    if (straight()) return ends;
    const auto grown = [](const Box& box, double by) {
        return Box{box.lower - Vec3{by, by, by}, box.upper + Vec3{by, by, by}};
    };
    const double gap = arc_gap(1);
    // A body that turns far stays near its centre.
    const Box centers{min(at0.pose->com, at1.pose->com), max(at0.pose->com, at1.pose->com)};
    const double rounding = kPathRounding * (max_abs() + shape->radius);
    const Box chord = grown(ends, gap), ball = grown(centers, shape->radius + rounding);
    return {max(chord.lower, ball.lower), min(chord.upper, ball.upper)};
}

void PlacedBody::place(const RigidShape& shape, const Pose& at) {
    pose = at;
    rotation = matrix(at.rotation);
    x.resize(shape.mesh.vertices.size());
    points.resize(x.size());
    box = world_vertices(shape.mesh.vertices, at.origin, at.rotation, x, points);
    refit(shape.bvh, points, nodes);
}

void PlacedBody::forget_features() {
    x = std::vector<Vec3>(); // of {} a vector keeps its memory
    points = std::vector<CoarseBox>();
    nodes = std::vector<CoarseBox>();
}

void PlacedBody::make_features_again(const RigidShape& shape) {
    x.resize(shape.mesh.vertices.size());
    points.resize(x.size());
    world_vertices(shape.mesh.vertices, pose.origin, pose.rotation, x, points);
    refit(shape.bvh, points, nodes);
}

std::size_t PlacedBody::memory() const {
    return x.capacity() * sizeof(Vec3) + (points.capacity() + nodes.capacity()) * sizeof(CoarseBox);
}

void Trajectories::start(const Model& model, std::span<const Pose> poses) {
    resize(model);
    for (std::size_t i = 0; i < poses.size(); ++i) start(model, i, poses[i]);
}

void Trajectories::resize(const Model& model) {
    rigid_ = model.settings.trajectory == Trajectory::rigid;
    entries_.clear();
    entries_.resize(model.size());
    stamps_.assign(model.size(), {});
}

void Trajectories::start(const Model& model, std::size_t body, const Pose& pose) {
    Entry& e = entries_[body];
    e.shape = &model.shape_of(body);
    stamps_[body].version = 1;
    e.at0.place(*e.shape, pose);
    e.features = Features::there;
}

void Trajectories::grow(const Model& model) {
    entries_.resize(model.size());
    stamps_.resize(model.size());
}

void Trajectories::place(const Model& model, std::size_t body, const Pose& pose) {
    Entry& e = entries_[body];
    e.shape = &model.shape_of(body);
    e.turn = {};
    e.at0.place(*e.shape, pose);
    e.features = Features::there;
    stamps_[body] = {version(body) + 1, true};
}

std::size_t Trajectories::forget_features(std::size_t body) {
    Entry& e = entries_[body];
    const std::size_t bytes = e.at0.memory() + e.at1.memory();
    if (!still(body) || bytes == 0) return 0;
    e.at0.forget_features();
    e.at1.forget_features();
    e.features = Features::forgotten;
    return bytes;
}

void Trajectories::make_features_again(const Entry& e) {
    const std::atomic_ref state(e.features);
    for (;;) {
        Features found = Features::forgotten;
        if (!state.compare_exchange_strong(found, Features::being_made, std::memory_order_acquire)) {
            if (found == Features::there) return;
            state.wait(Features::being_made, std::memory_order_acquire);
            continue;
        }
        try {
            e.at0.make_features_again(*e.shape);
        } catch (...) { // no memory
            state.store(Features::forgotten, std::memory_order_release);
            state.notify_all();
            throw;
        }
        state.store(Features::there, std::memory_order_release);
        state.notify_all();
        return;
    }
}

std::size_t Trajectories::memory() const {
    std::size_t bytes = entries_.capacity() * sizeof(Entry) + stamps_.capacity() * sizeof(Stamp);
    for (const Entry& e : entries_) bytes += e.at0.memory() + e.at1.memory();
    return bytes;
}

void Trajectories::advance(std::span<const std::int32_t> moved) {
    for (const std::int32_t body : moved) {
        const auto i = static_cast<std::size_t>(body);
        Entry& e = entries_[i];
        if (!still(i)) {
            std::swap(e.at0, e.at1);
            e.features = Features::there;
        }
        e.turn = {};
        stamps_[i] = {version(i) + 1, true};
    }
}

void Trajectories::set_end(std::size_t body, const Pose& end, const Vec3& turn) {
    Entry& e = entries_[body];
    e.turn = turn;
    // A turn below one radian that ends in the same bits is none; a whole turn is one where bodies really turn.
    const bool same = end == e.at0.pose && (!rigid_ || length_sq(turn) < 1);
    stamps_[body] = {version(body) + 1, same};
    if (!same) e.at1.place(*e.shape, end);
}

void Trajectories::take_end(std::size_t body, const Pose& end, const Vec3& turn, std::uint64_t version) {
    if (stamps_[body].version == version) return;
    set_end(body, end, turn);
    stamps_[body].version = version;
}

void Trajectories::hold(std::size_t body) { set_end(body, entries_[body].at0.pose, {}); }

BodyMotion Trajectories::motion(std::size_t body) const {
    const Entry& e = entry(body);
    const bool stays = still(body);
    return {e.shape, e.at0.view(), (stays ? e.at0 : e.at1).view(), rigid_ && !stays ? e.turn : Vec3{}};
}

BodyMotion Trajectories::at_start(std::size_t body) const {
    const Entry& e = entry(body);
    return {e.shape, e.at0.view(), e.at0.view(), {}};
}

BodyMotion Trajectories::at_end(std::size_t body) const {
    const Entry& e = entry(body);
    const BodyPlacement end = (still(body) ? e.at0 : e.at1).view();
    return {e.shape, end, end, {}};
}

} // namespace flotilla
