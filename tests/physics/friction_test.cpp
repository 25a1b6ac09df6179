// SPDX-License-Identifier: MIT
// Coulomb's friction: the rate of sliding, the threshold, creep, straight paths.
#include "physics/physics.hpp"
#include "physics/problems/sliding.hpp"

namespace flotilla::physics {
namespace {

constexpr double kSteep[] = {10, 20, 30, 40, 50}; // degrees

void slides_at_the_rate_of_coulomb(const Run& run, double heading) {
    for (const double angle : kSteep) {
        const Slope slope{angle * kDegree, heading * kDegree};
        const double friction = 0.7 * std::tan(slope.angle);
        Motion motion(block_on_slope(run.settings(), slope, friction));
        const auto [share, turn] = sliding(motion.record(1.5), slope, friction);
        const double turned = turn / kDegree;
        motion.print("slope %g, %.5f of the due rate %.4g m/s^2, %.3g degrees aside", angle, share,
                     slope.rate(friction), turned);
        EXPECT_NEAR(share, 1, 0.005) << "slope " << angle;
        EXPECT_LT(turned, 0.1) << "degrees, slope " << angle;
    }
}

// So little less than what holds that two seconds move the block by some millimetres.
void slides_just_below_the_threshold(const Run& run) {
    for (const double angle : {10.0, 30.0}) {
        const Slope slope{angle * kDegree, 0.5};
        const double friction = 0.999 * std::tan(slope.angle), due = 0.5 * slope.rate(friction) * 4;
        Motion motion(block_on_slope(run.settings(), slope, friction));
        const double way = way_down(motion.record(2), slope);
        motion.print("slope %g, %.4g of the due %.4g m", angle, way / due, due);
        EXPECT_NEAR(way / due, 1, 0.1) << "slope " << angle;
    }
}

void holds(const Run& run, double share, double time, double most) {
    for (const double angle : {10.0, 30.0}) {
        const Slope slope{angle * kDegree, 0.5};
        Motion motion(block_on_slope(run.settings(), slope, share * std::tan(slope.angle)));
        motion.run(0.5);
        const Vec3 start = motion.body(0).position;
        motion.run(0.5 + time);
        const double way = length(motion.body(0).position - start);
        motion.print("slope %g, %.4g m in %g s", angle, way, time);
        EXPECT_LT(way, most) << "slope " << angle;
    }
}

// Nothing stops it, however slow it is: it does not fall asleep.
void slow_cube_slides_on(const Run& run, const Vec3& velocity, double spin) {
    constexpr double kTime = 6, kSide = 0.5;
    SceneDescription scene = make_scene_with(run.settings());
    scene.settings.sleeping = true;
    const TriangleMesh cube = make_box(kSide, kSide, kSide);
    add_ground(scene, 20, 0, 0);
    auto& body =
        add_body(scene, add_shape(scene, cube, 100), BodyType::dynamic, {0, 0, 0.5 * kSide + rest_gap(cube)}, 0, 0);
    body.velocity = velocity;
    body.angular_velocity = {0, 0, spin};
    Motion motion(scene);
    const Vec3 start = motion.body(1).position;
    motion.run(kTime);
    const double way = length(motion.body(1).position - start), due = length(velocity) * motion.world().time();
    motion.print("slides %.6g m, due %.6g, spins at %.6g rad/s, due %.6g", way, due, motion.body(1).angular_velocity.z,
                 spin);
    EXPECT_NEAR(way, due, 1e-3 * due + 1e-6);
    EXPECT_NEAR(motion.body(1).angular_velocity.z, spin, 1e-3 * spin + 1e-9);
    EXPECT_EQ(motion.outcome().asleep, 0);
}

// Nothing pushes them aside but what solves leave undone; that adds up as long as they are awake: at 5 mm/s after 5 s,
// after 16 s the stack fell down.
void smooth_stack_falls_asleep(const Run& run, int boxes) {
    constexpr double kHeight = 0.25;
    SceneDescription scene = make_scene_with(run.settings());
    scene.settings.sleeping = true;
    add_ground(scene, 18, 0, 0);
    const auto box = add_shape(scene, make_box(0.3, 0.2, kHeight), 1);
    for (int i = 0; i < boxes; ++i)
        add_body(scene, box, BodyType::dynamic, {0, 0, 0.5 * kHeight + 0.0016 + (kHeight + 0.1) * i}, 0, 0);
    Motion motion(scene);
    motion.run(5);
    const Vec3 top = motion.body(static_cast<std::size_t>(boxes)).position;
    motion.print("%ld of %d asleep, the top strayed by %.2g m", static_cast<long>(motion.outcome().asleep), boxes,
                 std::hypot(top.x, top.y));
    EXPECT_EQ(motion.outcome().asleep, boxes);
    EXPECT_LT(std::hypot(top.x, top.y), 3e-4);
}

void slides(const Run& run, TriangleMesh mesh, double half_height, double angle, double friction, double time) {
    const Slope slope{angle, 0};
    Motion motion(on_slope(run.settings(), slope, friction, std::move(mesh), half_height));
    const History history = motion.record(time);
    // The scheme is exact for a constant rate; the first step may differ by what settling takes.
    const double way = way_down(history, slope),
                 due = 0.5 * slope.rate(friction) * motion.world().time() * motion.world().time();
    motion.print("slides %.5g m, due %.5g", way, due);
    EXPECT_NEAR(way / due, 1, 0.02);
}

// Shocks that are propagated through a stack hold it only where the friction of the ground could.
void stack_slides(const Run& run) {
    constexpr int kBoxes = 20;
    constexpr double kFriction = 0.3, kHeight = 0.05;
    const Slope slope{0.38, 0};
    const Start start = run.settings();
    const TriangleMesh box = make_box(0.5, 0.5, kHeight);
    const double pitch = kHeight + start.gap(box);
    SceneDescription scene = on_slope(start, slope, kFriction, box, kHeight / 2, 1);
    for (int i = 1; i < kBoxes; ++i)
        add_body(scene, 0, BodyType::dynamic, scene.bodies[0].position + rotate(slope.tilt(), {0, 0, i * pitch}),
                 kFriction, 0)
            .rotation = slope.tilt();
    Motion motion(scene);
    motion.run(2);
    const double due = 0.5 * slope.rate(kFriction) * motion.world().time() * motion.world().time();
    double mean = 0, farthest = 0, nearest = due;
    for (std::size_t b = 0; b <= kBoxes; ++b) {
        if (b == 1) continue; // the slope
        const double way = dot(motion.body(b).position - scene.bodies[b].position, slope.down());
        mean += way / kBoxes;
        farthest = std::max(farthest, way);
        nearest = std::min(nearest, way);
    }
    motion.print("slides %.4f m in the mean, %.4f to %.4f, due %.4f", mean, nearest, farthest, due);
    EXPECT_NEAR(mean / due, 1, 0.03);
    EXPECT_GT(nearest / due, 0.7) << "what preview leaves undone is slip between the boxes";
    EXPECT_LT(farthest / due, 1.3);
    expect_no_rise(motion);
}

void thrown_block_stops(const Run& run, double heading) {
    Motion motion(thrown_block(run.settings(), heading * kDegree));
    const auto [share, turn] = thrown(motion.record(2.5), heading * kDegree);
    const double due = kThrownSpeed * kThrownSpeed / (2 * kThrownFriction * kGravity), turned = turn / kDegree;
    motion.print("stops after %.5f of %.4g m, path turned by %.3g degrees, at %.3g m/s", share, due, turned,
                 length(motion.body(0).velocity));
    // A step in which the block stops is one of friction that is not needed in full: dt v / 2 at most.
    EXPECT_NEAR(share, 1, 0.01);
    EXPECT_LT(turned, 0.1);
    expect_no_rise(motion);
    expect_rest(motion);
}

void spinning_block_slides_straight(const Run& run) {
    Motion motion(spinning_block(run.settings()));
    motion.run(4);
    const Vec3 way = motion.body(0).position;
    motion.print("path of %.4g m, aside by %.3g m", way.x, way.y);
    EXPECT_GT(way.x, 9 / (2 * 0.3 * kGravity)); // spinning lengthens the way
    EXPECT_LT(std::abs(way.y), 0.03 * way.x);
    expect_no_rise(motion);
    expect_rest(motion);
}

/// Painleve's rod: slides on its lower end at tan = 2 to the ground, where friction above 4/3 has no finite answer
/// without an impulse.
void painleve_rod(const Run& run, double friction) {
    SceneDescription scene = make_scene_with(run.settings());
    const auto rod = add_shape(scene, make_box(1, 0.01, 0.01), 1);
    const double angle = std::atan(2.0);
    auto& body = add_body(scene, rod, BodyType::dynamic, {0, 0, 0.5 * std::sin(angle) + 0.01}, friction, 0);
    body.rotation = rotation_from_vector({0, angle, 0}); // the lower end ahead
    body.velocity = {3, 0, 0};
    add_ground(scene, 40, friction, 0);
    Motion motion(scene);
    double fastest = 0;
    motion.run(4, [&](const StepReport&) { fastest = std::max(fastest, motion.outcome().fastest); });
    motion.print("at most %.4g m/s", fastest);
    expect_no_rise(motion);
    EXPECT_LT(fastest, 6); // 3 m/s and the fall of its centre of mass
}

/// A box of 1 x 0.6 x 0.2 m, its lower edges cut off to the given depths (m).
TriangleMesh bevelled_box(double aside, double up) {
    TriangleMesh mesh;
    for (const auto& [x, y, z] : {Vec3{0.5 - aside, 0.3 - aside, -0.1}, {0.5, 0.3, -0.1 + up}, {0.5, 0.3, 0.1}})
        for (const auto& [u, v] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
            mesh.vertices.push_back({u * x, v * y, z});
    mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {8, 9, 10}, {8, 10, 11}};
    for (const std::int32_t ring : {0, 4})
        for (std::int32_t k = 0; k < 4; ++k) {
            const std::int32_t a = ring + k, b = ring + (k + 1) % 4;
            mesh.triangles.push_back({a, b, b + 4});
            mesh.triangles.push_back({a, b + 4, a + 4});
        }
    return mesh;
}

/// Without friction nothing stops a box that slides over the seam of two tables of one height.
void slides_over_a_seam(const Run& run, const TriangleMesh& mesh, double seam, double speed, double bound) {
    SceneDescription scene = make_scene_with(run.settings());
    const auto table = add_shape(scene, make_box(4, 2, 0.2), 1), box = add_shape(scene, mesh, 1);
    auto& body = add_body(scene, box, BodyType::dynamic, {1, 0, 0.1 + rest_gap(mesh)}, 0, 0);
    body.velocity = {speed, 0, 0};
    for (const double x : {0.0, 4 + seam}) add_body(scene, table, BodyType::fixed, {x, 0, -0.1}, 0, 0);
    Motion motion(scene);
    motion.run(1.2 / speed); // its front is beyond the seam after the first half
    const BodyState end = motion.body(0);
    motion.print("keeps %.6f of its speed, %.2g m/s upwards, turns at %.2g rad/s", end.velocity.x / speed,
                 end.velocity.z, length(end.angular_velocity));
    EXPECT_NEAR(end.velocity.x / speed, 1, bound);
    EXPECT_LT(length(end.angular_velocity), bound);
    expect_no_rise(motion);
}

/// A level box glides above another one, corner over corner, 1.05 rest distances from it where they are nearest: at
/// `phase` of a step.
void corner_passes_corner(const Run& run, double heading, double phase) {
    constexpr double kSpeed = 0.25, kAhead = 0.05; // m/s, m
    SceneDescription scene = make_scene_with(run.settings(), {});
    const TriangleMesh mesh = make_box(0.3, 0.3, 0.1);
    const auto box = add_shape(scene, mesh, 1);
    const double height = 0.1 + 1.05 * rest_gap(mesh);
    const Vec3 along{std::cos(heading), std::sin(heading), 0}, way = kSpeed * along;
    const Vec3 start = Vec3{-0.3, -0.3, height} - kAhead * along - phase * run.dt() * way;
    add_body(scene, box, BodyType::dynamic, start, 0, 0).velocity = way;
    add_body(scene, box, BodyType::fixed, {}, 0, 0);
    Motion motion(scene);
    motion.run(2 * kAhead / kSpeed);
    const BodyState end = motion.body(0);
    motion.print("velocity differs by %.2g of it, turns at %.2g rad/s", length(end.velocity - way) / kSpeed,
                 length(end.angular_velocity));
    EXPECT_LT(length(end.velocity - way), 1e-9 * kSpeed);
    EXPECT_LT(length(end.angular_velocity), 1e-9 * kSpeed);
}

// A cube between two jaws on rails that forces press on it, a tenth more than holds its weight: it stays. With the
// loads of its corners as sweeps find them it swung about the one that had most of them, and was down by up to 17 mm.
void pressed_jaws_hold_a_cube(const Run& run) {
    constexpr double kEdge = 0.1, kMass = 1, kFriction = 0.5, kApart = 5e-4, kPress = 1.1, kTime = 0.25;
    SceneDescription scene = make_scene_with(run.settings());
    add_body(scene, add_shape(scene, make_box(kEdge, kEdge, kEdge), kMass), BodyType::dynamic, {}, kFriction, 0);
    const auto jaw = add_shape(scene, make_box(kEdge, 1.2 * kEdge, 1.2 * kEdge), kMass / 2);
    for (const double side : {-1.0, 1.0}) {
        auto& body = add_body(scene, jaw, BodyType::dynamic, {side * (kEdge + kApart), 0, 0}, kFriction, 0);
        body.locked_translation = {false, true, true};
        body.locked_rotation = {true, true, true};
        body.force = {-side * kPress * kMass * kGravity / (2 * kFriction), 0, 0};
    }
    Motion motion(scene);
    motion.run(kTime);
    const double slid = -motion.body(0).center_of_mass.z;
    motion.print("slid by %.3g m", slid);
    EXPECT_NEAR(slid, 0, 0.002 * kEdge);
}

[[maybe_unused]] const bool registered = [] {
    const std::vector<Run> once = runs({24});
    for (const int heading : {0, 23, 45, 68, 90, 135, 200, 290}) {
        const bool fast = heading == 0 || heading == 23;
        for (const Run& run : runs())
            add_test("Friction", "SlidesAtTheRateOfCoulomb/" + run.name() + "_heading" + std::to_string(heading),
                     fast && run.rate == 24 ? Slice::fast : Slice::full,
                     [=] { slides_at_the_rate_of_coulomb(run, heading); });
        for (const Run& run : runs())
            add_test("Friction", "ThrownBlockStopsWhereItShould/" + run.name() + "_heading" + std::to_string(heading),
                     fast && run.rate == 24 ? Slice::fast : Slice::full, [=] { thrown_block_stops(run, heading); });
    }
    add_runs("Friction", "StackOf20Slides", {{"preview", 24}, {"preview", 60}, {"preview", 120}, {"balanced", 24}},
             true, stack_slides);
    add_runs("Friction", "SlidesJustBelowTheThreshold", runs(), true, slides_just_below_the_threshold);
    add_runs("Friction", "HoldsJustAboveTheThreshold", runs(), true, [](const Run& r) { holds(r, 1.001, 2, 1e-6); });
    add_runs("Friction", "DoesNotCreepInAMinute", once, true, [](const Run& r) { holds(r, 1.01, 60, 1e-9); });
    add_runs("Friction", "PlateOn27DegreesSlides", runs(), true,
             [](const Run& r) { slides(r, make_plate(1, 1), 0, 27 * kDegree, 0.5, 2); });
    add_runs("Friction", "PlateOn35DegreesSlides", runs(), true,
             [](const Run& r) { slides(r, make_plate(1, 1), 0, 35 * kDegree, 0.5, 2); });
    add_runs("Friction", "CubeSlidesTwoPercentBelowTheThreshold", runs(), true,
             [](const Run& r) { slides(r, make_box(1, 1, 1), 0.5, std::atan(0.5), 0.49, 2); });
    for (const int slope : {32, 35, 38, 44})
        add_runs("Friction", "BlockOnASlopeOfTan0_" + std::to_string(slope), runs(), true,
                 [=](const Run& r) { slides(r, make_box(1, 1, 0.4), 0.2, std::atan(0.01 * slope), 0.3, 100.0 / 24); });
    for (const int tenths : {1, 10, 30})
        add_runs("Friction", "SlidesOverASeamAt" + std::to_string(tenths) + "DecimetresASecond", runs(), true,
                 [=](const Run& r) { slides_over_a_seam(r, make_box(1, 0.6, 0.2), 1e-3, 0.1 * tenths, 1e-3); });
    for (const int tenths : {1, 5, 20})
        add_runs("Friction", "BevelsSlideOverASeamAt" + std::to_string(tenths) + "DecimetresASecond", runs(), true,
                 [=](const Run& r) { slides_over_a_seam(r, bevelled_box(0.03, 0.011), 4e-3, 0.1 * tenths, 3e-3); });
    for (const int degrees : {5, 30, 45, 77})
        add_runs("Friction", "CornerPassesCornerAt" + std::to_string(degrees) + "Degrees", runs(), true,
                 [=](const Run& r) {
                     for (int k = 0; k < 8; ++k) corner_passes_corner(r, degrees * kDegree, k / 8.0);
                 });
    add_runs("Friction", "PressedJawsHoldACube",
             {{"balanced", 24},
              {"balanced", 60},
              {"balanced", 120},
              {"accurate", 24},
              {"accurate", 60},
              {"reference", 24},
              {"reference", 60},
              {"reference", 120}},
             true, pressed_jaws_hold_a_cube);
    for (const int rate : {24, 240}) {
        // Below the speeds at which bodies fall asleep, 1.6e-3 and 8e-3 m/s at 1/24 s.
        for (const auto& [preset, slow] : {std::pair("balanced", 0.6e-3), std::pair("preview", 2e-3)})
            add_runs("Friction", "SlowCubeSlidesOn", {{preset, rate}}, true, [v = slow * 24 / rate](const Run& r) {
                slow_cube_slides_on(r, {v, 0, 0}, 0);
            });
        add_runs("Friction", "SlowCubeSpinsOn", {{"balanced", rate}}, true,
                 [=](const Run& r) { slow_cube_slides_on(r, {}, 1.2e-3 * 24 / rate); });
    }
    for (const auto& [boxes, preset, rate] : {std::tuple(5, "preview", 24), std::tuple(3, "balanced", 24),
                                              std::tuple(3, "balanced", 60), std::tuple(3, "balanced", 240)})
        add_runs("Friction", "SmoothStackOf" + std::to_string(boxes) + "FallsAsleep", {{preset, rate}}, true,
                 [boxes = boxes](const Run& r) { smooth_stack_falls_asleep(r, boxes); });
    add_runs("Friction", "SpinningBlockSlidesStraight", runs(), true, spinning_block_slides_straight);
    add_runs("Friction", "PainleveRodAbove4Thirds", runs(), true, [](const Run& r) { painleve_rod(r, 1.6); });
    add_runs("Friction", "PainleveRodBelow4Thirds", once, true, [](const Run& r) { painleve_rod(r, 1.2); });
    return true;
}();

} // namespace
} // namespace flotilla::physics
