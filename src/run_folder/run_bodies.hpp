// SPDX-License-Identifier: MIT
// The bodies of a run whose World is edited: who is there after which step, and what may pass through what.
//
// A body of a run is one that its scene or an edit brought. Bodies that follow each other at one place of the World are
// different ones, so the arrays of a run's frames have one column for each; what is not there lies at the origin and is
// marked as absent.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <flotilla/edit.hpp>
#include <flotilla/scene.hpp>

namespace flotilla::io {

/// BodyActivity's cluster in a frame, of a body that is not there.
inline constexpr std::uint8_t kAbsent = 255;

/// "file: /edits/3: edit after step 7" for messages.
[[nodiscard]] std::string name_of(const Edit& edit);

class RunBodies {
  public:
    /// Of the scene only the time step, names, shapes, types, groups and what is ignored count. The edits are sorted by
    /// step.
    RunBodies(const SceneDescription& scene, std::span<const Edit> edits);

    /// Makes the edits of steps up to this one that are not made yet, and returns them.
    std::span<const Edit> advance(std::int64_t step);
    [[nodiscard]] std::size_t size() const { return bodies_.size(); } ///< that are there at any time
    /// Of all of them; poses and velocities are those of their start, shapes count the scene's and added_shapes().
    [[nodiscard]] const std::vector<BodyDescription>& bodies() const { return bodies_; }
    /// Those that edits added, removed ones too.
    [[nodiscard]] const std::vector<ShapeDescription>& added_shapes() const { return added_shapes_; }
    /// The edit that added it, as messages name it.
    [[nodiscard]] const std::string& adder_of_shape(std::size_t added) const { return shape_adders_[added]; }
    [[nodiscard]] std::int32_t place_of(std::size_t body) const { return place_of_[body]; } ///< -1: it is not there
    [[nodiscard]] std::int32_t body_at(std::int32_t place) const { return body_at_[static_cast<std::size_t>(place)]; }
    [[nodiscard]] BodyType type_of(std::size_t body) const { return type_[body]; }
    [[nodiscard]] bool ignored(std::size_t a, std::size_t b) const;
    [[nodiscard]] bool ignores_any() const { return !ignored_groups_.empty() || !ignored_bodies_.empty(); }

    /// Where the last advance() put bodies.
    struct Placed {
        std::size_t body = 0;
        Vec3 position;
        Quat rotation;
    };
    [[nodiscard]] const std::vector<Placed>& placed() const { return placed_; }

  private:
    void make(const Edit& edit);
    [[nodiscard]] Placed start_of(std::size_t body, std::int64_t step) const;
    [[nodiscard]] std::size_t body_of(BodyId id) const;

    std::span<const Edit> edits_;
    double time_step_; ///< s
    std::size_t made_ = 0, next_body_ = 0;
    std::vector<BodyDescription> bodies_;
    std::vector<ShapeDescription> added_shapes_;
    std::vector<std::string> shape_adders_;
    std::vector<std::int32_t> place_of_, body_at_;
    std::vector<BodyType> type_;
    std::vector<std::string> group_;
    std::vector<NamedPair> ignored_groups_;
    std::vector<std::pair<std::size_t, std::size_t>> ignored_bodies_;
    std::vector<Placed> placed_;
};

} // namespace flotilla::io
