// SPDX-License-Identifier: MIT
// Scripted bodies: conveyor, turntable, press, closing walls. Their work may raise the energy, so bounds are checked
// instead.
#include <limits>

#include "physics/physics.hpp"

namespace flotilla::physics {
namespace {

// Friction 1 brings a box that is put down at rest to the speed of the belt in v / (mu g), 0.1 s.
void conveyor(const Run& run) {
    constexpr double kSpeed = 1, kTime = 3;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_box(0.5, 0.5, 0.5);
    const auto box = add_solid(scene, mesh, 200), belt = add_shape(scene, make_box(20, 2, 0.2));
    const double rest = 0.25 + rest_gap(mesh);
    add_body(scene, box, BodyType::dynamic, {-4, 0, rest}, 1, 0);
    add_body(scene, belt, BodyType::kinematic, {0, 0, -0.1}, 1, 0).keyframes = {{0, {0, 0, -0.1}, {}},
                                                                                {100, {100 * kSpeed, 0, -0.1}, {}}};
    Motion motion(scene);
    double hop = 0, fastest = 0;
    motion.run(kTime, [&](const StepReport&) {
        hop = std::max(hop, motion.body(0).center_of_mass.z - rest);
        fastest = std::max(fastest, motion.body(0).velocity.x);
    });
    const double speed = motion.body(0).velocity.x, way = motion.body(0).center_of_mass.x + 4,
                 due = kSpeed * kTime - kSpeed * kSpeed / (2 * kGravity);
    motion.print("hops %.3g m, at most %.4g m/s, at the end %.5g m/s, %.4g of %.4g m", hop, fastest, speed, way, due);
    EXPECT_LT(hop, 1e-3);
    EXPECT_LT(fastest, 1.001 * kSpeed);
    EXPECT_NEAR(speed, kSpeed, 1e-3);
    EXPECT_NEAR(way, due, kSpeed * run.dt());
    EXPECT_LT(motion.outcome().end, 0.505 * motion.mass(0) * kSpeed * kSpeed);
}

// Two boxes on a lift that goes up and down with half of gravity: in each step it carries them with what its velocity
// changes by as well, from the start of the step to its end.
void lift_carries(const Run& run) {
    constexpr double kRate = 2 * kPi, kPush = 0.5 * kGravity, kTime = 2;
    const auto height = [&](int k) { return kPush / (kRate * kRate) * (1 - std::cos(kRate * k * run.dt())); };
    const auto speed = [&](int k) { return kPush / kRate * std::sin(kRate * k * run.dt()); };
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_box(0.2, 0.2, 0.2);
    const auto box = add_solid(scene, mesh, 500);
    auto& lift = add_body(scene, add_shape(scene, make_box(2, 2, 0.2)), BodyType::kinematic, {0, 0, -0.1}, 0.5, 0);
    for (int k = 0; k <= kTime * run.rate + 1; ++k)
        lift.keyframes.push_back({k * run.dt(), {0, 0, -0.1 + height(k)}, {}});
    for (int k = 0; k < 2; ++k)
        add_body(scene, box, BodyType::dynamic, {0, 0, 0.1 + rest_gap(mesh) + k * (0.2 + rest_gap(mesh))}, 0.5, 0);
    Motion motion(scene);
    double worst = 0;
    motion.run(kTime, [&](const StepReport& r) {
        const auto k = static_cast<int>(r.step) - 1;
        const double added = (speed(k + 1) - speed(k)) / run.dt();
        const double due = motion.total_mass() * (kGravity + added);
        if (r.time > 0.25) worst = std::max(worst, std::abs(-motion.force_on(0).z / due - 1));
    });
    motion.print("force differs by up to %.3g", worst);
    const double of_solve = run.preset == "preview" ? 8.0 / 4096 : 1e-3; // what one may leave, of gravity
    const double of_path = std::pow(kRate * run.dt(), 2) / 3;            // velocities of second order, half its load
    EXPECT_LT(worst, of_solve + of_path);
}

constexpr double kStands = 0.25; // s, before a bed or a table moves

/// A box on a bed that moves by `way`, m, of the time since kStands, until `time`. Its friction is 0.3.
SceneDescription box_on_a_bed(const Run& run, double restitution, double time, const std::function<Vec3(double)>& way) {
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_box(0.2, 0.2, 0.1);
    auto& bed = add_body(scene, add_shape(scene, make_box(40, 2, 0.1)), BodyType::kinematic, {0, 0, -0.05}, 0.3, 0);
    const int inner = scene.settings.substeps;
    for (int k = 0; k <= (time * run.rate + 2) * inner; ++k) {
        const double at = k * run.dt() / inner;
        bed.keyframes.push_back({at, Vec3{0, 0, -0.05} + way(std::max(0.0, at - kStands)), {}});
    }
    add_body(scene, add_solid(scene, mesh, 500), BodyType::dynamic, {0, 0, 0.05 + rest_gap(mesh)}, 0.3, restitution);
    return scene;
}

/// m, of the box from where it was on the bed.
Vec3 slip(Motion& motion) {
    const Vec3 first = motion.scene().bodies[1].position - motion.scene().bodies[0].keyframes.front().position;
    return motion.body(1).position - motion.body(0).position - first;
}

// A bed that accelerates by `share` of mu g takes what stands on it along, or what is beyond mu g leaves it behind.
void bed_accelerates(const Run& run, double share) {
    constexpr double kTime = 1.25, kHolds = 0.3 * kGravity, kMoves = kTime - kStands;
    const double rate = share * kHolds;
    Motion motion(box_on_a_bed(run, 0, kTime, [&](double t) { return Vec3{0.5 * rate * t * t, 0, 0}; }));
    motion.run(kTime);
    const double due = share < 1 ? 0 : -0.5 * (rate - kHolds) * kMoves * kMoves, is = slip(motion).x;
    motion.print("slips by %.4g mm, due %.4g mm", 1e3 * is, 1e3 * due);
    EXPECT_NEAR(is, due, 1e-4);
}

// The same bed, whose next place is told it step by step: nothing is known of its acceleration before it has begun.
void bed_is_driven(const Run& run) {
    constexpr double kTime = 1.25, kRate = 0.95 * 0.3 * kGravity;
    Motion motion(box_on_a_bed(run, 0, kTime, [](double) { return Vec3{}; }));
    motion.run(kTime, [&](const StepReport& r) {
        const double next = r.time + run.dt(), t = std::max(0.0, next - kStands);
        motion.world().set_script(motion.world().id(0), {{next, {0.5 * kRate * t * t, 0, -0.05}, {}}});
    });
    motion.print("slips by %.4g mm", 1e3 * slip(motion).x);
    EXPECT_NEAR(slip(motion).x, 0, kRate * run.dt() * run.dt());
}

// A bed that goes down with less than gravity keeps what stands on it.
void bed_sinks(const Run& run) {
    constexpr double kTime = 0.75, kRate = 0.9 * kGravity;
    Motion motion(box_on_a_bed(run, 0, kTime, [](double t) { return Vec3{0, 0, -0.5 * kRate * t * t}; }));
    double most = 0;
    motion.run(kTime, [&](const StepReport&) { most = std::max(most, std::abs(slip(motion).z)); });
    motion.print("%.4g mm from the bed", 1e3 * most);
    EXPECT_LT(most, 2e-5);
}

// So does one that shakes up and down.
void bed_shakes(const Run& run) {
    constexpr double kTime = 2.25, kTurns = 2 * kPi * 5, kMost = 0.8 * kGravity / (kTurns * kTurns);
    Motion motion(box_on_a_bed(run, 0.5, kTime, [](double t) {
        return Vec3{0, 0, std::min(1.0, t) * kMost * std::sin(kTurns * t)}; // swells for a second
    }));
    double most = 0;
    motion.run(kTime, [&](const StepReport&) { most = std::max(most, std::abs(slip(motion).z)); });
    motion.print("%.4g mm from the bed", 1e3 * most);
    EXPECT_LT(most, 2e-5);
}

// One that starts at once strikes what stands on it with all of its speed, and not half of that before.
void bed_strikes(const Run& run) {
    constexpr double kTime = 0.5, kSpeed = 2, kRestitution = 0.8;
    Motion motion(box_on_a_bed(run, kRestitution, kTime, [](double t) { return Vec3{0, 0, kSpeed * t}; }));
    double fastest = 0;
    motion.run(kTime, [&](const StepReport&) { fastest = std::max(fastest, motion.body(1).velocity.z); });
    const double due = (1 + kRestitution) * kSpeed;
    motion.print("struck to %.5g m/s, due %.5g m/s", fastest, due);
    EXPECT_NEAR(fastest, due, kGravity * run.dt());
}

// A box at r on a table that turns at W stays where W^2 r <= mu g. Steps along the tangent would lead outwards by r (W
// dt)^2 / 2 each; those along the chord, to second order, do by r (W dt)^4 / 8.
void turntable(const Run& run, double share) {
    constexpr double kRate = 1.5, kFriction = 0.4;
    const double time = share < 1 ? 1 : 5;
    const double radius = share * kFriction * kGravity / (kRate * kRate);
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_box(0.3, 0.3, 0.1);
    const auto box = add_solid(scene, mesh, 500), table = add_shape(scene, make_cylinder(6, 0.2, 32));
    auto& body = add_body(scene, box, BodyType::dynamic, {radius, 0, 0.05 + rest_gap(mesh)}, kFriction, 0);
    body.velocity = {0, kRate * radius, 0};
    body.angular_velocity = {0, 0, kRate};
    auto& turning = add_body(scene, table, BodyType::kinematic, {0, 0, -0.1}, kFriction, 0);
    for (int k = 0; k <= 40; ++k) // slerp between them is a constant rate
        turning.keyframes.push_back({k * 0.5 / kRate, {0, 0, -0.1}, rotation_from_vector({0, 0, k * 0.5})});
    Motion motion(scene);
    motion.run(time);
    const Vec3 at = motion.body(0).center_of_mass;
    const double out = std::hypot(at.x, at.y) - radius, angle = std::atan2(at.y, at.x),
                 behind = std::remainder(kRate * motion.world().time() - angle, 2 * kPi);
    motion.print("%.3f of the least radius, moved out by %.4g m, behind by %.3g rad", share, out, behind);
    if (share < 1) {
        EXPECT_LT(std::abs(out), 1e-4 * radius);
        EXPECT_LT(std::abs(behind), 1e-3);
    } else {
        EXPECT_GT(out, 0.5 * radius);
    }
}

// What a roller turns under stands on it as on one that rests: only what is carried round goes along a chord.
void stands_on_a_roller(const Run& run) {
    const auto height_over = [&](double rate) {
        SceneDescription scene = make_scene_with(run.settings());
        const TriangleMesh mesh = make_box(0.3, 0.3, 0.1);
        auto& body =
            add_body(scene, add_solid(scene, mesh, 500), BodyType::dynamic, {0, 0, 1.05 + rest_gap(mesh)}, 0.5, 0);
        body.locked_translation = {true, true, false};
        body.locked_rotation = {true, true, true};
        auto& roller =
            add_body(scene, add_shape(scene, make_cylinder(1, 2, 512)), BodyType::kinematic, {0, 0, 0}, 0.5, 0);
        for (int k = 0; k <= 40; ++k) {
            const Quat turn = rotation_from_vector({0, rate * 0.1 * k, 0}) * rotation_from_vector({kPi / 2, 0, 0});
            roller.keyframes.push_back({k * 0.1, {0, 0, 0}, turn});
        }
        Motion motion(scene);
        motion.run(2);
        return motion.body(0).center_of_mass.z;
    };
    const double still = height_over(0), turning = height_over(3);
    std::printf("stands at %.6f m, %.6f m\n", still, turning);
    EXPECT_NEAR(turning, still, 1e-5);
}

// A tip that cannot go sideways on a plate that wobbles under it: in most steps that takes the surface farther from it
// than contacts are searched for, and what carries it there counts all the same.
void wobble_plate(const Run& run, double rate) {
    constexpr double kTilt = 10 * kPi / 180, kArm = 0.3, kRadius = 0.02;
    const double period = 2 * kPi / rate;
    SceneDescription scene = make_scene_with(run.settings());
    auto& plate = add_body(scene, add_shape(scene, make_plate(2, 1)), BodyType::kinematic, {}, 0, 0);
    for (int k = 0; k * run.dt() < 2 * period + 1; ++k) {
        const Quat turn = rotation_from_vector({0, 0, rate * k * run.dt()});
        plate.keyframes.push_back({k * run.dt(), {}, turn * rotation_from_vector({0, kTilt, 0}) * conjugate(turn)});
    }
    const TriangleMesh mesh = scenario::make_octahedron(kRadius);
    const double height = -kArm * std::tan(kTilt) + (kRadius + rest_gap(mesh)) / std::cos(kTilt);
    auto& tip = add_body(scene, add_shape(scene, mesh, 1), BodyType::dynamic, {kArm, 0, height}, 0, 0);
    tip.locked_translation = {true, true, false};
    tip.locked_rotation = {true, true, true};
    Motion motion(scene);
    double sum = 0, least = std::numeric_limits<double>::infinity();
    int steps = 0;
    motion.run(2 * period, [&](const StepReport& r) {
        if (r.time < period) return; // it has landed
        const double force = motion.force_on(1).z;
        sum += force, ++steps;
        least = std::min(least, force);
    });
    motion.print("force %.4f of the weight in the mean, %.4f at least", sum / (steps * kGravity), least / kGravity);
    EXPECT_NEAR(sum / steps, kGravity, 0.01 * kGravity);
    EXPECT_GT(least, 0.8 * kGravity);
}

/// A roller about the y axis that turns at `rate`, rad/s, for `time` s.
BodyDescription& add_turning_roller(SceneDescription& scene, double radius, double width, int sides, double rate,
                                    double time, double friction) {
    const auto shape = add_shape(scene, make_cylinder(radius, width, sides));
    BodyDescription& roller = add_body(scene, shape, BodyType::kinematic, {0, 0, 0}, friction, 0);
    const int turns = static_cast<int>(std::ceil(rate * time));
    for (int k = 0; k <= turns; ++k) {
        const double t = k * time / turns;
        const Quat turn = rotation_from_vector({0, rate * t, 0}) * rotation_from_vector({kPi / 2, 0, 0});
        roller.keyframes.push_back({t, {0, 0, 0}, turn});
    }
    return roller;
}

// A block on a roller that spins under it is pulled along with all its friction, however fine the roller's sides are
// and however far its ends are from its middle.
void roller_pulls(const Run& run, int sides) {
    constexpr double kRadius = 0.05, kRate = 20, kFriction = 0.25, kTime = 0.2;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_box(0.6, 0.2, 0.1);
    const Vec3 place{0, 0, kRadius + 0.05 + rest_gap(mesh)};
    auto& block = add_body(scene, add_solid(scene, mesh, 500), BodyType::dynamic, place, kFriction, 0);
    block.locked_translation = {false, true, false};
    block.locked_rotation = {true, true, true};
    add_turning_roller(scene, kRadius, 0.3, sides, kRate, 2 * kTime, kFriction);
    Motion motion(scene);
    motion.run(kTime);
    const double share = motion.body(0).velocity.x / (kFriction * kGravity * motion.world().time());
    motion.print("pulled along at %.4f of what friction gives", share);
    EXPECT_NEAR(share, 1, 0.03);
}

// A wheel that one of prescribed turns drives by friction ends with the same speed at its rim.
void wheel_drives_a_wheel(const Run& run) {
    constexpr double kDriver = 0.1, kDriven = 0.06, kRate = 20, kFriction = 0.3, kMass = 2, kPress = 20, kTime = 0.95;
    constexpr double kInertia = 0.5 * kMass * kDriven * kDriven;
    SceneDescription scene = make_scene_with(run.settings(), {});
    const TriangleMesh mesh = make_cylinder(kDriven, 0.08, 360);
    const auto wheel = add_shape(scene, mesh, kMass);
    scene.shapes.back().inertia = diagonal({kInertia, kInertia, kInertia});
    const double apart = kDriver + kDriven + rest_gap(mesh);
    auto& driven = add_body(scene, wheel, BodyType::dynamic, {apart, 0, 0}, kFriction, 0);
    driven.rotation = rotation_from_vector({kPi / 2, 0, 0});
    driven.force = {-kPress, 0, 0};
    driven.locked_translation = {false, true, true};
    driven.locked_rotation = {true, false, true};
    add_turning_roller(scene, kDriver, 0.1, 360, kRate, 2 * kTime, kFriction);
    Motion motion(scene);
    motion.run(kTime);
    const double share = -motion.body(0).angular_velocity.y * kDriven / (kRate * kDriver);
    motion.print("its rim has %.4f of the speed", share);
    EXPECT_NEAR(share, 1, 0.01);
}

// A block in a turning drum slides where friction just carries it, and swings about there. From elsewhere it swings for
// ever, farther or less far by what a step adds to a swing or takes from it, so that it is let go there. Its two edges
// press against the drum, each at the angle a from the middle: mu (N1 + N2) R = m g d sin(angle), d from the axis to
// its centre of mass, and N1 + N2 = m g cos(angle) / cos a.
void drum_carries_a_block(const Run& run, int sides) {
    constexpr double kRadius = 0.3, kWidth = 0.15, kRate = 1.5, kFriction = 0.4, kTime = 5;
    const TriangleMesh mesh = make_box(0.08, 0.1, 0.03);
    const double edges = std::sqrt(kRadius * kRadius - 0.04 * 0.04), middle = edges - 0.015 - rest_gap(mesh);
    TriangleMesh drum;
    for (int k = 0; k < sides; ++k) {
        const double angle = 2 * kPi * k / sides;
        for (const double y : {-kWidth, kWidth})
            drum.vertices.push_back({kRadius * std::cos(angle), y, kRadius * std::sin(angle)});
        const int a = 2 * k, b = 2 * ((k + 1) % sides);
        drum.triangles.push_back({a, b, b + 1});
        drum.triangles.push_back({a, b + 1, a + 1});
    }
    SceneDescription scene = make_scene_with(run.settings());
    const double due = std::atan(kFriction * kRadius / middle * kRadius / edges);
    add_body(scene, add_solid(scene, mesh, 1000), BodyType::dynamic,
             {-middle * std::sin(due), 0, -middle * std::cos(due)}, kFriction, 0)
        .rotation = rotation_from_vector({0, due, 0});
    auto& body = add_body(scene, add_shape(scene, drum), BodyType::kinematic, {0, 0, 0}, kFriction, 0);
    for (int k = 0; k <= 2 * kTime * kRate; ++k)
        body.keyframes.push_back({k / kRate, {0, 0, 0}, rotation_from_vector({0, 1.0 * k, 0})});
    Motion motion(scene);
    double sum = 0, highest = 0;
    int steps = 0;
    motion.run(kTime, [&](const StepReport&) {
        const Vec3 at = motion.body(0).center_of_mass;
        const double angle = std::atan2(-at.x, -at.z);
        sum += angle;
        highest = std::max(highest, angle);
        ++steps;
    });
    motion.print("swings about %.3f rad, due %.3f, up to %.3f", sum / steps, due, highest);
    EXPECT_NEAR(sum / steps, due, 0.05);
}

constexpr int kBoxes = 5;

/// A loose stack with 5 cm between its boxes of 0.5 m, and a press that comes down at 6 m/s from 6 m to `low` and goes
/// up again.
SceneDescription press(const Run& run, double low) {
    SceneDescription scene = make_scene_with(run.settings());
    const auto box = add_solid(scene, make_box(0.5, 0.5, 0.5), 500), plate = add_shape(scene, make_box(2, 2, 0.2));
    for (int i = 0; i < kBoxes; ++i) add_body(scene, box, BodyType::dynamic, {0, 0, 0.3 + 0.55 * i}, 0.5, 0);
    const Vec3 up{0, 0, 6.1}, down{0, 0, low + 0.1};
    const double time = (6 - low) / 6;
    add_body(scene, plate, BodyType::kinematic, up, 0.5, 0).keyframes = {
        {0, up, {}}, {time, down, {}}, {time + 1, down, {}}, {2 * time + 1, up, {}}};
    add_ground(scene, 20, 0.5, 0);
    return scene;
}

constexpr double kSettled = 0.5 * kBoxes; // m, the height of the stack without gaps

// There is room for all once the boxes have fallen together: the script ends.
void press_goes_back(const Run& run) {
    Motion motion(press(run, kSettled + 0.06));
    double lowest = 10;
    std::int64_t delayed = 0;
    motion.run(4, [&](const StepReport& r) {
        lowest = std::min(lowest, motion.body(kBoxes).position.z - 0.1);
        delayed += (r.warnings & kScriptDelayed) != 0 ? 1 : 0;
    });
    motion.print("press down to %.4g m (stack %.4g m), at the end at %.4g m, delayed in %lld steps", lowest, kSettled,
                 motion.body(kBoxes).position.z - 0.1, static_cast<long long>(delayed));
    EXPECT_LT(lowest, kSettled + 0.061);
    EXPECT_NEAR(motion.body(kBoxes).position.z, 6.1, 1e-6);
    expect_rest(motion);
}

// No room: boxes fall and are squeezed to contact, the press lies on them.
void press_meets_a_stack(const Run& run) {
    Motion motion(press(run, kSettled - 0.5));
    motion.run(run.rate <= 24 ? 2.5 : 1.5);
    const double low = motion.body(kBoxes).position.z - 0.1, top = motion.body(kBoxes - 1).center_of_mass.z + 0.25;
    motion.print("press %.4g m above the top box, that %.4g m above the height of the stack", low - top,
                 top - kSettled);
    EXPECT_LT(low - top, 0.006); // two rest distances
    EXPECT_LT(top - kSettled, 0.02);
    EXPECT_LT(motion.outcome().fastest, 0.01);
}

// Eight cubes in a box whose walls close until they would meet: the cubes fall to the floor and are pushed together,
// none hangs in the air. With `all` the floor and the ceiling close too, towards the height of the cubes' middle.
void closing_walls(const Run& run, bool all) {
    constexpr double kEdge = 0.5, kStart = 2, kSpeed = 1, kMiddle = 2;
    SceneDescription scene = make_scene_with(run.settings());
    const auto cube = add_solid(scene, make_box(kEdge, kEdge, kEdge), 500);
    const auto wall = add_shape(scene, make_box(0.2, 8, 8));
    const Vec3 middle{0, 0, kMiddle};
    Numbers numbers(6);
    for (int i = 0; i < 8; ++i) {
        const Vec3 cell{i % 2 - 0.5, i / 2 % 2 - 0.5, i / 4 - 0.5};
        add_body(scene, cube, BodyType::dynamic, middle + cell, 0.3, 0).rotation =
            rotation_from_vector(0.2 * numbers.vector());
    }
    // The walls overlap at their edges, as bodies without finite mass may.
    for (int k = 0; k < (all ? 6 : 4); ++k) {
        const Quat turn = k < 4 ? rotation_from_vector({0, 0, k * kPi / 2})
                                : rotation_from_vector({0, (k == 4 ? 1 : -1) * kPi / 2, 0});
        const auto at = [&](double distance) { return middle + rotate(turn, {distance + 0.1, 0, 0}); };
        auto& body = add_body(scene, wall, BodyType::kinematic, at(kStart), 0.3, 0);
        body.rotation = turn;
        body.keyframes = {{0, at(kStart), turn}, {kStart / kSpeed, at(0), turn}};
    }
    if (!all) add_ground(scene, 20, 0.3, 0);
    Motion motion(scene);
    double lowest = kMiddle, fallen = 0; // of the cubes' mean height
    motion.run(2.4, [&](const StepReport& r) {
        double mean = 0;
        for (std::size_t i = 0; i < 8; ++i) mean += motion.body(i).center_of_mass.z / 8;
        lowest = std::min(lowest, mean);
        if (r.time < 0.4) fallen = kMiddle - mean;
    });
    double width = 0;
    for (std::size_t i = 8; i < 12; ++i) width = std::max(width, length(motion.body(i).position - middle) - 0.1);
    motion.print("walls end %.4g m from the middle, cubes fell %.3g m in 0.4 s, %.3g m at most", width, fallen,
                 kMiddle - lowest);
    EXPECT_LT(width, 1.2); // less than half a metre of the way is needed to reach the cubes
    EXPECT_LT(motion.outcome().fastest, 0.1);
    EXPECT_GT(fallen, 0.5);
}

// A wedge of 30 degrees under a lid that comes down. Both its faces would have to slide for it to go aside, and their
// friction of 22 or 35 degrees each allows none of it: the lid waits. Without friction the wedge goes 0.25 m.
void lid_waits_for_a_wedge(const Run& run, double friction) {
    constexpr double kSpeed = 0.2, kAbove = 0.02;
    const double high = std::tan(kPi / 6);
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh wedge{{{0, -0.5, 0}, {1, -0.5, 0}, {0, -0.5, high}, {0, 0.5, 0}, {1, 0.5, 0}, {0, 0.5, high}},
                             {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}}};
    const TriangleMesh slope{{{-2, -3, 2 * high}, {3, -3, -3 * high}, {3, 3, -3 * high}, {-2, 3, 2 * high}},
                             {{0, 1, 2}, {0, 2, 3}}};
    add_body(scene, add_solid(scene, wedge, 20), BodyType::dynamic, {0, 0, rest_gap(wedge)}, friction, 0);
    const Vec3 up{0, 0, high + kAbove}, down{0, 0, up.z - 2 * kSpeed};
    add_body(scene, add_shape(scene, slope), BodyType::kinematic, up, friction, 0).keyframes = {{0, up, {}},
                                                                                                {2, down, {}}};
    add_ground(scene, 20, friction, 0);
    Motion motion(scene);
    const double from = motion.body(0).center_of_mass.x;
    motion.run(0.8);
    const double aside = motion.body(0).center_of_mass.x - from, came = up.z - motion.body(1).position.z;
    motion.print("wedge %.3g m aside, lid came down by %.3g of %.3g m", aside, came, kSpeed * motion.world().time());
    EXPECT_LT(std::abs(aside), 0.01);
    EXPECT_LT(came, kAbove + 0.01);
}

// Jaws that close on a box to less than its rest distance, which no impulses give back, lift it by half a metre.
void jaws_lift_a_box(const Run& run) {
    constexpr double kEdge = 0.4, kThick = 0.2, kNearer = 4e-4, kFriction = 0.5, kStart = 0.3, kLift = 0.5;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh box = make_box(kEdge, kEdge, kEdge);
    const double rest = kEdge / 2 + rest_gap(box);
    add_body(scene, add_solid(scene, box, 50), BodyType::dynamic, {0, 0, rest}, kFriction, 0);
    const auto jaw = add_shape(scene, make_box(kThick, 0.5, 0.5));
    for (const double side : {-1.0, 1.0}) {
        const double open = side * (kEdge / 2 + kThick / 2 + 0.05), closed = side * (kEdge / 2 + kThick / 2 + kNearer);
        const Vec3 away{open, 0, kStart}, at_box{closed, 0, kStart}, up{closed, 0, kStart + kLift};
        add_body(scene, jaw, BodyType::kinematic, away, kFriction, 0).keyframes = {
            {0, away, {}}, {0.5, at_box, {}}, {1.5, up, {}}, {2.5, up, {}}};
    }
    add_ground(scene, 20, kFriction, 0);
    Motion motion(scene);
    motion.run(2.4);
    const double lifted = motion.body(0).center_of_mass.z - rest, jaws = motion.body(1).position.z - kStart;
    motion.print("lifted by %.5f m, jaws by %.5f m", lifted, jaws);
    EXPECT_NEAR(jaws, kLift, 1e-9);
    EXPECT_NEAR(lifted, kLift, 2e-3);
}

// The same with a plate of 4 mm and of none, and fingers of a few centimetres. It hangs by their friction: by its weight
// as the force that it reports, and at rest. Without friction it stays where it is.
void fingers_hold_a_plate(const Run& run, double thick, double nearer, double mass, double friction) {
    constexpr double kEdge = 0.2, kFinger = 0.02, kStart = 0.15, kLift = 0.3;
    SceneDescription scene = make_scene_with(run.settings());
    TriangleMesh plate = make_box(kEdge, thick, kEdge);
    if (thick == 0)
        plate = {{{-kEdge / 2, 0, -kEdge / 2},
                  {kEdge / 2, 0, -kEdge / 2},
                  {kEdge / 2, 0, kEdge / 2},
                  {-kEdge / 2, 0, kEdge / 2}},
                 {{0, 1, 2}, {0, 2, 3}}};
    const double rest = kEdge / 2 + rest_gap(plate);
    add_body(scene, add_shape(scene, plate, mass), BodyType::dynamic, {0, 0, rest}, friction, 0);
    const auto finger = add_shape(scene, make_box(0.06, kFinger, 0.04));
    for (const double side : {-1.0, 1.0}) {
        const double open = side * (thick / 2 + 0.02), closed = side * (thick / 2 + kFinger / 2 + nearer);
        const Vec3 away{0, open, kStart}, at_plate{0, closed, kStart}, up{0, closed, kStart + kLift};
        add_body(scene, finger, BodyType::kinematic, away, friction, 0).keyframes = {
            {0, away, {}}, {0.5, at_plate, {}}, {1, at_plate, {}}, {2, up, {}}, {9, up, {}}};
    }
    add_ground(scene, 20, friction, 0);
    Motion motion(scene);
    motion.run(2.5);
    const double lifted = motion.body(0).center_of_mass.z - rest;
    const auto above = motion.outcome().above;
    double most = 0, least = std::numeric_limits<double>::infinity();
    while (motion.world().time() < 3.5) {
        motion.step();
        const double force = motion.force_on(0).z / (mass * kGravity);
        most = std::max(most, force), least = std::min(least, force);
    }
    const double moved = motion.body(0).center_of_mass.z - rest - lifted;
    motion.print("lifted by %.5f m, then moved %.2g m, carried by %.5f to %.5f of its weight", lifted, moved, least,
                 most);
    EXPECT_NEAR(lifted, friction > 0 ? kLift : 0, 2e-3);
    EXPECT_NEAR(moved, 0, 1e-5);
    EXPECT_NEAR(least, 1, 1e-3);
    EXPECT_NEAR(most, 1, 1e-3);
    EXPECT_EQ(motion.outcome().above, above); // that it lacks its rest distance is no fault of a solve
}

// Four blades at 20 rad/s among balls that have room beside them: what is driven before a blade is a jam of a step, and
// the rotor waits for next to none of it: of 144 starts at 1/60 s in 26, for 36 of 34,560 steps in all. Without joint
// solves at the limit of sweeps it lost 4 and 9 of its 60 rad in the two that are here.
void mixer_turns(const Run& run, int start) {
    constexpr double kRate = 20, kTime = 3, kBefore = 1, kTurn = 0.05, kWall = 0.4, kBall = 0.04;
    SceneDescription scene = make_scene_with(run.settings());
    TriangleMesh blades = make_box(0.6, 0.015, 0.06);
    const TriangleMesh other = make_box(0.015, 0.6, 0.06);
    const auto n = static_cast<std::int32_t>(blades.vertices.size());
    for (const Vec3& v : other.vertices) blades.vertices.push_back(v + Vec3{0, 0, 0.08});
    for (const Triangle& t : other.triangles) blades.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
    auto& rotor = add_body(scene, add_shape(scene, blades), BodyType::kinematic, {0, 0, 0.06}, 0.3, 0.2);
    rotor.keyframes = {{0, {0, 0, 0.06}, {}}};
    for (int k = 0; k * kTurn <= kRate * kTime + 1; ++k)
        rotor.keyframes.push_back({kBefore + k * kTurn / kRate, {0, 0, 0.06}, rotation_from_vector({0, 0, k * kTurn})});
    const auto ball = add_shape(scene, make_sphere(kBall, 1), 1000);
    add_body(scene, add_shape(scene, make_tube(kWall, 1.5, 32)), BodyType::fixed, {0, 0, 0.75}, 0.3, 0.2);
    for (const double z : {0.0, 1.5})
        add_body(scene, add_shape(scene, make_disc(kWall, 32)), BodyType::fixed, {0, 0, z}, 0.3, 0.2);
    for (int k = 0; k < 50; ++k) {
        const double aside = 0.01 * std::sin(12.9898 * (k + 1 + 50 * start));
        add_body(scene, ball, BodyType::dynamic,
                 {(k / 3 % 3 - 1) * 0.15 + aside, (k % 3 - 1) * 0.15, 0.25 + 0.1 * (k / 9)}, 0.3, 0.2);
    }
    Motion motion(scene);
    double turned = 0;
    motion.run(kBefore + kTime, [&](const StepReport&) { turned += motion.world().turn(0).z; });
    motion.print("turns by %.4f rad, due %.4f", turned, kRate * kTime);
    EXPECT_LT(turned, kRate * kTime + 1e-6);
    EXPECT_GT(turned, kRate * kTime - 1);
    EXPECT_LE(motion.outcome().held_steps, 3);
}

[[maybe_unused]] const bool registered = [] {
    add_runs("Scripts", "BoxOnAConveyor", runs(), true, conveyor);
    add_runs("Scripts", "LiftCarriesWhatItAccelerates", {{"balanced", 120}, {"preview", 60}, {"balanced", 480}}, true,
             lift_carries);
    add_runs("Scripts", "WobblePlateCarriesATip", {{"balanced", 24}, {"balanced", 60}, {"preview", 60}}, true,
             [](const Run& r) { wobble_plate(r, r.rate / 12.0); });
    add_runs("Scripts", "BedTakesABoxAlong", runs(), true, [](const Run& r) { bed_accelerates(r, 0.95); });
    add_runs("Scripts", "BoxSlidesOnABed", runs(), true, [](const Run& r) { bed_accelerates(r, 1.1); });
    add_runs("Scripts", "DrivenBedTakesABoxAlong", {{"balanced", 24}, {"balanced", 120}, {"preview", 60}}, true,
             bed_is_driven);
    add_runs("Scripts", "SinkingBedKeepsABox", runs({24, 120}), true, bed_sinks);
    add_runs("Scripts", "ShakingBedKeepsABox", runs({60, 240}), true, bed_shakes);
    add_runs("Scripts", "BedStrikesABox", runs({24, 120}), true, bed_strikes);
    add_runs("Scripts", "BoxStaysOnATurntable", runs(), true, [](const Run& r) { turntable(r, 0.9); });
    add_runs("Scripts", "BoxStandsOnARoller", runs({60, 240}), true, stands_on_a_roller);
    for (const int sides : {96, 256, 512})
        add_runs("Scripts", "Roller" + std::to_string(sides) + "PullsABlock", runs({60, 240}), true,
                 [=](const Run& r) { roller_pulls(r, sides); });
    add_runs("Scripts", "WheelDrivesAWheel", {{"balanced", 240}, {"accurate", 60}}, true, wheel_drives_a_wheel);
    for (const int sides : {720, 1440})
        add_runs("Scripts", "Drum" + std::to_string(sides) + "CarriesABlock", runs({24}), true,
                 [=](const Run& r) { drum_carries_a_block(r, sides); });
    add_runs("Scripts", "BoxSlidesOffATurntable", runs(), true, [](const Run& r) { turntable(r, 1.1); });
    add_runs("Scripts", "PressGoesBack", runs({24, 120}), true, press_goes_back);
    add_runs("Scripts", "PressMeetsAStack", runs({24, 120}), true, press_meets_a_stack);
    for (const auto& [name, friction] :
         {std::pair("LidWaitsForAWedge", 0.4), std::pair("LidWaitsForARoughWedge", 0.7)}) {
        const auto waits = [=](const Run& r) { lid_waits_for_a_wedge(r, friction); };
        add_runs("Scripts", name, runs({24, 60, 240}), true, waits);
        add_runs("Scripts", name, {{"preview", 24}, {"preview", 60}}, true, waits);
    }
    add_runs("Scripts", "JawsLiftABox", runs(), true, jaws_lift_a_box);
    struct Held {
        const char* name;
        double thick, nearer, mass, friction;
    };
    for (const Held& h : {Held{"Plate", 0.004, 1e-4, 0.05, 0.5}, Held{"PlateNearer", 0.004, 5e-5, 0.05, 0.5},
                          Held{"HeavyPlate", 0.004, 1e-4, 1, 0.3}, Held{"Sheet", 0, 1e-4, 0.05, 0.5},
                          Held{"SlipperyPlate", 0.004, 1e-4, 0.05, 0}})
        add_runs("Scripts", std::string("FingersHoldA") + h.name,
                 {{"preview", 60}, {"balanced", 24}, {"balanced", 60}, {"accurate", 60}, {"balanced", 240}},
                 std::string(h.name) == "Plate",
                 [=](const Run& r) { fingers_hold_a_plate(r, h.thick, h.nearer, h.mass, h.friction); });
    for (const int start : {3, 7}) // without joint solves at the limit of sweeps 56 and 51 of 60 rad
        add_runs("Scripts", "MixerTurnsAmongBallsFromStart" + std::to_string(start),
                 {{"balanced", 60}, {"preview", 60}, {"balanced", 120}}, start == 3,
                 [=](const Run& r) { mixer_turns(r, start); });
    add_runs("Scripts", "ClosingWalls", runs({24, 120}), false, [](const Run& r) { closing_walls(r, false); });
    add_runs("Scripts", "ClosingBox", runs({24, 120}), false, [](const Run& r) { closing_walls(r, true); });
    return true;
}();

} // namespace
} // namespace flotilla::physics
