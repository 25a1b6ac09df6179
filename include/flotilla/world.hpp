// SPDX-License-Identifier: MIT
// A scene in motion: the solver as an embedding program sees it.
//
//     flotilla::World world(flotilla::read_scene("boats.json"));
//     for (int i = 0; i < 240; ++i) world.step();
//     const flotilla::BodyState boat = world.body(0);
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <flotilla/error.hpp>
#include <flotilla/report.hpp>
#include <flotilla/scene.hpp>

namespace flotilla {

struct BodyState {
    Vec3 position;         ///< of the mesh's own origin, m
    Quat rotation;         ///< mesh axes to world, unit
    Vec3 center_of_mass;   ///< m
    Vec3 velocity;         ///< of the centre of mass, m/s
    Vec3 angular_velocity; ///< rad/s, world axes
};

/// Where an inner step of a body's last step ended (Settings::substeps), and how it came there from the one before: its centre of mass on
/// a straight line, its orientation by `turn`.
struct WayPoint {
    Vec3 position; ///< of the mesh's own origin, m
    Quat rotation;
    Vec3 turn; ///< rotation vector with whole turns, rad, world axes
};

/// A body that `initial_overlap: separate` moved, so that it intersects no other at the start.
struct MovedBody {
    std::int32_t body = 0;
    Vec3 by; ///< m
};

/// How operations that share no body are executed. The same bits in any case.
enum class Executor : std::uint8_t {
    parallel, ///< on all threads
    serial,   ///< everything in a plain loop on the calling thread
};

/// None changes a bit of the results. The threads are OpenMP's, for the time of a step: OMP_PROC_BIND and OMP_PLACES bind them,
/// OMP_WAIT_POLICY says how they wait between steps.
struct WorldOptions {
    /// Up to 1024, the calling thread among them; a negative number is refused. 0: FLOTILLA_NUM_THREADS, else what OpenMP would take
    /// (OMP_NUM_THREADS, else the cores that the process may use); less what steps of other Worlds use at the time; and one inside an
    /// active parallel region of OpenMP or a task of TBB, whose other threads have work of their own. A number is taken as it is, inside
    /// a parallel region as far as OpenMP allows regions within regions (OMP_MAX_ACTIVE_LEVELS), and as one where the process may not have
    /// the memory for their stacks.
    int threads = 0;
    Executor executor = Executor::parallel;
};

/// What a thread of a World did since that was made.
struct ThreadReport {
    double busy_ms = 0;      ///< in tasks
    double waiting_ms = 0;   ///< in parallel sections, without a task
    std::int64_t tasks = 0;  ///< chunks of loops and ordered operations
    std::int64_t stolen = 0; ///< of them, those first given to another thread
};

/// Its floating point environment is its own: it rounds to nearest and keeps subnormal numbers whatever the host does,
/// on all threads that it uses, and the host's environment is as before when a call returns or throws.
class World {
  public:
    /// Throws InputError for an invalid scene or number of threads, and OverlapError where bodies intersect at the start
    /// and, with `initial_overlap: separate`, no move of at most their own size frees them. `source` starts messages.
    explicit World(const SceneDescription& scene, const std::string& source = "scene",
                   const WorldOptions& options = {});
    /// Goes on from a snapshot of a World of the same scene and settings, with the same bits as that one, whatever the number of threads of
    /// either. Throws InputError for an invalid scene and for a snapshot that is damaged or of another scene.
    World(const SceneDescription& scene, std::span<const std::byte> snapshot, const std::string& source = "scene",
          const WorldOptions& options = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    /// Advances by settings().time_step, in settings().substeps inner steps, each of them proved. Throws BrokenPromise rather than leave
    /// bodies that are not proved apart; with `unsatisfiable_script: error` ScriptError, which leaves everything as it was before. After
    /// any exception but ScriptError (memory may be refused) the World is finished: it can be destroyed and assigned to, and step() and snapshot()
    /// throw Error; a snapshot taken before goes on.
    StepReport step();

    [[nodiscard]] std::size_t size() const; ///< bodies
    [[nodiscard]] std::int64_t steps() const;
    [[nodiscard]] double time() const; ///< s
    [[nodiscard]] const Settings& settings() const;
    /// InputError where there is no such body; so do turn() and way().
    [[nodiscard]] BodyState body(std::size_t index) const;
    /// The rotation vector of a body's motion in the last inner step, with whole turns, radians, world axes.
    [[nodiscard]] Vec3 turn(std::size_t index) const;
    /// Of all inner steps of the last step, whose end is the present pose; before a step of this World, the present pose alone.
    [[nodiscard]] std::vector<WayPoint> way(std::size_t index) const;
    /// Sorted by bodies. Those of sleeping bodies with each other or with infinite mass are among them, marked as asleep.
    [[nodiscard]] std::vector<ContactState> contacts() const;
    /// Of every body, in scene order; before the first step only the contacts are known.
    [[nodiscard]] std::vector<BodyActivity> activity() const;
    /// What was moved before the start; empty for a World made from a snapshot.
    [[nodiscard]] const std::vector<MovedBody>& moved_bodies() const;
    [[nodiscard]] std::uint64_t state_hash() const;
    /// Of all that the bits of every step depend on: settings, shapes, bodies and their start.
    [[nodiscard]] std::uint64_t scene_hash() const;
    /// Everything that can change a later bit; about 240 bytes a body and 80 bytes a contact.
    [[nodiscard]] std::vector<std::byte> snapshot() const;
    [[nodiscard]] std::vector<ThreadReport> threads() const;

  private:
    friend struct WorldAccess; ///< the library's own
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace flotilla
