// SPDX-License-Identifier: MIT
// Scenes with boats.
#include <algorithm>
#include <cmath>

#include "base/rotation.hpp"
#include "mesh/primitives.hpp"
#include "scene/library.hpp"

namespace flotilla::library {

namespace {

constexpr double kBoatDensity = 10; // kg/m^2
constexpr double kPi = 3.14159265358979323846;

ShapeDescription boat_shape() {
    ShapeDescription boat = shape_of("boat", boat_mesh());
    boat.mass_kind = MassKind::surface_density;
    boat.mass_value = kBoatDensity;
    return boat;
}

// Boats with random orientations whose bounding spheres stand at `places`; numbered on from those that are there.
void add_boats(SceneDescription& scene, const std::vector<Vec3>& places, const Vec3& sphere_center,
               std::uint64_t seed) {
    for (const Vec3& place : places) {
        const std::size_t i = scene.bodies.size();
        const Quat turn = random_rotation(seed, i);
        BodyDescription boat =
            body_of("boat" + std::to_string(i), 0, BodyType::dynamic, place - rotate(turn, sphere_center));
        boat.rotation = turn;
        scene.bodies.push_back(std::move(boat));
    }
}

// The bowl's radius, m. A settled pile takes about 4.5 m^3 per boat (a boat's box has 2.4 m^3; hulls nest a little and
// lie criss-cross); 70 % of the bowl is left to it, so that the impact throws none out. Below 4.5 m a boat would bridge
// the bowl.
double bowl_radius(int boats, double angle) {
    constexpr double kVolumePerBoat = 4.5 / 0.7, kLeast = 4.5;
    const double h = 1 - sin_cos(angle).cos; // depth of the cap of a unit sphere
    const double unit_volume = kPi * h * h * (3 - h) / 3;
    return std::max(kLeast, std::cbrt(boats * kVolumePerBoat / unit_volume));
}

constexpr double kBowlAngle = 80 * kPi / 180;

// Places for `boats` bounding spheres above a bowl on the z axis: whole boats inside the rim, the lowest just above it.
std::vector<Vec3> places_above_bowl(int boats, double bowl, const BoundingSphere& sphere, std::uint64_t seed) {
    constexpr double kAir = 0.3;
    const SinCos rim = sin_cos(kBowlAngle);
    const double column = bowl * rim.sin - sphere.radius - kAir;
    const double bottom = bowl * (1 - rim.cos) + 1.1 * sphere.radius;
    return packed_column(static_cast<std::size_t>(boats), sphere.radius, column, bottom, seed);
}

} // namespace

SceneDescription boats_in_bowl(int bodies, std::uint64_t seed) {
    const int boats = bodies - 2;
    const double radius = bowl_radius(boats, kBowlAngle);
    SceneDescription scene;
    scene.shapes = {boat_shape(), shape_of("bowl", bowl_mesh(radius, kBowlAngle, 20, 64)),
                    shape_of("ground", make_plate(6 * radius, 6 * radius))};
    const BoundingSphere sphere = bounding_sphere({scene.shapes[0].vertices, scene.shapes[0].triangles});
    add_boats(scene, places_above_bowl(boats, radius, sphere, seed), sphere.center, seed);
    scene.bodies.push_back(body_of("bowl", 1, BodyType::fixed, {}));
    scene.bodies.push_back(body_of("ground", 2, BodyType::fixed, {0, 0, -0.1 * radius}));
    return scene;
}

// Bowls of one size on a square grid, so far apart that no boat can bridge two; their boats differ.
SceneDescription boats_in_bowls(int bodies, std::uint64_t seed) {
    constexpr int kBodiesPerBowl = 101; // with the bowl
    const int bowls = std::max(1, (bodies - 1 + kBodiesPerBowl / 2) / kBodiesPerBowl);
    const int boats = bodies - 1 - bowls;
    const double radius = bowl_radius((boats + bowls - 1) / bowls, kBowlAngle);
    const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(bowls))));
    const double spacing = 3 * radius, middle = 0.5 * (columns - 1);
    const auto axis = [&](int bowl) {
        return Vec3{spacing * (bowl % columns - middle), spacing * (bowl / columns - middle), 0};
    };

    SceneDescription scene;
    const double ground = spacing * columns + 3 * radius;
    scene.shapes = {boat_shape(), shape_of("bowl", bowl_mesh(radius, kBowlAngle, 20, 64)),
                    shape_of("ground", make_plate(ground, ground))};
    const BoundingSphere sphere = bounding_sphere({scene.shapes[0].vertices, scene.shapes[0].triangles});
    for (int k = 0; k < bowls; ++k) {
        constexpr std::uint64_t kOther = 0x9e3779b97f4a7c15; // jitter is keyed by the place in its column
        auto places = places_above_bowl(boats / bowls + (k < boats % bowls ? 1 : 0), radius, sphere,
                                        seed + static_cast<std::uint64_t>(k) * kOther);
        for (Vec3& place : places) place += axis(k);
        add_boats(scene, places, sphere.center, seed);
    }
    for (int k = 0; k < bowls; ++k)
        scene.bodies.push_back(body_of("bowl" + std::to_string(k), 1, BodyType::fixed, axis(k)));
    scene.bodies.push_back(body_of("ground", 2, BodyType::fixed, {0, 0, -0.1 * radius}));
    return scene;
}

