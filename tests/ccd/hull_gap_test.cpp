// SPDX-License-Identifier: MIT
// Planes between two bodies: what is said of the gap holds for all vertices at all times, and bodies apart are found to
// be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "base/rotation.hpp"
#include "ccd/hull_gap.hpp"
#include "mesh/primitives.hpp"
#include "support/convex_pair.hpp"

namespace flotilla {
namespace {

class Random {
  public:
    explicit Random(std::int64_t seed) : seed_(seed) {}
    double uniform(double low, double high) { return low + (high - low) * unit_interval(random_bits(seed_, ++count_)); }
    Vec3 vec(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
    Quat rotation() { return rotation_from_vector(vec(3)); }

  private:
    std::int64_t seed_, count_ = 0;
};

/// Two bodies and their straight motions.
struct Pair {
    Model model;
    Trajectories trajectories;

    Pair(TriangleMesh a, TriangleMesh b) {
        model.shapes.push_back(test::shape_of(std::move(a)));
        model.shapes.push_back(test::shape_of(std::move(b)));
        model.bodies.resize(2);
        model.bodies[1].shape = 1;
    }
    void move(const std::array<Pose, 2>& start, const std::array<Pose, 2>& end) {
        trajectories.start(model, start);
        for (std::size_t i = 0; i < 2; ++i) trajectories.set_end(i, end[i], {});
    }
    [[nodiscard]] BodyMotion motion(std::size_t i) const { return trajectories.motion(i); }
    [[nodiscard]] Pose pose(std::size_t i, const Vec3& at, const Quat& rotation) const {
        return make_pose(model.shapes[i], at, rotation);
    }
};

/// The least gap of any two vertices along a direction at time t.
long double gap_of_vertices(const BodyMotion& a, const BodyMotion& b, const Vec3& d, double t) {
    const auto along = [&](const BodyMotion& body, std::size_t v) {
        const auto at = [&](const Vec3& x) {
            return static_cast<long double>(d.x) * x.x + static_cast<long double>(d.y) * x.y +
                   static_cast<long double>(d.z) * x.z;
        };
        return (1 - static_cast<long double>(t)) * at(body.at0.x[v]) + static_cast<long double>(t) * at(body.at1.x[v]);
    };
    long double most = -INFINITY, least = INFINITY;
    for (std::size_t v = 0; v < a.at0.x.size(); ++v) most = std::max(most, along(a, v));
    for (std::size_t v = 0; v < b.at0.x.size(); ++v) least = std::min(least, along(b, v));
    return least - most;
}

TEST(HullGap, IsNoMoreThanThatOfAnyVerticesAtAnyTime) {
    Random random(1);
    int found = 0, apart = 0;
    for (int i = 0; i < 3000; ++i) {
        const double size = std::pow(10, random.uniform(-4, 4)), far = std::pow(10, random.uniform(-1, 4)) * size;
        Pair pair(make_box(size * random.uniform(0.1, 2), size, size * random.uniform(0.1, 2)), make_sphere(size, 1));
        const Vec3 place = random.vec(far);
        std::array<Pose, 2> start, end;
        for (std::size_t k = 0; k < 2; ++k) {
            start[k] = pair.pose(k, place + random.vec(1.5 * size), random.rotation());
            end[k] = pair.pose(k, start[k].com + random.vec(0.5 * size),
                               normalized(rotation_from_vector(random.vec(0.5)) * start[k].rotation));
        }
        pair.move(start, end);
        const BodyMotion a = pair.motion(0), b = pair.motion(1);
        Vec3 direction{};
        const HullGap gap = find_hull_gap(a, b, 0, direction);
        const double least = std::min(gap.start, gap.end);
        if (!(least > 0)) continue;
        ++found;
        apart += least > 0.1 * size ? 1 : 0;
        EXPECT_LE(gap.start, gap_of_vertices(a, b, direction, 0));
        EXPECT_LE(gap.end, gap_of_vertices(a, b, direction, 1));
        for (const double t : {0.1, 0.5, 0.7}) EXPECT_LE(least, gap_of_vertices(a, b, direction, t));
    }
    EXPECT_GE(found, 500);
    EXPECT_GE(apart, 100);
}

TEST(HullGap, IsFoundBetweenBodiesThatMoveTogether) {
    Pair pair(make_box(1, 1, 0.2), make_sphere(0.5, 2));
    const Quat none{}, turned = rotation_from_vector({0.1, 0.2, 0.5});
    // Their boxes overlap, and the direction of their centres does not separate them.
    const Vec3 together{3, 0, -2};
    const std::array<Pose, 2> start{pair.pose(0, {0, 0, 0}, turned), pair.pose(1, {0.3, 0.2, 0.65}, none)};
    pair.move(start, {pair.pose(0, start[0].com + together, turned), pair.pose(1, start[1].com + together, none)});
    Vec3 direction{};
    HullGap gap = find_hull_gap(pair.motion(0), pair.motion(1), 0.01, direction);
    EXPECT_GT(std::min(gap.start, gap.end), 0.01);
    // Through each other and out on the other side: apart at both ends, and no plane says so of the time between.
    pair.move(start, {start[0], pair.pose(1, start[1].com - Vec3{0, 0, 2}, none)});
    direction = {};
    gap = find_hull_gap(pair.motion(0), pair.motion(1), 0.01, direction);
    EXPECT_LT(std::min(gap.start, gap.end), 0);
}

} // namespace
} // namespace flotilla
