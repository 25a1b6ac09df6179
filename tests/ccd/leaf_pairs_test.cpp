// SPDX-License-Identifier: MIT
// Leaf pairs with kept directions: what they leave out is apart, and no answer changes, however the ends move between
// queries.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/random.hpp"
#include "base/rotation.hpp"
#include "ccd/pair_query.hpp"
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

  private:
    std::int64_t seed_, count_ = 0;
};

RigidShape make_shape(TriangleMesh mesh) {
    RigidShape shape;
    shape.mesh = std::move(mesh);
    shape.topology = build_topology(shape.mesh);
    shape.bvh = build_bvh(shape.mesh);
    shape.box = bounding_box(shape.mesh);
    shape.radius = bounding_radius(shape.mesh, {});
    return shape;
}

/// One shell in another, nearer to it on one side than anywhere else: no plane keeps them apart. `place`: of both, m.
struct Shells {
    Model model;
    Trajectories trajectories;
    std::array<Pose, 2> start, end;

    Shells(Random& random, const Vec3& place) {
        model.shapes.push_back(make_shape(make_sphere(1.0, 2)));
        model.shapes.push_back(make_shape(make_sphere(0.93, 2)));
        model.bodies.resize(2);
        model.bodies[1].shape = 1;
        for (std::size_t i = 0; i < 2; ++i) {
            start[i] = make_pose(model.shapes[i], place + random.vec(i == 0 ? 0 : 0.012),
                                 normalized(rotation_from_vector(random.vec(3))));
            end[i] = moved(i, start[i], random, 0.02);
        }
        move(end);
    }
    Pose moved(std::size_t i, const Pose& pose, Random& random, double size) const {
        return make_pose(model.shapes[i], pose.com + random.vec(size),
                         normalized(rotation_from_vector(random.vec(size)) * pose.rotation));
    }
    void move(const std::array<Pose, 2>& to) {
        trajectories.start(model, start);
        for (std::size_t i = 0; i < 2; ++i) trajectories.set_end(i, to[i], {});
    }
    [[nodiscard]] BodyMotion motion(std::size_t i) const { return trajectories.motion(i); }
};

CandidateList list_of(const Shells& s, double margin) {
    CandidateList list;
    ListingScratch scratch;
    EXPECT_TRUE(list.build_of_leaves(
        s.motion(0), s.motion(1), {swept_reach(kSeparation, s.motion(0), s.motion(1)), kProximity}, margin, scratch));
    return list;
}

std::set<std::uint64_t> keys_of(std::span<const FeaturePair> features) {
    std::set<std::uint64_t> keys;
    for (const FeaturePair& f : features) keys.insert(feature_key(f));
    return keys;
}

template <class Call>
void for_all_features(const BodyMotion& a, const BodyMotion& b, const Call& call) {
    const auto count = [](const auto& items) { return static_cast<std::int32_t>(items.size()); };
    const auto each = [&](FeatureKind kind, std::int32_t of_a, std::int32_t of_b) {
        for (std::int32_t i = 0; i < of_a; ++i)
            for (std::int32_t j = 0; j < of_b; ++j) call(FeaturePair{kind, i, j});
    };
    each(FeatureKind::vertex_face, count(a.shape->mesh.vertices), count(b.shape->mesh.triangles));
    each(FeatureKind::face_vertex, count(a.shape->mesh.triangles), count(b.shape->mesh.vertices));
    each(FeatureKind::edge_edge, count(a.shape->topology.edges), count(b.shape->topology.edges));
}

Vec3 place_of(int n) { return n % 3 == 0 ? Vec3{} : n % 3 == 1 ? Vec3{3e3, -2e3, 1e3} : Vec3{-2e4, 1e4, 1e4}; }

TEST(LeafPairs, LeaveOutNothingThatHitsOrIsNear) {
    int selected = 0, near = 0;
    for (int n = 0; n < 3; ++n) {
        Random random(100 + n);
        Shells s(random, place_of(n));
        const CandidateList list = list_of(s, 0.1);
        FeatureBuffer buffer;
        for (int k = 0; k < 3; ++k) {
            std::array<Pose, 2> to;
            for (std::size_t i = 0; i < 2; ++i) to[i] = s.moved(i, s.end[i], random, 0.03);
            s.move(to);
            const BodyMotion a = s.motion(0), b = s.motion(1);
            const double largest = std::max(a.max_abs(), b.max_abs());
            const auto swept = keys_of(list.select(FeatureTest::swept, a, b, list.strayed(a, b),
                                                   CoarseReach(swept_reach(kSeparation, a, b), largest), buffer));
            const auto at_end =
                keys_of(list.select(FeatureTest::near, s.trajectories.at_end(0), s.trajectories.at_end(1),
                                    {0, list.strayed_at_end(a, b)}, CoarseReach(kProximity, largest), buffer));
            for_all_features(a, b, [&](const FeaturePair& f) {
                const std::uint64_t key = feature_key(f);
                if (closest_points(a, b, f, 1).distance_sq < kProximity * kProximity) {
                    ++near;
                    EXPECT_TRUE(at_end.contains(key));
                }
                if (swept.contains(key)) return;
                EXPECT_FALSE(ccd(ccd_kind(f.kind), ccd_query(a, b, f), {kSeparation, CcdStart::relaxed}).hit);
            });
            selected += static_cast<int>(swept.size());
        }
    }
    EXPECT_GE(near, 100);
    EXPECT_GE(selected, 100);
}

