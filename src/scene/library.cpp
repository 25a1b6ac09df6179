// SPDX-License-Identifier: MIT
#include "scene/library.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <flotilla/error.hpp>
#include <flotilla/scene_library.hpp>

#include "base/floating_point.hpp"
#include "base/random.hpp"
#include "base/rotation.hpp"
#include "base/text.hpp"

namespace flotilla {

namespace library {

namespace {

constexpr double kPi = 3.14159265358979323846;

double uniform(std::uint64_t seed, Purpose purpose, std::size_t id, int draw) {
    return unit_interval(random_bits(seed, static_cast<std::uint64_t>(purpose), static_cast<std::uint64_t>(id), draw));
}

} // namespace

// Shoemake (1992): two points on circles whose radii share the unit evenly.
Quat random_rotation(std::uint64_t seed, std::size_t id) {
    const double share = uniform(seed, Purpose::orientation, id, 0);
    const SinCos a = sin_cos(2 * kPi * uniform(seed, Purpose::orientation, id, 1));
    const SinCos b = sin_cos(2 * kPi * uniform(seed, Purpose::orientation, id, 2));
    const double r = std::sqrt(1 - share), s = std::sqrt(share);
    return normalized(Quat{s * b.cos, r * a.sin, r * a.cos, s * b.sin});
}

// The first point of a sequence in the cube that lies in the ball; the centre, should 64 of them miss it (chance
// 1e-20).
Vec3 random_in_ball(std::uint64_t seed, std::size_t id, double radius) {
    for (int draw = 0; draw < 64; ++draw) {
        const auto coordinate = [&](int axis) { return 2 * uniform(seed, Purpose::jitter, id, 3 * draw + axis) - 1; };
        const Vec3 p{coordinate(0), coordinate(1), coordinate(2)};
        if (length_sq(p) <= 1) return radius * p;
    }
    return {};
}

std::vector<Vec3> packed_column(std::size_t count, double radius, double column_radius, double bottom,
                                std::uint64_t seed) {
    // Neighbours stand 2.12 radii apart and move by up to 0.055 radii each, which leaves 0.01 radii between the
    // spheres.
    constexpr double kSpacing = 2.12, kJitter = 0.055;
    const double d = kSpacing * radius;
    const double row = d * std::sqrt(3.0) / 2, layer = d * std::sqrt(2.0 / 3.0);
    const double limit = std::max(column_radius - kJitter * radius, 0.0);
    const int reach = static_cast<int>(limit / row) + 2;

    std::vector<Vec3> places;
    for (int k = 0; places.size() < count; ++k) {
        // Odd layers lie in the hollows of even ones. The lattice is shifted so that both have places near the axis.
        const Vec3 shift = k % 2 == 0 ? Vec3{0, 0, 0} : Vec3{d / 2, row / 3, 0};
        const bool narrow =
            length(shift) > limit; // no hollow inside the column: one above the other, a full diameter apart
        if (narrow && k % 2 != 0) continue;
        for (int j = -reach; j <= reach; ++j)
            for (int i = -reach; i <= reach && places.size() < count; ++i) {
                const Vec3 p = Vec3{(i + 0.5 * (j & 1)) * d, j * row, 0} + shift;
                if (length(p) > limit && (i != 0 || j != 0)) continue;
                places.push_back({p.x, p.y, bottom + k * layer});
            }
    }
    for (std::size_t i = 0; i < places.size(); ++i) places[i] += random_in_ball(seed, i, kJitter * radius);
    return places;
}

ShapeDescription shape_of(std::string name, TriangleMesh mesh) {
    ShapeDescription shape;
    shape.name = std::move(name);
    shape.vertices = std::move(mesh.vertices);
    shape.triangles = std::move(mesh.triangles);
    return shape;
}

BodyDescription body_of(std::string name, std::int32_t shape, BodyType type, const Vec3& position) {
    BodyDescription body;
    body.name = std::move(name);
    body.shape = shape;
    body.type = type;
    body.position = position;
    return body;
}

TriangleMesh bowl_mesh(double radius, double angle, int rings, int segments) {
    TriangleMesh mesh;
    mesh.vertices.push_back({});
    for (int i = 1; i <= rings; ++i) {
        const SinCos polar = sin_cos(angle * i / rings);
        for (int j = 0; j < segments; ++j) {
            const SinCos around = sin_cos(2 * kPi * j / segments);
            mesh.vertices.push_back(
                {radius * polar.sin * around.cos, radius * polar.sin * around.sin, radius * (1 - polar.cos)});
        }
    }
    const auto at = [&](int ring, int j) { return 1 + (ring - 1) * segments + j % segments; };
    for (int j = 0; j < segments; ++j) mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    for (int i = 1; i < rings; ++i)
        for (int j = 0; j < segments; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return mesh;
}

} // namespace library

namespace {

struct Entry {
    LibraryScene info;
    SceneDescription (*make)(int bodies, std::uint64_t seed);
};

constexpr int kMaxBodies = 1000000;

constexpr std::array kEntries{
    Entry{{"boats-in-bowl", 102, 3, kMaxBodies,
           "boats fall into a bowl that is large enough for all of them (paper, figures 12, 13, 16, 17, 19)"},
          library::boats_in_bowl},
    Entry{{"boats-in-bowls", 203, 3, kMaxBodies,
           "boats fall into bowls side by side, 100 into each where the bodies are 101 k + 1: piles of equal depth"},
          library::boats_in_bowls},
    Entry{{"household", 102, 10, kMaxBodies,
           "mugs, bowls, plates, stools, pallets, gears, rings and loose triangles fall into a large bowl"},
          library::household},
    Entry{{"wires", 101, 2, kMaxBodies,
           "rods, hoops and frames of segments and clouds of points, without any surface, fall into a bowl"},
          library::wires},
    Entry{{"rocks", 1329, 7, kMaxBodies,
           "convex rocks of 16 triangles fall on a floor with walls, a scripted cylinder ploughs through them"},
          library::rocks},
    Entry{
        {"triangles-on-pegs", 186, 6, kMaxBodies, "flat triangles fall on fixed pegs and the ground (paper, figure 1)"},
        library::triangles_on_pegs},
    Entry{{"stack", 11, 2, 10000, "boxes stacked on the ground, each a rest distance above the one below"},
          library::stack},
    Entry{{"falling-boats", 2, 2, kMaxBodies, "boats fall on the ground"}, library::falling_boats},
    Entry{{"fast-plate", 2, 2, 2, "a plate of two triangles hits a fixed one at 100 m/s"}, library::fast_plate},
    Entry{{"closing-walls", 3, 3, 3, "two scripted walls close on a boat until they meet"}, library::closing_walls},
    Entry{
        {"catapult", 11, 6, 105, "a fast block hits one end of a plank and launches blocks from the other (figure 2)"},
        library::catapult},
    Entry{{"sliding-boxes", 3, 3, 3,
           "a box slides over a slab of many triangles, another rests on it (figures 3, 4, 11)"},
          library::sliding_boxes},
    Entry{
        {"turning-strip", 2, 2, 2,
         "a strip turns past a particle that only its true, curved path meets (figure 5); see the setting trajectory"},
        library::turning_strip},
    Entry{{"particle-and-block", 2, 2, 2,
           "a particle's path in one step enters a block's top and leaves by its side (figure 6)"},
          library::particle_and_block},
    Entry{{"ball-on-ground", 2, 2, 2, "a ball of 1,280 triangles bounces (figures 7, 8)"}, library::ball_on_ground},
    Entry{{"stack-and-ball", 10, 3, 1000,
           "a ball hits a stack of boxes with the failsafe forced (figure 9); see the setting rigidification"},
          library::stack_and_ball},
    Entry{{"hanging-rings", 2003, 5, kMaxBodies,
           "chains of rings without thickness are hit by two rolling balls of 1,280 triangles (figure 10)"},
          library::hanging_rings},
    Entry{
        {"pinched-block", 5, 5, 5, "two cylinders, pressed by two planes, hold a block by friction alone (figure 14)"},
        library::pinched_block},
    Entry{{"boats-and-ball", 12, 4, 1000, "a ball of 1,280 triangles at 100 m/s hits a heap of boats (figures 15, 18)"},
          library::boats_and_ball},
};

} // namespace

std::vector<LibraryScene> list_scenes() {
    std::vector<LibraryScene> scenes;
    for (const Entry& entry : kEntries) scenes.push_back(entry.info);
    return scenes;
}

SceneDescription make_scene(std::string_view name, int bodies, std::uint64_t seed) {
    const DefaultFloatingPoint environment;
    std::vector<std::string_view> names;
    for (const Entry& entry : kEntries) names.push_back(entry.info.name);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        throw InputError(unknown_name("scene", name, names) + " (flotilla scene --list prints them)");
    const Entry& entry = kEntries[static_cast<std::size_t>(found - names.begin())];
    if (bodies == 0) bodies = entry.info.default_bodies;
    if (bodies < entry.info.min_bodies || bodies > entry.info.max_bodies)
        throw InputError("scene " + std::string(name) + " has " + std::to_string(entry.info.min_bodies) + " to " +
                         std::to_string(entry.info.max_bodies) + " bodies, not " + std::to_string(bodies));
    return entry.make(bodies, seed);
}

} // namespace flotilla
