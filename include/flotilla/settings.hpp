// SPDX-License-Identifier: MIT
// Every setting of a run in one aggregate. Defaults are the paper's (figure 20) unless the field says otherwise,
// lengths by bodies' sizes (src/DEVIATIONS.md); the names are the keys of `settings` in a scene file and of --set.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace flotilla {

enum class Trajectory : std::uint8_t {
    linear, ///< one straight segment per vertex and step (paper, section 3.1)
    rigid,  ///< bodies turn on the way: segments of equal angle, whose certificate covers the turning motion
};
enum class Collisions : std::uint8_t {
    sequential,  ///< one pair after the other, each by its earliest hits as the pairs before it left them (paper,
                 ///< Algorithm 1)
    accumulated, ///< all pairs are queried, then all hits of the step so far are solved together, until no pair hits
};
enum class CcdMethod : std::uint8_t {
    conservative, ///< directional conservative advancement, no false negatives
    cubic, ///< stage 1 by the paper's cubic with a tolerance (section 3.1), a baseline; stage 5 stays conservative
};
enum class Tangents : std::uint8_t {
    random,  ///< the paper's pyramid, turned by a generator keyed by (seed, features), where bodies slide by the step
             ///< too
    aligned, ///< as cone, whose steps are the same for all tangents
    cone, ///< Coulomb's cone: friction of mu times the normal force in every direction, whether bodies slide or stick
};
enum class VelocityUpdate : std::uint8_t {
    trapezoidal, ///< contact forces act half at the start of a step, half at its end: of second order, like gravity
    end, ///< all at the end of the step, as in the paper: of first order, so that what swings or rolls is damped
};
enum class ContactSolver : std::uint8_t {
    pgs,       ///< projected Gauss-Seidel, and shock propagation where that ends unsolved (paper, section 4.3.2)
    exact,     ///< the same, but small islands that it leaves unsolved are solved by an interior point method
    exact_few, ///< exact, but only in islands of up to eight bodies and in columns and chains at rest, whose
               ///< factorisation costs little
};
enum class Rigidification : std::uint8_t {
    kinematic, ///< clusters keep their members' relative motion (paper, section 4.2.2)
    rigid,     ///< clusters move as one rigid body (section 4.2.1): the paper's comparison in figure 9
};
enum class UnsatisfiableScript : std::uint8_t {
    hold,   ///< the body waits, and its script with it: jaws that jammed while closing stay shut
    follow, ///< the script goes on, the body catches up along its path: jaws that jammed open when their script says so
    error,  ///< World::step throws ScriptError in the first step that a script cannot make in full
};
enum class InitialOverlap : std::uint8_t { error, separate };

/// Lengths are metres; a length of 0 means "derived per pair from body size" as the field says.
struct Settings {
    double time_step = 1.0 / 24.0; ///< s, > 0
    /// Inner steps of time_step / substeps that make a step, >= 1. The motion, and what other settings say of "a step",
    /// is theirs; frames, scripts' times, reports and checkpoints keep the step.
    int substeps = 1;
    double friction = 0.1;    ///< default of bodies, >= 0
    double restitution = 0.1; ///< default of bodies, in [0, 1]
    std::uint64_t seed = 0;   ///< of the tangent generator

    /// d_rest; 0: size/330, size = smaller bounding-sphere diameter of the movable bodies, less for thin solids
    double rest_distance = 0;
    double proximity_distance = 0; ///< d_proximity > d_rest; 0: 2 d_rest
    double separation = 0;         ///< s_min, least certified distance; 0: d_rest/50
    double proximity_angle = 3;    ///< theta_proximity, degrees, in (0, 90)
    /// m/s, slower end proximities are left to static contact; < 0: |g| dt/2, and what would rebound slower than that,
    /// if it approaches by no more than the proximity distance in a step
    double approach_threshold = -1;

