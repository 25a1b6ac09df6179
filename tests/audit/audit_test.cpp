// SPDX-License-Identifier: MIT
// Planted faults must be found, clean scenes must pass.
#include "audit/audit.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "audit/sweep.hpp"
#include "audit/triangle_distance.hpp"
#include "base/rotation.hpp"
#include "geometry/exact/triangle_triangle.hpp"
#include "mesh/placement.hpp"

namespace flotilla::audit {
namespace {

constexpr double kPi = std::numbers::pi;

/// A square plate of two triangles, side 1, in the xy plane, about the origin.
Shape plate() {
    return make_shape({{{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}}, {{0, 1, 2}, {0, 2, 3}}}, {});
}

/// A closed box of 12 triangles with the given half sizes.
Shape box(double x, double y, double z) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back({(i & 1) != 0 ? x : -x, (i & 2) != 0 ? y : -y, (i & 4) != 0 ? z : -z});
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return make_shape(std::move(mesh), {});
}

Scene scene_of(std::vector<Shape> shapes) {
    Scene scene;
    for (std::size_t i = 0; i < shapes.size(); ++i) scene.bodies.push_back({static_cast<std::int32_t>(i), false});
    scene.shapes = std::move(shapes);
    return scene;
}

Pose pose(const Vec3& position, const Vec3& turn = {}) { return {position, rotation_from_vector(turn)}; }

StateReport state(const Scene& scene, const std::vector<Pose>& poses, int threads = 1) {
    return check_state(scene, place(scene, poses, threads), threads);
}

MotionReport motion(const Scene& scene, const std::vector<Pose>& from, const std::vector<Pose>& to,
                    Motion kind = Motion::linear, const std::vector<Vec3>& turns = {}, int threads = 1) {
    return check_motion(scene, place(scene, from, threads), place(scene, to, threads), kind, turns, threads);
}

TEST(AuditState, FindsCrossingPlatesAndNamesBodiesTrianglesAndPlace) {
    const Scene scene = scene_of({plate(), plate()});
    const auto report = state(scene, {pose({}), pose({0.2, 0.1, 0.1}, {kPi / 2, 0, 0})});
    ASSERT_EQ(report.intersections.size(), 1u);
    EXPECT_EQ(report.pairs, 1);
    EXPECT_EQ(report.intersections[0].body_a, 0);
    EXPECT_EQ(report.intersections[0].body_b, 1);
    EXPECT_GE(report.intersections[0].triangle_pairs, 2);
    EXPECT_NEAR(report.intersections[0].place.y, 0.1, 1e-12);
    EXPECT_NEAR(report.intersections[0].place.z, 0, 1e-12);
}

TEST(AuditState, TouchingCountsAndOneUlpApartDoesNot) {
    const Scene scene = scene_of({plate(), plate()});
    EXPECT_EQ(state(scene, {pose({}), pose({0.25, 0, 0})}).intersections.size(), 1u);
    EXPECT_EQ(state(scene, {pose({}), pose({0.25, 0, 5e-324})}).intersections.size(), 0u);
    EXPECT_EQ(state(scene, {pose({}), pose({1, 0, 0})}).intersections.size(), 1u);
    EXPECT_EQ(state(scene, {pose({}), pose({std::nextafter(1, 2), 0, 0})}).intersections.size(), 0u);
}

TEST(AuditState, ABodyInsideAClosedSurfaceDoesNotIntersectIt) {
    const Scene scene = scene_of({box(1, 1, 1), box(0.1, 0.1, 0.1)});
    EXPECT_TRUE(state(scene, {pose({}), pose({})}).intersections.empty());
    EXPECT_FALSE(state(scene, {pose({}), pose({0.95, 0, 0})}).intersections.empty());
}

TEST(AuditState, PairsOfInfiniteMassAreExempt) {
    Scene scene = scene_of({plate(), plate(), plate()});
    scene.bodies[0].infinite_mass = scene.bodies[1].infinite_mass = true;
    const auto report = state(scene, {pose({}), pose({}), pose({0, 0, 0.5})});
    EXPECT_TRUE(report.intersections.empty());
    EXPECT_EQ(state(scene, {pose({}), pose({}), pose({})}).intersections.size(), 2u);
}

TEST(AuditState, ReportsPosesThatAreNoPoses) {
    const Scene scene = scene_of({plate(), plate(), plate(), plate()});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<Pose> poses{pose({}), pose({nan, 0, 0}), pose({0, 0, 2}), pose({0, 0, 3})};
    poses[2].rotation.w = 1.001;
    poses[3].rotation.y = nan;
    const Placement placement = place(scene, poses, 1);
    ASSERT_EQ(placement.bad.size(), 3u);
    EXPECT_EQ(placement.bad[0].body, 1);
    EXPECT_EQ(placement.bad[0].reason, "the position is not finite");
    EXPECT_NE(placement.bad[1].reason.find("off unit length"), std::string::npos);
    EXPECT_EQ(placement.bad[2].reason, "the rotation is not finite");
    EXPECT_TRUE(check_state(scene, placement, 1).intersections.empty());
}

TEST(AuditState, AgreesWithAllPairsOnRandomBoxesAtAnyThreadCount) {
    std::mt19937_64 rng(4);
    std::uniform_real_distribution<double> u(-1.6, 1.6), size(0.05, 0.5);
    for (int round = 0; round < 20; ++round) {
        std::vector<Shape> shapes;
        std::vector<Pose> poses;
        for (int i = 0; i < 25; ++i) {
            shapes.push_back(box(size(rng), size(rng), size(rng)));
            poses.push_back(pose({u(rng), u(rng), u(rng)}, {u(rng), u(rng), u(rng)}));
        }
        const Scene scene = scene_of(std::move(shapes));
        const auto found = state(scene, poses, 3).intersections;
        std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
        for (const auto& hit : found) pairs.emplace_back(hit.body_a, hit.body_b);
        std::vector<std::pair<std::int32_t, std::int32_t>> expected;
        for (std::int32_t a = 0; a < 25; ++a) {
            for (std::int32_t b = a + 1; b < 25; ++b) {
                Scene two;
                two.shapes = {scene.shapes[static_cast<std::size_t>(a)], scene.shapes[static_cast<std::size_t>(b)]};
                for (auto& shape : two.shapes) { // no hierarchy: all triangle pairs
                    shape.tree.nodes = {{-1, 0, static_cast<std::int32_t>(shape.mesh.triangles.size())}};
                }
                two.bodies = {{0, false}, {1, false}};
                if (!state(two, {poses[static_cast<std::size_t>(a)], poses[static_cast<std::size_t>(b)]})
                         .intersections.empty())
                    expected.emplace_back(a, b);
            }
        }
        EXPECT_EQ(pairs, expected);
        EXPECT_FALSE(expected.empty());
    }
}

TEST(AuditMotion, FindsAPassThroughBetweenTwoCleanFrames) {
    const Scene scene = scene_of({plate(), plate()});
    const std::vector<Pose> from{pose({}), pose({0.1, 0.1, 1})}, to{pose({}), pose({0.1, 0.1, -3})};
    EXPECT_TRUE(state(scene, from).intersections.empty());
    EXPECT_TRUE(state(scene, to).intersections.empty());
    const auto report = motion(scene, from, to);
    ASSERT_EQ(report.passages.size(), 1u);
    EXPECT_EQ(report.passages[0].body_a, 0);
    EXPECT_EQ(report.passages[0].body_b, 1);
    EXPECT_NEAR(report.passages[0].time, 0.25, 1e-6);
    EXPECT_NEAR(report.passages[0].place.z, 0, 1e-6);
}

TEST(AuditMotion, FindsPassagesAtAnySpeed) {
    const Scene scene = scene_of({plate(), plate()});
    for (const double distance : {1e-3, 1.0, 1e3, 1e6, 1e9}) {
        const auto report =
            motion(scene, {pose({}), pose({0.1, 0.1, distance / 3})}, {pose({}), pose({0.1, 0.1, -distance})});
        EXPECT_EQ(report.passages.size(), 1u) << distance;
    }
}

TEST(AuditMotion, FindsSwappedIdentities) {
    const Scene scene = scene_of({box(0.3, 0.2, 0.1), box(0.3, 0.2, 0.1)});
    const Pose a = pose({}, {0.1, 0.2, 0}), b = pose({3, 1, 0}, {0, 0, 1});
    EXPECT_EQ(motion(scene, {a, b}, {b, a}).passages.size(), 1u);
    EXPECT_TRUE(motion(scene, {a, b}, {a, b}).passages.empty());
}

TEST(AuditMotion, ProvesNearMissesOfFastBodies) {
    const Scene scene = scene_of({plate(), plate()});
    // Sliding over each other at 100 m per step, 1e-6 m apart; following each other at the same speed.
    EXPECT_TRUE(motion(scene, {pose({}), pose({-50, 0, 1e-6})}, {pose({}), pose({50, 0, 1e-6})}).passages.empty());
    EXPECT_TRUE(
        motion(scene, {pose({}), pose({0, 0, 1e-6})}, {pose({0, 0, 100}), pose({0, 0, 100 + 1e-6})}).passages.empty());
    // Edges that pass each other in skew directions, 1e-5 m apart.
    const Vec3 upright{kPi / 2, 0, 0};
    EXPECT_TRUE(motion(scene, {pose({}), pose({-5, 0.3, 0.5 + 1e-5}, upright)},
                       {pose({}), pose({5, -0.3, 0.5 + 1e-5}, upright)})
                    .passages.empty());
}

TEST(AuditMotion, FindsABodyThatTurnsThroughAnotherBetweenCleanFrames) {
    // A long blade turns by 180 degrees about z through a post; its frames are alike.
    const Scene scene = scene_of({box(2, 0.05, 0.2), box(0.05, 0.05, 1)});
    const std::vector<Pose> from{pose({}), pose({0, 1.5, 0})}, to{pose({}, {0, 0, kPi}), pose({0, 1.5, 0})};
    EXPECT_TRUE(state(scene, from).intersections.empty());
    EXPECT_TRUE(state(scene, to).intersections.empty());
    const auto report = motion(scene, from, to, Motion::rigid, {{0, 0, kPi}, {}});
    ASSERT_EQ(report.passages.size(), 1u);
    EXPECT_TRUE(report.passages[0].crossing);
    EXPECT_TRUE(report.bad_paths.empty());
    // Out of the blade's reach, and the other way round.
    const std::vector<Pose> far_from{from[0], pose({0, 2.1, 0})}, far_to{to[0], pose({0, 2.1, 0})};
    EXPECT_TRUE(motion(scene, far_from, far_to, Motion::rigid, {{0, 0, kPi}, {}}).passages.empty());
    EXPECT_EQ(motion(scene, from, to, Motion::rigid, {{0, 0, -kPi}, {}}).passages.size(), 1u);
}

TEST(AuditMotion, FollowsWholeTurns) {
    const Scene scene = scene_of({box(2, 0.05, 0.2), box(0.05, 0.05, 1)});
    const double turn = 3 * 2 * kPi + 0.1;
    const std::vector<Pose> from{pose({}), pose({0, 1.5, 0})};
    const std::vector<Pose> to{{Vec3{}, rotation_from_vector({0, 0, turn})}, pose({0, 1.5, 0})};
    EXPECT_EQ(motion(scene, from, to, Motion::rigid, {{0, 0, turn}, {}}).passages.size(), 1u);
    EXPECT_TRUE(motion(scene, from, to, Motion::rigid, {{0, 0, 0.1}, {}}).passages.empty());
    // A post just out of reach: 30 turns proved free.
    const double fast = 30 * 2 * kPi;
    const std::vector<Pose> clear{pose({}), pose({0, 2.06, 0})},
        clear_to{{Vec3{}, rotation_from_vector({0, 0, fast})}, pose({0, 2.06, 0})};
    EXPECT_TRUE(motion(scene, clear, clear_to, Motion::rigid, {{0, 0, fast}, {}}).passages.empty());
}

// However fast it turns, a body stays in the ball about its centre: also where no bisection follows its turns.
TEST(AuditMotion, ProvesASmallBodyThatTurnsBeyondCounting) {
    const Scene scene = scene_of({plate(), box(1e-4, 1e-4, 1e-6)});
    const std::vector<Pose> from{pose({}), pose({0.1, 0.1, 0.01})};
    for (const double turn : {1e11, 1e13}) {
        const auto lands = [&](double height) {
            return std::vector{pose({}), Pose{{0.1, 0.1, height}, rotation_from_vector({turn, 0, 0})}};
        };
        EXPECT_TRUE(motion(scene, from, lands(0.02), Motion::rigid, {{}, {turn, 0, 0}}).passages.empty()) << turn;
        EXPECT_FALSE(motion(scene, from, lands(-0.01), Motion::rigid, {{}, {turn, 0, 0}}).passages.empty()) << turn;
    }
}

// Their balls do not meet, or that of one and the other's triangles: proved without following a million turns.
TEST(AuditMotion, ProvesLongBodiesThatTurnBeyondCountingByTheirBalls) {
    const Scene scene = scene_of({box(1, 1e-6, 1e-6), box(1, 1e-6, 1e-6), box(40, 40, 1e-3)});
    const auto rising = [&](double height, const Vec3& turn) {
        std::vector<Pose> from{pose({0, 0, 2}), pose({0, 1.5, 3.9}), pose({0, 0, 0.9})}, to = from;
        to[0].rotation = rotation_from_vector(turn);
        to[2].position.z = height;
        return motion(scene, from, to, Motion::rigid, {turn, {}, {}});
    };
    const auto report = rising(0.95, {2e7, -1e7, 3e6});
    EXPECT_TRUE(report.passages.empty());
    EXPECT_EQ(report.triangle_pairs, 0);
    EXPECT_FALSE(rising(2.1, {20, -10, 3}).passages.empty());
}

TEST(AuditMotion, NeverProvesWhatIsBeyondNumbers) {
    const Scene scene = scene_of({plate(), plate()});
    const std::vector<Pose> from{pose({}), pose({0, 0, 0.5})};
    for (const double turn : {1e154, 1e200, 1e308})
        EXPECT_FALSE(motion(scene, from, from, Motion::rigid, {{turn, 0, 0}, {}}).passages.empty()) << turn;
    // The way between both places is beyond numbers, though each of them is one.
    const std::vector<Pose> far{pose({-1.7e308, 0, 0}), pose({0, 0, 0.5})};
    const std::vector<Pose> there{pose({1.7e308, 0, 0}, {0, 0, 1}), pose({0, 0, 0.5})};
    const auto report = motion(scene, far, there, Motion::rigid, {{0, 0, 1}, {}});
    EXPECT_FALSE(report.passages.empty() && report.bad_paths.empty());
}

TEST(AuditMotion, ReportsATurnThatDoesNotLeadToTheNextFrame) {
    const Scene scene = scene_of({plate(), plate()});
    const std::vector<Pose> from{pose({}), pose({0, 0, 5})}, to{pose({}, {0, 0, 0.5}), pose({0, 0, 5})};
    EXPECT_TRUE(motion(scene, from, to, Motion::rigid, {{0, 0, 0.5}, {}}).bad_paths.empty());
    const auto report = motion(scene, from, to, Motion::rigid, {{0, 0, 0.4}, {}});
    ASSERT_EQ(report.bad_paths.size(), 1u);
    EXPECT_EQ(report.bad_paths[0].body, 0);
}

TEST(AuditMotion, ProvesFacesThatTurnTogetherAtATinyGap) {
    // Any one direction separates them for 1e-8 of the step only.
    const Scene scene = scene_of({plate(), plate()});
    const auto turned = [](double angle, double gap) {
        const Vec3 turn{angle, 0.3 * angle, 0.1 * angle};
        return std::vector{pose({}, turn), pose(rotate(rotation_from_vector(turn), {0.01, 0.02, gap}), turn)};
    };
    for (const double gap : {1e-6, 1e-8, 1e-10, 1e-12}) {
        EXPECT_TRUE(motion(scene, turned(-0.01, gap), turned(0.01, gap)).passages.empty()) << gap;
        EXPECT_FALSE(motion(scene, turned(-0.01, gap), turned(0.01, -gap)).passages.empty()) << gap;
    }
}

TEST(AuditMotion, ProvesBoxesSideBySideThatTurnAsOneAtATinyGap) {
    const Scene scene = scene_of({box(0.5, 0.5, 0.5), box(0.5, 0.5, 0.5)});
    const auto turned = [](double share, double gap) {
        const Vec3 turn = share * Vec3{-0.004, -0.055, 0.038};
        return std::vector{pose({}, turn), pose(rotate(rotation_from_vector(turn), {1 + gap, 0, 0}), turn)};
    };
    for (const double gap : {2e-6, 1e-8}) {
        EXPECT_TRUE(motion(scene, turned(0, gap), turned(1, gap)).passages.empty()) << gap;
        EXPECT_FALSE(motion(scene, turned(0, gap), turned(1, -gap)).passages.empty()) << gap;
    }
}

TEST(AuditMotion, ProvesNeedlesSideBySideThatTurnAsOne) {
    TriangleMesh needle;
    needle.vertices = {{0, 0, 0}, {-1e9, 0, 0}, {1, 0, 0}}; // collinear: no normal, and all edges parallel
    needle.triangles = {{0, 1, 2}};
    const Scene scene = scene_of({make_shape(needle, {-3e8, 0, 0}), make_shape(needle, {-3e8, 0, 0})});
    const Vec3 turn{3e-4, -5e-4, 4e-4};
    const auto passes = [&](const Vec3& from, const Vec3& to, double tilt) {
        const auto turned = [&](double share, const Vec3& aside) {
            const Quat r = rotation_from_vector(share * turn);
            return std::vector<Pose>{{{}, r}, {rotate(r, aside), normalized(r * rotation_from_vector({0, 0, tilt}))}};
        };
        return !motion(scene, turned(0, from), turned(1, to), Motion::rigid, {turn, turn}).passages.empty();
    };
    EXPECT_FALSE(passes({0.1, 0.2, 0.2}, {0.1, 0.2, 0.2}, 0));
    EXPECT_TRUE(passes({0.1, 50, 0.2}, {0.1, 50, -0.3}, 1e-7)); // through the middle
}

TEST(AuditMotion, ProvesFarFromTheOriginWhatItProvesNearIt) {
    const Scene scene = scene_of({plate(), plate()});
    const double gap = 0x1p-23; // one unit of the last place there
    const Vec3 far{0x1p29, -0x1p29, 0x1p29}, above{0x1p29, -0x1p29, 0x1p29 + gap};
    EXPECT_TRUE(motion(scene, {pose(far), pose(above + Vec3{0, 0, 1})}, {pose(far), pose(above)}).passages.empty());
    EXPECT_FALSE(motion(scene, {pose(far), pose(above + Vec3{0, 0, 1})}, {pose(far), pose(far)}).passages.empty());
    // And of bodies that fly there together.
    EXPECT_TRUE(motion(scene, {pose({}), pose({0, 0, 1e-10})}, {pose(far), pose(above)}).passages.empty());
    EXPECT_FALSE(motion(scene, {pose({}), pose({0, 0, 1e-10})}, {pose(far), pose(far)}).passages.empty());
}

TEST(AuditMotion, ProvesEdgesThatAreNearlyParallelAtATinyGap) {
    const Scene scene = scene_of({box(0.5, 0.5, 0.5), box(0.5, 0.5, 0.5)});
    for (const double gap : {1e-6, 1e-8, 1e-10})
        for (const double angle : {0.0, 1e-13, 1e-10, 1e-8, 1e-6, 1e-3}) {
            // Rotated alike by a third of a turn or so, edges of one along those of the other but for `angle`.
            const Vec3 turn{0.3, 0.7, -0.2};
            const Vec3 apart = rotate(rotation_from_vector(turn), {1 + gap, 1 + gap, 0.3});
            const Quat tilted = rotation_from_vector(turn) * rotation_from_vector({0, 0, angle});
            EXPECT_TRUE(motion(scene, {pose({}, turn), {apart, tilted}}, {pose({}, turn), {1.5 * apart, tilted}})
                            .passages.empty())
                << gap << ' ' << angle;
        }
}

/// A vertex brought to within `gap` of a face at a random time of random motions.
TEST(AuditMotion, NeverProvesATinyPassage) {
    std::mt19937_64 rng(12);
    std::uniform_real_distribution<double> u(-1, 1);
    const auto at = [](const Vec3& x, const Vec3& y, double t) { return x + t * (y - x); };
    int proved = 0, refuted = 0;
    for (int round = 0; round < 20000; ++round) {
        std::array<std::vector<Vec3>, 2> from, to;
        for (auto* v : {&from[0], &from[1], &to[0], &to[1]})
            for (int k = 0; k < 3; ++k) v->push_back({u(rng), u(rng), u(rng)});
        const double t = 0.5 + 0.5 * u(rng), gap = 1e-8 * u(rng);
        const auto& [f0, f1] = std::pair{from[1], to[1]};
        const Vec3 o = at(f0[0], f1[0], t), x = at(f0[1], f1[1], t) - o, y = at(f0[2], f1[2], t) - o;
        const Vec3 goal = o + 0.3 * x + 0.3 * y + gap * normalized(cross(x, y));
        const Vec3 shift = goal - at(from[0][0], to[0][0], t);
        for (auto* v : {&from[0], &to[0]})
            for (Vec3& p : *v) p += shift;
        if (round % 2 == 0) to[0] = from[0], to[1] = from[1]; // and at rest, where there may be a proof
        const BodyPath a(from[0], to[0]), b(from[1], to[1]);
        const Triangle all{0, 1, 2};
        const bool apart = sweep_triangles(a, all, b, all, 0, 1).verdict == SweepVerdict::apart;
        bool hit = false;
        for (const double s : {t, t - 1e-7, t + 1e-7, 0.0, 0.25, 0.5, 0.75, 1.0})
            hit = hit || (s >= 0 && s <= 1 && exact::triangles_intersect(a.corners(all, s), b.corners(all, s)));
        EXPECT_FALSE(apart && hit) << round;
        proved += apart ? 1 : 0;
        refuted += hit ? 1 : 0;
    }
    EXPECT_GT(proved, 100);
    EXPECT_GT(refuted, 100);
}

TEST(AuditMotion, ContactWithoutCrossingIsNotProved) {
    // The plate comes down to the other one and stops one ulp above it: apart in every frame, but no plane separates
    // them by more than rounding.
    const Scene scene = scene_of({plate(), plate()});
    const auto report = motion(scene, {pose({}), pose({0, 0, 1})}, {pose({}), pose({0, 0, 1e-17})});
    ASSERT_EQ(report.passages.size(), 1u);
    EXPECT_FALSE(report.passages[0].crossing);
}

/// Dense sampling of the same paths: never apart where the audit says apart.
TEST(AuditMotion, NeverProvesWhatSamplingRefutes) {
    std::mt19937_64 rng(11);
    std::uniform_real_distribution<double> u(-1, 1);
    int proved = 0, refuted = 0;
    for (int round = 0; round < 300; ++round) {
        const Scene scene = scene_of({box(0.6, 0.2, 0.01), box(0.01, 0.5, 0.4)});
        const Vec3 turn_a = 4 * Vec3{u(rng), u(rng), u(rng)}, turn_b = 4 * Vec3{u(rng), u(rng), u(rng)};
        const std::vector<Pose> from{pose({u(rng), u(rng), u(rng)}, {u(rng), u(rng), u(rng)}),
                                     pose({u(rng), u(rng), u(rng)}, {u(rng), u(rng), u(rng)})};
        const std::vector<Pose> to{{{u(rng), u(rng), u(rng)}, rotation_from_vector(turn_a) * from[0].rotation},
                                   {{u(rng), u(rng), u(rng)}, rotation_from_vector(turn_b) * from[1].rotation}};
        const bool apart = motion(scene, from, to, Motion::rigid, {turn_a, turn_b}).passages.empty();
        bool hit = false;
        for (int k = 0; k <= 200 && !hit; ++k) {
            const double t = k / 200.0;
            const auto between = [&](std::size_t i, const Vec3& turn) {
                return Pose{from[i].position + t * (to[i].position - from[i].position),
                            rotation_from_vector(t * turn) * from[i].rotation};
            };
            hit = !state(scene, {between(0, turn_a), between(1, turn_b)}).intersections.empty();
        }
        EXPECT_FALSE(apart && hit) << round;
        proved += apart ? 1 : 0;
        refuted += hit ? 1 : 0;
        EXPECT_TRUE(apart || hit) << "proof missing in round " << round; // the samples are dense enough here
    }
    EXPECT_GT(proved, 20);
    EXPECT_GT(refuted, 20);
}

TEST(AuditDistance, IsThatOfTheNearestPair) {
    const Scene scene = scene_of({box(1, 1, 1), box(0.5, 0.5, 0.5), plate()});
    const auto nearest =
        smallest_distance(scene, place(scene, std::vector{pose({}), pose({2, 0, 0}), pose({0, 0, 1.25})}, 1), 1);
    EXPECT_DOUBLE_EQ(nearest.distance, 0.25);
    EXPECT_EQ(nearest.body_a, 0);
    EXPECT_EQ(nearest.body_b, 2);
    const Scene alone = scene_of({plate()});
    EXPECT_TRUE(std::isinf(smallest_distance(alone, place(alone, std::vector{pose({})}, 1), 1).distance));
}

/// Every pair of triangles, nothing left out.
SmallestDistance distance_of_all(const Scene& scene, const Placement& placement) {
    SmallestDistance best{std::numeric_limits<double>::infinity(), -1, -1};
    const auto corners = [&](std::size_t body, const Triangle& t) {
        const auto at = [&](std::size_t k) { return placement.vertices[body][static_cast<std::size_t>(t[k])]; };
        return Corners{at(0), at(1), at(2)};
    };
    for (std::size_t a = 0; a < scene.bodies.size(); ++a)
        for (std::size_t b = a + 1; b < scene.bodies.size(); ++b)
            for (const Triangle& t : scene.shape_of(a).mesh.triangles)
                for (const Triangle& u : scene.shape_of(b).mesh.triangles) {
                    const double d = std::sqrt(closest_points(corners(a, t), corners(b, u)).distance_sq);
                    if (d < best.distance) best = {d, static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)};
                }
    return best;
}

