// SPDX-License-Identifier: MIT
// The earliest hit on turning paths against samples of these paths.
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "ccd/rigid_path.hpp"
#include "geometry/closest.hpp"
#include "mesh/primitives.hpp"

namespace flotilla {
namespace {

constexpr double kSeparation = 2e-4, kRest = 0.01;

class Random {
  public:
    explicit Random(std::int64_t seed) : seed_(seed) {}
    double uniform(double low, double high) { return low + (high - low) * unit_interval(random_bits(seed_, ++count_)); }
    Vec3 vec(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
    Vec3 direction() { return normalized(vec(1)); }

  private:
    std::int64_t seed_, count_ = 0;
};

RigidShape make_shape(TriangleMesh mesh, const Vec3& center_of_mass = {}) {
    RigidShape shape;
    shape.mesh = std::move(mesh);
    shape.topology = build_topology(shape.mesh);
    shape.bvh = build_bvh(shape.mesh);
    shape.box = bounding_box(shape.mesh);
    shape.center_of_mass = center_of_mass;
    shape.radius = bounding_radius(shape.mesh, center_of_mass);
    return shape;
}

TriangleMesh soup(Random& random) {
    TriangleMesh mesh;
    for (int t = 0; t < 5; ++t) {
        const Vec3 c = random.vec(0.8);
        for (int k = 0; k < 3; ++k) mesh.vertices.push_back(c + random.vec(0.4));
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

/// A quadrilateral in the plane y = 0.
void add_strip(TriangleMesh& mesh, double x0, double x1, double half_height) {
    const auto n = static_cast<std::int32_t>(mesh.vertices.size());
    for (const auto& [x, z] : {std::pair{x0, -half_height}, {x1, -half_height}, {x1, half_height}, {x0, half_height}})
        mesh.vertices.push_back({x, 0, z});
    mesh.triangles.push_back({n, n + 1, n + 2});
    mesh.triangles.push_back({n, n + 2, n + 3});
}

TriangleMesh particle() {
    constexpr double kSize = 1e-3;
    return {{{kSize, 0, 0}, {-kSize, kSize, 0}, {-kSize, -kSize, 0}}, {{0, 1, 2}}};
}

struct Pair {
    Model model;
    Trajectories trajectories;
    std::array<Pose, 2> start;
    std::array<Vec3, 2> shift, turn;

    Pair(RigidShape a, RigidShape b) {
        model.shapes.push_back(std::move(a));
        model.shapes.push_back(std::move(b));
        model.bodies.resize(2);
        model.bodies[1].shape = 1;
    }
    void move(Trajectory trajectory) {
        model.settings.trajectory = trajectory;
        trajectories.start(model, start);
        for (std::size_t i = 0; i < 2; ++i)
            trajectories.set_end(i,
                                 make_pose(model.shapes[i], start[i].com + shift[i],
                                           normalized(rotation_from_vector(turn[i]) * start[i].rotation)),
                                 turn[i]);
    }
    [[nodiscard]] BodyMotion motion(std::size_t i) const { return trajectories.motion(i); }

    PairHit query(double start_distance, PathCut& cut) {
        CcdScratch scratch;
        const BodyMotion a = motion(0), b = motion(1);
        cut = cut_path(a, b, {kRest, start_distance});
        return earliest_hit_on_path(a, b, {kSeparation}, cut, {}, scratch);
    }

    /// The vertices of a body on its path.
    [[nodiscard]] std::vector<Vec3> vertices(std::size_t i, double t) const {
        const RigidShape& shape = model.shapes[i];
        const Pose pose = make_pose(shape, start[i].com + t * shift[i],
                                    normalized(rotation_from_vector(t * turn[i]) * start[i].rotation));
        std::vector<Vec3> x;
        const Mat3 rotation = matrix(pose.rotation);
        for (const Vec3& v : shape.mesh.vertices) x.push_back(rotation * v + pose.origin);
        return x;
    }

    struct Nearest {
        double distance = 1e300;
        Vec3 direction; ///< from a to b
    };
    [[nodiscard]] Nearest nearest(double t) const {
        const std::vector<Vec3> x = vertices(0, t), y = vertices(1, t);
        const RigidShape &a = model.shapes[0], &b = model.shapes[1];
        Nearest best;
        const auto offer = [&](double distance_sq, const Vec3& p, const Vec3& q) {
            if (const double d = std::sqrt(distance_sq); d < best.distance) best = {d, normalized(q - p)};
        };
        const auto at = [](const std::vector<Vec3>& v, std::int32_t i) { return v[static_cast<std::size_t>(i)]; };
        for (const Vec3& p : x)
            for (const Triangle& t1 : b.mesh.triangles) {
                const auto c = closest_vertex_triangle(p, at(y, t1[0]), at(y, t1[1]), at(y, t1[2]));
                offer(c.distance_sq, p, c.point);
            }
        for (const Vec3& p : y)
            for (const Triangle& t0 : a.mesh.triangles) {
                const auto c = closest_vertex_triangle(p, at(x, t0[0]), at(x, t0[1]), at(x, t0[2]));
                offer(c.distance_sq, c.point, p);
            }
        for (const Edge& e : a.topology.edges)
            for (const Edge& f : b.topology.edges) {
                const auto c = closest_edge_edge(at(x, e[0]), at(x, e[1]), at(y, f[0]), at(y, f[1]));
                offer(c.distance_sq, c.p, c.q);
            }
        return best;
    }
};

/// A plate turns by a right angle about the z axis and a particle stands in the way of its edge (figure 5).
struct Hits {
    bool linear, rigid;
    double toi;
};
Hits turn_past_particle(const TriangleMesh& plate, double particle_radius) {
    Pair pair(make_shape(plate), make_shape(particle()));
    const double c = particle_radius * std::sqrt(0.5);
    pair.start[1] = make_pose(pair.model.shapes[1], {c, c, 0}, {});
    pair.turn[0] = {0, 0, 2 * std::atan(1)};
    CcdScratch scratch;
    pair.move(Trajectory::linear);
    Hits hits{};
    hits.linear = earliest_hit(pair.motion(0), pair.motion(1), {kSeparation}, {}, scratch).hit;
    pair.move(Trajectory::rigid);
    PathCut cut;
    const PairHit hit = pair.query(pair.nearest(0).distance, cut);
    hits.rigid = hit.hit;
    hits.toi = hit.toi;
    if (hit.hit) {
        EXPECT_GT(dot(hit.normal, Vec3{-1, 1, 0}), 1.3) << "the edge moves this way when it meets the particle";
    }
    return hits;
}

TEST(RigidPath, HitsWhereTheChordCutsTheCorner) {
    TriangleMesh plate;
    add_strip(plate, -1, 1, 0.5);
    const Hits hits = turn_past_particle(plate, 0.85);
    EXPECT_FALSE(hits.linear);
    EXPECT_TRUE(hits.rigid);
    EXPECT_NEAR(hits.toi, 0.5, 0.01);
}

TEST(RigidPath, MissesWhatOnlyTheChordMeets) {
    TriangleMesh plates;
    add_strip(plates, 0.9, 1.1, 0.1);
    add_strip(plates, -1.1, -0.9, 0.1);
    const Hits hits = turn_past_particle(plates, std::sqrt(0.5));
    EXPECT_TRUE(hits.linear);
    EXPECT_FALSE(hits.rigid);
}

TEST(RigidPath, CostsNothingWhereNothingTurns) {
    Random random(7);
    Pair pair(make_shape(soup(random)), make_shape(make_sphere(0.7, 1)));
    pair.start[1] = make_pose(pair.model.shapes[1], {3, 0, 0}, {});
    pair.shift[1] = {-2, 0.1, 0};
    pair.move(Trajectory::rigid);
    CcdScratch scratch;
    const BodyMotion a = pair.motion(0), b = pair.motion(1);
    const PathCut cut = cut_path(a, b, {kRest, 1e-3});
    EXPECT_EQ(cut.segments, 1);
    EXPECT_EQ(cut.gap, 0);
    const PairHit on_path = earliest_hit_on_path(a, b, {kSeparation}, cut, {}, scratch);
    EXPECT_EQ(scratch.counters.segments, 0);
    const PairHit straight = earliest_hit(a, b, {kSeparation}, {}, scratch);
    EXPECT_TRUE(straight.hit);
    EXPECT_EQ(on_path.toi, straight.toi);
    EXPECT_EQ(on_path.normal, straight.normal);
}

struct Counts {
    int hits = 0, misses = 0, many_segments = 0, near_starts = 0, shared = 0;
};

/// The earliest hit on the chords of all segments, one after the other, of bodies that do not start near.
PairHit hit_on_chords(const Pair& pair, const PathCut& cut) {
    CcdScratch scratch;
    std::array<std::array<PlacedBody, 2>, 2> placed;
    const auto end = [&](std::size_t body, int i) {
        const BodyMotion m = pair.motion(body);
        if (i == 0) return m.at0;
        if (i == cut.segments) return m.at1;
        PlacedBody& p = placed[body][static_cast<std::size_t>(i % 2)];
        p.place(*m.shape, m.pose(static_cast<double>(i) / cut.segments));
        return p.view();
    };
    for (int i = 0; i < cut.segments; ++i) {
        const BodyMotion a{&pair.model.shapes[0], end(0, i), end(0, i + 1), {}},
            b{&pair.model.shapes[1], end(1, i), end(1, i + 1), {}};
        PairHit hit = earliest_hit(a, b, {kSeparation + cut.gap, CcdStart::strict}, {}, scratch);
        hit.toi = std::min((i + hit.toi) / cut.segments, 1.0);
        if (hit.hit) return hit;
    }
    return {};
}

/// The samples of a path against the answer of the query; the samples up to the hit, or all of them.
void check_samples(Pair& pair, Counts& counts) {
    constexpr int kSamples = 1000;
    pair.move(Trajectory::rigid);
    const double start = pair.nearest(0).distance;
    if (!(start > 1e-5)) return;
    PathCut cut;
    const PairHit hit = pair.query(start, cut);
    ASSERT_TRUE(cut.gap < 0.1 * std::min(start, kRest) || cut.segments == 64);
    const double kept = 0.95 * start, reach = kSeparation + cut.gap;
    const bool provable = start >= 1.02 * reach || kept - cut.gap >= 0.5 * std::min(kSeparation, kept);
    ASSERT_TRUE(provable || hit.hit) << "no certificate without room for the arcs";
    ++(hit.hit ? counts.hits : counts.misses);
    if (cut.segments >= 8) ++counts.many_segments;
    if (cut.segments > 8 && start >= 1.02 * reach) {
        const PairHit expected = hit_on_chords(pair, cut);
        ASSERT_EQ(hit.hit, expected.hit);
        ASSERT_EQ(hit.toi, expected.toi);
        ASSERT_TRUE(!hit.hit || hit.features == expected.features);
        ++counts.shared;
    }
    if (start < reach) ++counts.near_starts;
    const double certified = std::min(kSeparation, kept - cut.gap);
    const double last = hit.hit ? hit.toi : 1;
    const Box box_a = pair.motion(0).swept(), box_b = pair.motion(1).swept();
    for (int n = 0; n <= kSamples; ++n) {
        const double t = last * n / kSamples;
        if (provable) {
            ASSERT_GE(pair.nearest(t).distance, certified * (1 - 1e-9)) << "t " << t << " of " << last;
        }
        if (n % 100 != 0) continue;
        const double any = static_cast<double>(n) / kSamples;
        for (const Vec3& p : pair.vertices(0, any)) ASSERT_TRUE(max(p, box_a.lower) == p && min(p, box_a.upper) == p);
        for (const Vec3& p : pair.vertices(1, any)) ASSERT_TRUE(max(p, box_b.lower) == p && min(p, box_b.upper) == p);
    }
    if (!hit.hit || hit.toi == 0) return;
    // A hit is as near as the chords' separation and both gaps allow.
    const FeaturePoints p = closest_points(pair.motion(0), pair.motion(1), hit.features, hit.toi);
    EXPECT_LE(length(p.b - p.a), 1.02 * (kSeparation + 2 * cut.gap)) << "toi " << hit.toi;
    EXPECT_NEAR(length(hit.normal), 1, 1e-12);
    // Its points move as the path does.
    const double h = 1e-6;
    const Vec3 turned = cross(pair.turn[0], p.a - pair.motion(0).pose(hit.toi).com) + pair.shift[0];
    EXPECT_LE(length((p.a1 - p.a0) - turned), h);
    EXPECT_LE(length(p.a - (p.a0 + hit.toi * (p.a1 - p.a0))), h);
}

TEST(RigidPath, SamplesNeverComeNearerThanCertified) {
    Counts counts;
    for (std::int64_t n = 0; n < 160; ++n) {
        Random random(n);
        // A centre of mass away from the origin of the mesh and inside its hull.
        Pair pair(make_shape(soup(random), random.vec(0.3)), make_shape(make_sphere(0.5, 0), {0.1, 0.2, -0.1}));
        // Up to 50 rad/s at 1/24 s, and several turns.
        const double largest = n % 3 == 0 ? 0.3 : n % 3 == 1 ? 50.0 / 24 : 20;
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec3 at = i == 0 ? Vec3{} : random.uniform(0.9, 1.7) * random.direction();
            pair.start[i] = make_pose(pair.model.shapes[i], at, rotation_from_vector(random.vec(3)));
            pair.turn[i] = random.uniform(0, largest) * random.direction();
            pair.shift[i] = random.vec(0.3);
        }
        check_samples(pair, counts);
        if (HasFatalFailure()) return;
    }
    std::printf("%d hits, %d misses, %d with 8 segments or more\n", counts.hits, counts.misses, counts.many_segments);
    EXPECT_GE(counts.hits, 60);
    EXPECT_GE(counts.misses, 40);
    EXPECT_GE(counts.many_segments, 60);
    EXPECT_GE(counts.shared, 40);
}

TEST(RigidPath, NearStartsKeepWhatTheyMust) {
    Counts counts;
    for (std::int64_t n = 0; n < 140; ++n) {
        Random random(3000 + n);
        Pair pair(make_shape(soup(random), random.vec(0.3)), make_shape(make_sphere(0.5, 0)));
        pair.start[0] = make_pose(pair.model.shapes[0], {}, rotation_from_vector(random.vec(3)));
        const Vec3 side = random.direction();
        const double wanted = std::pow(10, random.uniform(-4.5, -2.5));
        pair.start[1] = make_pose(pair.model.shapes[1], 2.5 * side, rotation_from_vector(random.vec(3)));
        for (int k = 0; k < 100; ++k) { // a step towards a by less than the distance never meets it
            const double d = pair.nearest(0).distance;
            if (d < 1.01 * wanted) break;
            pair.start[1] =
                make_pose(pair.model.shapes[1], pair.start[1].com - (d - wanted) * side, pair.start[1].rotation);
        }
        for (std::size_t i = 0; i < 2; ++i)
            pair.turn[i] = std::pow(10, random.uniform(-3, n % 2 == 0 ? -0.5 : 0.5)) * random.direction();
        pair.shift[1] = random.uniform(-0.1, 0.2) * side;
        check_samples(pair, counts);
        if (HasFatalFailure()) return;
    }
    std::printf("%d hits, %d misses, %d near starts\n", counts.hits, counts.misses, counts.near_starts);
    EXPECT_GE(counts.hits, 30);
    EXPECT_GE(counts.misses, 30);
    EXPECT_GE(counts.near_starts, 40);
}

} // namespace
} // namespace flotilla
