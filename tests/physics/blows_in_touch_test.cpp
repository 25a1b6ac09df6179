// SPDX-License-Identifier: MIT
// Blows on bodies that touch others: on two sides of one body, past what they slide along, in rows, falling together.
#include "physics/physics.hpp"

namespace flotilla::physics {
namespace {

/// A plate of two triangles from a corner along two edges.
void add_plate(TriangleMesh& mesh, const Vec3& corner, const Vec3& along, const Vec3& across) {
    const auto n = static_cast<std::int32_t>(mesh.vertices.size());
    for (const Vec3& v : {corner, corner + along, corner + along + across, corner + across}) mesh.vertices.push_back(v);
    mesh.triangles.push_back({n, n + 1, n + 2});
    mesh.triangles.push_back({n, n + 2, n + 3});
}

/// A ball with restitution 1 and without friction that meets both sides of a body within a step or so, from many places.
/// The least of its energy that is left, J of J.
template <class Start>
double least_kept(const Run& run, const TriangleMesh& sides, double time, double base, int starts, Start&& place) {
    constexpr double kRadius = 0.1;
    double least = 1;
    for (int k = 0; k < starts; ++k) {
        SceneDescription scene = make_scene_with(run.settings());
        auto& ball = add_body(scene, add_shape(scene, make_sphere(kRadius, 2), 1), BodyType::dynamic, {}, 0, 1);
        place(k, ball);
        add_body(scene, add_shape(scene, sides), BodyType::fixed, {}, 0, 1);
        Motion motion(scene);
        motion.run(time);
        least = std::min(least, (motion.outcome().end_total - base) / (motion.outcome().start_total - base));
        expect_no_rise(motion);
    }
    return least;
}

// Each side of a body gives the rebound of its own.
void bounces_in_a_corner(const Run& run) {
    TriangleMesh room;
    add_plate(room, {-9, -9, 0}, {18, 0, 0}, {0, 18, 0});
    add_plate(room, {1, -9, 0}, {0, 18, 0}, {0, 0, 9});
    const double kept = least_kept(run, room, 0.45, 0, 40, [](int k, BodyDescription& ball) {
        ball.position = {0.5, 0, 0.7 + 1e-3 * k};
        ball.velocity = {2, 0, -2};
    });
    std::printf("Impact.BallBouncesInACorner/%s: keeps %.4f of its energy\n", run.name().c_str(), kept);
    EXPECT_GT(kept, 0.99);
}

// It slides down one side of a valley, touching that all the time, and meets the other one at a right angle.
void slides_to_the_other_side(const Run& run) {
    constexpr double kAway = 0.1006; // m, a rest distance and a hair
    const double c = std::sqrt(0.5);
    TriangleMesh valley;
    add_plate(valley, {0, -5, 0}, {9, 0, 9}, {0, 10, 0});
    add_plate(valley, {0, -5, 0}, {-9, 0, 9}, {0, 10, 0});
    const double bottom = kGravity * c * 2 * kAway; // J
    const double kept = least_kept(run, valley, 0.7, bottom, 60, [&](int k, BodyDescription& ball) {
        const double along = 0.6 + 4e-3 * k;
        ball.position = {c * (along - kAway), 0, c * (along + kAway)};
    });
    std::printf("Impact.BallSlidesToTheOtherSide/%s: keeps %.4f of its energy\n", run.name().c_str(), kept);
    EXPECT_GT(kept, 0.97);
}

/// A cube that comes down or along to a plate, past one that it touches all the way: m, the most that it is short of it in
/// the step in which it stops, from 16 places. `down`: of gravity; the way is along x, the plate beside it below z = 0.
double stops_short(const Run& run, double speed, const Vec3& down) {
    constexpr double kSide = 0.3, kThick = 0.5, kFar = 20, kMass = 1, kHalf = 0.5 * kSide;
    const TriangleMesh cube = make_box(kSide, kSide, kSide);
    double most = 0;
    for (int k = 0; k < 16; ++k) {
        SceneDescription scene = make_scene_with(run.settings());
        scene.gravity = kGravity * down;
        const Vec3 start{-kHalf - 0.4 - 0.013 * k, 0, kHalf + rest_gap(cube)};
        add_body(scene, add_shape(scene, cube, kMass), BodyType::dynamic, start, 0, 0).velocity = {speed, 0, 0};
        add_body(scene, add_shape(scene, make_box(kFar, 4, kThick)), BodyType::fixed, {0, 0, -0.5 * kThick}, 0, 0);
        add_body(scene, add_shape(scene, make_box(kThick, 2, 2)), BodyType::fixed, {0.5 * kThick, 0, 1.01}, 0, 0);
        Motion motion(scene);
        double fastest = 0, last = 0;
        motion.run(0.6, [&](const StepReport&) {
            const BodyState s = motion.body(0);
            fastest = std::max(fastest, s.velocity.x);
            if (last > 0.5 * fastest && s.velocity.x < 0.1 * fastest)
                most = std::max(most, -kHalf - s.center_of_mass.x);
            last = s.velocity.x;
        });
        EXPECT_LT(last, 0.1 * fastest);
        expect_no_rise(motion);
    }
    return most;
}

// What slides over a floor into a block stops at the block, not where it was a step before.
void slides_into_a_block(const Run& run) {
    for (const double speed : {3.0, 8.0}) {
        const double most = stops_short(run, speed, {0, 0, -1});
        std::printf("Impact.SlidesIntoABlock/%s: %g m/s, %.3g m short of it\n", run.name().c_str(), speed, most);
        EXPECT_LT(most, 4e-3);
    }
}

void falls_along_a_wall(const Run& run) {
    const double most = stops_short(run, 0, {1, 0, 0});
    std::printf("Impact.FallsAlongAWall/%s: %.3g m above the floor\n", run.name().c_str(), most);
    EXPECT_LT(most, 4e-3);
}

// A cube slides into others that stand side by side without friction: whatever they do, the mean of their places moves
// as their momentum says, although the floor takes part in none of it.
void slides_into_a_row(const Run& run, int boxes, double restitution) {
    constexpr double kSide = 0.3, kApart = 1e-3, kSpeed = 3;
    const TriangleMesh cube = make_box(kSide, kSide, kSide);
    double most = 0; // m
    for (int k = 0; k < 6; ++k) {
        SceneDescription scene = make_scene_with(run.settings());
        const auto shape = add_shape(scene, cube, 1);
        const double z = 0.5 * kSide + rest_gap(cube), behind = kSide + 0.6 + 0.013 * k;
        add_body(scene, shape, BodyType::dynamic, {-behind, 0, z}, 0, restitution).velocity = {kSpeed, 0, 0};
        for (int i = 0; i < boxes; ++i)
            add_body(scene, shape, BodyType::dynamic, {i * (kSide + kApart), 0, z}, 0, restitution);
        add_ground(scene, 18, 0, 0);
        Motion motion(scene);
        const auto mean = [&] {
            double sum = 0;
            for (int i = 0; i <= boxes; ++i) sum += motion.body(static_cast<std::size_t>(i)).center_of_mass.x;
            return sum / (boxes + 1);
        };
        const double start = mean();
        motion.run(0.8, [&](const StepReport& r) {
            most = std::max(most, std::abs(mean() - start - kSpeed * r.time / (boxes + 1)));
        });
        expect_no_rise(motion);
    }
    std::printf("Impact.SlidesIntoARowOf%d/%s: the mean strays by %.2g m\n", boxes, run.name().c_str(), most);
    EXPECT_LT(most, 1e-4);
}

// Boxes that fall one on the other, a millimetre apart: the lowest one is stopped by the floor at the floor.
void fall_one_on_the_other(const Run& run, int boxes) {
    constexpr double kSide = 0.3, kApart = 1e-3, kMass = 1, kHalf = 0.5 * kSide;
    double most = 0; // m, above the floor
    for (int k = 0; k < 16; ++k) {
        SceneDescription scene = make_scene_with(run.settings());
        const auto box = add_shape(scene, make_box(kSide, kSide, kSide), kMass);
        for (int i = 0; i < boxes; ++i)
            add_body(scene, box, BodyType::dynamic, {0, 0, kHalf + 0.6 + 0.013 * k + i * (kSide + kApart)}, 0.3, 0);
        add_ground(scene, 9, 0.3, 0);
        Motion motion(scene);
        double last = 0;
        motion.run(0.8, [&](const StepReport&) {
            const BodyState s = motion.body(0);
            if (last < -2 && s.velocity.z > -0.5) most = std::max(most, s.center_of_mass.z - kHalf);
            last = s.velocity.z;
        });
        EXPECT_GT(last, -0.5);
        expect_no_rise(motion);
    }
    std::printf("Impact.BoxesFallOneOnTheOther/%s: %.3g m above the floor\n", run.name().c_str(), most);
    EXPECT_LT(most, 4e-3);
}

[[maybe_unused]] const bool registered = [] {
    const std::vector<Run> kinds = {
        {"balanced", 24}, {"balanced", 60}, {"balanced", 240}, {"preview", 24}, {"accurate", 24}};
    add_runs("Impact", "BallBouncesInACorner", kinds, true, bounces_in_a_corner);
    add_runs("Impact", "BallSlidesToTheOtherSide", kinds, true, slides_to_the_other_side);
    add_runs("Impact", "SlidesIntoABlock", kinds, true, slides_into_a_block);
    add_runs("Impact", "FallsAlongAWall", kinds, true, falls_along_a_wall);
    for (const int boxes : {2, 4})
        for (const int e : {0, 100})
            add_runs("Impact",
                     "SlidesIntoARowOf" + std::to_string(boxes) + "WithRestitution" + std::to_string(e) + "Percent",
                     {{"preview", 60}, {"balanced", 24}, {"balanced", 60}, {"accurate", 24}}, true,
                     [=](const Run& r) { slides_into_a_row(r, boxes, 0.01 * e); });
    for (const int boxes : {2, 5})
        add_runs("Impact", std::to_string(boxes) + "BoxesFallOneOnTheOther", kinds, true,
                 [=](const Run& r) { fall_one_on_the_other(r, boxes); });
    return true;
}();

} // namespace
} // namespace flotilla::physics
