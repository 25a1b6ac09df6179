// SPDX-License-Identifier: MIT
// Runs that are edited on the way: the promises hold, and a snapshot of any step goes on with the same bits.
#include <algorithm>

#include "run/edited_runs.hpp"

namespace flotilla::test {
namespace {

TEST(EditedRuns, KeepEveryBodyApartThroughRandomEdits) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const EditedRunCounts counts = run_edited(seed, 400, 3);
        EXPECT_GT(counts.made, 200);
        EXPECT_GT(counts.refused, 40);
        EXPECT_EQ(counts.balanced < counts.steps, seed % 2 == 0) << "work is done in every other run alone";
    }
}

TEST(EditedRuns, ResumeFromAnyStepWithTheSameBitsAtOtherThreadCounts) {
    constexpr int kSteps = 60;
    World world(tub(), "scene", {2});
    RandomEdits edits(9, 2.4, 4, 24);
    Ignored ignored;
    std::vector<Edit> made;
    std::vector<std::vector<std::byte>> snapshots; // after the edits, before the step
    std::vector<std::vector<ContactState>> contacts;
    std::vector<std::uint64_t> hashes;
    std::vector<std::size_t> edits_before;
    std::vector<bool> after_failsafe{false};
    for (int step = 0; step < kSteps; ++step) {
        for (int k = 0; k < 2; ++k) edit_once(world, edits, ignored, &made);
        edits_before.push_back(made.size());
        snapshots.push_back(world.snapshot());
        contacts.push_back(world.contacts());
        const StepReport report = world.step();
        after_failsafe.push_back(report.merges + report.held > 0);
        hashes.push_back(report.state_hash);
        ASSERT_EQ(hashes.back(), world.state_hash());
    }
    ASSERT_GT(made.size(), 60u);
    ASSERT_GT(std::ranges::count(after_failsafe, true), 0);
    for (std::size_t from = 0; from < kSteps; ++from) {
        if (from % 7 != 0 && !after_failsafe[from]) continue;
        World resumed(tub(), snapshots[from], "scene", {1 + static_cast<int>(from % 3)});
        ASSERT_TRUE(resumed.snapshot() == snapshots[from]);
        ASSERT_EQ(resumed.contacts(), contacts[from]);
        std::size_t next = edits_before[from];
        for (std::size_t step = from; step < std::min<std::size_t>(from + 15, kSteps); ++step) {
            for (; next < edits_before[step]; ++next) resumed.apply(made[next]);
            ASSERT_EQ(resumed.step().state_hash, hashes[step]) << "from " << from << ", step " << step;
        }
    }
    // The list of edits alone says it all.
    World repeated(tub(), "scene", {3});
    std::size_t next = 0;
    for (std::size_t step = 0; step < kSteps; ++step) {
        for (; next < edits_before[step]; ++next) repeated.apply(made[next]);
        ASSERT_EQ(repeated.step().state_hash, hashes[step]) << step;
    }
    // Back and on again in place.
    repeated.restore(snapshots[3]);
    EXPECT_EQ(repeated.step().state_hash, hashes[3]);
    repeated.restore(snapshots[40]);
    EXPECT_EQ(repeated.step().state_hash, hashes[40]);
    World start(tub(), "scene", {1});
    const std::vector<std::byte> unedited = start.snapshot();
    const std::uint64_t first = start.step().state_hash;
    repeated.restore(unedited);
    EXPECT_EQ(repeated.step().state_hash, first);
    EXPECT_EQ(repeated.num_bodies(), tub().bodies.size());
}

// The heap is thrown from wall to wall: no step may gain energy of that step's gravity.
TEST(EditedRuns, KeepEveryPromiseWhileGravityTurnsInEveryStep) {
    for (const double g : {9.8, 98.0, 9.8e4}) {
        SceneDescription closed = tub();
        BodyDescription lid = closed.bodies[0];
        lid.name = "lid";
        lid.position.z = 4;
        closed.bodies.push_back(lid);
        AuditedWorld w(closed, {1});
        World three(closed, "scene", {3});
        Random random(17);
        for (int step = 0; step < 40; ++step) {
            const Vec3 direction = random.vec(1);
            const Vec3 gravity = (g / std::max(length(direction), 0.1)) * direction;
            w.world.set_gravity(gravity);
            three.set_gravity(gravity);
            const double before = w.world.energy(), lift = most_lift(w.world);
            StepReport report;
            ASSERT_EQ(w.step(&report), "") << g << ", step " << step;
            ASSERT_LE(report.energy, before + lift + 1e-9 * (1 + std::abs(before))) << g << ", step " << step;
            ASSERT_EQ(three.step().state_hash, report.state_hash) << g << ", step " << step;
        }
    }
}

