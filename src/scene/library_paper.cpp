// SPDX-License-Identifier: MIT
// The paper's examples that the other files do not have. Sizes and speeds that it does not print are ours. Balls are
// meshes of flat triangles here, not spheres.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/rotation.hpp"
#include "mesh/primitives.hpp"
#include "scene/library.hpp"
#include "scene/scene.hpp"

namespace flotilla::library {

namespace {

constexpr double kPi = std::numbers::pi;

ShapeDescription solid(const char* name, TriangleMesh mesh, double density) {
    ShapeDescription shape = shape_of(name, std::move(mesh));
    shape.mass_kind = MassKind::density;
    shape.mass_value = density;
    return shape;
}

ShapeDescription shell(const char* name, TriangleMesh mesh, double surface_density) {
    ShapeDescription shape = shape_of(name, std::move(mesh));
    shape.mass_kind = MassKind::surface_density;
    shape.mass_value = surface_density;
    return shape;
}

/// A little more than the default rest distance of bodies of this size, both m.
double gap_of(double size) { return 1.01 * size / kSizePerRestDistance; }

/// Bodies have a friction and restitution of their own, which win over the settings.
void use_settings(SceneDescription& scene) {
    for (BodyDescription& body : scene.bodies) {
        body.friction = scene.settings.friction;
        body.restitution = scene.settings.restitution;
    }
}

} // namespace

// Figure 2. The plank lies level on an edge below its middle and on a support below the blocks. The fast block meets
// its other end.
SceneDescription catapult(int bodies, std::uint64_t) {
    constexpr double kLength = 6, kWidth = 1, kThickness = 0.08, kHeight = 1, kSide = 0.4, kSpeed = 60;
    constexpr double kBlockGap = 0.0025; // the blocks' rest distance, and a little
    SceneDescription scene;
    scene.settings.friction = 0.5;
    scene.shapes = {solid("plank", make_box(kLength, kWidth, kThickness), 600),
                    solid("block", make_box(kSide, kSide, kSide), 500),
                    solid("fast block", make_box(0.6, 0.6, 0.6), 2000),
                    shape_of("edge", {{{0, -0.6, kHeight},
                                       {0, 0.6, kHeight},
                                       {-0.4, -0.6, 0.01},
                                       {-0.4, 0.6, 0.01},
                                       {0.4, -0.6, 0.01},
                                       {0.4, 0.6, 0.01}},
                                      {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}}}),
                    shape_of("support", make_box(0.6, kWidth, kHeight - 0.01)),
                    shape_of("ground", make_plate(60, 60))};
    const double bottom = kHeight + kBlockGap, top = bottom + kThickness;
    scene.bodies.push_back(body_of("plank", 0, BodyType::dynamic, {0, 0, bottom + kThickness / 2}));
    scene.bodies.push_back(body_of("fast block", 2, BodyType::dynamic, {2.6, 0, top + 0.31 + kSpeed * 0.5}));
    scene.bodies.back().velocity = {0, 0, -kSpeed};
    scene.bodies.push_back(body_of("edge", 3, BodyType::fixed, {}));
    scene.bodies.push_back(body_of("support", 4, BodyType::fixed, {-2.6, 0, (kHeight + 0.01) / 2}));
    scene.bodies.push_back(body_of("ground", 5, BodyType::fixed, {0, 0, 0}));
    const int blocks = bodies - 5;
    for (int i = 0; i < blocks; ++i) // two side by side
        scene.bodies.push_back(body_of(
            "block" + std::to_string(i), 1, BodyType::dynamic,
            {-2.6, (i % 2 - 0.5) * (kSide + 0.05), top + kBlockGap + kSide / 2 + (i / 2) * (kSide + kBlockGap)}));
    use_settings(scene);
    return scene;
}