TEST(AuditDistance, IsTheSmallestOfAllTrianglesOnAnyThreads) {
    std::mt19937_64 rng(5);
    std::uniform_real_distribution<double> u(-1, 1);
    for (int round = 0; round < 200; ++round) {
        std::vector<Shape> shapes;
        std::vector<Pose> poses;
        for (int i = 0; i < 8; ++i) {
            shapes.push_back(i % 2 == 0 ? plate() : box(0.4, 0.2, 0.01));
            poses.push_back(pose({1.5 * u(rng), 1.5 * u(rng), 1.5 * u(rng)}, {3 * u(rng), 3 * u(rng), 3 * u(rng)}));
        }
        const Scene scene = scene_of(std::move(shapes));
        const Placement placement = place(scene, poses, 1);
        const SmallestDistance all = distance_of_all(scene, placement);
        for (const int threads : {1, 3}) {
            const SmallestDistance found = smallest_distance(scene, placement, threads);
            EXPECT_EQ(found.distance, all.distance) << round;
            EXPECT_EQ(found.body_a, all.body_a) << round;
            EXPECT_EQ(found.body_b, all.body_b) << round;
        }
        EXPECT_EQ(smallest_distance(scene, placement, 2, 1.001 * all.distance + 1e-300).distance, all.distance);
        EXPECT_TRUE(std::isinf(smallest_distance(scene, placement, 2, all.distance).distance));
    }
}

} // namespace
} // namespace flotilla::audit
