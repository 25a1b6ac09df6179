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
    return true;
}();

} // namespace
} // namespace flotilla::physics
