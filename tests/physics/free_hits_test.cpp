// SPDX-License-Identifier: MIT
// Hits of bodies on which nothing else acts: their momenta are kept, and their ways turn where they meet.
#include <algorithm>
#include <cmath>

#include "physics/physics.hpp"

namespace flotilla::physics {
namespace {

constexpr double kSpeed = 6; // m/s, of either body

/// Two boxes that fly at each other, turning slowly.
SceneDescription meeting_boxes(const Run& run, const Vec3& size, int i, double friction, double e) {
    SceneDescription scene = make_scene_with(run.settings(), {});
    const auto box = add_solid(scene, make_box(size.x, size.y, size.z), 1000);
    Numbers numbers(static_cast<std::uint64_t>(i) + 1);
    for (const double side : {-1.0, 1.0}) {
        const Vec3 place = Vec3{0.6 * side, 0.05 * side, 0.02} + 0.03 * numbers.vector();
        BodyDescription& body = add_body(scene, box, BodyType::dynamic, place, friction, e);
        body.rotation = numbers.rotation();
        body.velocity = {-side * kSpeed, 0, 0};
        body.angular_velocity = numbers.vector();
    }
    return scene;
}

// Both momenta, and the energy where nothing takes any. Impulses act where bodies meet within the step; what is left is
// that their masses there are those of the start of the step, and contacts between bodies that turn on each other: of
// corners that follow within a step one in a hundred is stopped by them, without its rebound.
void boxes_keep_momenta(const Run& run, const Vec3& size, double friction, double e) {
    constexpr int kPairs = 20;
    double mean = 0, energy = 0;
    for (int i = 0; i < kPairs; ++i) {
        Motion motion(meeting_boxes(run, size, i, friction, e));
        const Vec3 start = motion.step().angular_momentum;
        Vec3 momentum, end;
        motion.run(0.5, [&](const StepReport& r) { momentum = r.momentum, end = r.angular_momentum; });
        mean += length(end - start) / length(start) / kPairs;
        energy += std::abs(motion.outcome().end / motion.outcome().start - 1) / kPairs;
        EXPECT_LT(length(momentum), 1e-12 * motion.total_mass() * kSpeed);
        expect_no_rise(motion);
    }
    std::printf("angular momentum off by %.4f in the mean, energy by %.3g\n", mean, energy);
    EXPECT_LT(mean, 3 * run.dt());
    if (friction == 0 && e == 1) {
        EXPECT_LT(energy, 2e-3);
    }
}

// A ball that meets two others almost at once, from any place within the step: it turns where it meets the first, and
// does not miss the second for that. Met alone, it goes on from that place.
void ball_meets_both(const Run& run) {
    constexpr double kRadius = 0.0286, kBetween = 2.5e-4, kAway = 0.2, kStarts = 8, kBall = 3;
    const double apart = 2 * kRadius + kBetween, x = 0.5 * std::sqrt(3.0) * apart, y = 0.5 * apart;
    const double meets = x - std::sqrt(4 * kRadius * kRadius - y * y);
    const auto start = [&](int i) { return -kAway - kBall * run.dt() * i / kStarts; };
    const auto scene = [&](int i, int others) {
        SceneDescription out = make_scene_with(run.settings(), {});
        const auto ball = add_solid(out, make_sphere(kRadius, 3), 1700);
        add_body(out, ball, BodyType::dynamic, {start(i), 0, 0}, 0, 1).velocity = {kBall, 0, 0};
        for (int k = 0; k < others; ++k) add_body(out, ball, BodyType::dynamic, {x, k == 0 ? y : -y, 0}, 0, 1);
        return out;
    };
    double slowest = kBall, off = 0;
    for (int i = 0; i < kStarts; ++i) {
        Motion both(scene(i, 2)), one(scene(i, 1));
        for (Motion* motion : {&both, &one}) motion->run(0.5);
        slowest = std::min({slowest, length(both.body(1).velocity), length(both.body(2).velocity)});
        const BodyState ball = one.body(0);
        const double since = one.world().time() - (meets - start(i)) / kBall;
        off = std::max(off, length(ball.center_of_mass - (Vec3{meets, 0, 0} + since * ball.velocity)));
    }
    std::printf("the slower ball goes at %.3f m/s, the path is off by up to %.3g m\n", slowest, off);
    EXPECT_GT(slowest, 0.9); // 1.04 of both at once, 1.1 and 2.39 of one after the other
    EXPECT_LT(off, 1e-3);
}

// A cube that is thrown at a wall without thickness, or knocked at it by another one, and one that stands behind the
// wall within reach of its way in a step: nothing comes through the wall, in whatever order bodies are listed.
void wall_stops_blows(const Run& run, bool knocked) {
    constexpr double kEdge = 0.1, kThrown = 5, kBehind = 1e-3, e = 0.5;
    constexpr int kStarts = 5;
    enum Role { thrown, behind, wall, thrower };
    std::vector<Role> order{thrown, behind, wall};
    if (knocked) order.push_back(thrower);
    double through = 0, slow = 0; // m/s: of the one behind, and of what the thrown one leaves short of its rebound
    do {
        for (int i = 0; i < kStarts; ++i) {
            SceneDescription scene = make_scene_with(run.settings(), {});
            const auto cube = add_solid(scene, make_box(kEdge, kEdge, kEdge), 1000);
            const TriangleMesh upright{{{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}}, {{0, 1, 2}, {0, 2, 3}}};
            const auto plate = add_shape(scene, upright);
            const double way = kThrown * run.dt() * i / kStarts, near = knocked ? 0.01 : 0.1 + way;
            std::size_t of_behind = 0, of_thrown = 0;
            for (const Role role : order) {
                const double x = role == behind    ? 0.5 * kEdge + kBehind
                                 : role == thrown  ? -0.5 * kEdge - near
                                 : role == thrower ? -1.5 * kEdge - near - 0.1 - way
                                                   : 0;
                if (role == wall) {
                    add_body(scene, plate, BodyType::fixed, {}, 0, e);
                    continue;
                }
                (role == behind ? of_behind : of_thrown) = scene.bodies.size();
                add_body(scene, cube, BodyType::dynamic, {x, 0, 0}, 0, e).velocity = {
                    role == (knocked ? thrower : thrown) ? kThrown : 0.0, 0, 0};
            }
            Motion motion(scene);
            motion.run(0.2);
            through = std::max(through, length(motion.body(of_behind).velocity));
            if (!knocked) slow = std::max(slow, std::abs(motion.body(of_thrown).velocity.x + e * kThrown));
        }
    } while (std::ranges::next_permutation(order).found);
    std::printf("behind the wall up to %.3g m/s, rebound off by up to %.3g m/s\n", through, slow);
    EXPECT_LT(through, 1e-6);
    EXPECT_LT(slow, 1e-3 * kThrown);
}

const bool kRegistered = [] {
    const std::vector<Run> list{
        {"balanced", 60}, {"balanced", 24}, {"balanced", 240}, {"preview", 60}, {"accurate", 60}};
    for (const auto& [name, size] :
         {std::pair{"Cubes", Vec3{0.2, 0.2, 0.2}}, std::pair{"Boxes", Vec3{0.1, 0.2, 0.3}}}) {
        add_runs("FreeHits", std::string(name) + "KeepMomenta", list, true,
                 [size = size](const Run& r) { boxes_keep_momenta(r, size, 0.3, 0.5); });
        add_runs("FreeHits", std::string("Elastic") + name + "KeepMomentaAndEnergy", list, true,
                 [size = size](const Run& r) { boxes_keep_momenta(r, size, 0, 1); });
    }
    add_runs("FreeHits", "BallMeetsBoth", list, true, ball_meets_both);
    const std::vector<Run> sequential{
        {"balanced", 60}, {"balanced", 24}, {"balanced", 240}, {"accurate", 60}, {"reference", 60}};
    add_runs("FreeHits", "WallStopsThrownCube", sequential, true, [](const Run& r) { wall_stops_blows(r, false); });
    add_runs("FreeHits", "WallStopsKnockedCube", sequential, true, [](const Run& r) { wall_stops_blows(r, true); });
    return true;
}();

} // namespace
} // namespace flotilla::physics
