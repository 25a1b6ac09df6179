// SPDX-License-Identifier: MIT
// A World made from a snapshot goes on with the bits of the one that it was taken from (G3).
#include <cmath>
#include <cstring>

#include <flotilla/error.hpp>

#include "scene/scene.hpp"
#include "state/build_model.hpp"
#include "state/feature_pair.hpp"
#include "state/snapshot.hpp"
#include "step/scenario.hpp"
#include "step/thread_scenes.hpp"

namespace flotilla::scenario {
namespace {

/// Two boxes.
SceneDescription two_boxes() {
    SceneDescription scene = empty_scene();
    const auto box = add_shape(scene, make_box(1, 1, 1), 1);
    add_body(scene, box, BodyType::dynamic, {});
    add_body(scene, box, BodyType::dynamic, {3, 0, 0});
    return scene;
}

class Snapshot : public testing::TestWithParam<ThreadScene> {};

TEST_P(Snapshot, GoesOnWithTheSameBits) {
    const SceneDescription scene = GetParam().make(false);
    const int steps = GetParam().fast_steps;
    World whole(scene);
    std::vector<std::uint64_t> expected;
    std::vector<std::vector<std::byte>> snapshots{whole.snapshot()};
    for (int n = 0; n < steps; ++n) {
        expected.push_back(whole.step().state_hash);
        snapshots.push_back(whole.snapshot());
    }
    for (const int from : {0, 1, steps / 3, 2 * steps / 3, steps - 1}) {
        World rest(scene, snapshots[static_cast<std::size_t>(from)], "scene", {1 + from % 3});
        EXPECT_EQ(rest.steps(), from);
        for (int n = from; n < steps; ++n)
            ASSERT_EQ(rest.step().state_hash, expected[static_cast<std::size_t>(n)])
                << "from " << from << ", step " << n;
        EXPECT_EQ(rest.snapshot(), whole.snapshot());
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Snapshot, testing::ValuesIn(thread_scenes()),
                         [](const auto& scene) { return std::string(scene.param.name); });

/// A lid that moves by keyframes and is held for some steps: its clock is part of the state.
TEST(SnapshotOf, ADelayedScriptGoesOnWithTheSameBits) {
    SceneDescription scene = empty_scene();
    const auto crate = add_shape(scene, make_box(0.5, 0.5, 0.5), 20);
    const auto plate = add_shape(scene, make_box(3, 3, 0.1));
    add_body(scene, plate, BodyType::fixed, {0, 0, -0.1});
    add_body(scene, crate, BodyType::dynamic, {0, 0, 0.51});
    auto& lid = add_body(scene, plate, BodyType::kinematic, {0, 0, 3});
    lid.keyframes = {{0, {0, 0, 3}, {}}, {1, {0, 0, 0}, {}}, {2, {0, 0, 3}, {}}};
    World whole(scene);
    std::vector<std::byte> middle;
    bool delayed = false;
    for (int n = 0; n < 40; ++n) {
        if (n == 22) middle = whole.snapshot();
        const StepReport r = whole.step();
        delayed = delayed || (n < 22 && (r.warnings & kScriptDelayed) != 0);
    }
    ASSERT_TRUE(delayed);
    World rest(scene, middle);
    for (int n = 22; n < 40; ++n) rest.step();
    EXPECT_EQ(rest.state_hash(), whole.state_hash());
}

/// Small cubes look for contacts ahead among pairs near each other; those of bodies that fell asleep are not among
/// them, or the step in which these wake would depend on more than the state.
TEST(SnapshotOf, SmallBodiesThatWakeGoOnWithTheSameBits) {
    constexpr double kEdge = 0.01;
    SceneDescription scene = empty_scene();
    scene.settings.sleeping = true;
    const auto cube = add_shape(scene, make_box(kEdge, kEdge, kEdge), 1);
    const double low = 0.5 * kEdge + 5.3e-5;
    add_body(scene, cube, BodyType::dynamic, {-0.5, 0.3, low}, 0).velocity = {1, 0, 0}; // never sleeps
    add_body(scene, cube, BodyType::dynamic, {0.0102, 0, 1.3}, 0.4).rotation = rotation_from_vector({0.5, 0, 0});
    add_body(scene, cube, BodyType::dynamic, {0, 0, low}, 0.4);
    add_body(scene, add_shape(scene, make_plate(4, 4)), BodyType::fixed, {}, 0.4);
    World whole(scene);
    std::int64_t slept = 0, woken = 0, sleeping = 0;
    for (int n = 0; n < 30; ++n) {
        World rest(scene, whole.snapshot());
        const StepReport r = whole.step();
        ASSERT_EQ(rest.step().state_hash, r.state_hash) << "step " << n;
        slept += std::max<std::int64_t>(r.sleeping - sleeping, 0);
        woken += std::max<std::int64_t>(sleeping - r.sleeping, 0);
        sleeping = r.sleeping;
    }
    EXPECT_GT(slept, 0);
    EXPECT_GT(woken, 0);
}

TEST(SnapshotOf, WhatIsNoStateOfTheSceneIsRefusedThoughItsHashFits) {
    const Scene scene = build_scene(two_boxes());
    const Model model = make_model(scene);
    const State good = initial_state(scene, model);
    const auto message = [&](auto&& change) -> std::string {
        State state = good;
        change(state);
        try {
            (void)read_snapshot(write_snapshot(state, 7), 7, model);
            return "none";
        } catch (const InputError& error) {
            return error.what();
        }
    };
    const std::string sizes = "damaged snapshot: its arrays do not fit the scene";
    const std::string content = "damaged snapshot: its content is no state of the scene";
    EXPECT_EQ(message([](State&) {}), "none");
    EXPECT_EQ(message([](State& s) { s.lift.push_back(0); }), sizes);
    EXPECT_EQ(message([](State& s) { s.searched.resize(7); }), sizes);
    EXPECT_EQ(message([](State& s) { s.pose[0].com.x = std::nan(""); }), content);
    EXPECT_EQ(message([](State& s) { s.motion[1].momentum.z = HUGE_VAL; }), content);
    EXPECT_EQ(message([](State& s) { s.motion[1].velocity.z = 1e200; }), content);
    EXPECT_EQ(message([](State& s) { s.sleep[0].island = 2; }), content);
    EXPECT_EQ(message([](State& s) { s.rest_distances = {{0, 2, 0.1}}; }), content);
    EXPECT_EQ(message([](State& s) { s.squeezed = {{0, 1, 0.1, -3, 4}}; }), "none");
    EXPECT_EQ(message([](State& s) { s.squeezed = {{0, 2, 0.1, 3, 0}}; }), content);
    EXPECT_EQ(message([](State& s) { s.squeezed = {{0, 1, 0.1, 3, -1}}; }), content);
    EXPECT_EQ(message([](State& s) { s.squeezed = {{0, 1, HUGE_VAL, 3, 0}}; }), content);
    EXPECT_EQ(message([](State& s) { s.squeezed = {{0, 1, 0.1, INT32_MAX, 0}}; }), content);
    EXPECT_EQ(message([](State& s) { s.squeezed = {{0, 1, 0.1, INT32_MIN, 0}}; }), content);
    EXPECT_EQ(message([](State& s) { s.squeezed = {{0, 1, 0.1, 3, INT32_MAX}}; }), content);
    EXPECT_EQ(message([](State& s) { s.warm[ContactStage::kept] = {{1, 0, 3, {}}}; }), content);
    EXPECT_EQ(message([](State& s) { s.waiting[ContactStage::final] = {{0, 1, 3, {0, 0, std::nan("")}}}; }), content);
    EXPECT_EQ(message([](State& s) { s.earlier = {{1, 0, 3, {}}}; }), content);
    // Impulses at features: boxes have 8 vertices, 12 triangles and 18 edges.
    const auto of_features = [&](const FeaturePair& f) {
        return message([&](State& s) { s.warm[ContactStage::final] = {{0, 1, feature_key(f), {}}}; });
    };
    EXPECT_EQ(of_features({FeatureKind::vertex_face, 7, 11}), "none");
    EXPECT_EQ(of_features({FeatureKind::vertex_face, 8, 11}), content);
    EXPECT_EQ(of_features({FeatureKind::vertex_face, 7, 12}), content);
    EXPECT_EQ(of_features({FeatureKind::face_vertex, 11, 7}), "none");
    EXPECT_EQ(of_features({FeatureKind::face_vertex, 12, 7}), content);
    EXPECT_EQ(of_features({FeatureKind::face_vertex, 11, 8}), content);
    EXPECT_EQ(of_features({FeatureKind::edge_edge, 17, 17}), "none");
    EXPECT_EQ(of_features({FeatureKind::edge_edge, 17, 18}), content);
    EXPECT_EQ(message([](State& s) { s.waiting[ContactStage::half] = {{0, 1, std::uint64_t{3} << 62, {}}}; }), content);
}

TEST(SnapshotOf, AnotherSceneOrDamageIsRefused) {
    const SceneDescription scene = forced_stack(false);
    World world(scene);
    world.step();
    const std::vector<std::byte> snapshot = world.snapshot();
    const auto message = [](const SceneDescription& of, const std::vector<std::byte>& bytes) -> std::string {
        try {
            World(of, bytes);
        } catch (const InputError& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_EQ(message(scene, snapshot), "");
    SceneDescription other = scene;
    other.settings.friction += 0.1;
    EXPECT_EQ(message(other, snapshot), "snapshot of another scene or other settings");
    other = scene;
    other.bodies[1].position.x += 1e-9;
    EXPECT_EQ(message(other, snapshot), "snapshot of another scene or other settings");
    EXPECT_EQ(message(scene, {}), "no snapshot");
    std::vector<std::byte> bad = snapshot;
    bad[0] ^= std::byte{1};
    EXPECT_EQ(message(scene, bad), "no snapshot");
    for (const std::size_t size : {std::size_t{24}, snapshot.size() / 2, snapshot.size() - 1}) {
        bad = snapshot;
        bad.resize(size);
        EXPECT_EQ(message(scene, bad), "damaged snapshot: its arrays do not fit its size") << size;
    }
    bad = snapshot;
    bad.push_back(std::byte{});
    EXPECT_EQ(message(scene, bad), "damaged snapshot: its arrays do not fit its size");
    for (std::size_t at = 24; at < snapshot.size(); at += 97) { // behind magic, version and scene
        bad = snapshot;
        bad[at] ^= std::byte{4};
        EXPECT_TRUE(message(scene, bad).starts_with("damaged snapshot: ")) << at << ": " << message(scene, bad);
    }
    bad = snapshot;
    const std::uint64_t huge = ~std::uint64_t{0};
    std::memcpy(bad.data() + 40, &huge, sizeof huge); // the number of poses
    EXPECT_EQ(message(scene, bad), "damaged snapshot: its arrays do not fit its size");
}

} // namespace
} // namespace flotilla::scenario
