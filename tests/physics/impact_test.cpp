// SPDX-License-Identifier: MIT
// Impacts: free fall, bounces, what lands flat, what hands a blow on.
#include <numbers>

#include "physics/physics.hpp"
#include "physics/problems/falling_cube.hpp"
#include "physics/problems/impact.hpp"

namespace flotilla::physics {
namespace {

// Exact for constant gravity but for rounding.
void ballistic(const Run& run) {
    Motion motion(projectile(run.settings()));
    const History history = motion.record(2);
    double most = 3;
    for (const Instant& i : history.instants()) most = std::max(most, length(i.bodies[0].center_of_mass));
    const double worst = off_parabola(history);
    motion.print("off by %.3g m", worst);
    EXPECT_LE(worst, 10 * motion.outcome().steps * scenario::kRoundOff * most);
    EXPECT_LT(motion.outcome().rise, 1e-11);
}

// Each bounce misses its height by what the contact distances are worth, and those before it: (1 - e^2) of 2/330 m.
void bounces_as_due(const Run& run, double e) {
    Motion motion(bouncing(run.settings(), e));
    const double due_time = due_end_of_bouncing(e);
    const Bounces b = bounces(motion.record(1.3 * due_time));
    ASSERT_GE(b.heights.size(), 3u);
    motion.print("heights %.4f %.4f %.4f of %.4f %.4f %.4f m, stops at %.3f of %.3f s", b.heights[0], b.heights[1],
                 b.heights[2], kDrop * e * e, kDrop * std::pow(e, 4), kDrop * std::pow(e, 6), b.end_of_bouncing,
                 due_time);
    double exact = kDrop, bound = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        bound = e * e * bound + (1 - e * e) * 2.0 / 330;
        exact *= e * e;
        EXPECT_NEAR(b.heights[i], exact, bound) << "bounce " << i;
    }
    expect_no_rise(motion);
}

// All corners hit at once: no spin, no tilt, and each rise as for a point.
void lands_flat(const Run& run, double e) {
    Motion motion(flat_crate(run.settings(), e));
    double hit = 0, spin = 0, tilt = 0;
    const double fall = std::sqrt(2 / kGravity);
    motion.run(fall + run.dt() + 0.25, [&](const StepReport& r) {
        const BodyState s = motion.body(0);
        if (hit == 0 && s.velocity.z > 0) hit = r.time;
        const double turning = 0.5 * motion.mass(0) / 6 * length_sq(s.angular_velocity);
        spin = std::max(spin, turning / (motion.mass(0) * kGravity));
        tilt = std::max(tilt, std::acos(std::min(1.0, rotate(s.rotation, {0, 0, 1}).z)) / kDegree);
    });
    motion.print("%.3g of its energy in spin, tilted by %.3g degrees", spin, tilt);
    EXPECT_LT(spin, 1e-6);
    EXPECT_LT(tilt, 0.05);
    expect_no_rise(motion);
}

/// A crate that falls flat from half a metre across the seams of four tiles, its centre aside of them.
SceneDescription crate_over_tiles(const Settings& settings, double e) {
    SceneDescription scene = make_scene_with(settings);
    const auto crate = add_shape(scene, make_box(1, 1, 1), 200), tile = add_shape(scene, make_plate(4, 4), 1);
    add_body(scene, crate, BodyType::dynamic, {0.2, 0.1, 0.5 + 0.5}, 0.1, e);
    for (const double x : {-2, 2})
        for (const double y : {-2, 2}) add_body(scene, tile, BodyType::fixed, {x, y, 0}, 0.1, e);
    return scene;
}

/// A beam that falls flat from half a metre on five posts.
SceneDescription beam_over_posts(const Settings& settings, double e) {
    SceneDescription scene = make_scene_with(settings);
    const auto post = add_shape(scene, make_box(0.1, 0.5, 0.5), 1), beam = add_shape(scene, make_box(2, 0.3, 0.1), 500);
    for (const double x : {-0.9, -0.45, 0.0, 0.45, 0.9}) add_body(scene, post, BodyType::fixed, {x, 0, -0.25}, 0.1, e);
    add_body(scene, beam, BodyType::dynamic, {0, 0, 0.05 + 0.5}, 0.1, e);
    return scene;
}

// What lands on several bodies that stand still lands as on one: it does not turn, and rises as a point does.
void lands_level(const Run& run, const SceneDescription& scene, std::size_t body, double e) {
    Motion motion(scene);
    const double start = motion.body(body).center_of_mass.z, fall = std::sqrt(2 * 0.5 / kGravity);
    double lowest = start, rise = 0, tilt = 0;
    motion.run(fall + run.dt() + 0.4, [&](const StepReport& r) {
        const BodyState s = motion.body(body);
        lowest = std::min(lowest, s.center_of_mass.z);
        if (r.time > fall) rise = std::max(rise, s.center_of_mass.z - lowest);
        tilt = std::max(tilt, std::acos(std::min(1.0, rotate(s.rotation, {0, 0, 1}).z)) / kDegree);
    });
    motion.print("rises by %.4f of %.4f m, tilted by %.3g degrees", rise, 0.5 * e * e, tilt);
    EXPECT_LT(tilt, 0.05);
    EXPECT_LT(rise, 0.5 * e * e + 0.02);
    expect_no_rise(motion);
}

/// rad/s, of the first body in so many seconds.
double greatest_spin(Motion& motion, double time) {
    double spin = 0;
    motion.run(time, [&](const StepReport&) { spin = std::max(spin, length(motion.body(0).angular_velocity)); });
    motion.print("turns at up to %.3g rad/s", spin);
    return spin;
}

// Between a floor of two tiles and a ceiling, which it hits in turns within a step, a crate does not turn either.
void stays_level_between_tiles_and_ceiling(const Run& run, double e) {
    SceneDescription scene = make_scene_with(run.settings());
    scene.gravity = {};
    const auto crate = add_shape(scene, make_box(1, 1, 0.5), 250), tile = add_shape(scene, make_box(3, 3, 0.5), 1),
               ceiling = add_shape(scene, make_box(6, 6, 0.5), 1);
    add_body(scene, crate, BodyType::dynamic, {0.2, 0, 0.25 + 0.03}, 0, e).velocity = {0, 0, -6};
    for (const double x : {-1.5005, 1.5005}) add_body(scene, tile, BodyType::fixed, {x, 0, -0.25}, 0, e);
    add_body(scene, ceiling, BodyType::fixed, {0, 0, 0.5 + 0.07 + 0.25}, 0, e);
    Motion motion(scene);
    EXPECT_LT(greatest_spin(motion, 4 * run.dt()), 1e-3);
    expect_no_rise(motion);
}

// A box that falls at its rest distance beside a wall on a ledge under its far half is held up by the ledge alone.
void falls_beside_a_wall(const Run& run) {
    for (const double gap : {0.0025, 0.0035, 0.006}) {
        SceneDescription scene = make_scene_with(run.settings());
        const auto box = add_shape(scene, make_box(1, 1, 1), 500), wall = add_shape(scene, make_box(1, 4, 4), 1),
                   ledge = add_shape(scene, make_box(0.3, 1, 0.5), 1);
        add_body(scene, box, BodyType::dynamic, {0.5 + gap, 0, 0.5 + 0.3}, 0, 0.5);
        add_body(scene, wall, BodyType::fixed, {-0.5, 0, 0}, 0, 0.5);
        add_body(scene, ledge, BodyType::fixed, {1, 0, -0.25}, 0, 0.5);
        Motion motion(scene);
        motion.run(0.35);
        const BodyState s = motion.body(0);
        motion.print("%.3f m/s aside, %.3f rad/s", s.velocity.x, s.angular_velocity.y);
        EXPECT_LT(s.angular_velocity.y, -0.2);
        EXPECT_GT(s.velocity.x, 0.5);
        expect_no_rise(motion);
    }
}

// How far a mesh reaches beyond the posts on it, or a grid of coordinates in single precision far from its origin, is
// nothing to the plate that lands on them.
void lands_on_posts_of_any_mesh(const Run& run) {
    for (const double base : {1.0, 100.0})
        for (const double offset : {0.0, 100.0}) {
            SceneDescription scene = make_scene_with(run.settings());
            TriangleMesh plate = make_box(1, 1, 0.1);
            for (Vec3& x : plate.vertices) {
                x += Vec3{offset, offset, offset};
                x = {static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z)};
            }
            TriangleMesh posts = make_box(base, base, 0.1);
            for (Vec3& x : posts.vertices) x.z -= 0.4;
            for (const double x : {-0.4, 0.4})
                for (const double y : {-0.4, 0.4}) {
                    const auto first = static_cast<std::int32_t>(posts.vertices.size());
                    const TriangleMesh post = make_box(0.05, 0.05, 0.2);
                    for (const Vec3& v : post.vertices) posts.vertices.push_back(v + Vec3{x, y, -0.1});
                    for (const Triangle& t : post.triangles)
                        posts.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
                }
            const auto falling = add_shape(scene, plate, 500), standing = add_shape(scene, posts, 1);
            const Quat tilt = rotation_from_vector({1e-3, 0, 0});
            BodyDescription& body = add_body(scene, falling, BodyType::dynamic, {}, 0.3, 0.5);
            body.rotation = tilt;
            body.position = Vec3{0, 0, 0.05 + 0.3} - rotate(tilt, {offset, offset, offset});
            add_body(scene, standing, BodyType::fixed, {}, 0.3, 0.5);
            Motion motion(scene);
            EXPECT_LT(greatest_spin(motion, 0.5), 0.05);
            expect_no_rise(motion);
        }
}

