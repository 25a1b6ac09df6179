// SPDX-License-Identifier: MIT
// Bodies, and interference of two of them at one time: Guendelman, Bridson, Fedkiw 2003, sections 3 and 4.
#pragma once

#include <cstddef>
#include <vector>

#include <flotilla/scene.hpp>

#include "poses_file.hpp"
#include "solid.hpp"

namespace flotilla::baseline {

struct Pose {
    Vec3 center; ///< of mass, m, world
    Quat rotation;
};

struct Body {
    std::size_t solid = 0;
    bool movable = false;
    double friction = 0, restitution = 0;
    Pose pose;               ///< at the start of the step
    Vec3 velocity;           ///< of the centre of mass, m/s
    Vec3 angular_velocity;   ///< rad/s, world
    double inverse_mass = 0; ///< 1/kg; 0 for fixed bodies, and for those that shock propagation has frozen
    Mat3 inverse_inertia;    ///< world axes at the start of the step; 0 likewise
};

struct Bodies {
    std::vector<Solid> solids;
    std::vector<Body> all;
    Vec3 gravity;

    [[nodiscard]] const Solid& solid(std::size_t body) const { return solids[all[body].solid]; }
};

/// Throws InputError for kinematic bodies, which [15] has and this program does not.
[[nodiscard]] Bodies make_bodies(const SceneDescription& scene, int samples_across, double thickness);

/// Inverse mass and inertia of a movable body at its present orientation.
void set_inverse_mass(const Solid& solid, Body& body);

/// Where `body` gets in dt seconds with a velocity of velocity + extra. The rotation is the exponential map.
[[nodiscard]] Pose moved(const Body& body, double dt, const Vec3& extra = {});

/// Moves it, keeping its angular momentum.
void advance(const Solid& solid, Body& body, double dt);

/// Of the surface point at `arm` from the centre of mass, m/s.
[[nodiscard]] inline Vec3 point_velocity(const Body& body, const Vec3& arm) {
    return body.velocity + cross(body.angular_velocity, arm);
}

/// A sample of one body inside another: place, depth > 0, and the unit normal from the second body of the pair to the
/// first.
struct Interference {
    double depth = 0; ///< m
    Vec3 place;       ///< m, world
    Vec3 normal;
};

/// All samples of either solid that are inside the other one, deepest first. Section 3: "interference detection".
void find_interferences(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b,
                        std::vector<Interference>& out);

/// The trajectory's rows.
[[nodiscard]] std::vector<PoseRow> rows(const Bodies& bodies);

} // namespace flotilla::baseline
