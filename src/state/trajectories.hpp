// SPDX-License-Identifier: MIT
// Where every body starts and ends in the step under way: poses, world vertices, boxes, versions.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "state/model.hpp"

namespace flotilla {

/// A body at one time of the step, with what culls its features.
struct BodyPlacement {
    std::span<const Vec3> x;           ///< world vertices, m
    std::span<const CoarseBox> points; ///< their boxes
    std::span<const CoarseBox> nodes;  ///< boxes of the hierarchy's nodes
    const Box* box = nullptr;          ///< of all of them
    const Pose* pose = nullptr;
    const Mat3* rotation = nullptr; ///< of the pose
};

/// One body as the pair queries see it, from t = 0 to t = 1. Every vertex moves on a straight line from x0 to x1
/// (paper, section 3.1) or, where there is a turn, with its body: the centre of mass on a straight line, the
/// orientation R(t turn) q0.
struct BodyMotion {
    const RigidShape* shape = nullptr;
    BodyPlacement at0, at1;
    Vec3 turn; ///< rad, with whole turns; zero where every vertex moves straight

    [[nodiscard]] bool straight() const { return turn == Vec3{}; }
    [[nodiscard]] bool still() const { return at0.x.data() == at1.x.data(); }
    /// The pose at t in [0, 1].
    [[nodiscard]] Pose pose(double t) const;
    /// How far, at equal times, any vertex may be from the straight line between its places at both ends of a part of
    /// [0, 1] that is 1 / `segments` long, m. Rounding included; zero where vertices move straight.
    [[nodiscard]] double arc_gap(int segments) const;
    /// Holds the body at all times.
    [[nodiscard]] Box swept() const;
    /// The largest magnitude of a coordinate at both ends, m.
    [[nodiscard]] double max_abs() const {
        return std::max(max_abs_coordinate(*at0.box), max_abs_coordinate(*at1.box));
    }
};

/// A pose with the world vertices and boxes that follow from it.
struct PlacedBody {
    Pose pose;
    Mat3 rotation;
    Box box;
    std::vector<Vec3> x;
    std::vector<CoarseBox> points, nodes;

    void place(const RigidShape& shape, const Pose& at);
    void forget_features(); ///< frees vertices and boxes, but for that of all of them
    void make_features_again(const RigidShape& shape);
    [[nodiscard]] std::size_t memory() const; ///< bytes
    [[nodiscard]] BodyPlacement view() const { return {x, points, nodes, &box, &pose, &rotation}; }
};

/// The candidate trajectories of a step. Each committed end state has a version, never reused; a proof names the
/// versions it is about.
class Trajectories {
  public:
    /// All bodies at rest at the given poses. The model's setting `trajectory` decides how they will move.
    void start(const Model& model, std::span<const Pose> poses);
    /// The same in two parts: room for all bodies, then one body after another or side by side, each placed by the
    /// thread that calls.
    void resize(const Model& model);
    void start(const Model& model, std::size_t body, const Pose& pose);
    /// Between steps: room for bodies that came, and a body that is elsewhere, or another one, now.
    void grow(const Model& model);
    void place(const Model& model, std::size_t body, const Pose& pose);
    /// Frees the vertices and boxes of a still body. They are made again when somebody asks for them, and those of its
    /// end state when it moves. Returns how many bytes became free.
    std::size_t forget_features(std::size_t body);
    /// Makes the end states of the given bodies the start states of the next step; the others stood still.
    void advance(std::span<const std::int32_t> moved);

    /// Commits an end state: the body turns by the rotation vector `turn` (with whole turns) on the way.
    void set_end(std::size_t body, const Pose& end, const Vec3& turn);
    /// Commits what another rank committed to its copy (parallel/division.hpp), with the version that it has there.
    void take_end(std::size_t body, const Pose& end, const Vec3& turn, std::uint64_t version);
    /// Commits the start state as the end state, bit for bit.
    void hold(std::size_t body);

    [[nodiscard]] const Pose& start_pose(std::size_t body) const { return entries_[body].at0.pose; }
    [[nodiscard]] const Pose& end_pose(std::size_t body) const {
        return still(body) ? entries_[body].at0.pose : entries_[body].at1.pose;
    }
    /// Of all vertices at the start pose; also of a body whose features are forgotten.
    [[nodiscard]] const Box& start_box(std::size_t body) const { return entries_[body].at0.box; }
    [[nodiscard]] const Vec3& turn(std::size_t body) const { return entries_[body].turn; }
    [[nodiscard]] std::uint64_t version(std::size_t body) const { return stamps_[body].version; }
    /// The end is bitwise the start, and the body does not move on the way either.
    [[nodiscard]] bool still(std::size_t body) const { return stamps_[body].still; }
    [[nodiscard]] BodyMotion motion(std::size_t body) const;
    [[nodiscard]] BodyMotion at_start(std::size_t body) const; ///< resting at the start pose
    [[nodiscard]] BodyMotion at_end(std::size_t body) const;   ///< resting at the end pose
    [[nodiscard]] std::size_t size() const { return entries_.size(); }
    [[nodiscard]] std::size_t memory() const; ///< bytes

  private:
    enum class Features : std::uint8_t { there, forgotten, being_made };
    struct Entry {
        Vec3 turn;
        const RigidShape* shape = nullptr;
        mutable PlacedBody at0;
        PlacedBody at1;
        mutable Features features = Features::there; ///< of at0; read and written as an atomic
    };
    /// With its features. Threads may ask side by side.
    [[nodiscard]] const Entry& entry(std::size_t body) const {
        const Entry& e = entries_[body];
        if (std::atomic_ref(e.features).load(std::memory_order_acquire) != Features::there) make_features_again(e);
        return e;
    }
    static void make_features_again(const Entry& e);

    struct Stamp {
        std::uint64_t version = 0;
        bool still = true;
    };

    std::vector<Entry> entries_;
    std::vector<Stamp> stamps_; ///< of the end states: what is asked of most pairs, and nothing else
    bool rigid_ = false;        ///< the setting `trajectory`
};

} // namespace flotilla