// It lands on one narrow side of its mesh and does not roll off.
void cylinder_lands_on_its_side(const Run& run, int sides) {
    constexpr double kRadius = 0.3;
    SceneDescription scene = make_scene_with(run.settings());
    const auto cylinder = add_solid(scene, make_cylinder(kRadius, 0.8, sides, 1), 300);
    add_body(scene, cylinder, BodyType::dynamic, {0, 0, kRadius + 0.4}, 0.3, 0.5).rotation =
        rotation_from_vector({0.5 * std::numbers::pi, 0, 0}) * rotation_from_vector({0, 0, std::numbers::pi / sides});
    add_ground(scene, 6, 0.3, 0.5);
    Motion motion(scene);
    EXPECT_LT(greatest_spin(motion, 0.5), 0.03);
    expect_no_rise(motion);
}

// A fine mesh is a ball, not a foot as wide as what of it is within its rest distance: thrown at a floor to which it
// sticks it leaves with 5/7 of its tangential speed, that of its rolling, and e of its normal one.
void ball_bounces_as_a_sphere(const Run& run, int subdivisions) {
    constexpr double kRadius = 0.3, kRestitution = 0.8;
    for (const double height : {0.15, 0.18, 0.2, 0.23}) {
        SceneDescription scene = make_scene_with(run.settings());
        scene.gravity = {};
        const auto ball = add_solid(scene, make_sphere(kRadius, subdivisions), 300);
        add_body(scene, ball, BodyType::dynamic, {0, 0, kRadius + height}, 2, kRestitution).velocity = {1, 0, -2};
        add_ground(scene, 9, 2, kRestitution);
        Motion motion(scene);
        motion.run(0.4);
        const BodyState s = motion.body(0);
        motion.print("leaves with %.4f, %.4f m/s, %.4f rad/s", s.velocity.x, s.velocity.z, s.angular_velocity.y);
        EXPECT_NEAR(s.velocity.x, 5.0 / 7, 0.005);
        EXPECT_NEAR(s.velocity.z, 2 * kRestitution, 0.01);
        EXPECT_NEAR(s.angular_velocity.y, 5.0 / 7 / kRadius, 0.02);
        expect_no_rise(motion);
    }
}

