// SPDX-License-Identifier: MIT
// A World of Python's: with its scene, its callbacks, and safe beside a step on another thread.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <flotilla/world.hpp>

#include "python/scene.hpp"

namespace flotilla::python {

/// Whom a World calls; none where an object is None or null. Copied with Python's lock held only, so that the World's
/// own callbacks do not hold them.
struct WorldCallbacks {
    py::object force, observer, log;
};

/// A step runs without Python's lock, so another thread may call meanwhile: it gets an Error, never half a step. All
/// members are used with the lock held.
class PythonWorld {
  public:
    PythonWorld(const NamedScene& scene, const WorldOptions& options, const std::optional<std::string>& snapshot);
    PythonWorld(const PythonWorld&) = delete; // its World's callbacks know where it is
    PythonWorld& operator=(const PythonWorld&) = delete;
    ~PythonWorld() = default;

    /// n steps, the lock given away while they run; interrupted between two of them by a signal.
    StepReport step(std::int64_t n);
    /// Goes on from the snapshot. On an error everything is as it was.
    void restore(const std::string& snapshot);
    /// Another World in the same state, without callbacks.
    [[nodiscard]] std::unique_ptr<PythonWorld> clone(const WorldOptions& options) const;
    /// The number of a shape given by number, which is not checked, or name.
    [[nodiscard]] std::int32_t shape_number(const py::object& shape) const;

    void set_force_callback(const py::object& callback);
    void set_observer(const py::object& observer);
    void set_log(const py::object& log);
    [[nodiscard]] WorldCallbacks& callbacks() { return callbacks_; }

    /// Error while a step runs, but in its force callback; so does edit().
    [[nodiscard]] const World& world() const;
    [[nodiscard]] World& edit();
    [[nodiscard]] const SceneDescription& start() const { return scene_; }
    [[nodiscard]] const WorldOptions& options() const { return options_; }
    /// The scene with the bodies where they are; kinematic ones stand still.
    [[nodiscard]] SceneDescription scene_now() const;

  private:
    PythonWorld(const PythonWorld& other, World&& world, const WorldOptions& options);
    /// What `work` gives, while other threads of Python run and are refused.
    template <class Work>
    auto unlocked(Work&& work) const;
    void call_force();
    bool call_observer(Phase phase);
    void call_log(const std::string& line);

    SceneDescription scene_; ///< as it started: the caller's may change
    std::string source_;
    WorldOptions options_;
    World world_;
    WorldCallbacks callbacks_;
    mutable bool busy_ = false;         ///< a step runs, or a clone is made
    mutable unsigned long busy_on_ = 0; ///< the thread that it runs on
    bool in_force_callback_ = false;    ///< then that thread may use the World
};

} // namespace flotilla::python