SceneDescription falling_boats(int bodies, std::uint64_t seed) {
    const auto boats = static_cast<std::size_t>(bodies - 1);
    SceneDescription scene;
    scene.shapes = {boat_shape()};
    const BoundingSphere sphere = bounding_sphere({scene.shapes[0].vertices, scene.shapes[0].triangles});
    const double column = sphere.radius * std::cbrt(static_cast<double>(boats));
    scene.shapes.push_back(
        shape_of("ground", make_plate(10 * (column + sphere.radius), 10 * (column + sphere.radius))));
    add_boats(scene, packed_column(boats, sphere.radius, column, 1.5 * sphere.radius, seed), sphere.center, seed);
    scene.bodies.push_back(body_of("ground", 1, BodyType::fixed, {}));
    return scene;
}

// Figures 15 and 18. The boats fall into a heap; the ball comes when that lies still, and crosses it in a step of 1/24
// s.
SceneDescription boats_and_ball(int bodies, std::uint64_t seed) {
    constexpr double kBall = 0.5, kSpeed = 100, kFlight = 5, kHeight = 0.8, kGravity = 9.8; // m, m/s, s, m, m/s^2
    SceneDescription scene = falling_boats(bodies - 1, seed);
    scene.settings.friction = 0.3;
    scene.shapes.push_back(shape_of("ball", make_sphere(kBall, 3)));
    scene.shapes.back().mass_kind = MassKind::density;
    scene.shapes.back().mass_value = 300;
    scene.shapes[1] = shape_of("ground", make_plate(3 * kSpeed * kFlight, 3 * kSpeed * kFlight));
    scene.bodies.push_back(body_of("ball", 2, BodyType::dynamic, {0, -kSpeed * kFlight, kHeight}));
    scene.bodies.back().velocity = {0, kSpeed, 0.5 * kGravity * kFlight};
    for (BodyDescription& body : scene.bodies) body.friction = scene.settings.friction;
    return scene;
}

SceneDescription closing_walls(int, std::uint64_t) {
    SceneDescription scene;
    scene.gravity = {};
    scene.shapes = {boat_shape(), shape_of("wall", make_plate(6, 6))};
    scene.bodies.push_back(body_of("boat", 0, BodyType::dynamic, {}));
    // Upright, 2 m from the boat's middle at first, through each other at the end.
    const Quat upright = rotation_from_vector({kPi / 2, 0, 0});
    for (const double side : {-1.0, 1.0}) {
        BodyDescription wall = body_of(side < 0 ? "left" : "right", 1, BodyType::kinematic, {0, 2 * side, 0});
        wall.rotation = upright;
        wall.keyframes = {{0, {0, 2 * side, 0}, upright}, {2, {0, -0.1 * side, 0}, upright}};
        scene.bodies.push_back(std::move(wall));
    }
    return scene;
}

} // namespace flotilla::library