// A blow within the step acts from when it comes: what falls without rebound lies on the floor at the end of that step,
// wherever the step caught it, and does not hang in the air and fall again.
void lies_where_it_lands(const Run& run) {
    double worst = 0;
    for (int k = 0; k < 8; ++k) {
        SceneDescription scene = flat_crate(run.settings(), 0);
        scene.bodies[0].position.z += 0.02 * k;
        Motion motion(scene);
        bool fell = false, landed = false;
        motion.run(1, [&](const StepReport&) {
            const BodyState s = motion.body(0);
            fell = fell || s.velocity.z < -3;
            landed = landed || (fell && s.velocity.z > -1);
            if (landed) worst = std::max(worst, s.center_of_mass.z - 0.5);
        });
        EXPECT_TRUE(landed);
        expect_no_rise(motion);
    }
    std::printf("at most %.3g m above the floor\n", worst);
    EXPECT_LT(worst, 2 * std::sqrt(3) / 330);
}

/// rad/s, about the axes in `about`, at most until some steps after the landing.
double spin_of_landing(const SceneDescription& scene, double drop, const Run& run, const Vec3& about) {
    Motion motion(scene);
    double spin = 0;
    motion.run(std::sqrt(2 * drop / kGravity) + 3 * run.dt(), [&](const StepReport&) {
        const Vec3 w = abs(motion.body(0).angular_velocity);
        spin = std::max({spin, about.x * w.x, about.y * w.y, about.z * w.z});
    });
    expect_no_rise(motion);
    return spin;
}

