// SPDX-License-Identifier: MIT
// A scene in motion: the solver as an embedding program sees it.
//
//     flotilla::World world(flotilla::read_scene("boats.json"));
//     for (int i = 0; i < 240; ++i) world.step();
//     const flotilla::BodyState boat = world.body(0);
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <flotilla/edit.hpp>
#include <flotilla/error.hpp>
#include <flotilla/query.hpp>
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

/// Where an inner step of a body's last step ended (Settings::substeps), and how it came there from the one before: its
/// centre of mass on a straight line, its orientation by `turn`.
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

/// None changes a bit of the results. The threads are OpenMP's, for the time of a step: OMP_PROC_BIND and OMP_PLACES
/// bind them, OMP_WAIT_POLICY says how they wait between steps.
struct WorldOptions {
    /// Up to 1024, the calling thread among them; a negative number is refused. 0: FLOTILLA_NUM_THREADS, else what
    /// OpenMP would take (OMP_NUM_THREADS, else the cores that the process may use); less what steps of other Worlds
    /// use at the time; and one inside an active parallel region of OpenMP or a task of TBB, whose other threads have
    /// work of their own. A number is taken as it is, inside a parallel region as far as OpenMP allows regions within
    /// regions (OMP_MAX_ACTIVE_LEVELS), and as one where the process may not have the memory for their stacks. What the
    /// environment asks for must be something that there is (flotilla/environment.hpp).
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
    /// Throws InputError for an invalid scene or number of threads, and OverlapError where bodies intersect at the
    /// start and, with `initial_overlap: separate`, no move of at most their own size frees them. `source` starts
    /// messages.
    explicit World(const SceneDescription& scene, const std::string& source = "scene",
                   const WorldOptions& options = {});
    /// Goes on from a snapshot of a World of the same scene and settings, with the same bits as that one, whatever the
    /// number of threads of either. Throws InputError for an invalid scene and for a snapshot that is damaged or of
    /// another scene.
    World(const SceneDescription& scene, std::span<const std::byte> snapshot, const std::string& source = "scene",
          const WorldOptions& options = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    /// Advances by settings().time_step, in settings().substeps inner steps, each of them proved. Throws BrokenPromise
    /// rather than leave bodies that are not proved apart; with `unsatisfiable_script: error` ScriptError, which leaves
    /// everything as it was before. After any exception but ScriptError (memory may be refused) the World is finished:
    /// it can be destroyed and assigned to, and step() and snapshot() throw Error; a snapshot taken before goes on.
    StepReport step();

    // Changes between steps. What cannot be done is refused by InputError or OverlapError, and then nothing has
    // changed; bodies that an edit concerns wake, with those near them. Every edit counts in state_hash(), and a
    // snapshot holds them all.

    /// Every other function of this section is a short form of this one.
    /// Returns the body of an AddBody or of the edit, the shape's number as `index` of an AddShape, and nobody of
    /// others.
    BodyId apply(const Edit& edit);
    /// The number that add_body() knows the shape by. A shape without a name gets one.
    std::int32_t add_shape(ShapeDescription shape);
    /// Lets go of a shape that add_shape() added and no body has. Its number is given to the next one that comes, those
    /// of others stay.
    void remove_shape(std::int32_t shape);
    /// Costs about as much as testing the body against those whose boxes meet its own. A body without a name gets one.
    BodyId add_body(BodyDescription body);
    void remove_body(BodyId body);
    void set_pose(BodyId body, const Vec3& position, const Quat& rotation);
    void set_velocity(BodyId body, const Vec3& velocity, const Vec3& angular_velocity);
    void set_type(BodyId body, BodyType type);
    void set_script(BodyId body, std::vector<Keyframe> keyframes);
    void set_material(BodyId body, double friction, double restitution);
    /// N and N m, at the centre of mass, until it is set again.
    void set_force(BodyId body, const Vec3& force, const Vec3& torque);
    /// N at a point (m, world), for the next step; adds to what was applied before.
    void apply_force(BodyId body, const Vec3& force, const Vec3& point);
    void apply_torque(BodyId body, const Vec3& torque); ///< N m, likewise
    /// N s at a point (m, world): the velocities change at once.
    void apply_impulse(BodyId body, const Vec3& impulse, const Vec3& point);
    void set_gravity(const Vec3& gravity);
    void set_group(BodyId body, const std::string& group);
    void ignore_groups(const std::string& a, const std::string& b, bool ignored = true);
    void ignore_pair(BodyId a, BodyId b, bool ignored = true);
    /// Which groups, or bodies by name, may pass through each other now.
    [[nodiscard]] std::vector<NamedPair> ignored_groups() const;
    [[nodiscard]] std::vector<NamedPair> ignored_bodies() const;
    void wake(BodyId body);

    /// Called at the start of every step, when it may change the World as above; what it throws leaves step() with
    /// nothing done but its edits. Empty: none.
    void set_force_callback(std::function<void(World&)> callback);
    /// Called after stages 1, 3, 5 and 7 of a step, or of each inner one, on the thread that calls step(); after 1 and
    /// 3 again where the step begins anew, since it hit what slept. Where it returns false, or throws, everything is as
    /// it was before the step, and step() throws StepCancelled, or what it threw. Costs a copy of the state in every
    /// step. Empty: none.
    void set_observer(std::function<bool(Phase)> observer);
    /// Takes one line for what is worth a look: warnings of a step that the step before did not have, and edits that
    /// were refused. What it throws comes out of the call, whose work is done: the World goes on. Empty: nobody.
    void set_log(std::function<void(const std::string&)> log);
    /// Keeps the edits from now on, in order, with the step after which each was made; begins anew where there was one
    /// meanwhile that it does not have. restore() drops those that the snapshot is before.
    void record_edits(bool record);
    /// Throws Error after restore() of a snapshot to which they do not lead, until record_edits() begins anew.
    [[nodiscard]] const std::vector<Edit>& recorded_edits() const;

    /// The present body at a place, or with a name; InputError where there is none.
    [[nodiscard]] BodyId id(std::size_t index) const;
    [[nodiscard]] std::vector<BodyId> ids() const; ///< of the num_bodies() that are present, by place
    /// How many bodies have occupied this place before the present one (BodyId::generation); InputError where there is
    /// no such place.
    [[nodiscard]] std::uint32_t generation(std::size_t index) const;
    [[nodiscard]] BodyId find(const std::string& name) const;
    [[nodiscard]] bool contains(BodyId body) const; ///< it was not removed
    /// The number of the shape with a name; InputError where there is none.
    [[nodiscard]] std::int32_t find_shape(const std::string& name) const;
    /// As it was described; the vertices and triangles of one that add_shape() did not add are left out, for the scene
    /// has them. InputError where there is no such shape.
    [[nodiscard]] const ShapeDescription& shape(std::int32_t number) const;
    [[nodiscard]] bool contains_shape(std::int32_t number) const;
    /// Numbers of shapes, those of removed ones too.
    [[nodiscard]] std::size_t num_shapes() const;
    [[nodiscard]] const std::string& name(BodyId body) const;
    /// As it is now but for pose and velocities, which body() has.
    [[nodiscard]] const BodyDescription& description(BodyId body) const;
    /// The embedder's own, 0 at first. In snapshots of an edited World, in no hash.
    void set_user_data(BodyId body, std::uint64_t data);
    [[nodiscard]] std::uint64_t user_data(BodyId body) const;
    [[nodiscard]] Vec3 gravity() const;  ///< m/s^2
    [[nodiscard]] double energy() const; ///< J, kinetic and potential, of the dynamic bodies as they are now

    /// Of all places, those of removed bodies too. No copies: valid until the next step or edit, or as pin() says.
    [[nodiscard]] std::span<const Pose> poses() const;
    [[nodiscard]] std::span<const Motion> motions() const;
    /// While somebody holds what this returns, poses() and motions() stay where they are as long as the World lives,
    /// through steps, edits and restore(): what would change the number of places is refused with InputError.
    [[nodiscard]] std::shared_ptr<const void> pin() const;
    /// The same as contacts(), valid until the next step or edit.
    [[nodiscard]] std::span<const ContactState> contact_view() const;
    /// The same, which stays what it is as long as somebody holds it, whatever becomes of the World.
    [[nodiscard]] std::shared_ptr<const std::vector<ContactState>> shared_contacts() const;

    /// The first body on the ray, of those within `reach` (m). The direction need not be a unit vector, but not zero.
    [[nodiscard]] std::optional<RayHit> ray(const Vec3& origin, const Vec3& direction, double reach) const;
    [[nodiscard]] ClosestPoints closest(BodyId a, BodyId b) const;
    /// Bodies that a shape at a pose would intersect, by place: those that add_body() would refuse it for.
    [[nodiscard]] std::vector<BodyId> overlapping(std::int32_t shape, const Vec3& position, const Quat& rotation) const;
    /// Bodies with a point of their surface in the box, boundary included; exact.
    [[nodiscard]] std::vector<BodyId> bodies_in(const Vec3& lower, const Vec3& upper) const;
    [[nodiscard]] BodyContacts contacts_of(BodyId body) const;
    [[nodiscard]] MemoryUse memory() const;

    /// Another World in the same state, with the same bits from here on. Callbacks, log and recorded edits are not
    /// copied.
    [[nodiscard]] World clone(const WorldOptions& options = {}) const;
    /// Goes back, or on, to a snapshot of this scene, edited or not. Throws InputError as the constructor does, and
    /// then nothing changed.
    void restore(std::span<const std::byte> snapshot);

    /// Places of bodies; of a World whose bodies were never removed: bodies.
    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] std::size_t num_bodies() const; ///< present
    [[nodiscard]] std::int64_t steps() const;
    [[nodiscard]] double time() const; ///< s
    [[nodiscard]] const Settings& settings() const;
    /// InputError where there is no such place; of a body that was removed, what it was last. So do turn() and way().
    [[nodiscard]] BodyState body(std::size_t index) const;
    /// The rotation vector of a body's motion in the last inner step, with whole turns, radians, world axes.
    [[nodiscard]] Vec3 turn(std::size_t index) const;
    /// Of all inner steps of the last step, whose end is the present pose; before a step of this World, the present
    /// pose alone.
    [[nodiscard]] std::vector<WayPoint> way(std::size_t index) const;
    /// Sorted by bodies. Those of sleeping bodies with each other or with infinite mass are among them, marked as
    /// asleep.
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

    struct Impl; ///< the library's own

  private:
    friend struct WorldAccess;
    explicit World(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

} // namespace flotilla
