// SPDX-License-Identifier: MIT
// The hits of a step solved together: blows go through rows and columns, crates land flat, and no energy comes from
// anywhere.
#include "response/kept_hits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace flotilla {
namespace {

constexpr double kSolved = 2e-4; // of the fastest approach: a round leaves 1e-4 of it undone

double energy(const Impulsive& b) {
    if (!(b.inverse_mass > 0)) return 0;
    const auto& i = b.inverse_inertia.m;
    const Vec3 w = b.angular_velocity;
    return 0.5 * (length_sq(b.velocity) / b.inverse_mass + w.x * w.x / i[0] + w.y * w.y / i[4] + w.z * w.z / i[8]);
}

/// Bodies and the hits of a step, as one island.
struct System {
    std::vector<Impulsive> bodies;
    std::vector<KeptHit> hits;

    std::int32_t add(double mass, const Vec3& velocity, double inertia = 1) {
        const double w = mass > 0 ? 1 / mass : 0, i = mass > 0 ? 1 / inertia : 0;
        bodies.push_back({w, diagonal({i, i, i}), velocity, {}});
        return static_cast<std::int32_t>(bodies.size()) - 1;
    }
    [[nodiscard]] Vec3 relative(const KeptHit& h) const {
        const auto at = [&](std::int32_t i) { return bodies[static_cast<std::size_t>(i)]; };
        return point_velocity(at(h.b), h.point.arm_b) - point_velocity(at(h.a), h.point.arm_a);
    }
    KeptHit& add_hit(std::int32_t a, std::int32_t b, const ContactPoint& point, double restitution, bool fresh) {
        KeptHit hit;
        hit.a = a, hit.b = b, hit.point = point, hit.restitution = restitution, hit.fresh = fresh;
        if (fresh) hit.point.relative_velocity = relative(hit);
        hits.push_back(hit);
        return hits.back();
    }
    void solve() {
        std::stable_sort(hits.begin(), hits.end(),
                         [](const KeptHit& x, const KeptHit& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
        std::vector<std::int32_t> island(hits.size());
        std::iota(island.begin(), island.end(), 0);
        const std::size_t n = bodies.size();
        HitBodies work;
        work.body = work.before = bodies;
        work.stamp.resize(n), work.owner.resize(n), work.saved.resize(n);
        solve_hits(hits, island, work);
        for (const KeptHit& h : hits) { // as the stage applies them
            Impulsive &a = bodies[static_cast<std::size_t>(h.a)], &b = bodies[static_cast<std::size_t>(h.b)];
            a.velocity -= a.inverse_mass * h.change;
            a.angular_velocity -= a.inverse_inertia * cross(h.point.arm_a, h.change);
            b.velocity += b.inverse_mass * h.change;
            b.angular_velocity += b.inverse_inertia * cross(h.point.arm_b, h.change);
        }
    }
    [[nodiscard]] double total_energy() const {
        double sum = 0;
        for (const Impulsive& b : bodies) sum += energy(b);
        return sum;
    }
    [[nodiscard]] Vec3 momentum() const {
        Vec3 sum;
        for (const Impulsive& b : bodies)
            if (b.inverse_mass > 0) sum += b.velocity / b.inverse_mass;
        return sum;
    }
};

/// Looks at a row of points until none would pass its neighbour within the step; the number of looks.
int resolve_row(System& s, const std::vector<double>& place, double dt, double restitution) {
    for (int looks = 1; looks < 1000; ++looks) {
        bool found = false;
        for (std::int32_t i = 0; i + 1 < static_cast<std::int32_t>(s.bodies.size()); ++i) {
            const auto k = static_cast<std::size_t>(i);
            const double v = s.bodies[k + 1].velocity.x - s.bodies[k].velocity.x;
            if (!(place[k + 1] - place[k] + dt * v < 0)) continue;
            found = true;
            const auto known = std::find_if(s.hits.begin(), s.hits.end(), [&](const KeptHit& h) { return h.a == i; });
            if (known == s.hits.end()) {
                s.add_hit(i, i + 1, {{1, 0, 0}, {}, {}, {}, 0}, restitution, true);
            } else {
                known->fresh = true;
                known->point.relative_velocity = s.relative(*known);
            }
        }
        if (!found) return looks;
        const double before = s.total_energy();
        s.solve();
        EXPECT_LE(s.total_energy(), before * (1 + 1e-12));
    }
    return 1000;
}

// A look for each, and a few for what the sweeps leave of a chain. Pair by pair, with a look after each, it takes 72,
// 189 and 256.
TEST(KeptHits, AColumnThatFallsTakesOneLookABody) {
    for (const int n : {10, 20, 30}) {
        System s;
        std::vector<double> place;
        s.add(0, {});
        place.push_back(0);
        for (int i = 0; i < n; ++i) {
            s.add(1, {-8, 0, 0});
            place.push_back(0.01 + 0.001 * i);
        }
        EXPECT_LE(resolve_row(s, place, 1.0 / 24, 0.1), n + 1 + n / 10);
    }
}

// ((1 + e) / 2)^(n - 1) of the first one's speed, whether the others wait in contact or are met one by one.
TEST(KeptHits, ARowHandsABlowOn) {
    constexpr int kBodies = 5;
    for (const double e : {0.0, 0.5, 1.0})
        for (const bool wait : {false, true}) {
            System s;
            std::vector<double> place;
            for (int i = 0; i < kBodies; ++i) {
                s.add(2, {i == 0 ? 3.0 : 0.0, 0, 0});
                place.push_back(0.001 * i);
            }
            if (wait)
                for (int i = 1; i + 1 < kBodies; ++i) s.add_hit(i, i + 1, {{1, 0, 0}, {}, {}, {}, 0}, e, false);
            (void)resolve_row(s, place, 1.0, e);
            EXPECT_NEAR(s.momentum().x, 6, 1e-12);
            for (const Impulsive& b : s.bodies) EXPECT_LT(b.velocity.x, 3 + kSolved);
            const double due = e > 0 ? 3 * std::pow((1 + e) / 2, kBodies - 1) : 3.0 / kBodies;
            EXPECT_NEAR(s.bodies.back().velocity.x, due, 3e-3) << e << wait;
        }
}

/// Four corners of the lower face of a crate of edge 1 over the ground.
std::vector<ContactPoint> corners(double friction) {
    std::vector<ContactPoint> points;
    for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5}) points.push_back({{0, 0, 1}, {x, y, 0}, {x, y, -0.5}, {}, friction});
    return points;
}

TEST(KeptHits, ACrateLandsFlatWhetherItsCornersAreMetAtOnceOrNot) {
    for (const double e : {0.0, 0.5, 1.0})
        for (const double friction : {0.0, 0.3})
            for (const bool at_once : {true, false}) {
                System s;
                const std::int32_t ground = s.add(0, {}), crate = s.add(1, {0, 0, -3}, 0.2);
                const auto points = corners(friction);
                s.add_hit(ground, crate, points[0], e, true);
                if (!at_once) s.solve();
                for (std::size_t i = 1; i < 4; ++i) s.add_hit(ground, crate, points[i], e, true);
                s.solve();
                EXPECT_NEAR(s.bodies[1].velocity.z, 3 * e, 3e-3) << e << ' ' << friction << at_once;
                EXPECT_LT(length(s.bodies[1].angular_velocity), 6e-3) << e << ' ' << friction << at_once;
            }
}

// Hits of anything with anything, met in three looks: what rebounds at once could take energy from nowhere.
TEST(KeptHits, NoEnergyIsGainedAndNoMomentumLost) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> in(-1, 1), share(0, 1);
    int cut = 0;
    for (int round = 0; round < 300; ++round) {
        System s;
        for (int i = 0; i < 8; ++i) {
            const auto k = static_cast<std::size_t>(
                s.add(std::exp(2 * in(random)), {in(random), in(random), in(random)}, std::exp(2 * in(random))));
            s.bodies[k].angular_velocity = {in(random), in(random), in(random)};
        }
        const Vec3 momentum = s.momentum();
        const double before = s.total_energy(); // a pair that begins anew may give back what it took
        for (int look = 0; look < 3; ++look) {
            for (int k = 0; k < 6; ++k) {
                const auto a = static_cast<std::int32_t>(4 * share(random)),
                           b = static_cast<std::int32_t>(4 + 4 * share(random));
                const Vec3 n = normalized(Vec3{in(random), in(random), in(random)});
                const ContactPoint p{
                    n, {in(random), in(random), in(random)}, {in(random), in(random), in(random)}, {}, share(random)};
                if (dot(n, s.relative(s.add_hit(a, b, p, share(random), true))) >= 0) s.hits.pop_back();
            }
            s.solve();
            EXPECT_LE(s.total_energy(), before * (1 + 1e-12)) << round << ' ' << look;
            EXPECT_LT(length(s.momentum() - momentum), 1e-12);
            for (const KeptHit& h : s.hits) {
                const double normal = dot(h.impulse, h.point.normal);
                EXPECT_GE(normal, 0);
                EXPECT_LE(length(h.impulse - normal * h.point.normal), h.point.friction * normal * (1 + 1e-9) + 1e-12);
                cut += normal > 0 ? 1 : 0;
            }
        }
    }
    EXPECT_GT(cut, 1000);
}

// What waits is met where something pushes it faster than it may go, and not before.
TEST(KeptHits, WhatWaitsIsMetWhenItIsPushed) {
    for (const double least : {0.1, 10.0}) {
        System s;
        for (int i = 0; i < 3; ++i) s.add(1, {i == 0 ? 2.0 : 0.0, 0, 0});
        s.add_hit(0, 1, {{1, 0, 0}, {}, {}, {}, 0}, 0, true);
        s.add_hit(1, 2, {{1, 0, 0}, {}, {}, {}, 0}, 0, false).least = least;
        s.solve();
        EXPECT_EQ(s.hits[1].met, least < 1);
        EXPECT_NEAR(s.bodies[2].velocity.x, least < 1 ? 2.0 / 3 : 0, 0.1);
    }
}

} // namespace
} // namespace flotilla