// Where edges cross there is a point of the hit, though no corner of either body is near: a bar turns about the rail,
// and not about itself.
void bar_lands_across_a_rail(const Run& run, double e) {
    double spin = 0;
    for (const double aside : {0.0, 0.4})
        for (const double friction : {0.0, 0.3})
            for (int k = 0; k < 5; ++k) {
                const double drop = 0.2 + 0.02 * k;
                const SceneDescription scene = bar_over_rail(run.settings(), drop, aside, friction, e);
                spin = std::max(spin, spin_of_landing(scene, drop, run, {1, 0, 1}));
            }
    std::printf("spin of up to %.3g rad/s about itself\n", spin);
    EXPECT_LT(spin, 0.1);
}

// The corners of what does not move are points of the hit as well.
void plate_lands_on_a_block(const Run& run, double e) {
    double spin = 0;
    for (int k = 0; k < 5; ++k) {
        const double drop = 0.2 + 0.02 * k;
        spin = std::max(spin, spin_of_landing(plate_over_block(run.settings(), drop, e), drop, run, {1, 1, 1}));
    }
    std::printf("spin of up to %.3g rad/s\n", spin);
    EXPECT_LT(spin, 0.1);
}

// Boxes that land flat on one another, edge on edge, in the air and on the ground, keep flat.
// The middle of a disc that falls flat is among what hits, at the same time as its corners; they carry it and brake its
// spin, in the impact as afterwards: by 2 mu g / R for a rim, less the sides.
void spinning_disc_lands(const Run& run, int sides) {
    constexpr double kRadius = 0.5, kDrop = 0.05, kFriction = 0.3, kSpin = 10, kTime = 1.0 / 3;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_cylinder(kRadius, 0.05, sides);
    const auto disc = add_solid(scene, mesh, 1000);
    add_body(scene, disc, BodyType::dynamic, {0, 0, 0.025 + kDrop + rest_gap(mesh)}, kFriction, 0).angular_velocity = {
        0, 0, kSpin};
    add_ground(scene, 10, kFriction, 0);
    Motion motion(scene);
    motion.run(kTime);
    const double side = kPi / sides,
                 of_polygon = (2 + std::cos(2 * side)) / 3; // of R^2 / 2, the radius of gyration's square
    const double lost = kSpin - motion.body(0).angular_velocity.z,
                 due = kFriction * kGravity * motion.world().time() * 2 / (kRadius * of_polygon);
    motion.print("loses %.4g of its spin, due %.4g rad/s", lost, due);
    EXPECT_NEAR(lost / due, 1, 0.02);
    expect_no_rise(motion);
}

