// SPDX-License-Identifier: MIT
// A heap of everyday things.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/rotation.hpp"
#include "mesh/primitives.hpp"
#include "scene/household_meshes.hpp"
#include "scene/library.hpp"

namespace flotilla::library {

namespace {

enum Thing : std::int32_t { mug, bowl, plate, stool, pallet, gear, ring, triangle };

// Stoneware, wood, plastic and sheet metal, by kg/m^2 where the surface has no thickness, else by kg/m^3.
std::vector<ShapeDescription> thing_shapes() {
    const auto thing = [](const char* name, TriangleMesh mesh, MassKind kind, double density) {
        ShapeDescription shape = shape_of(name, std::move(mesh));
        shape.mass_kind = kind;
        shape.mass_value = density;
        return shape;
    };
    constexpr double kSide = 0.2;
    const double r = kSide / std::sqrt(3.0); // of the circle through the triangle's corners
    return {thing("mug", mug_mesh(), MassKind::surface_density, 10),
            thing("bowl", soup_bowl_mesh(), MassKind::surface_density, 10),
            thing("plate", dinner_plate_mesh(), MassKind::surface_density, 10),
            thing("stool", stool_mesh(), MassKind::density, 700),
            thing("pallet", pallet_mesh(), MassKind::density, 500),
            thing("gear", gear_mesh(), MassKind::density, 1200),
            thing("ring", make_ring(0.09, 0.012, 20, 6), MassKind::density, 700),
            thing("triangle", {{{r, 0, 0}, {-r / 2, kSide / 2, 0}, {-r / 2, -kSide / 2, 0}}, {{0, 1, 2}}},
                  MassKind::surface_density, 10)};
}

// What falls, over and over: one of each first, the large ones apart from each other.
constexpr std::array kOrder{stool, mug, plate, bowl,  gear, ring, pallet, triangle, mug,      plate,
                            bowl,  mug, gear,  plate, mug,  ring, bowl,   mug,      triangle, mug};

constexpr bool is_large(Thing thing) { return thing == stool || thing == pallet; }

// Places for the bounding spheres of `things`, in bands one above the other, each of large things below small ones,
// so that a column of things of unlike size is no higher than it must be. Every band is turned, for the last layer of
// a band is not full.
std::vector<Vec3> bands(const std::vector<Thing>& things, double large, double small, double column, double bottom,
                        std::uint64_t seed) {
    constexpr double kApart = 1.06, kTurn = 2.4; // radii: sphere and jitter; rad: the golden angle
    const std::size_t count = things.size();
    const auto num_bands = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(count))));
    std::vector<Vec3> places(count);
    for (std::size_t part = 0; part < 2 * num_bands; ++part) {
        const bool of_large = part % 2 == 0;
        const double radius = of_large ? large : small;
        std::vector<std::size_t> members;
        for (std::size_t i = part / 2 * count / num_bands; i < (part / 2 + 1) * count / num_bands; ++i)
            if (is_large(things[i]) == of_large) members.push_back(i);
        if (members.empty()) continue;
        bottom += kApart * radius;
        constexpr std::uint64_t kOther = 0x9e3779b97f4a7c15; // jitter is keyed by the place in its column
        const std::vector<Vec3> packed = packed_column(members.size(), radius, std::max(column - kApart * radius, 0.0),
                                                       bottom, seed + part * kOther);
        const SinCos turn = sin_cos(kTurn * static_cast<double>(part));
        for (std::size_t k = 0; k < members.size(); ++k) {
            const Vec3& p = packed[k];
            places[members[k]] = {turn.cos * p.x - turn.sin * p.y, turn.sin * p.x + turn.cos * p.y, p.z};
            bottom = std::max(bottom, p.z);
        }
        bottom += kApart * radius;
    }
    return places;
}

} // namespace

// The bowl is large enough for all: a settled heap takes about 0.0035 m^3 a thing, and 70 % of the bowl is left to it.
SceneDescription household(int bodies, std::uint64_t seed) {
    constexpr double kRim = 75 * std::numbers::pi / 180, kVolumePerThing = 0.0035 / 0.7, kLeast = 0.5;
    const double depth = 1 - sin_cos(kRim).cos; // of the cap of a unit sphere
    const double unit_volume = std::numbers::pi * depth * depth * (3 - depth) / 3;
    const double radius = std::max(kLeast, std::cbrt((bodies - 2) * kVolumePerThing / unit_volume));

    SceneDescription scene;
    scene.settings.friction = 0.4;
    scene.shapes = thing_shapes();
    std::vector<BoundingSphere> spheres;
    double large = 0, small = 0;
    for (const ShapeDescription& shape : scene.shapes) {
        double& largest = is_large(static_cast<Thing>(spheres.size())) ? large : small;
        spheres.push_back(bounding_sphere({shape.vertices, shape.triangles}));
        largest = std::max(largest, spheres.back().radius);
    }
    std::vector<Thing> things;
    for (std::size_t i = 0; i + 2 < static_cast<std::size_t>(bodies); ++i) things.push_back(kOrder[i % kOrder.size()]);
    const std::vector<Vec3> places =
        bands(things, large, small, 0.95 * radius * sin_cos(kRim).sin, radius * depth, seed);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto shape = static_cast<std::size_t>(things[i]);
        const Quat turn = random_rotation(seed, i);
        scene.bodies.push_back(body_of(scene.shapes[shape].name + std::to_string(i), things[i], BodyType::dynamic,
                                       places[i] - rotate(turn, spheres[shape].center)));
        scene.bodies.back().rotation = turn;
    }
    const auto next = static_cast<std::int32_t>(scene.shapes.size());
    scene.shapes.push_back(shape_of("large bowl", bowl_mesh(radius, kRim, 20, 64)));
    scene.shapes.push_back(shape_of("ground", make_plate(6 * radius, 6 * radius)));
    scene.bodies.push_back(body_of("large bowl", next, BodyType::fixed, {}));
    scene.bodies.push_back(body_of("ground", next + 1, BodyType::fixed, {0, 0, -0.1 * radius}));
    for (BodyDescription& body : scene.bodies) body.friction = scene.settings.friction;
    return scene;
}

} // namespace flotilla::library
