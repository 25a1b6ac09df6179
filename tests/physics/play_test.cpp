// SPDX-License-Identifier: MIT
// Bodies with little play between others, from less than a rest distance on. Sides that nothing presses on a body do
// not press on it either: what may slide, roll or turn does so as if they were not there. Sides that carry it do so near
// where they were.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "physics/physics.hpp"
#include "scene/household_meshes.hpp"

namespace flotilla::physics {
namespace {

// A disc that spins on the ground, and a plate above it, which touches nothing.
double spin_under_a_plate(const Run& run, double play, double time) {
    constexpr double kFriction = 0.2, kHeight = 0.02;
    SceneDescription scene = make_scene_with(run.settings());
    const double gap = play > 0 ? 0.5 * play : 5e-4; // m, below
    add_body(scene, add_solid(scene, make_cylinder(0.1, kHeight, 32), 1000), BodyType::dynamic,
             {0, 0, gap + kHeight / 2}, kFriction, 0)
        .angular_velocity = {0, 0, 30};
    add_ground(scene, 3, kFriction, 0);
    if (play > 0)
        add_body(scene, add_shape(scene, make_box(1, 1, 0.1)), BodyType::fixed, {0, 0, kHeight + play + 0.05},
                 kFriction, 0);
    Motion motion(scene);
    motion.run(time);
    expect_no_rise(motion);
    const double spin = motion.body(0).angular_velocity.z;
    motion.print("play of %g mm: spins at %.5g rad/s", 1e3 * play, spin);
    return spin;
}

void disc_spins_under_a_plate(const Run& run) {
    constexpr double kTime = 0.4;
    const double free = spin_under_a_plate(run, 0, kTime);
    for (const double play : {3e-4, 1e-3, 2e-3})
        EXPECT_NEAR(spin_under_a_plate(run, play, kTime) / free, 1, 0.01) << play;
}

// A coin on its edge, down a slope between two walls.
double speed_of_a_coin(const Run& run, double play) {
    constexpr double kRadius = 0.1, kThick = 0.03, kFriction = 0.5, kSlope = 10 * kDegree;
    SceneDescription scene =
        make_scene_with(run.settings(), {kGravity * std::sin(kSlope), 0, -kGravity * std::cos(kSlope)});
    const TriangleMesh mesh = make_cylinder(kRadius, kThick, 64);
    add_body(scene, add_solid(scene, mesh, 1000), BodyType::dynamic, {0, 0, kRadius + rest_gap(mesh)}, kFriction, 0)
        .rotation = rotation_from_vector({kPi / 2, 0, 0});
    add_ground(scene, 6, kFriction, 0);
    for (const double side : {-1.0, 1.0})
        if (play > 0)
            add_body(scene, add_shape(scene, make_box(4, 0.1, 0.3)), BodyType::fixed,
                     {0, side * (0.5 * (kThick + play) + 0.05), 0.16}, kFriction, 0);
    Motion motion(scene);
    motion.run(1);
    expect_no_rise(motion);
    const double speed = motion.body(0).velocity.x;
    motion.print("play of %g mm: %.5g m/s", 1e3 * play, speed);
    return speed;
}

void coin_rolls_in_a_slot(const Run& run) {
    const double free = speed_of_a_coin(run, 0);
    for (const double play : {5e-4, 1e-3}) EXPECT_NEAR(speed_of_a_coin(run, play) / free, 1, 0.1) << play;
}

// Tiles side by side in a tray that is open at one end, down its slope.
void tiles_slide_out_of_a_tray(const Run& run) {
    constexpr double kEdge = 0.1, kHigh = 0.02, kFriction = 0.3, kSlope = 37 * kDegree, kTime = 0.3;
    constexpr int kSide = 3;
    for (const double gap : {1e-5, 1e-4, 3e-4}) {
        SceneDescription scene =
            make_scene_with(run.settings(), {kGravity * std::sin(kSlope), 0, -kGravity * std::cos(kSlope)});
        const auto tile = add_solid(scene, make_box(kEdge, kEdge, kHigh), 2000);
        const auto place = [&](int i) { return (i - (kSide - 1) / 2) * (kEdge + gap); };
        for (int i = 0; i < kSide; ++i)
            for (int k = 0; k < kSide; ++k)
                add_body(scene, tile, BodyType::dynamic, {place(i), place(k), kHigh / 2 + 1e-4}, kFriction, 0);
        const double wall = place(kSide - 1) + kEdge / 2 + gap + 0.05;
        for (const double side : {-1.0, 1.0})
            add_body(scene, add_shape(scene, make_box(4, 0.1, 0.1)), BodyType::fixed, {0, side * wall, 0.06}, kFriction,
                     0);
        add_ground(scene, 6, kFriction, 0);
        Motion motion(scene);
        motion.run(kTime);
        const double due = kGravity * (std::sin(kSlope) - kFriction * std::cos(kSlope)) * motion.world().time();
        double least = 1e300, most = 0;
        for (std::size_t i = 0; i < kSide * kSide; ++i) {
            least = std::min(least, motion.body(i).velocity.x / due);
            most = std::max(most, motion.body(i).velocity.x / due);
        }
        motion.print("gaps of %g mm: %.4f to %.4f of the speed that is due", 1e3 * gap, least, most);
        EXPECT_GT(least, 0.98);
        EXPECT_LT(most, 1.02);
        expect_no_rise(motion);
    }
}

// A drawer pulled beside its middle: its sides carry the moment, and rub by that.
void drawer_is_pulled_beside_its_middle(const Run& run) {
    constexpr double kLong = 0.4, kWide = 0.3, kHigh = 0.1, kMass = 2, kForce = 20, kFriction = 0.3, kTime = 0.4;
    for (const double play : {2e-4, 5e-4, 2e-3})
        for (const double beside : {0.0, 0.1, 0.3}) {
            SceneDescription scene = make_scene_with(run.settings());
            BodyDescription& drawer = add_body(scene, add_shape(scene, make_box(kLong, kWide, kHigh), kMass),
                                               BodyType::dynamic, {-0.5, 0, kHigh / 2 + 5e-4}, kFriction, 0);
            drawer.force = {kForce, 0, 0};
            drawer.torque = {0, 0, -kForce * beside};
            add_ground(scene, 10, 0, 0);
            for (const double side : {-1.0, 1.0})
                add_body(scene, add_shape(scene, make_box(4, 0.1, 0.2)), BodyType::fixed,
                         {1, side * (0.5 * (kWide + play) + 0.05), 0.101}, kFriction, 0);
            Motion motion(scene);
            while (motion.world().time() < kTime - run.dt() / 2) motion.step(); // the force is what adds energy
            const double presses = kForce * beside / kLong;
            const double due = (kForce - 2 * kFriction * presses) / kMass * motion.world().time();
            const double speed = motion.body(0).velocity.x;
            motion.print("play of %g mm, pulled %g m beside: %.5g m/s of %.5g", 1e3 * play, beside, speed, due);
            EXPECT_NEAR(speed / due, 1, 0.01);
        }
}

// An axle with a disc in two bushes, without friction: corners go over sides, and cost little.
void axle_spins_in_bushes(const Run& run, int sides) {
    constexpr double kRadius = 0.05, kSpin = 10, kPlay = 0.05;
    constexpr int kPhases = 8;
    const TriangleMesh bush = make_hoop(kRadius * (1 + kPlay), 0.05, 0.1, 64);
    const TriangleMesh axle = library::revolve({{0, -0.25},
                                                {kRadius, -0.25},
                                                {kRadius, -0.05},
                                                {0.15, -0.05},
                                                {0.15, 0.05},
                                                {kRadius, 0.05},
                                                {kRadius, 0.25},
                                                {0, 0.25}},
                                               sides);
    double least = 1e300; // rad/s
    for (int phase = 0; phase < kPhases; ++phase) {
        SceneDescription scene = make_scene_with(run.settings());
        const auto in_place = rotation_from_vector({kPi / 2, 0, 0});
        const double turned = 0.01 + 2 * kPi / sides * phase / kPhases;
        BodyDescription& body = add_body(scene, add_solid(scene, axle, 1000), BodyType::dynamic, {}, 0, 0);
        body.rotation = in_place * rotation_from_vector({0, 0, turned});
        body.angular_velocity = {0, kSpin, 0};
        const auto shape = add_shape(scene, bush);
        for (const double side : {-1.0, 1.0})
            add_body(scene, shape, BodyType::fixed, {0, 0.15 * side, 0}, 0, 0).rotation = in_place;
        Motion motion(scene);
        motion.run(1);
        expect_no_rise(motion);
        least = std::min(least, motion.body(0).angular_velocity.y);
        motion.print("%d sides, turned by %.3g: spins at %.4g rad/s of %g", sides, turned,
                     motion.body(0).angular_velocity.y, kSpin);
    }
    EXPECT_GT(least, 0.8 * kSpin);
}

// It rests, and its contacts keep a share of the gaps that it was placed with.
void expect_carried(Motion& motion, double gap) {
    double least = 1e300;
    motion.run(2, [&](const StepReport& r) { least = std::min(least, r.min_distance); });
    motion.print("gaps of %g mm: nearest %.3f of them, sank %.3g mm", 1e3 * gap, least / gap, 1e3 * motion.farthest());
    EXPECT_GT(least, 0.45 * gap);
    EXPECT_EQ(motion.outcome().held, 0);
    expect_rest(motion);
    expect_no_rise(motion);
}

// A plank on a support in its middle, held down at its end: both sides carry, at different places.
void plank_rests_between_a_support_and_a_hook(const Run& run) {
    for (const double gap : {1e-4, 1e-3}) {
        SceneDescription scene = make_scene_with(run.settings());
        add_body(scene, add_solid(scene, make_box(1, 0.1, 0.05), 1000), BodyType::dynamic, {}, 0.5, 0);
        const auto block = add_shape(scene, make_box(0.1, 0.1, 0.1));
        add_body(scene, block, BodyType::fixed, {-0.1, 0, -0.075 - gap}, 0.5, 0);
        add_body(scene, block, BodyType::fixed, {-0.45, 0, 0.075 + gap}, 0.5, 0);
        Motion motion(scene);
        expect_carried(motion, gap);
    }
}

// A wedge between two fixed bodies with its slope: what it sinks takes the play away.
void wedge_rests_between_two_bodies(const Run& run, double degrees) {
    constexpr double kHalfWidth = 0.01, kHalfHeight = 0.05, kDepth = 0.05;
    const double slope = std::tan(degrees * kDegree);
    const auto prism = [&](double low_0, double high_0, double low_1, double high_1, double half_height) {
        const auto face = [&](double x, double y, double z) { return Vec3{x, y, z}; };
        return make_hexahedron({face(low_0, -kDepth, -half_height), face(high_0, -kDepth, -half_height),
                                face(high_0, kDepth, -half_height), face(low_0, kDepth, -half_height),
                                face(low_1, -kDepth, half_height), face(high_1, -kDepth, half_height),
                                face(high_1, kDepth, half_height), face(low_1, kDepth, half_height)});
    };
    for (const double gap : {1e-4, 4e-4}) {
        SceneDescription scene = make_scene_with(run.settings());
        const double low = kHalfWidth, high = kHalfWidth + 2 * kHalfHeight * slope;
        add_body(scene, add_solid(scene, prism(-low, low, -high, high, kHalfHeight), 2000), BodyType::dynamic, {}, 0.5,
                 0);
        const double beside = gap / std::cos(degrees * kDegree), at_middle = 0.5 * (low + high) + beside;
        const double bottom = at_middle - 2 * kHalfHeight * slope, top = at_middle + 2 * kHalfHeight * slope;
        add_body(scene, add_shape(scene, prism(bottom, 0.3, top, 0.3, 2 * kHalfHeight)), BodyType::fixed, {}, 0.5, 0);
        add_body(scene, add_shape(scene, prism(-0.3, -bottom, -0.3, -top, 2 * kHalfHeight)), BodyType::fixed, {}, 0.5,
                 0);
        Motion motion(scene);
        expect_carried(motion, gap);
    }
}

[[maybe_unused]] const bool registered = [] {
    const std::vector<Run> list{
        {"balanced", 60}, {"balanced", 24}, {"preview", 60}, {"balanced", 240}, {"accurate", 60}};
    add_runs("Play", "DiscSpinsUnderAPlate", list, true, disc_spins_under_a_plate);
    add_runs("Play", "CoinRollsInASlot", list, true, coin_rolls_in_a_slot);
    add_runs("Play", "TilesSlideOutOfATray", list, true, tiles_slide_out_of_a_tray);
    add_runs("Play", "DrawerIsPulledBesideItsMiddle", list, true, drawer_is_pulled_beside_its_middle);
    add_runs("Play", "PlankRestsBetweenASupportAndAHook", list, true, plank_rests_between_a_support_and_a_hook);
    for (const int degrees : {3, 8})
        add_runs("Play", "WedgeOf" + std::to_string(degrees) + "DegreesRestsBetweenTwoBodies", list, true,
                 [=](const Run& r) { wedge_rests_between_two_bodies(r, degrees); });
    for (const int sides : {24, 64})
        add_runs("Play", "AxleOf" + std::to_string(sides) + "SidesSpinsInBushes", list, true,
                 [=](const Run& r) { axle_spins_in_bushes(r, sides); });
    return true;
}();

} // namespace
} // namespace flotilla::physics