void boxes_land_flat(const Run& run, double e) {
    double spin = 0, aside = 0;
    for (const double gap : {0.01, 0.02, 0.03, 0.05, 0.06, 0.08, 0.1, 0.13, 0.16, 0.2}) {
        Motion motion(flat_boxes(run.settings(), 2, gap, e));
        motion.run(0.6, [&](const StepReport&) {
            for (std::size_t i = 0; i < 2; ++i) {
                const BodyState s = motion.body(i);
                spin = std::max(spin, length(s.angular_velocity));
                aside = std::max(aside, std::hypot(s.center_of_mass.x, s.center_of_mass.y));
            }
        });
        expect_no_rise(motion);
    }
    std::printf("spin of up to %.3g rad/s, moved aside by up to %.3g m\n", spin, aside);
    EXPECT_LT(spin, 0.2);
    EXPECT_LT(aside, 2e-3);
}

// The same of many: the more hits there are, the more of them are between edges that lie slightly aside.
void stacks_land_flat(const Run& run, double e) {
    double mean = 0, aside = 0;
    int stacks = 0;
    for (const std::size_t count : {3u, 5u, 8u})
        for (const double gap : {0.02, 0.05, 0.08, 0.13}) {
            Motion motion(flat_boxes(run.settings(), static_cast<int>(count), gap, e));
            double spin = 0;
            motion.run(1.5, [&](const StepReport&) {
                for (std::size_t i = 0; i < count; ++i) {
                    const BodyState s = motion.body(i);
                    spin = std::max(spin, length(s.angular_velocity));
                    aside = std::max(aside, std::hypot(s.center_of_mass.x, s.center_of_mass.y));
                }
            });
            expect_no_rise(motion);
            mean += spin;
            ++stacks;
        }
    mean /= stacks;
    std::printf("greatest spin %.3g rad/s in the mean, moved aside by up to %.3g m\n", mean, aside);
    EXPECT_LT(mean, 0.3);
    EXPECT_LT(aside, 0.01);
}

// What lands obliquely on a plate of many triangles, with edges of it across edges of the plate, moves on as from one
// of two.
void lands_as_on_two_triangles(const Run& run, double e) {
    double mean = 0, most = 0;
    for (int i = 0; i < kThrownBoxes; ++i) {
        Motion plain(thrown_box(run.settings(), i, 1, e)), divided(thrown_box(run.settings(), i, 100, e));
        for (Motion* motion : {&plain, &divided}) motion->run(0.4);
        const double off = length(divided.body(0).velocity - plain.body(0).velocity);
        mean += off / kThrownBoxes;
        most = std::max(most, off);
        expect_no_rise(divided);
    }
    std::printf("velocities %.3g m/s apart in the mean, %.3g at most\n", mean, most);
    EXPECT_LT(most, 1e-4);
}

// Corners that land one after the other are stopped one after the other, however many a step has.
void cubes_rise_as_in_the_exact_sequence(const Run& run) {
    constexpr double kTime = 1; // s
    double error = 0, due_mean = 0, mean = 0;
    for (int i = 0; i < kFallingCubes; ++i) {
        Motion motion(falling_cube(run.settings(), i));
        motion.run(kTime);
        const double rise = motion.body(0).velocity.z / kCubeFall, due = due_rise_of_cube(i, kTime) / kCubeFall;
        error += std::abs(rise - due) / kFallingCubes;
        mean += rise / kFallingCubes;
        due_mean += due / kFallingCubes;
        expect_no_rise(motion);
    }
    std::printf("rise with %.4f of their fall, due %.4f, mean error %.4f\n", mean, due_mean, error);
    EXPECT_NEAR(due_mean, 0.0771, 1e-3);
    EXPECT_LT(error, 0.016);
}

