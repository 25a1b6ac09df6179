// SPDX-License-Identifier: MIT
// Where every body starts and ends in the step under way: poses, world vertices, boxes, versions.
#pragma once

#include <span>

#include "state/model.hpp"

namespace flotilla {

/// One body as the pair queries see it. Every vertex moves on a straight line from x0 to x1 (paper, section 3.1).
struct BodyMotion {
    const RigidShape* shape = nullptr;
    std::span<const Vec3> x0, x1;
    std::span<const Box> boxes0, boxes1; ///< of the hierarchy's nodes

    [[nodiscard]] BvhView view() const { return {shape->bvh, boxes0, boxes1}; }
    [[nodiscard]] Box swept() const { return merged(boxes0[0], boxes1[0]); }
};

/// The candidate trajectories of a step. Each committed end state has a version, never reused; a proof names the versions it is
/// about.
class Trajectories {
  public:
    /// All bodies at rest at the given poses.
    void start(const Model& model, std::span<const Pose> poses);
    /// Makes the end states the start states of the next step.
    void advance();

    /// Commits an end state: the body turns by the rotation vector `turn` (with whole turns) on the way.
    void set_end(std::size_t body, const Pose& end, const Vec3& turn);
    /// Commits the start state as the end state, bit for bit.
    void hold(std::size_t body);

    [[nodiscard]] const Pose& start_pose(std::size_t body) const { return entry(body).start; }
    [[nodiscard]] const Pose& end_pose(std::size_t body) const { return entry(body).end; }
    [[nodiscard]] const Vec3& turn(std::size_t body) const { return entry(body).turn; }
    [[nodiscard]] std::uint64_t version(std::size_t body) const { return entry(body).version; }
    [[nodiscard]] bool still(std::size_t body) const { return entry(body).still; } ///< end is bitwise the start
    [[nodiscard]] BodyMotion motion(std::size_t body) const;
    [[nodiscard]] BodyMotion at_start(std::size_t body) const; ///< resting at the start pose
    [[nodiscard]] BodyMotion at_end(std::size_t body) const;   ///< resting at the end pose
    [[nodiscard]] std::size_t size() const { return entries_.size(); }

  private:
    struct Entry {
        Pose start, end;
        Vec3 turn;
        std::uint64_t version = 0;
        bool still = true;
        const RigidShape* shape = nullptr;
        std::vector<Vec3> x0, x1;
        std::vector<Box> boxes0, boxes1;
    };
    [[nodiscard]] const Entry& entry(std::size_t body) const { return entries_[body]; }

    std::vector<Entry> entries_;
};

} // namespace flotilla
