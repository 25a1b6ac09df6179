// SPDX-License-Identifier: MIT
// What verify_run proves of edited runs: motions from where edits put bodies, of those too that go by a script from
// there.
#include <functional>

#include <gtest/gtest.h>

#include <flotilla/run.hpp>
#include <flotilla/verify.hpp>

#include "mesh/primitives.hpp"
#include "run_folder/run_folder.hpp"
#include "step/scene_parts.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla::test {
namespace {

constexpr std::int64_t kEdited = 5, kSteps = 8; // steps

/// Two plates, without gravity: one that floats, and a lid high above that moves by a script or is yet to come.
SceneDescription floating_plate(bool with_lid) {
    SceneDescription scene = scenario::empty_scene();
    scene.gravity = {};
    const std::int32_t plate = scenario::add_shape(scene, make_plate(1, 1), 1);
    scenario::add_body(scene, plate, BodyType::dynamic, {}).name = "plate";
    if (!with_lid) return scene;
    BodyDescription& lid = scenario::add_body(scene, plate, BodyType::kinematic, {0, 0, 4});
    lid.name = "lid";
    lid.keyframes = {{0, {0, 0, 4}, {}}};
    return scene;
}

/// Where it is when it comes, between two keyframes, is written nowhere.
BodyDescription moving_lid() {
    BodyDescription lid;
    lid.name = "lid";
    lid.type = BodyType::kinematic;
    lid.keyframes = {{0, {0, 0, 4}, {}}, {1, {0, 0, 2}, {0.8, 0, 0, 0.6}}};
    lid.position = {0, 0, 4};
    return lid;
}

struct Case {
    const char* name;
    bool lid_in_scene;
    std::function<std::vector<Edit>()> edits;
};

const std::vector<Keyframe> kElsewhere{{1, {0, 0, 3}, {}}};

class VerifiedEdits : public testing::TestWithParam<Case> {
  protected:
    VerifiedEdits() {
        RunOptions options;
        options.output = folder_.path() / "clean";
        options.steps = kSteps;
        options.edits = GetParam().edits();
        (void)run_scene(floating_plate(GetParam().lid_in_scene), "scene", options);
    }
    /// A copy of the run with the lid elsewhere in the frame after the edit.
    [[nodiscard]] VerifyReport with_lid_at(const Vec3& position) const {
        io::RunReader reader(folder_.path() / "clean");
        io::RunInfo info = reader.info();
        info.scene_json = "{}";
        const std::filesystem::path folder = folder_.path() / "planted";
        io::RunWriter writer(folder, info, reader.scene(), io::OpenRun::overwrite);
        for (std::int64_t k = 0; k < reader.frames(); ++k) {
            io::Frame f = reader.frame(k);
            if (k > kEdited) f.position[1] = position;
            writer.add_frame(
                {f.step, f.time, f.position, f.rotation, f.velocity, f.angular_velocity, {}, f.activity.view()});
        }
        writer.close("complete");
        return verify_run(folder);
    }
    TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(
    Scripts, VerifiedEdits,
    testing::Values(Case{"Added", false,
                         [] {
                             return std::vector<Edit>{{kEdited, edits::AddBody{moving_lid()}}};
                         }},
                    Case{"AddedWithAnotherScript", false,
                         [] {
                             return std::vector<Edit>{{kEdited, edits::AddBody{moving_lid()}},
                                                      {kEdited, edits::SetScript{{1, 0}, kElsewhere}}};
                         }},
                    Case{"ChangedScript", true,
                         [] {
                             return std::vector<Edit>{{kEdited, edits::SetScript{{1, 0}, kElsewhere}}};
                         }},
                    Case{"MadeKinematic", true,
                         [] {
                             return std::vector<Edit>{{1, edits::SetType{{1, 0}, BodyType::fixed}},
                                                      {kEdited, edits::SetScript{{1, 0}, kElsewhere}}};
                         }}),
    [](const auto& c) { return std::string(c.param.name); });

TEST_P(VerifiedEdits, FindAScriptedBodyThatPassesThroughAnotherInItsFirstStep) {
    const VerifyReport clean = verify_run(folder_.path() / "clean");
    EXPECT_TRUE(clean.proved());
    EXPECT_EQ(clean.motions, kSteps);
    const VerifyReport planted = with_lid_at({0, 0, -1}); // beyond the plate, which has not moved
    EXPECT_EQ(planted.intersecting_pairs, 0) << "no frame has the lid in the plate";
    ASSERT_EQ(planted.crossing_pairs, 1);
    EXPECT_EQ(planted.faults.front().kind, VerifyFault::Kind::crossing);
    EXPECT_EQ(planted.faults.front().frame, kEdited);
    EXPECT_EQ(planted.faults.front().name_b, "lid");
}

TEST_P(VerifiedEdits, StartWhereTheScriptIsWhenTheBodyComes) {
    // Just above the plate: from there it passes nothing, whatever it is thought to come from above.
    EXPECT_TRUE(with_lid_at({0, 0, 0.1}).proved());
}

} // namespace
} // namespace flotilla::test
