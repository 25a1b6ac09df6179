// SPDX-License-Identifier: MIT
// The earliest hit and the proximities of a pair: the same from a loop over all features, a traversal and a candidate
// list.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "base/rotation.hpp"
#include "ccd/pair_query.hpp"
#include "geometry/plane_test.hpp"
#include "mesh/primitives.hpp"
#include "proximity/contact_points.hpp"

namespace flotilla {
namespace {

constexpr double kSeparation = 2e-4, kProximity = 0.02, kAngleCos = 0.9986;

class Random {
  public:
    explicit Random(std::int64_t seed) : seed_(seed) {}
    double uniform(double low, double high) { return low + (high - low) * unit_interval(random_bits(seed_, ++count_)); }
    Vec3 vec(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
    Quat rotation() { return rotation_from_vector(vec(3)); }

  private:
    std::int64_t seed_, count_ = 0;
};

TriangleMesh soup(Random& random) {
    TriangleMesh mesh;
    for (int t = 0; t < 20; ++t) {
        const Vec3 c = random.vec(1);
        for (int k = 0; k < 3; ++k) mesh.vertices.push_back(c + random.vec(0.4));
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

RigidShape make_shape(TriangleMesh mesh) {
    RigidShape shape;
    shape.mesh = std::move(mesh);
    shape.topology = build_topology(shape.mesh);
    shape.bvh = build_bvh(shape.mesh);
    shape.box = bounding_box(shape.mesh);
    shape.radius = bounding_radius(shape.mesh, {});
    return shape;
}

/// Two bodies of different shapes and their trajectories.
struct Pair {
    Model model;
    Trajectories trajectories;

    explicit Pair(Random& random) {
        model.shapes.push_back(make_shape(soup(random)));
        model.shapes.push_back(make_shape(make_sphere(0.7, 2)));
        model.bodies.resize(2);
        model.bodies[1].shape = 1;
    }
    void move(const std::array<Pose, 2>& start, const std::array<Pose, 2>& end) {
        trajectories.start(model, start);
        for (std::size_t i = 0; i < 2; ++i) trajectories.set_end(i, end[i], {});
    }
    [[nodiscard]] BodyMotion motion(std::size_t i) const { return trajectories.motion(i); }
};

Pose near(const RigidShape& shape, const Pose& pose, Random& random, double size) {
    return make_pose(shape, pose.com + random.vec(size),
                     normalized(rotation_from_vector(random.vec(size)) * pose.rotation));
}

/// The rule of pair_query.hpp by a loop over all feature pairs.
PairHit hit_of_all_features(const BodyMotion& a, const BodyMotion& b) {
    const CoarseReach reach(kSeparation * (1 + 0x1p-6), std::max(a.max_abs(), b.max_abs()));
    PairHit best;
    const auto offer = [&](const FeaturePair& f, const MovingCoarseBox& p, const MovingCoarseBox& q) {
        float entry = 0;
        if (!coarse_overlap(p, q, reach, reach, entry)) return;
        const CcdResult r = ccd(ccd_kind(f.kind), ccd_query(a, b, f), {kSeparation, CcdStart::relaxed});
        if (!r.hit) return;
        const double toi = std::max(r.toi, double{entry});
        if (!best.hit || std::pair(toi, feature_key(f)) < std::pair(best.toi, feature_key(best.features)))
            best = {true, toi, f, {}};
    };
    const auto &ma = a.shape->mesh, &mb = b.shape->mesh;
    const auto count = [](const auto& list) { return static_cast<std::int32_t>(list.size()); };
    for (std::int32_t i = 0; i < count(ma.vertices); ++i)
        for (std::int32_t j = 0; j < count(mb.triangles); ++j)
            offer({FeatureKind::vertex_face, i, j}, coarse_vertex(a, i),
                  coarse_triangle(b, mb.triangles[static_cast<std::size_t>(j)]));
    for (std::int32_t i = 0; i < count(ma.triangles); ++i)
        for (std::int32_t j = 0; j < count(mb.vertices); ++j)
            offer({FeatureKind::face_vertex, i, j}, coarse_triangle(a, ma.triangles[static_cast<std::size_t>(i)]),
                  coarse_vertex(b, j));
    const auto &ea = a.shape->topology.edges, &eb = b.shape->topology.edges;
    for (std::int32_t i = 0; i < count(ea); ++i)
        for (std::int32_t j = 0; j < count(eb); ++j)
            offer({FeatureKind::edge_edge, i, j}, coarse_edge(a, ea[static_cast<std::size_t>(i)]),
                  coarse_edge(b, eb[static_cast<std::size_t>(j)]));
    return best;
}

void expect_same(const PairHit& p, const PairHit& q) {
    ASSERT_EQ(p.hit, q.hit);
    if (!p.hit) return;
    EXPECT_EQ(p.toi, q.toi);
    EXPECT_EQ(feature_key(p.features), feature_key(q.features));
}

TEST(EarliestHit, IsTheLeastOfAllFeaturePairs) {
    int hits = 0, misses = 0;
    for (std::int64_t n = 0; n < 150; ++n) {
        Random random(n);
        Pair pair(random);
        const double size = n % 2 == 0 ? 0.3 : 2;
        std::array<Pose, 2> start, end;
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec3 at = i == 0 ? Vec3{} : Vec3{random.uniform(1.2, 2), random.uniform(-1, 1), 0};
            start[i] = make_pose(pair.model.shapes[i], at, random.rotation());
            end[i] = near(pair.model.shapes[i], start[i], random, size);
        }
        pair.move(start, end);
        CcdScratch scratch;
        const PairHit hit = earliest_hit(pair.motion(0), pair.motion(1), {kSeparation}, {}, scratch);
        expect_same(hit, hit_of_all_features(pair.motion(0), pair.motion(1)));
        ++(hit.hit ? hits : misses);
    }
    EXPECT_GE(hits, 30);
    EXPECT_GE(misses, 30);
}

/// A sphere in a box that turns, as on a segment of its path: normals of the box's triangles keep nearly all of the
/// sphere's apart from them, whose boxes meet.
TEST(EarliestHit, LeavesOutTrianglesThatADirectionKeepsApart) {
    int hits = 0, misses = 0;
    std::int64_t queries = 0, features = 0;
    for (std::int64_t n = 0; n < 24; ++n) {
        Random random(500 + n);
        Pair pair(random);
        pair.model.shapes[0] = make_shape(make_box(1, 1, 1));
        pair.model.shapes[1] = make_shape(make_sphere(0.47, 2));
        std::array<Pose, 2> start, end;
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec3 place = n % 3 == 0 ? Vec3{-2e4, 1e4, 1e4} : Vec3{};
            start[i] = make_pose(pair.model.shapes[i], place + random.vec(0.01), random.rotation());
            end[i] = near(pair.model.shapes[i], start[i], random, 0.04);
        }
        pair.move(start, end);
        CcdScratch scratch;
        const PairHit hit = earliest_hit(pair.motion(0), pair.motion(1), {kSeparation}, {}, scratch);
        expect_same(hit, hit_of_all_features(pair.motion(0), pair.motion(1)));
        ++(hit.hit ? hits : misses);
        queries += scratch.counters.feature_queries;
        features += 2 * 12 * 162 + 2 * 8 * 320 + 18 * 480;
    }
    EXPECT_GE(hits, 5);
    EXPECT_GE(misses, 5);
    EXPECT_LT(20 * queries, features);
}

/// The queries of feature pairs, by their corners, are the same on every instruction set, and those of the copied
/// corners.
void expect_same_queries(const BodyMotion& a, const BodyMotion& b, FeatureKind kind,
                         const std::vector<FeaturePair>& features) {
    const CcdPoints points = ccd_points(a, b, kind);
    const CcdOptions options{kSeparation, CcdStart::relaxed};
    std::vector<CcdCorners> corners;
    for (const FeaturePair& f : features) corners.push_back(ccd_corners(a, b, f));
    std::vector<CcdResult> scalar(features.size()), wide(features.size());
    ccd_batch(ccd_kind(kind), points, corners, options, scalar, Isa::scalar);
    ccd_batch(ccd_kind(kind), points, corners, options, wide, best_isa());
    for (std::size_t i = 0; i < features.size(); ++i) {
        const CcdResult expected = ccd(ccd_kind(kind), ccd_query(a, b, features[i]), options);
        for (const CcdResult& r : {scalar[i], wide[i]}) {
            EXPECT_EQ(r.hit, expected.hit);
            EXPECT_EQ(r.toi, expected.toi);
            EXPECT_EQ(r.direction, expected.direction);
        }
    }
    for (const double distance : {0.02, 0.2}) {
        std::vector<std::int32_t> near(features.size() + 1), near_wide(features.size() + 1);
        const long n = near_by_planes(ccd_kind(kind), points, corners, distance, near.data(), Isa::scalar);
        ASSERT_EQ(near_by_planes(ccd_kind(kind), points, corners, distance, near_wide.data(), best_isa()), n);
        near.resize(static_cast<std::size_t>(n));
        near_wide.resize(static_cast<std::size_t>(n));
        EXPECT_EQ(near_wide, near);
        for (std::size_t i = 0; i < features.size(); ++i) {
            if (std::find(near.begin(), near.end(), static_cast<std::int32_t>(i)) != near.end()) continue;
            EXPECT_GT(closest_points(a, b, features[i], 0).distance_sq, distance * distance);
        }
    }
}

TEST(FeatureKernels, GiveTheSameListsAndSelectionsOnEveryInstructionSet) {
    std::size_t listed = 0, selected = 0;
    for (std::int64_t n = 0; n < 50; ++n) {
        Random random(3000 + n);
        Pair pair(random);
        std::array<Pose, 2> start, end;
        for (std::size_t i = 0; i < 2; ++i) {
            start[i] = make_pose(pair.model.shapes[i], i == 0 ? Vec3{} : Vec3{random.uniform(1.1, 2.2), 0, 0},
                                 random.rotation());
            end[i] = near(pair.model.shapes[i], start[i], random, 0.2);
        }
        pair.move(start, end);
        const ListingArrays a = listing_arrays(pair.motion(0)), b = listing_arrays(pair.motion(1));
        const auto list = [&](Isa isa) {
            const ListingReach reach{2e-4f, 0.02f, n % 2 == 0 ? 0x1p100f : 3.0f, 0.06f};
            ListingStack stack;
            stack.pairs[stack.size++] = {0, 0};
            std::vector<ListedFeature> out;
            while (stack.size > 0) {
                std::array<NodeIds, 5> leaves;
                const long found = open_node_pairs(a, b, reach, stack, leaves.data(), leaves.size(), isa);
                std::vector<ListedFeature> some(leaves.size() * 4 * kFeaturesPerTrianglePair + 1);
                some.resize(
                    static_cast<std::size_t>(list_features(a, b, reach, leaves.data(), found, some.data(), isa)));
                out.insert(out.end(), some.begin(), some.end());
            }
            return out;
        };
        const auto expected = list(Isa::scalar), wide = list(best_isa());
        ASSERT_EQ(wide.size(), expected.size());
        std::array<std::vector<FeatureIds>, 3> ids;
        for (std::size_t i = 0; i < wide.size(); ++i) {
            EXPECT_EQ(wide[i].ids.a, expected[i].ids.a);
            EXPECT_EQ(wide[i].ids.b, expected[i].ids.b);
            EXPECT_EQ(wide[i].kind, expected[i].kind);
            EXPECT_EQ(wide[i].distance, expected[i].distance);
            ids[static_cast<std::size_t>(wide[i].kind)].push_back(wide[i].ids);
        }
        listed += wide.size();
        for (const FeatureTest test : {FeatureTest::swept, FeatureTest::near})
            for (const FeatureKind kind :
                 {FeatureKind::vertex_face, FeatureKind::face_vertex, FeatureKind::edge_edge}) {
                const auto& some = ids[static_cast<std::size_t>(kind)];
                const auto select = [&](Isa isa) {
                    std::vector<FeaturePair> out(some.size() + 1);
                    out.resize(static_cast<std::size_t>(
                        select_features(test, kind, some.data(), static_cast<long>(some.size()), a.features, b.features,
                                        CoarseReach(0.01, 4), out.data(), isa)));
                    return out;
                };
                const auto kept = select(Isa::scalar);
                EXPECT_EQ(select(best_isa()), kept);
                selected += kept.size();
                expect_same_queries(pair.motion(0), pair.motion(1), kind, kept);
            }
    }
    EXPECT_GE(listed, 1000u);
    EXPECT_GE(selected, 100u);
}

TEST(CandidateList, ChangesNoAnswerOfAMotionThatItCovers) {
    int hits = 0, misses = 0, proximities = 0, uncovered = 0;
    std::size_t plain_size = 0, refined_size = 0; // of lists of bodies that hardly move
    for (std::int64_t n = 0; n < 400; ++n) {
        const bool refined = n % 2 != 0, slow = n % 4 >= 2;
        Random random(1000 + n);
        Pair pair(random);
        std::array<Pose, 2> start, end;
        for (std::size_t i = 0; i < 2; ++i) {
            start[i] = make_pose(pair.model.shapes[i], i == 0 ? Vec3{} : Vec3{random.uniform(1.1, 2.2), 0, 0},
                                 random.rotation());
            end[i] = near(pair.model.shapes[i], start[i], random, slow ? 0.01 : 0.2);
        }
        pair.move(start, end);
        CandidateList list;
        CcdScratch scratch;
        EXPECT_TRUE(list.empty());
        ASSERT_TRUE(list.build(pair.motion(0), pair.motion(1),
                               {swept_reach(kSeparation, pair.motion(0), pair.motion(1)), kProximity}, {0.02, 0.06},
                               refined, scratch.listing));
        if (slow) (refined ? refined_size : plain_size) += list.size();
        for (int k = 0; k < 10; ++k) {
            std::array<Pose, 2> start_k, end_k;
            for (std::size_t i = 0; i < 2; ++i) {
                start_k[i] = near(pair.model.shapes[i], start[i], random, 0.006);
                end_k[i] = near(pair.model.shapes[i], end[i], random, 0.018);
            }
            pair.move(start_k, end_k);
            const BodyMotion a = pair.motion(0), b = pair.motion(1);
            const CoveringList covering{&list, list.strayed(a, b)};
            if (!list.covers(covering.strayed)) {
                ++uncovered;
                continue;
            }
            const PairHit with = earliest_hit(a, b, {kSeparation}, covering, scratch);
            expect_same(with, earliest_hit(a, b, {kSeparation}, {}, scratch));
            ++(with.hit ? hits : misses);

            const BodyMotion at_a = pair.trajectories.at_end(0), at_b = pair.trajectories.at_end(1);
            ProximityScratch p, q;
            const auto near_with = find_proximities(at_a, at_b, kProximity, kAngleCos, covering, p);
            const auto near_without = find_proximities(at_a, at_b, kProximity, kAngleCos, {}, q);
            EXPECT_EQ(near_with.near, near_without.near);
            EXPECT_EQ(near_with.distance, near_without.distance);
            EXPECT_EQ(any_proximity(at_a, at_b, kProximity, covering, p), near_without.near);
            ASSERT_EQ(find_proximities(at_a, at_b, kProximity, kAngleCos, covering, p).near, near_without.near);
            ASSERT_EQ(p.found.size(), q.found.size());
            for (std::size_t i = 0; i < p.found.size(); ++i) {
                EXPECT_EQ(feature_key(p.found[i].features), feature_key(q.found[i].features));
                EXPECT_EQ(p.found[i].a, q.found[i].a);
                EXPECT_EQ(p.found[i].b, q.found[i].b);
            }
            proximities += static_cast<int>(p.found.size());
        }
    }
    EXPECT_LT(refined_size, plain_size / 2);
    EXPECT_GE(hits, 200);
    EXPECT_GE(misses, 200);
    EXPECT_GE(proximities, 500);
    EXPECT_GE(uncovered, 20);
}

/// The poles of two discs come near each other: every spoke of one is near every spoke of the other.
TEST(CandidateList, IsNotMadeOfFansWhosePairsGrowByTheSquare) {
    Random random(1);
    Pair pair(random);
    for (RigidShape& shape : pair.model.shapes) shape = make_shape(make_disc(1, 2000));
    const std::array<Pose, 2> poses{make_pose(pair.model.shapes[0], {}, {}),
                                    make_pose(pair.model.shapes[1], {0, 0, 0.01}, {})};
    pair.move(poses, poses);
    CandidateList list;
    CcdScratch scratch;
    EXPECT_FALSE(
        list.build(pair.motion(0), pair.motion(1), {kSeparation, kProximity}, {0.02, 0.06}, true, scratch.listing));
    EXPECT_TRUE(list.empty());
    EXPECT_LT(scratch.listing.found.size(), 2 * CandidateList::kMostListed); // 4 million edge pairs alone would be near
}

TEST(CandidateList, KnowsHowFarBodiesMayStillStrayBeforeAnythingIsNear) {
    int known = 0, near_beyond = 0;
    for (std::int64_t n = 0; n < 400; ++n) {
        Random random(9000 + n);
        Pair pair(random);
        std::array<Pose, 2> start;
        for (std::size_t i = 0; i < 2; ++i)
            start[i] = make_pose(pair.model.shapes[i], i == 0 ? Vec3{} : Vec3{random.uniform(1.2, 2.8), 0, 0},
                                 random.rotation());
        pair.move(start, start);
        CandidateList list;
        CcdScratch scratch;
        ASSERT_TRUE(list.build(pair.motion(0), pair.motion(1),
                               {swept_reach(kSeparation, pair.motion(0), pair.motion(1)), kProximity}, {0.06, 0.06},
                               n % 2 == 0, scratch.listing));
        for (int k = 0; k < 20; ++k) {
            std::array<Pose, 2> end;
            for (std::size_t i = 0; i < 2; ++i)
                end[i] = near(pair.model.shapes[i], start[i], random, k % 2 == 0 ? 0.003 : 0.03);
            pair.move(start, end);
            const BodyMotion a = pair.motion(0), b = pair.motion(1);
            const double strayed = list.strayed_at_end(a, b);
            ProximityScratch p;
            const bool is_near =
                any_proximity(pair.trajectories.at_end(0), pair.trajectories.at_end(1), kProximity, {}, p);
            if (list.room_at_end(strayed) > 0) {
                EXPECT_FALSE(is_near) << n;
                ++known;
            } else {
                near_beyond += is_near ? 1 : 0;
            }
        }
    }
    EXPECT_GE(known, 1000);
    EXPECT_GE(near_beyond, 100);
}

/// From anywhere to places nearby.
void move_anywhere(Pair& pair, Random& random, double size) {
    std::array<Pose, 2> from, to;
    for (std::size_t i = 0; i < 2; ++i) {
        from[i] = make_pose(pair.model.shapes[i], random.vec(2), random.rotation());
        to[i] = near(pair.model.shapes[i], from[i], random, size);
    }
    pair.move(from, to);
}

TEST(Displacement, OfTwoBodiesTogetherIsNoLessThanTheRelativeOne) {
    for (std::int64_t n = 0; n < 50; ++n) {
        Random random(7000 + n);
        Pair pair(random);
        move_anywhere(pair, random, n % 2 == 0 ? 0.01 : 1);
        const BodyMotion a = pair.motion(0), b = pair.motion(1);
        const double of_a = displacement(*a.shape, matrix_pose(a.at0), matrix_pose(a.at1));
        const double of_b = displacement(*b.shape, matrix_pose(b.at0), matrix_pose(b.at1));
        EXPECT_GE((of_a + of_b) * (1 + 1e-12), relative_displacement(*a.shape, matrix_pose(a.at0), matrix_pose(a.at1),
                                                                     *b.shape, matrix_pose(b.at0), matrix_pose(b.at1)));
        for (std::size_t i = 0; i < a.at0.x.size(); ++i)
            EXPECT_LE(max_component(abs(a.at1.x[i] - a.at0.x[i])), of_a * (1 + 1e-12));
        EXPECT_EQ(displacement(*a.shape, matrix_pose(a.at0), matrix_pose(a.at0)), 0);
    }
}

TEST(RelativeDisplacement, BoundsHowFarAnyGapChanges) {
    for (std::int64_t n = 0; n < 50; ++n) {
        Random random(5000 + n);
        Pair pair(random);
        move_anywhere(pair, random, n % 2 == 0 ? 0.01 : 1);
        const BodyMotion a = pair.motion(0), b = pair.motion(1);
        const double bound = relative_displacement(*a.shape, matrix_pose(a.at0), matrix_pose(a.at1), *b.shape,
                                                   matrix_pose(b.at0), matrix_pose(b.at1));
        double largest = 0;
        for (std::size_t i = 0; i < a.at0.x.size(); ++i)
            for (std::size_t j = 0; j < b.at0.x.size(); ++j)
                largest = std::max(largest, max_component(abs((b.at1.x[j] - a.at1.x[i]) - (b.at0.x[j] - a.at0.x[i]))));
        EXPECT_LE(largest, bound * (1 + 1e-12));
        EXPECT_GE(largest, 0.2 * bound);
    }
}

} // namespace
} // namespace flotilla
