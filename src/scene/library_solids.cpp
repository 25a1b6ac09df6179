// SPDX-License-Identifier: MIT
// Scenes with triangles, boxes and plates.
#include <cmath>

#include "base/rotation.hpp"
#include "mesh/primitives.hpp"
#include "scene/library.hpp"
#include "scene/scene.hpp"

namespace flotilla::library {

SceneDescription triangles_on_pegs(int bodies, std::uint64_t seed) {
    constexpr double kSide = 1, kPegRadius = 0.06, kPegHeight = 2, kSpacing = 1.3;
    // About a seventh of the bodies are pegs in a square: 25 of the paper's 186.
    const int row = std::max(2, static_cast<int>(std::sqrt(bodies / 7.0)));
    const auto triangles = static_cast<std::size_t>(bodies - row * row - 1);
    const double width = kSpacing * (row - 1);
    const double r = kSide / std::sqrt(3.0); // of the circle through the corners

    SceneDescription scene;
    ShapeDescription triangle =
        shape_of("triangle", {{{r, 0, 0}, {-r / 2, kSide / 2, 0}, {-r / 2, -kSide / 2, 0}}, {{0, 1, 2}}});
    triangle.mass_kind = MassKind::surface_density;
    triangle.mass_value = 10;
    scene.shapes = {triangle, shape_of("peg", make_cylinder(kPegRadius, kPegHeight, 12)),
                    shape_of("ground", make_plate(40 * (width + 5), 40 * (width + 5)))};

    const std::vector<Vec3> places = packed_column(triangles, r, width / 2 + kSide / 2, kPegHeight + 1.5 * r, seed);
    for (std::size_t i = 0; i < triangles; ++i) {
        scene.bodies.push_back(body_of("triangle" + std::to_string(i), 0, BodyType::dynamic, places[i]));
        scene.bodies.back().rotation = random_rotation(seed, i);
    }
    for (int i = 0; i < row * row; ++i)
        scene.bodies.push_back(
            body_of("peg" + std::to_string(i), 1, BodyType::fixed,
                    {kSpacing * (i % row) - width / 2, kSpacing * (i / row) - width / 2, kPegHeight / 2 + 0.001}));
    scene.bodies.push_back(body_of("ground", 2, BodyType::fixed, {}));
    // A triangle that leans at 45 degrees needs more than the default.
    scene.settings.friction = 0.6;
    for (BodyDescription& body : scene.bodies) body.friction = scene.settings.friction;
    return scene;
}

SceneDescription stack(int bodies, std::uint64_t) {
    constexpr double kSide = 1;
    const double gap = kSide * std::sqrt(3.0) / kSizePerRestDistance;
    SceneDescription scene;
    ShapeDescription box = shape_of("box", make_box(kSide, kSide, kSide));
    box.mass_kind = MassKind::density;
    box.mass_value = 500;
    scene.shapes = {box, shape_of("ground", make_plate(20, 20))};
    for (int i = 0; i + 1 < bodies; ++i)
        scene.bodies.push_back(
            body_of("box" + std::to_string(i), 0, BodyType::dynamic, {0, 0, (i + 0.5) * kSide + (i + 1) * gap}));
    scene.bodies.push_back(body_of("ground", 1, BodyType::fixed, {}));
    return scene;
}

SceneDescription fast_plate(int, std::uint64_t) {
    SceneDescription scene;
    ShapeDescription plate = shape_of("plate", make_plate(1, 1));
    plate.mass_kind = MassKind::surface_density;
    plate.mass_value = 10;
    scene.shapes = {plate, shape_of("target", make_plate(10, 10))};
    scene.bodies.push_back(body_of("plate", 0, BodyType::dynamic, {0.1, 0.2, 10}));
    scene.bodies.back().velocity = {0, 0, -100};
    scene.bodies.push_back(body_of("target", 1, BodyType::fixed, {}));
    return scene;
}

} // namespace flotilla::library
