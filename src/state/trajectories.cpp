// SPDX-License-Identifier: MIT
#include "state/trajectories.hpp"

#include "base/rotation.hpp"
#include "mesh/placement.hpp"

namespace flotilla {

void Trajectories::Placement::place(const RigidShape& shape, const Pose& at) {
    pose = at;
    rotation = matrix(at.rotation);
    x.resize(shape.mesh.vertices.size());
    points.resize(x.size());
    world_vertices(shape.mesh.vertices, at.origin, at.rotation, x);
    box = {};
    for (std::size_t i = 0; i < x.size(); ++i) {
        points[i] = coarse_box(x[i]);
        box = extended(box, x[i]);
    }
    refit(shape.bvh, points, nodes);
}

void Trajectories::start(const Model& model, std::span<const Pose> poses) {
    entries_.assign(poses.size(), {});
    for (std::size_t i = 0; i < poses.size(); ++i) {
        Entry& e = entries_[i];
        e.shape = &model.shape_of(i);
        e.version = 1;
        e.at0.place(*e.shape, poses[i]);
    }
}

void Trajectories::advance() {
    for (Entry& e : entries_) {
        if (!e.still) std::swap(e.at0, e.at1);
        e.turn = {};
        e.still = true;
        ++e.version;
    }
}

void Trajectories::set_end(std::size_t body, const Pose& end, const Vec3& turn) {
    Entry& e = entries_[body];
    ++e.version;
    e.turn = turn;
    e.still = end == e.at0.pose;
    if (!e.still) e.at1.place(*e.shape, end);
}

void Trajectories::hold(std::size_t body) { set_end(body, entries_[body].at0.pose, {}); }

BodyMotion Trajectories::motion(std::size_t body) const {
    const Entry& e = entries_[body];
    return {e.shape, e.at0.view(), (e.still ? e.at0 : e.at1).view()};
}

BodyMotion Trajectories::at_start(std::size_t body) const {
    const Entry& e = entries_[body];
    return {e.shape, e.at0.view(), e.at0.view()};
}

BodyMotion Trajectories::at_end(std::size_t body) const {
    const Entry& e = entries_[body];
    const BodyPlacement end = (e.still ? e.at0 : e.at1).view();
    return {e.shape, end, end};
}

} // namespace flotilla
