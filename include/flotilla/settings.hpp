// SPDX-License-Identifier: MIT
// Every setting of a run in one aggregate. Defaults are the paper's (figure 20) unless the field says otherwise; the names
// are the keys of `settings` in a scene file and of --set.
#pragma once

#include <cstdint>

namespace flotilla {

enum class Trajectory : std::uint8_t {
    linear, ///< one straight segment per vertex and step (paper, section 3.1)
    rigid,  ///< segments of equal angle, so that the certificate covers the rotating motion itself
};
enum class CcdMethod : std::uint8_t {
    conservative, ///< directional conservative advancement, no false negatives
    cubic,        ///< roots of the coplanarity cubic with a tolerance (paper, section 3.1); a baseline, not proved
};
enum class Tangents : std::uint8_t {
    random,  ///< friction pyramid turned by a generator keyed by (seed, step, features)
    aligned, ///< first tangent along the slip velocity: sliding friction without the pyramid's bias
};
enum class ContactSolver : std::uint8_t { pgs };
enum class Rigidification : std::uint8_t {
    kinematic, ///< clusters keep their members' relative motion (paper, section 4.2.2)
    rigid,     ///< clusters move as one rigid body (section 4.2.1): the paper's comparison in figure 9
};
enum class UnsatisfiableScript : std::uint8_t { hold, error };
enum class InitialOverlap : std::uint8_t { error, separate };

/// Lengths are metres; a length of 0 means "derived per pair from body size" as the field says.
struct Settings {
    double time_step = 1.0 / 24.0; ///< s, > 0
    double friction = 0.1;         ///< default of bodies, >= 0
    double restitution = 0.1;      ///< default of bodies, in [0, 1]
    std::uint64_t seed = 0;        ///< of the tangent generator

    double rest_distance = 0; ///< d_rest; 0: size/330, size = smaller bounding-sphere diameter of the movable bodies
    double proximity_distance = 0;  ///< d_proximity > d_rest; 0: 2 d_rest
    double separation = 0;          ///< s_min, least certified distance; 0: d_rest/50
    double proximity_angle = 3;     ///< theta_proximity, degrees, in (0, 90)
    double approach_threshold = -1; ///< m/s, slower end proximities are left to static contact; < 0: |g| dt/2

    int collision_iterations = 100;    ///< sweeps of Algorithm 1
    int collision_pair_iterations = 4; ///< impulses per pair and sweep
    int dynamic_iterations = 100;      ///< sweeps of Algorithm 2
    int dynamic_pair_iterations = 20;  ///< impulses per pair and sweep
    int static_iterations = 1000;      ///< sweeps of projected Gauss-Seidel
    double static_tolerance = 1e-6;    ///< L-infinity constraint violation, m/s
    bool warm_start = true;            ///< start PGS from the last impulses
    bool shock_propagation = true;     ///< after PGS reached its limit

    bool sleeping = true; ///< resting islands sleep
    Trajectory trajectory = Trajectory::linear;
    CcdMethod ccd = CcdMethod::conservative;
    ContactSolver contact_solver = ContactSolver::pgs;
    Tangents tangents = Tangents::random;
    Rigidification rigidification = Rigidification::kinematic;
    UnsatisfiableScript unsatisfiable_script = UnsatisfiableScript::hold;
    InitialOverlap initial_overlap = InitialOverlap::error;

    friend bool operator==(const Settings&, const Settings&) = default;
};

} // namespace flotilla
