// SPDX-License-Identifier: MIT
// A World of Python's: with its scene, and safe beside a step on another thread.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <flotilla/world.hpp>

#include "python/scene.hpp"

namespace flotilla::python {

/// A step runs without Python's lock, so another thread may call meanwhile: it gets an Error, never half a step. All
/// members are used with the lock held.
class PythonWorld {
  public:
    PythonWorld(const NamedScene& scene, const WorldOptions& options, const std::optional<std::string>& snapshot);

    /// n steps, the lock given away while they run; interrupted between two of them by a signal.
    StepReport step(std::int64_t n);
    /// Goes on from the snapshot. On an error everything is as it was.
    void restore(const std::string& snapshot);
    /// Another World in the same state.
    [[nodiscard]] std::unique_ptr<PythonWorld> clone() const;
    std::int32_t add_shape(const ShapeDescription& shape);

    /// Error while a step runs; so does edit().
    [[nodiscard]] const World& world() const;
    [[nodiscard]] World& edit();
    [[nodiscard]] const SceneDescription& start() const { return scene_; }
    [[nodiscard]] const WorldOptions& options() const { return options_; }
    /// The scene with the bodies where they are; kinematic ones stand still.
    [[nodiscard]] SceneDescription scene_now() const;

  private:
    PythonWorld(const PythonWorld& other, World&& world);

    SceneDescription scene_;              ///< as it started: the caller's may change
    std::vector<ShapeDescription> added_; ///< shapes, by number after the scene's
    std::string source_;
    WorldOptions options_;
    World world_;
    bool stepping_ = false;
};

} // namespace flotilla::python