// What an edit wakes goes by where bodies are: not by what was asked for before.
TEST(EditedRuns, QuestionsBetweenEditsOfOneStepChangeNothing) {
    World world(tub(), "scene", {1});
    StepReport report;
    for (int step = 0; step < 400 && report.sleeping < 12; ++step) report = world.step();
    ASSERT_EQ(report.sleeping, 12) << "all at rest";
    const std::vector<std::byte> rest = world.snapshot();
    std::uint64_t hashes[2] = {};
    for (const bool asked : {false, true}) {
        world.restore(rest);
        const BodyId lowest = world.find("body5");
        BodyDescription above;
        above.shape = 1;
        above.position = world.body(static_cast<std::size_t>(lowest.index)).position;
        for (above.position.z += 0.39; !world.overlapping(1, above.position, {}).empty();) above.position.z += 0.001;
        const BodyId added = world.add_body(above);
        if (asked) ASSERT_FALSE(world.contacts_of(added).contacts.empty()) << "near enough to count";
        world.remove_body(added);
        for (int step = 0; step < 5; ++step) hashes[asked ? 1 : 0] = world.step().state_hash;
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(EditedRuns, HaveTheSameBitsWhateverIsAskedBetweenRandomEdits) {
    for (std::uint64_t seed = 40; seed < 46; ++seed) {
        World quiet(tub(), "scene", {1}), asked(tub(), "scene", {1});
        RandomEdits edits(seed, 2.4, 4, 24);
        Ignored ignored;
        for (int step = 0; step < 120; ++step) {
            std::vector<Edit> made;
            for (int k = 0; step % 3 == 0 && k < 6; ++k) edit_once(quiet, edits, ignored, &made);
            for (const Edit& edit : made) {
                asked.apply(edit);
                (void)asked.contacts();
                if (step % 2 == 0) asked.restore(asked.snapshot());
            }
            const std::uint64_t hash = quiet.step().state_hash;
            ASSERT_EQ(asked.step().state_hash, hash) << "seed " << seed << ", step " << step;
        }
    }
}

TEST(EditedRuns, ClonesGoOnAlike) {
    World world(tub(), "scene", {1});
    RandomEdits edits(11, 2.4, 4, 24);
    Ignored ignored;
    for (int step = 0; step < 20; ++step) {
        edit_once(world, edits, ignored, nullptr);
        (void)world.step();
    }
    edit_once(world, edits, ignored, nullptr);
    World clone = world.clone({3});
    for (int step = 0; step < 20; ++step) ASSERT_EQ(clone.step().state_hash, world.step().state_hash) << step;
}

TEST(EditedRuns, DamagedSnapshotsAreRefused) {
    World world(tub(), "scene", {1});
    RandomEdits edits(5, 2.4, 4, 24);
    Ignored ignored;
    for (int k = 0; k < 10; ++k) edit_once(world, edits, ignored, nullptr);
    (void)world.step();
    const std::vector<std::byte> good = world.snapshot();
    const std::uint64_t hash = world.state_hash();
    Random random(3);
    for (int k = 0; k < 300; ++k) {
        std::vector<std::byte> bad = good;
        if (k % 3 == 0)
            bad.resize(random.below(bad.size()));
        else
            bad[random.below(bad.size())] ^= static_cast<std::byte>(1 + random.below(255));
        EXPECT_THROW(world.restore(bad), InputError) << k;
        ASSERT_EQ(world.state_hash(), hash) << k;
    }
}

// Shapes of the scene are not written; one that another scene does not have tells that it is another.
TEST(EditedRuns, SnapshotsOfScenesWithMoreShapesAreNamedSo) {
    SceneDescription scene = tub(), fewer = tub();
    const std::int32_t shape = scenario::add_shape(scene, make_box(0.2, 0.2, 0.2), 1);
    World world(scene, "scene", {1}), other(fewer, "scene", {1});
    BodyDescription body;
    body.name = "late", body.shape = shape, body.position = {0, 0, 50};
    (void)world.add_body(body);
    (void)world.step();
    try {
        other.restore(world.snapshot());
        FAIL() << "it was taken";
    } catch (const InputError& e) {
        EXPECT_STREQ(e.what(), "snapshot of another scene or other settings");
    }
}

} // namespace
} // namespace flotilla::test