void cradle_hands_on(const Run& run, double e) {
    Motion motion(cradle(run.settings(), e));
    Vec3 momentum;
    motion.run(2.5, [&](const StepReport& r) { momentum = r.momentum; });
    const double due = due_cradle_speed(e), last = motion.body(kCradleBodies - 1).velocity.x;
    double spin = 0;
    for (std::size_t i = 0; i < kCradleBodies; ++i) spin = std::max(spin, length(motion.body(i).angular_velocity));
    const double start = motion.mass(0) * kCradleSpeed;
    motion.print("last at %.5g m/s, due %.5g; spin %.3g rad/s", last, due, spin);
    EXPECT_NEAR(last, due, 1e-3 * kCradleSpeed);
    EXPECT_LT(spin, 1e-3);
    EXPECT_LT(length(momentum - Vec3{start, 0, 0}), 1e-12 * start);
    expect_no_rise(motion);
}

/// The usual ones, and those whose hits are solved together.
std::vector<Run> runs_of_impacts() {
    std::vector<Run> list = runs();
    for (const int rate : {24, 120}) list.push_back({"preview", rate});
    return list;
}

// A plate that lands flat rebounds flat, from whatever height: also where it meets the ground by what gravity adds in
// the step alone.
void plate_lands_flat(const Run& run) {
    constexpr double kLeast = 0.2, kMost = 0.6, kRestitution = 0.5; // m
    constexpr int kHeights = 41;
    const TriangleMesh mesh = make_box(0.2, 0.2, 0.02);
    double worst = 0, fastest = 0, highest = 0; // shares of the due height; rad/s
    for (int k = 0; k < kHeights; ++k) {
        const double height = kLeast + (kMost - kLeast) * k / (kHeights - 1), ground = 0.01 + rest_gap(mesh);
        SceneDescription scene = make_scene_with(run.settings());
        add_body(scene, add_solid(scene, mesh, 1000), BodyType::dynamic, {0, 0, ground + height}, 0.3, kRestitution);
        add_ground(scene, 3, 0.3, kRestitution);
        Motion motion(scene);
        double rebound = 0;
        bool rises = false;
        motion.run((1 + kRestitution) * std::sqrt(2 * height / kGravity) + 2 * run.dt(), [&](const StepReport&) {
            const BodyState plate = motion.body(0);
            fastest = std::max(fastest, length(plate.angular_velocity));
            rises = rises || plate.velocity.z > 0;
            const double above = plate.center_of_mass.z - ground, speed = plate.velocity.z;
            if (rises) rebound = std::max(rebound, above + 0.5 * speed * std::abs(speed) / kGravity);
        });
        const double share = rebound / (kRestitution * kRestitution * height);
        worst = std::min(k == 0 ? share : worst, share);
        highest = std::max(highest, share);
    }
    std::printf("Impact.PlateLandsFlat/%s: rebounds to %.4f to %.4f of the due height, turns at up to %.3g rad/s\n",
                run.name().c_str(), worst, highest, fastest);
    EXPECT_GT(worst, 0.95);
    EXPECT_LT(highest, 1.05);
    EXPECT_LT(fastest, 0.01); // 7 rad/s where it tilts by what a corner alone is pushed
}

