// SPDX-License-Identifier: MIT
// The vertices of a body at a time on its way.
#pragma once

#include "base/index.hpp"
#include "ccd/candidate_list.hpp"
#include "state/trajectories.hpp"

namespace flotilla {

class BodyAt {
  public:
    /// t in [0, 1]; the body lives longer.
    BodyAt(const BodyMotion& body, double t) : body_(&body), t_(t) {
        if (body.straight()) return;
        const Pose pose = body.pose(t);
        turned_ = {pose.origin, matrix(pose.rotation)};
    }

    [[nodiscard]] Vec3 vertex(std::int32_t v) const {
        if (!body_->straight()) return turned_.rotation * body_->shape->mesh.vertices[at(v)] + turned_.origin;
        return body_->at0.x[at(v)] + t_ * (body_->at1.x[at(v)] - body_->at0.x[at(v)]);
    }
    /// What leads from mesh coordinates to places, but for rounding; on straight ways no rotation.
    [[nodiscard]] MatrixPose map() const {
        if (!body_->straight()) return turned_;
        const MatrixPose p0 = matrix_pose(body_->at0), p1 = matrix_pose(body_->at1);
        return {p0.origin + t_ * (p1.origin - p0.origin), p0.rotation + t_ * (p1.rotation - p0.rotation)};
    }
    [[nodiscard]] const BodyMotion& motion() const { return *body_; }
    [[nodiscard]] const RigidShape& shape() const { return *body_->shape; }
    [[nodiscard]] double time() const { return t_; }

  private:
    const BodyMotion* body_;
    double t_;
    MatrixPose turned_{}; ///< of a body that turns
};

} // namespace flotilla
