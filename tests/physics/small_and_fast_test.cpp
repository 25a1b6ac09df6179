// SPDX-License-Identifier: MIT
// Small, thin and fast bodies, and steps that are large against them: only ratios may matter, never metres or seconds.
#include <algorithm>
#include <numbers>
#include <vector>

#include "physics/physics.hpp"
#include "scene/household_meshes.hpp"

namespace flotilla::physics {
namespace {

/// Three cubes fall half a metre or more, which at a frame rate is many times their size. Returns when the last of them
/// rests, s.
double time_to_rest(Motion& motion, double edge, double time) {
    // A body that hangs in the air while its velocity grows shows as a step whose way is not that of its velocity. One
    // that is higher than before was hit from below.
    const double time_step = motion.scene().settings.time_step;
    double hangs = 0, moved = 0;
    Vec3 at = motion.body(0).center_of_mass, speed;
    motion.run(time, [&](const StepReport&) {
        const BodyState s = motion.body(0);
        const bool in_air = s.center_of_mass.z > 3 * edge && s.center_of_mass.z <= at.z;
        if (in_air && s.velocity.z < speed.z && speed.z < 0)
            hangs = std::max(hangs, 1 - (s.center_of_mass.z - at.z) / (speed.z * time_step));
        at = s.center_of_mass, speed = s.velocity;
        if (motion.outcome().fastest_sizes > 1e-4) moved = motion.world().time();
    });
    double highest = 0;
    for (std::size_t i = 0; i < 3; ++i) highest = std::max(highest, motion.body(i).center_of_mass.z / edge);
    motion.print("rests after %.3g s, highest at %.3g edges, falls short of its speed by %.3g", moved, highest, hangs);
    EXPECT_LT(highest, 3) << "edges";
    EXPECT_LT(hangs, 0.01);
    return moved;
}

/// Nine starts, half of which rest by `time`: in a step of several times the square root of edge over gravity a cube
/// turns over more than once, and how often it does so before it rests is chance.
void three_cubes(const Run& run, double edge, double time_step, double time) {
    Settings settings = run.settings();
    settings.time_step = time_step;
    Numbers numbers(2);
    std::vector<double> rests;
    for (int start = 0; start < 9; ++start) {
        SceneDescription scene = make_scene_with(settings);
        const auto cube = add_solid(scene, make_box(edge, edge, edge), 1000);
        for (int i = 0; i < 3; ++i)
            add_body(scene, cube, BodyType::dynamic, {0.3 * edge * i, 0, std::max(0.5, 1.5 * edge) + 2 * edge * i}, 0.3)
                .rotation = numbers.rotation();
        add_ground(scene, std::max(10.0, 100 * edge), 0.3);
        Motion motion(scene);
        rests.push_back(time_to_rest(motion, edge, 3 * time));
        expect_no_rise(motion);
        expect_rest(motion);
    }
    std::sort(rests.begin(), rests.end());
    EXPECT_LT(rests[4], time) << "s, the median";
}

constexpr double kBar = 1e-3; // m, thickness of bars of 1 m

void two_bars(const Run& run) {
    SceneDescription scene = make_scene_with(run.settings(), {});
    const auto bar = add_shape(scene, make_box(1, kBar, kBar), 1);
    add_body(scene, bar, BodyType::dynamic, {}, 0.1, 0);
    auto& falling = add_body(scene, bar, BodyType::dynamic, {0.2, 0.1, 0.5}, 0.1, 0);
    falling.rotation = rotation_from_vector({0, 0, 1.5});
    falling.velocity = {0, 0, -5};
    Motion motion(scene);
    double after = 0;
    motion.run(2, [&](const StepReport& r) {
        if (r.time < 0.2) after = r.kinetic_energy;
    });
    motion.print("%.4g J at the start, %.4g after the impact, %.4g at the end", motion.outcome().start, after,
                 motion.outcome().end);
    expect_no_rise(motion);
}

void bar_dropped(const Run& run, double thickness) {
    SceneDescription scene = make_scene_with(run.settings());
    const auto bar = add_shape(scene, make_box(1, thickness, thickness), 1);
    add_body(scene, bar, BodyType::dynamic, {0, 0, 0.8}, 0.3, 0).rotation = rotation_from_vector({0.1, 0.15, 0.3});
    add_ground(scene, 20, 0.3, 0);
    Motion motion(scene);
    motion.run(3);
    motion.print("height %.4g m", motion.body(0).center_of_mass.z);
    expect_no_rise(motion);
    expect_rest(motion);
}

/// Layers of bars across each other, none quite level.
SceneDescription heap_of_bars(const Run& run, double thickness, int count, unsigned seed) {
    SceneDescription scene = make_scene_with(run.settings());
    const auto bar = add_shape(scene, make_box(1, thickness, thickness), 0.05);
    Numbers numbers(seed);
    for (int i = 0; i < count; ++i)
        add_body(scene, bar, BodyType::dynamic, {0.2 * numbers.next(), 0.2 * numbers.next(), 0.15 + 0.05 * i}, 0.5, 0.1)
            .rotation =
            rotation_from_vector({0, 0, 3 * numbers.next()}) * rotation_from_vector({0, 0.02 * numbers.next(), 0});
    add_ground(scene, 20, 0.5);
    return scene;
}

void bars_in_a_heap(const Run& run, double thickness) {
    Motion motion(heap_of_bars(run, thickness, 18, 4));
    motion.run(5);
    motion.print();
    expect_no_rise(motion);
    expect_rest(motion);
    EXPECT_EQ(motion.outcome().held, 0);
}

/// Of eight starts one may still rock: bars of 10 um did in one of ten.
void five_bars(const Run& run, double thickness) {
    int rest = 0;
    for (unsigned seed = 4; seed < 12; ++seed) {
        Motion motion(heap_of_bars(run, thickness, 5, seed));
        motion.run(5);
        motion.print("start %u", seed);
        expect_no_rise(motion);
        EXPECT_EQ(motion.outcome().held, 0);
        rest += motion.outcome().fastest_sizes < 1e-4 ? 1 : 0;
    }
    EXPECT_GE(rest, 7) << "of 8 starts";
}

/// A needle across a slope of tan 0.35, 300 thicknesses above it: it stays or slides as Coulomb says, and does not roll,
/// whichever body comes first.
void needle_on_a_slope(const Run& run, bool ground_first, double friction) {
    constexpr double kThickness = 1e-5, kSlope = 0.35, kGravity = 9.8, kTime = 2;
    constexpr double kRest = 1.0 / 330, kAbove = 0.02 * kRest; // m
    SceneDescription scene = make_scene_with(run.settings());
    const double cos = 1 / std::sqrt(1 + kSlope * kSlope), sin = kSlope * cos;
    scene.gravity = {0, kGravity * sin, -kGravity * cos};
    if (ground_first) add_ground(scene, 60, friction);
    const auto needle = add_shape(scene, make_box(1, kThickness, kThickness), 0.05);
    add_body(scene, needle, BodyType::dynamic, {0, 0, 0.5 * kThickness + kRest + kAbove}, friction, 0);
    if (!ground_first) add_ground(scene, 60, friction);
    Motion motion(scene);
    motion.run(kTime);
    const BodyState s = motion.body(ground_first ? 1 : 0);
    const double due = std::max(0.0, kGravity * (sin - friction * cos)) * kTime;
    motion.print("%.6g m/s of %.6g, %.3g rad/s, moved %.3g m", s.velocity.y, due, length(s.angular_velocity),
                 s.center_of_mass.y);
    EXPECT_NEAR(s.velocity.y, due, 0.005 * due + 1e-6);
    EXPECT_LE(length(s.angular_velocity), 1) << "rad/s";
    if (due == 0) EXPECT_LE(std::abs(s.center_of_mass.y), kSlope * kAbove) << "where it falls to";
    EXPECT_EQ(motion.outcome().held, 0);
}

/// A scene and one 1,024 times as large in 32 times as long: the same bits in other units. A preset's tolerances count
/// as derived from the scene's.
void same_motion_at_any_size(const Run& run) {
    constexpr double kFactor = 1024, kRoot = 32;
    const auto make = [&](double factor) {
        SceneDescription scene = make_scene_with(run.settings());
        const auto cube = add_solid(scene, make_box(0.5, 0.5, 0.5), 1000);
        for (int i = 0; i < 4; ++i)
            add_body(scene, cube, BodyType::dynamic, {0.125 * i, 0, 0.75 + 0.75 * i}, 0.5).rotation =
                rotation_from_vector({0.1 * i, 0.2, 0});
        add_ground(scene, 16, 0.5);
        scene = scaled(scene, factor);
        scene.settings.time_step *= std::sqrt(factor);
        return scene;
    };
    Motion motion(make(1)), large(make(kFactor));
    std::int64_t first_difference = -1;
    double farthest = 0;
    for (int n = 0; n < 72; ++n) {
        motion.step(), large.step();
        for (std::size_t i = 0; i < 4; ++i) {
            const BodyState a = motion.body(i), b = large.body(i);
            farthest = std::max(farthest, length(kFactor * a.position - b.position) / kFactor);
            const bool same =
                kFactor * a.position == b.position && a.rotation == b.rotation && kRoot * a.velocity == b.velocity;
            if (!same && first_difference < 0) first_difference = n + 1;
        }
    }
    motion.print("first difference in step %lld, at most %.3g m", static_cast<long long>(first_difference), farthest);
    EXPECT_EQ(first_difference, -1);
}

// ---- next to nothing between bodies
//      -----------------------------------------------------------------------------------------

/// Two walls close on a cube that slides between them, until either side has less than a rest distance: no place is
/// right by both, but nothing stops the cube.
void walls_close(const Run& run) {
    constexpr double kSpeed = 2, kEdge = 0.5, kTime = 2.5, kClosing = 0.3, kHalfWall = 0.1;
    const double rest = std::sqrt(3.0) * kEdge / 330;
    for (const double play : {0.1, 0.5, 0.9}) { // on either side, in rest distances
        SceneDescription scene = make_scene_with(run.settings(), {});
        const auto cube = add_solid(scene, make_box(kEdge, kEdge, kEdge), 1000);
        const auto wall = add_shape(scene, make_box(8, 2, 2 * kHalfWall));
        const auto place = [&](double gap) { return Vec3{3, 0, 0.5 * kEdge + gap * rest + kHalfWall}; };
        add_body(scene, wall, BodyType::fixed, -1.0 * place(play) + Vec3{6, 0, 0}, 0, 0);
        add_body(scene, wall, BodyType::kinematic, place(1.5), 0, 0).keyframes = {{0, place(1.5), {}},
                                                                                  {kClosing, place(play), {}}};
        add_body(scene, cube, BodyType::dynamic, {}, 0, 0).velocity = {kSpeed, 0, 0};
        Motion motion(scene);
        motion.run(kTime);
        const BodyState s = motion.body(2);
        motion.print("play of %g rest distances: %.6g m of %g, %.6g m/s", play, s.position.x, kSpeed * kTime,
                     s.velocity.x);
        EXPECT_EQ(motion.outcome().held, 0);
        EXPECT_NEAR(s.position.x, kSpeed * kTime, 1e-3);
        EXPECT_NEAR(s.velocity.x, kSpeed, 1e-3);
    }
}

void slides_out_of_a_tunnel(const Run& run) {
    constexpr double kPlay = 1e-4, kSpeed = 10, kEdge = 1, kLength = 6;
    SceneDescription scene = make_scene_with(run.settings(), {});
    const auto cube = add_solid(scene, make_box(kEdge, kEdge, kEdge), 1000);
    const auto wall = add_shape(scene, make_plate(kLength, 2));
    add_body(scene, cube, BodyType::dynamic, {}, 0.1, 0).velocity = {kSpeed, 0, 0};
    for (int i = 0; i < 4; ++i) {
        const Quat turn = rotation_from_vector({i * kPi / 2, 0, 0});
        add_body(scene, wall, BodyType::fixed, rotate(turn, {kLength / 2 - 2, 0, -(kEdge + kPlay) / 2}), 0.1, 0)
            .rotation = turn;
    }
    Motion motion(scene);
    motion.run(1);
    const BodyState s = motion.body(0);
    motion.print("%.6g m of 10, %.6g m/s", s.position.x, s.velocity.x);
    EXPECT_EQ(motion.outcome().held, 0);
    EXPECT_NEAR(s.position.x, 10, 0.01);
    EXPECT_NEAR(s.velocity.x, kSpeed, 0.01);
}

/// A square peg over a hole that leaves less than its rest distance on either side, off its middle.
void peg_falls_into_its_hole(const Run& run, double friction) {
    constexpr double kEdge = 0.05, kLength = 0.12, kDepth = 0.1, kPlay = 2.5e-4, kOff = 1e-4;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_box(kEdge, kEdge, kLength);
    ASSERT_GT(rest_gap(mesh), kPlay);
    const double inside = std::numbers::sqrt2 * (0.5 * kEdge + kPlay);
    const TriangleMesh walls = library::revolve({{inside, 0}, {inside, kDepth}, {2 * inside, kDepth}}, 4);
    add_body(scene, add_solid(scene, mesh, 2700), BodyType::dynamic, {kOff, 0, kDepth + 0.005 + kLength / 2}, friction,
             0);
    add_body(scene, add_shape(scene, walls), BodyType::fixed, {}, friction, 0).rotation =
        rotation_from_vector({0, 0, kPi / 4});
    add_ground(scene, 1, friction, 0);
    Motion motion(scene);
    motion.run(2);
    const double above = motion.body(0).position.z - kLength / 2;
    motion.print("%.4g m above the ground", above);
    EXPECT_LT(above, 1e-3);
    expect_no_rise(motion);
}

constexpr double kGap = 1e-9; // m

/// Two boxes almost in touch, pushed along their faces and away from each other.
void leaves_a_gap_of_a_nanometre(const Run& run) {
    SceneDescription scene = make_scene_with(run.settings(), {});
    const auto box = add_solid(scene, make_box(1, 1, 1), 1000);
    add_body(scene, box, BodyType::dynamic, {}, 0, 0);
    add_body(scene, box, BodyType::dynamic, {0, 0, 1 + kGap}, 0, 0).velocity = {1, 0, 0.1};
    Motion motion(scene);
    motion.run(2.5);
    const Vec3 apart = motion.body(1).position - motion.body(0).position;
    motion.print("apart by (%.4g, %.4g, %.4g) m, due (2.5, 0, 1.25)", apart.x, apart.y, apart.z);
    EXPECT_EQ(motion.outcome().held, 0);
    EXPECT_NEAR(apart.x, 2.5, 1e-6);
    EXPECT_NEAR(apart.z, 1.25, 1e-6);
}

/// A box that slides over a plate from which rounding alone separates it.
void slides_over_a_gap_of_a_nanometre(const Run& run) {
    SceneDescription scene = make_scene_with(run.settings());
    const auto box = add_solid(scene, make_box(1, 1, 1), 1000);
    add_body(scene, box, BodyType::dynamic, {0, 0, 0.5 + kGap}, 0, 0).velocity = {1, 0, 0};
    add_ground(scene, 20, 0, 0);
    Motion motion(scene);
    motion.run(2.5);
    const double way = motion.body(0).position.x;
    motion.print("slides %.4g m, due 2.5", way);
    EXPECT_EQ(motion.outcome().held, 0);
    EXPECT_NEAR(way, 2.5, 1e-3); // a tolerance of speed may act at corners, one sided
}

void falls_through_a_slot(const Run& run) {
    SceneDescription scene = make_scene_with(run.settings());
    const auto box = add_solid(scene, make_box(1, 1, 1), 1000);
    const auto wall = add_shape(scene, make_plate(80, 4));
    add_body(scene, box, BodyType::dynamic, {}, 0, 0);
    for (const double side : {-1.0, 1.0})
        add_body(scene, wall, BodyType::fixed, {side * (0.5 + kGap), 0, 0}, 0, 0).rotation =
            rotation_from_vector({0, kPi / 2, 0});
    Motion motion(scene);
    motion.run(2.5);
    const double fallen = -motion.body(0).position.z, due = 0.5 * kGravity * 2.5 * 2.5;
    motion.print("falls %.4g m, due %.4g", fallen, due);
    EXPECT_EQ(motion.outcome().held, 0);
    EXPECT_NEAR(fallen / due, 1, 0.01);
}

[[maybe_unused]] const bool registered = [] {
    const std::vector<Run> once = runs({24});
    struct Edge {
        const char* name;
        double edge, time_step, time;
    };
    for (const Edge& e : {Edge{"10mm", 1e-2, 0, 4}, {"1mm", 1e-3, 0, 4}, {"300um", 3e-4, 0, 4}, {"1mAt1s", 1, 1, 40}})
        add_runs("SmallAndFast", std::string("ThreeCubesOf") + e.name, once, true,
                 [=](const Run& r) { three_cubes(r, e.edge, e.time_step > 0 ? e.time_step : r.dt(), e.time); });
    add_runs("SmallAndFast", "TwoBarsInSpace", runs(), true, two_bars);
    for (const int aspect : {100, 1000})
        add_runs("SmallAndFast", "BarOfAspect" + std::to_string(aspect) + "Falls", runs(), true,
                 [=](const Run& r) { bar_dropped(r, 1.0 / aspect); });
    for (const auto& [size, thickness] : {std::pair{"1mm", 1e-3}, {"10um", 1e-5}}) {
        const std::string of = std::string("Of") + size;
        add_runs("SmallAndFast", "HeapOfBars" + of, once, kSlow, [=](const Run& r) { bars_in_a_heap(r, thickness); });
        add_runs("SmallAndFast", "FiveBars" + of, once, true, [=](const Run& r) { five_bars(r, thickness); });
    }
    for (const bool first : {false, true})
        for (const double friction : {0.2, 0.5})
            add_runs("SmallAndFast",
                     std::string("NeedleOnASlope") + (friction < 0.35 ? "Slides" : "Stays") +
                         (first ? "OnABodyBefore" : "OnABodyAfter"),
                     once, true, [=](const Run& r) { needle_on_a_slope(r, first, friction); });
    add_runs("SmallAndFast", "SameMotionAtAnySize", once, true, same_motion_at_any_size);
    add_runs("SmallAndFast", "CubeSlidesOutOfATightTunnel", runs(), true, slides_out_of_a_tunnel);
    for (const int percent : {5, 20, 50})
        add_runs("SmallAndFast", "PegFallsIntoItsHoleWithFriction" + std::to_string(percent) + "Percent",
                 {{"preview", 60}, {"balanced", 60}, {"balanced", 240}, {"accurate", 60}}, true,
                 [=](const Run& r) { peg_falls_into_its_hole(r, 0.01 * percent); });
    add_runs("SmallAndFast", "WallsCloseOnACubeThatSlides", runs(), true, walls_close);
    add_runs("SmallAndFast", "BoxLeavesAGapOfANanometre", once, true, leaves_a_gap_of_a_nanometre);
    add_runs("SmallAndFast", "BoxSlidesOverAGapOfANanometre", once, true, slides_over_a_gap_of_a_nanometre);
    add_runs("SmallAndFast", "BoxFallsThroughASlotOfANanometre", once, true, falls_through_a_slot);
    return true;
}();

} // namespace
} // namespace flotilla::physics