// What falls flat on a light box that lies on the ground stops there. Its faces are level and without friction: nothing
// moves the light one aside.
void heavy_falls_on_light(const Run& run, double ratio) {
    constexpr double kWide = 1, kHigh = 0.5, kLight = 1; // m, kg
    const TriangleMesh box = make_box(kWide, kWide, kHigh);
    constexpr int kHeights = 13;
    double aside = 0;
    int pushed = 0; // heights from which a body goes aside
    for (int k = 0; k < kHeights; ++k) {
        const double fall = 0.2 + 0.05 * k;
        SceneDescription scene = make_scene_with(run.settings());
        const double lies = kHigh / 2 + rest_gap(box);
        add_body(scene, add_shape(scene, box, kLight), BodyType::dynamic, {0, 0, lies}, 0, 0);
        add_body(scene, add_shape(scene, box, ratio * kLight), BodyType::dynamic, {0, 0, lies + kHigh + fall}, 0, 0);
        add_ground(scene, 20, 0, 0);
        Motion motion(scene);
        motion.run(1);
        const Vec3 light = motion.body(0).center_of_mass;
        const double way = std::hypot(light.x, light.y);
        aside = std::max(aside, way);
        pushed += way > 0.01 * kWide ? 1 : 0;
        expect_no_rise(motion);
    }
    std::printf("Impact.HeavyFallsOnLight%.0f/%s: %.3g m aside, pushed from %d of %d heights\n", ratio,
                run.name().c_str(), aside, pushed, kHeights);
    // At 1/24 s stage 5, which goes on with hits at their own directions, meets some before stage 1 does.
    EXPECT_LE(pushed, run.dt() > 1.0 / 30 ? 2 : 1);
}

// A stick that lands on a whole edge does not roll about its length: both ends of the edge meet the floor alike, in the
// step that brings it there as well, which gravity's last half alone may do.
void stick_lands_on_an_edge(const Run& run, double restitution) {
    constexpr double kLength = 1, kThick = 0.02;
    double most = 0; // rad/s
    for (const double tilt : {0.05, 0.15, 0.3, 0.5})
        for (int k = 0; k < 12; ++k) {
            SceneDescription scene = make_scene_with(run.settings());
            const double height = 0.3 + 0.5 * k / 11;
            const double low = 0.5 * (kLength * std::sin(tilt) + kThick * std::cos(tilt));
            const auto stick = add_shape(scene, make_box(kLength, kThick, kThick), 1);
            add_body(scene, stick, BodyType::dynamic, {0, 0, height + low}, 0.3, restitution).rotation =
                rotation_from_vector({0, 0, 0.5}) * rotation_from_vector({0, tilt, 0});
            add_ground(scene, 29, 0.3, restitution);
            Motion motion(scene);
            motion.run(std::sqrt(2 * height / kGravity) + 0.5, [&](const StepReport&) {
                const BodyState s = motion.body(0);
                most = std::max(most, std::abs(dot(rotate(s.rotation, {1, 0, 0}), s.angular_velocity)));
            });
            expect_no_rise(motion);
        }
    std::printf("Impact.StickLandsOnAnEdge/%s: spins about its length by %.3g rad/s at most\n", run.name().c_str(),
                most);
    EXPECT_LT(most, 1);
}

