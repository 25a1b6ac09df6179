// SPDX-License-Identifier: MIT
// The matrix of extremes: small scenes, each with one or two axes at an extreme value and the others at ordinary ones.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <flotilla/scene.hpp>

namespace flotilla::extremes {

/// Gravity of a step, the first is 1, from the scene's own.
using GravityOfStep = std::function<Vec3(const Vec3& gravity, int step)>;

/// What a scene is made from. SI units.
struct Knobs {
    enum class Shape {
        cube,
        needle,
        strip,
        triangle,
        flat_box,
        duplicates,
        slivers,
        collinear,
        soup,
        shell,
        ring,
        chain
    };
    enum class Crowd { few, sheets, sliding_sheets, closing_walls, convoy, fixed_only, none, one };

    Settings settings;
    Shape shape = Shape::cube;
    Crowd crowd = Crowd::few;
    double aspect = 1;             ///< of needles and strips
    double size = 1;               ///< m
    double size_ratio = 1;         ///< of every other body to the first
    double mass_ratio = 1;         ///< the same
    double speed = 1;              ///< m/s
    double spin = 1;               ///< rad/s
    double place = 0;              ///< m from the origin, along each axis
    double gravity = 9.8;          ///< m/s^2
    bool deep = false;             ///< a ball of 20,480 triangles among the bodies
    GravityOfStep gravity_of_step; ///< if it changes
};

/// One extreme value of an axis.
struct Extreme {
    std::string axis, value;
    std::function<void(Knobs&)> set;
};

/// Of all axes that are part of a scene.
[[nodiscard]] std::vector<Extreme> all_extremes();

/// Gravity that has another direction, or another size, in every step: what a World is told between steps.
[[nodiscard]] std::vector<Extreme> changing_gravity();

/// Bodies that fall onto each other and a floor, or that fly at each other where there is no gravity and nothing else.
enum class Situation { pile, clash };

struct Cell {
    Situation situation = Situation::pile;
    std::vector<Extreme> extremes;               ///< of different axes
    std::function<SceneDescription()> own_scene; ///< of one that is not made from knobs; its extreme sets nothing

    [[nodiscard]] std::string name() const;
    [[nodiscard]] SceneDescription scene() const;
    [[nodiscard]] GravityOfStep gravity_of_step() const; ///< empty where it is the scene's all the time

  private:
    [[nodiscard]] Knobs knobs() const;
};

/// Every value alone and every two of different axes, in both situations; gravity changes in piles alone.
[[nodiscard]] std::vector<Cell> all_cells();

/// Scenes of their own that no two axes make: many bodies, large meshes, bodies in each other's hollows.
[[nodiscard]] std::vector<Cell> large_cells();

} // namespace flotilla::extremes