// Figures 3, 4 and 11. The slab's top consists of many triangles, over whose edges a box slides and on which another
// rests.
SceneDescription sliding_boxes(int, std::uint64_t) {
    constexpr double kSide = 0.5;
    const double gap = gap_of(kSide * std::sqrt(3.0));
    SceneDescription scene;
    scene.settings.friction = 0;
    scene.settings.restitution = 0;
    scene.settings.sleeping = false;
    scene.shapes = {solid("box", make_box(kSide, kSide, kSide, 2), 500), shape_of("slab", make_box(20, 4, 0.5, 24))};
    scene.bodies.push_back(body_of("slider", 0, BodyType::dynamic, {-8, 0.6, kSide / 2 + gap}));
    scene.bodies.back().velocity = {2, 0, 0};
    scene.bodies.back().rotation = rotation_from_vector({0, 0, 0.3});
    scene.bodies.push_back(body_of("rester", 0, BodyType::dynamic, {0, -0.8, kSide / 2 + gap}));
    scene.bodies.push_back(body_of("slab", 1, BodyType::fixed, {0, 0, -0.25}));
    use_settings(scene);
    return scene;
}

// Figure 5. A strip turns about its middle by so much in a step that its straight line leaves out a particle on its
// arc.
SceneDescription turning_strip(int, std::uint64_t) {
    constexpr double kTurn = 2.2; // rad in a step
    SceneDescription scene;
    scene.gravity = {};
    scene.settings.restitution = 1;
    scene.settings.friction = 0;
    scene.shapes = {shell("strip", make_plate(2, 0.4), 10), solid("particle", make_sphere(0.02, 1), 1000)};
    scene.bodies.push_back(body_of("strip", 0, BodyType::dynamic, {}));
    scene.bodies.back().angular_velocity = {0, -kTurn / scene.settings.time_step, 0};
    // The tip goes through half the turn at this angle, a unit from the middle; its chord passes at cos(kTurn / 2) of
    // that.
    const SinCos half = sin_cos(kTurn / 2);
    scene.bodies.push_back(body_of("particle", 1, BodyType::dynamic, {0.93 * half.cos, 0, 0.93 * half.sin}));
    use_settings(scene);
    return scene;
}

// Figure 6. In one step the particle's path goes in through the top of the block and out through its side.
SceneDescription particle_and_block(int, std::uint64_t) {
    SceneDescription scene;
    scene.gravity = {};
    scene.settings.restitution = 1;
    scene.settings.friction = 0;
    scene.shapes = {solid("particle", make_sphere(0.02, 1), 1000), shape_of("block", make_box(1, 1, 1))};
    scene.bodies.push_back(body_of("particle", 0, BodyType::dynamic, {0.1, 0, 0.8}));
    scene.bodies.back().velocity = {18, 0, -18}; // 0.75 m in each direction
    scene.bodies.push_back(body_of("block", 1, BodyType::fixed, {}));
    use_settings(scene);
    return scene;
}

// Figures 7 and 8.
SceneDescription ball_on_ground(int, std::uint64_t) {
    constexpr double kRadius = 0.5;
    SceneDescription scene;
    scene.settings.sleeping = false;
    scene.shapes = {solid("ball", make_sphere(kRadius, 3), 500), shape_of("ground", make_plate(20, 20))};
    scene.bodies.push_back(body_of("ball", 0, BodyType::dynamic, {0, 0, kRadius + 1}));
    scene.bodies.push_back(body_of("ground", 1, BodyType::fixed, {}));
    return scene;
}

// Figure 9, with the limits that force the failsafe.
SceneDescription stack_and_ball(int bodies, std::uint64_t seed) {
    SceneDescription scene = stack(bodies - 1, seed);
    scene.settings.collision_iterations = scene.settings.dynamic_iterations = 0;
    scene.shapes.push_back(solid("ball", make_sphere(0.6, 3), 750));
    const double height = 0.4 * (bodies - 2);
    scene.bodies.push_back(body_of("ball", 2, BodyType::dynamic, {-3, 0.1, height}));
    scene.bodies.back().velocity = {12, 0, 0};
    return scene;
}

