// SPDX-License-Identifier: MIT
#include "state/trajectories.hpp"

#include "mesh/placement.hpp"

namespace flotilla {

void Trajectories::start(const Model& model, std::span<const Pose> poses) {
    entries_.assign(poses.size(), {});
    for (std::size_t i = 0; i < poses.size(); ++i) {
        Entry& e = entries_[i];
        e.shape = &model.shape_of(i);
        e.start = e.end = poses[i];
        e.version = 1;
        e.x0.resize(e.shape->mesh.vertices.size());
        world_vertices(e.shape->mesh.vertices, poses[i].origin, poses[i].rotation, e.x0);
        refit(e.shape->bvh, e.x0, e.boxes0);
    }
}

void Trajectories::advance() {
    for (Entry& e : entries_) {
        if (!e.still) {
            std::swap(e.x0, e.x1);
            std::swap(e.boxes0, e.boxes1);
        }
        e.start = e.end;
        e.turn = {};
        e.still = true;
        ++e.version;
    }
}

void Trajectories::set_end(std::size_t body, const Pose& end, const Vec3& turn) {
    Entry& e = entries_[body];
    ++e.version;
    e.turn = turn;
    e.end = end;
    e.still = end == e.start;
    if (e.still) return;
    e.x1.resize(e.x0.size());
    world_vertices(e.shape->mesh.vertices, end.origin, end.rotation, e.x1);
    refit(e.shape->bvh, e.x1, e.boxes1);
}

void Trajectories::hold(std::size_t body) { set_end(body, entries_[body].start, {}); }

BodyMotion Trajectories::motion(std::size_t body) const {
    const Entry& e = entries_[body];
    if (e.still) return at_start(body);
    return {e.shape, e.x0, e.x1, e.boxes0, e.boxes1};
}

BodyMotion Trajectories::at_start(std::size_t body) const {
    const Entry& e = entries_[body];
    return {e.shape, e.x0, e.x0, e.boxes0, e.boxes0};
}

BodyMotion Trajectories::at_end(std::size_t body) const {
    const Entry& e = entries_[body];
    if (e.still) return at_start(body);
    return {e.shape, e.x1, e.x1, e.boxes1, e.boxes1};
}

} // namespace flotilla
