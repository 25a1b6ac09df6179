// SPDX-License-Identifier: MIT
// A scene in motion: the solver as an embedding program sees it.
//
//     flotilla::World world(flotilla::read_scene("boats.json"));
//     for (int i = 0; i < 240; ++i) world.step();
//     const flotilla::BodyState boat = world.body(0);
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <flotilla/report.hpp>
#include <flotilla/scene.hpp>

namespace flotilla {

/// The end of a step could not be proved free of intersections. It is thrown instead of leaving such a state.
class BrokenPromise : public std::logic_error {
  public:
    using std::logic_error::logic_error;
};

/// Bodies intersect at the start; the message names them.
class OverlapError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

struct BodyState {
    Vec3 position;         ///< of the mesh's own origin, m
    Quat rotation;         ///< mesh axes to world, unit
    Vec3 center_of_mass;   ///< m
    Vec3 velocity;         ///< of the centre of mass, m/s
    Vec3 angular_velocity; ///< rad/s, world axes
};

/// How operations that share no body are executed. The same bits in any case.
enum class Executor : std::uint8_t {
    parallel, ///< on all threads
    serial,   ///< everything in a plain loop on the calling thread
};

/// None changes a bit of the results.
struct WorldOptions {
    int threads =
        0; ///< up to 1024; 0: FLOTILLA_NUM_THREADS, else OMP_NUM_THREADS, else the cores that the process may use
    Executor executor = Executor::parallel;
    bool pin = false; ///< keep each thread on a core of its own, the calling one until the World is gone
};

/// What a thread of a World did since that was made.
struct ThreadReport {
    double busy_ms = 0;      ///< in tasks
    double waiting_ms = 0;   ///< in parallel sections, without a task
    std::int64_t tasks = 0;  ///< chunks of loops and ordered operations
    std::int64_t stolen = 0; ///< of them, those first given to another thread
};

class World {
  public:
    /// Throws InputError for an invalid scene or number of threads and OverlapError where bodies intersect at the start. `source` starts messages.
    explicit World(const SceneDescription& scene, const std::string& source = "scene",
                   const WorldOptions& options = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    /// Advances by settings().time_step. Throws BrokenPromise rather than leave bodies that are not proved apart.
    StepReport step();

    [[nodiscard]] std::size_t size() const; ///< bodies
    [[nodiscard]] std::int64_t steps() const;
    [[nodiscard]] double time() const; ///< s
    [[nodiscard]] const Settings& settings() const;
    [[nodiscard]] BodyState body(std::size_t index) const;
    /// The rotation vector of a body's motion in the last step, with whole turns, radians, world axes.
    [[nodiscard]] Vec3 turn(std::size_t index) const;
    /// Sorted by bodies. Contacts of sleeping bodies with each other or with infinite mass are not looked for and not among them.
    [[nodiscard]] std::vector<ContactState> contacts() const;
    /// Of every body, in scene order; before the first step only the contacts are known.
    [[nodiscard]] std::vector<BodyActivity> activity() const;
    [[nodiscard]] std::uint64_t state_hash() const;
    [[nodiscard]] std::vector<ThreadReport> threads() const;

  private:
    friend struct WorldAccess; ///< the library's own
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace flotilla