// Figure 10. Rings are tubes without thickness. Each hangs through the one above; the topmost of a chain does not move.
SceneDescription hanging_rings(int bodies, std::uint64_t) {
    constexpr double kRadius = 0.4, kWidth = 0.12, kSlack = 0.03, kBall = 1.5, kSpeed = 8, kAbove = 0.4;
    constexpr int kMostLinks = 20, kRows = 10;
    const int rings = bodies - 3, links = std::min(kMostLinks, rings), chains = (rings + links - 1) / links;
    const double spacing = 2 * kRadius - kSlack, across = 1.3;
    const int columns = (chains + kRows - 1) / kRows, rows = std::min(chains, kRows);

    SceneDescription scene;
    scene.settings.friction = 0.3;
    scene.shapes = {shell("ring", make_tube(kRadius, kWidth, 24), 20), shell("ball", make_sphere(kBall, 3), 100),
                    shape_of("ground", make_plate(200, 200))};
    const Quat along_x = rotation_from_vector({0, kPi / 2, 0}), along_y = rotation_from_vector({kPi / 2, 0, 0});
    for (int i = 0; i < rings; ++i) {
        const int chain = i / links, link = i % links;
        const double x = across * (chain / rows - 0.5 * (columns - 1)), y = across * (chain % rows - 0.5 * (rows - 1));
        const double z = kAbove + kRadius + spacing * (links - 1 - link);
        scene.bodies.push_back(
            body_of("ring" + std::to_string(i), 0, link == 0 ? BodyType::fixed : BodyType::dynamic, {x, y, z}));
        scene.bodies.back().rotation = link % 2 == 0 ? along_y : along_x;
    }
    const double away = 0.5 * across * columns + 4 * kBall;
    for (const double side : {-1.0, 1.0}) {
        scene.bodies.push_back(body_of(side < 0 ? "left ball" : "right ball", 1, BodyType::dynamic,
                                       {side * away, side * 0.25 * across * (rows - 1), kBall + gap_of(2 * kBall)}));
        scene.bodies.back().velocity = {-side * kSpeed, 0, 0};
        scene.bodies.back().angular_velocity = {0, -side * kSpeed / kBall, 0};
    }
    scene.bodies.push_back(body_of("ground", 2, BodyType::fixed, {}));
    use_settings(scene);
    return scene;
}

// Figure 14: planes at 60 degrees, all movable bodies of one mass, friction 5 % above what statics needs to hold the
// block. A pair's friction is the geometric mean, and the cylinders have 1.
SceneDescription pinched_block(int, std::uint64_t) {
    constexpr double kSlope = 60 * kPi / 180, kRadius = 1, kSide = 1, kMargin = 1.05;
    const double tangent = std::sqrt(3.0), cosine = 0.5, sine = tangent / 2;
    const double block_friction = kMargin / (2 * tangent + (1 + sine) / cosine);
    const double plane_friction = kMargin * cosine / (3 + sine);
    SceneDescription scene;
    scene.settings = preset("accurate");
    scene.settings.trajectory = Trajectory::linear;
    scene.settings.rest_distance = 2e-4;
    scene.settings.restitution = 0;
    const double gap = 1.0001 * scene.settings.rest_distance;
    const auto heavy = [](const char* name, TriangleMesh mesh) {
        ShapeDescription shape = shape_of(name, std::move(mesh));
        shape.mass_kind = MassKind::mass;
        shape.mass_value = 100;
        return shape;
    };
    // Of so many sides that the pressure's way across one of them, which resists rolling, changes the thresholds by 2 %
    // only.
    scene.shapes = {heavy("block", make_box(kSide, kSide, kSide)), heavy("cylinder", make_tube(kRadius, kSide, 720)),
                    shape_of("plane", make_plate(8, 8))};
    const auto add = [&](const char* name, std::int32_t shape, BodyType type, const Vec3& at, double friction) {
        scene.bodies.push_back(body_of(name, shape, type, at));
        scene.bodies.back().friction = friction;
        scene.bodies.back().restitution = 0;
    };
    add("block", 0, BodyType::dynamic, {}, block_friction * block_friction);
    for (const double side : {-1.0, 1.0}) {
        const Vec3 center{side * (kSide / 2 + gap + kRadius), 0, 0}, up{-side * sine, 0, cosine};
        add(side < 0 ? "left cylinder" : "right cylinder", 1, BodyType::dynamic, center, 1);
        scene.bodies.back().rotation = rotation_from_vector({kPi / 2, 0, 0});
        add(side < 0 ? "left plane" : "right plane", 2, BodyType::fixed, center - (kRadius + gap) * up,
            plane_friction * plane_friction);
        scene.bodies.back().rotation = rotation_from_vector({0, -side * kSlope, 0});
    }
    return scene;
}

} // namespace flotilla::library