TEST(LeafPairs, ChangeNoAnswerHoweverTheEndsMove) {
    int hits = 0, misses = 0, proximities = 0;
    for (int n = 0; n < 24; ++n) {
        Random random(1000 + n);
        Shells s(random, place_of(n));
        const CandidateList list = list_of(s, 0.1);
        CcdScratch with_list, without;
        for (int k = 0; k < 20; ++k) {
            std::array<Pose, 2> to;
            for (std::size_t i = 0; i < 2; ++i)
                to[i] = s.moved(i, k % 2 == 0 ? s.start[i] : s.end[i], random, k % 2 == 0 ? 0.005 : 0.02);
            s.move(to);
            const BodyMotion a = s.motion(0), b = s.motion(1);
            const CoveringList covering{&list, list.strayed(a, b)};
            if (!list.covers(covering.strayed)) continue;
            const PairHit hit = earliest_hit(a, b, {kSeparation}, covering, with_list),
                          expected = earliest_hit(a, b, {kSeparation}, {}, without);
            EXPECT_EQ(hit.hit, expected.hit);
            EXPECT_EQ(hit.toi, expected.toi);
            EXPECT_EQ(hit.normal, expected.normal);
            EXPECT_EQ(feature_key(hit.features), feature_key(expected.features));
            ++(hit.hit ? hits : misses);
            const BodyMotion at_a = s.trajectories.at_end(0), at_b = s.trajectories.at_end(1);
            ProximityScratch p, q;
            const auto near = find_proximities(at_a, at_b, kProximity, kAngleCos, covering, p);
            const auto near_expected = find_proximities(at_a, at_b, kProximity, kAngleCos, {}, q);
            EXPECT_EQ(near.near, near_expected.near);
            EXPECT_EQ(near.distance, near_expected.distance);
            ASSERT_EQ(p.found.size(), q.found.size());
            for (std::size_t i = 0; i < p.found.size(); ++i)
                EXPECT_EQ(feature_key(p.found[i].features), feature_key(q.found[i].features));
            EXPECT_EQ(p.counters.proximities, q.counters.proximities);
            proximities += static_cast<int>(p.found.size());
        }
    }
    EXPECT_GE(hits, 50);
    EXPECT_GE(misses, 50);
    EXPECT_GE(proximities, 500);
}

TEST(LeafPairs, KeepDirectionsThatLeaveLittleToLookAt) {
    Random random(7);
    std::size_t by_boxes = 0, selected = 0;
    for (int n = 0; n < 10; ++n) {
        Shells s(random, {});
        for (std::size_t i = 0; i < 2; ++i) s.end[i] = s.moved(i, s.start[i], random, 0.02);
        s.move(s.end);
        const BodyMotion a = s.motion(0), b = s.motion(1);
        CandidateList leaves = list_of(s, 0.1), features;
        CcdScratch scratch;
        ASSERT_TRUE(
            features.build(a, b, {swept_reach(kSeparation, a, b), kProximity}, {0, 0.1}, false, scratch.listing));
        const CoarseReach reach(swept_reach(kSeparation, a, b), std::max(a.max_abs(), b.max_abs()));
        FeatureBuffer buffer;
        by_boxes += features.select(FeatureTest::swept, a, b, {}, reach, buffer).size();
        selected += leaves.select(FeatureTest::swept, a, b, {}, reach, buffer).size();
    }
    EXPECT_GT(by_boxes, 1000u);
    EXPECT_LT(selected, by_boxes / 2);
}

TEST(LeafPairs, AreTheSameForWideKernels) {
    Random random(11);
    const Shells s(random, {});
    const BodyMotion a = s.motion(0), b = s.motion(1);
    const ListingArrays arrays_a = listing_arrays(a), arrays_b = listing_arrays(b);
    ListingStack stack;
    stack.pairs[stack.size++] = {0, 0};
    std::vector<NodeIds> leaves(1 << 14);
    const long n = open_node_pairs(arrays_a, arrays_b, {0.1f, 0.1f, 1, 0}, stack, leaves.data(), 1 << 14, Isa::scalar);
    ASSERT_GE(n, 100);
    const auto meeting = [&](Isa isa) {
        std::vector<std::int32_t> out(static_cast<std::size_t>(n) + 1);
        out.resize(
            static_cast<std::size_t>(meeting_leaves(arrays_a, arrays_b, 0.02f, leaves.data(), n, out.data(), isa)));
        return out;
    };
    EXPECT_EQ(meeting(best_isa()), meeting(Isa::scalar));
    EXPECT_LT(meeting(Isa::scalar).size(), static_cast<std::size_t>(n));
    const auto selected = [&](Isa isa) {
        const auto room = static_cast<std::size_t>(4 * n);
        std::vector<FeaturePair> out(15 * room + 3);
        SelectedFeatures to{{out.data(), out.data() + 3 * room + 1, out.data() + 6 * room + 2}, {}};
        select_leaf_features(arrays_a, arrays_b, 0.02f, leaves.data(), n, to, isa);
        std::vector<std::uint64_t> keys;
        for (std::size_t k = 0; k < 3; ++k)
            for (long i = 0; i < to.count[k]; ++i) keys.push_back(feature_key(to.out[k][i]));
        return keys;
    };
    EXPECT_EQ(selected(best_isa()), selected(Isa::scalar));
    EXPECT_GE(selected(Isa::scalar).size(), 100u);
}

} // namespace
} // namespace flotilla