[[maybe_unused]] const bool registered = [] {
    for (const int e : {10, 50})
        add_runs("Impact", "StickLandsOnAnEdgeWithRestitution" + std::to_string(e) + "Percent",
                 {{"balanced", 24}, {"balanced", 60}, {"accurate", 24}}, true,
                 [=](const Run& r) { stick_lands_on_an_edge(r, 0.01 * e); });
    for (const double ratio : {100.0, 1e3})
        add_runs("Impact", "HeavyFallsOnLight" + std::to_string(static_cast<int>(ratio)), runs_of_impacts(), true,
                 [=](const Run& r) { heavy_falls_on_light(r, ratio); });
    add_runs("Impact", "FreeFallIsExact", runs(), true, ballistic);
    for (const int e : {50, 80})
        add_runs("Impact", "BouncesWithRestitution0_" + std::to_string(e), runs_of_impacts(), true,
                 [=](const Run& r) { bounces_as_due(r, 0.01 * e); });
    for (const int e : {0, 50, 90})
        add_runs("Impact", "CrateLandsFlatWithRestitution" + std::to_string(e) + "Percent", runs_of_impacts(), true,
                 [=](const Run& r) { lands_flat(r, 0.01 * e); });
    for (const int sides : {12, 24})
        add_runs("Impact", "SpinningDiscOf" + std::to_string(sides) + "Lands",
                 {{"preview", 24}, {"balanced", 24}, {"balanced", 120}, {"accurate", 24}}, true,
                 [=](const Run& r) { spinning_disc_lands(r, sides); });
    for (const int e : {50, 80}) {
        const std::string percent = std::to_string(e) + "Percent";
        add_runs("Impact", "BarLandsAcrossARailWithRestitution" + percent, runs_of_impacts(), true,
                 [=](const Run& r) { bar_lands_across_a_rail(r, 0.01 * e); });
        add_runs("Impact", "PlateLandsOnABlockWithRestitution" + percent, runs_of_impacts(), true,
                 [=](const Run& r) { plate_lands_on_a_block(r, 0.01 * e); });
    }
    for (const int e : {0, 30, 80}) {
        const std::string percent = std::to_string(e) + "Percent";
        add_runs("Impact", "CrateLandsLevelOnTilesWithRestitution" + percent, runs_of_impacts(), true,
                 [=](const Run& r) { lands_level(r, crate_over_tiles(r.settings(), 0.01 * e), 0, 0.01 * e); });
        add_runs("Impact", "BeamLandsLevelOnPostsWithRestitution" + percent, runs_of_impacts(), true,
                 [=](const Run& r) { lands_level(r, beam_over_posts(r.settings(), 0.01 * e), 5, 0.01 * e); });
    }
    for (const int e : {50, 90})
        add_runs("Impact", "StaysLevelBetweenTilesAndCeilingWithRestitution" + std::to_string(e) + "Percent", runs(),
                 true, [=](const Run& r) { stays_level_between_tiles_and_ceiling(r, 0.01 * e); });
    add_runs("Impact", "BoxFallsBesideAWall", {{"balanced", 24}, {"balanced", 120}, {"accurate", 24}}, true,
             falls_beside_a_wall);
    add_runs("Impact", "PlateLandsOnPostsOfAnyMesh", runs_of_impacts(), true, lands_on_posts_of_any_mesh);
    for (const int sides : {48, 64, 128})
        add_runs("Impact", "CylinderOf" + std::to_string(sides) + "SidesLandsOnItsSide", runs(), true,
                 [=](const Run& r) { cylinder_lands_on_its_side(r, sides); });
    for (const int subdivisions : {3, 4, 5})
        add_runs("Impact", "BallOf" + std::to_string(subdivisions) + "SubdivisionsBouncesAsASphere", runs_of_impacts(),
                 subdivisions == 4, [=](const Run& r) { ball_bounces_as_a_sphere(r, subdivisions); });
    add_runs("Impact", "PlasticCrateLiesWhereItLands", runs_of_impacts(), true, lies_where_it_lands);
    for (const int e : {50, 80, 100})
        add_runs("Impact", "BoxesLandFlatOnEachOtherWithRestitution" + std::to_string(e) + "Percent", runs(), true,
                 [=](const Run& r) { boxes_land_flat(r, 0.01 * e); });
    for (const int e : {50, 80})
        add_runs("Impact", "StacksLandFlatWithRestitution" + std::to_string(e) + "Percent", runs(), true,
                 [=](const Run& r) { stacks_land_flat(r, 0.01 * e); });
    for (const int e : {0, 50})
        add_runs("Impact", "LandsOnManyTrianglesAsOnTwoWithRestitution" + std::to_string(e) + "Percent", runs(), true,
                 [=](const Run& r) { lands_as_on_two_triangles(r, 0.01 * e); });
    add_runs("Impact", "PlasticCubesRiseAsInTheExactSequence", runs(), true, cubes_rise_as_in_the_exact_sequence);
    for (const int e : {100, 50})
        add_runs("Impact", "CradleWithRestitution" + std::to_string(e) + "Percent", runs_of_impacts(), true,
                 [=](const Run& r) { cradle_hands_on(r, 0.01 * e); });
    add_runs(
        "Impact", "PlateLandsFlat",
        {{"balanced", 24}, {"balanced", 30}, {"balanced", 60}, {"balanced", 240}, {"preview", 24}, {"accurate", 24}},
        true, plate_lands_flat);
    return true;
}();

} // namespace
} // namespace flotilla::physics