    Collisions collisions = Collisions::sequential; ///< of stage 1
    int collision_iterations = 100;                 ///< sweeps of Algorithm 1; rounds over all pairs where accumulated
    int collision_pair_iterations = 4;              ///< impulses per pair and sweep
    /// Sweeps of Algorithm 2 after which it is given up, once half as many did not make the list of pairs left any
    /// shorter.
    int dynamic_iterations = 100;
    int dynamic_pair_iterations = 20; ///< impulses per pair and sweep
    int static_iterations = 1000;     ///< sweeps of projected Gauss-Seidel
    /// Largest constraint violation of a contact that a solve may leave, m/s; not figure 20's 1e-6, see preset().
    /// Targets of equation 16 below it count as zero. Negative: 1/4096 of what gravity adds in a step, and at most what
    /// moves a pair of bodies by 1/2048 of its rest distance in one.
    double static_tolerance = -1;
    /// Of that tolerance, where none is given in m/s. Below 1 only static_iterations ends a solve above it.
    double tolerance_share = 1;
    /// Of the rest distance: how far the bodies of a pair may move before the features in contact are searched for
    /// anew; their points, gaps and normals are always those of the present poses. 0: in every step, as the paper does.
    double contact_reuse = 1.0 / 64;
    bool warm_start = true;        ///< start PGS from the last impulses; not the paper's, which is from zero
    bool shock_propagation = true; ///< after PGS reached its limit

    bool sleeping = true; ///< resting islands sleep; in the paper none do
    Trajectory trajectory = Trajectory::linear;
    CcdMethod ccd = CcdMethod::conservative;
    VelocityUpdate velocity_update = VelocityUpdate::trapezoidal; ///< not the paper's, which is end
    ContactSolver contact_solver = ContactSolver::exact;          ///< not the paper's, which is pgs
    Tangents tangents = Tangents::cone;                           ///< not the paper's, which are random
    Rigidification rigidification = Rigidification::kinematic;
    UnsatisfiableScript unsatisfiable_script = UnsatisfiableScript::hold;
    InitialOverlap initial_overlap = InitialOverlap::error;

    friend bool operator==(const Settings&, const Settings&) = default;
};

/// What there is to know about one setting without reading the source. `type` is "number", "integer", "boolean" or the
/// choices "a | b"; `effect` says what a change costs or gains in speed and accuracy.
struct SettingInfo {
    std::string_view key;
    std::string type, unit, range, default_value, description, effect;
};

/// Every setting, in the order of the struct.
[[nodiscard]] std::vector<SettingInfo> list_settings();

/// The value of a setting as text that set_setting reads back exactly. Throws InputError for an unknown key.
[[nodiscard]] std::string setting_value(const Settings& settings, std::string_view key);

/// Sets one setting from text, as `--set key=value` does. Throws InputError for an unknown key (naming the nearest
/// known one) and for a value of the wrong type or outside its range.
void set_setting(Settings& settings, std::string_view key, std::string_view value);

/// Every problem of `settings`, "key: reason" each; empty when they can be run.
[[nodiscard]] std::vector<std::string> validate_settings(const Settings& settings);

/// paper, preview, balanced, accurate, reference.
[[nodiscard]] std::vector<std::string_view> preset_names();

/// The settings of a preset; what a scene file or --set gives explicitly replaces them.
///  - preview: for a first look: hits solved together after two rounds over the pairs, few iterations, contacts kept
///    for longer; what is left of an impact is resolved without rebound. The guarantees hold all the same.
///  - paper: figure 20 as printed: friction pyramids of random direction, 1e-6 m/s, no warm start, contact forces at
///    the end of a step.
///  - balanced: `Settings{}`, figure 20 with Coulomb's cone, warm start and a tolerance that goes by gravity and the
///    bodies' sizes: figure 20's 1e-6 m/s is never reached in a pile within 1000 sweeps and only means "always run to
///    the limit". 1e-4 m/s, that of boats at 1/24 s, lets a resting contact creep by at most 0.1 mm per second. In a
///    tower the errors of all contacts below add up: the top of 20 blocks sways by about 0.4 mm at up to 15 times the
///    tolerance.
///  - accurate: four inner steps, tight tolerance, rotating trajectories certified, no sleeping.
///  - reference: accurate with eight inner steps and iteration limits that are practically never reached, to measure
///    the others against.
/// Throws InputError for an unknown name.
[[nodiscard]] Settings preset(std::string_view name);

} // namespace flotilla
