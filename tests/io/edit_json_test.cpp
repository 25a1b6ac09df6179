// SPDX-License-Identifier: MIT
// Files of edits: what they hold comes back to the same bits, and what is wrong in them is named at its place.
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <flotilla/edit_file.hpp>

#include "run/edited_runs.hpp"

namespace flotilla::test {
namespace {

using testing::HasSubstr, testing::Not;

std::string problems(const std::string& edits) {
    try {
        (void)parse_edits("{\"flotilla_edits\": 1, \"edits\": [" + edits + "]}", "file", {}, tub());
    } catch (const InputError& e) {
        return e.what();
    }
    return "";
}

TEST(EditFile, WhatAWorldRecordedIsReadBackToTheSameBits) {
    World world(tub(), "scene", {1});
    world.record_edits(true);
    ShapeDescription another = tub().shapes[1];
    another.name = ""; // the World gives it one
    world.add_shape(another);
    another.name = "passing";
    world.remove_shape(world.add_shape(another));
    another.name = "";
    world.add_shape(another); // at its number
    RandomEdits edits(21, 2.4, 4, 24);
    Ignored ignored;
    std::vector<std::uint64_t> hashes;
    for (int step = 0; step < 80; ++step) {
        for (int k = 0; k < 2; ++k) edit_once(world, edits, ignored, nullptr);
        hashes.push_back(world.step().state_hash);
    }
    std::ostringstream text;
    write_edits(text, world.recorded_edits(), tub());
    const std::vector<Edit> read = parse_edits(text.str(), "recorded", {}, tub());
    ASSERT_EQ(read.size(), world.recorded_edits().size());
    World again(tub(), "scene", {2});
    std::size_t next = 0;
    for (int step = 0; step < 80; ++step) {
        for (; next < read.size() && read[next].step == step; ++next) again.apply(read[next]);
        ASSERT_EQ(again.step().state_hash, hashes[static_cast<std::size_t>(step)]) << step;
    }
}

TEST(EditFile, EditsKnowTheirPlaces) {
    const std::vector<Edit> edits =
        parse_edits(R"({"flotilla_edits": 1.0, "edits": [{"step": 9, "wake": "body5"}, {"step": 2, "wake": "body6"}]})",
                    "file", {}, tub());
    ASSERT_EQ(edits.size(), 2u);
    EXPECT_EQ(edits[0].place, "file: /edits/1");
    EXPECT_EQ(edits[1].place, "file: /edits/0");
}

TEST(EditFile, ProblemsAreNamedAtTheirPlaces) {
    EXPECT_EQ(problems("{\"step\": 3, \"remove_body\": \"body5\"}"), "");
    EXPECT_THAT(problems("{\"remove_body\": \"body5\"}"), HasSubstr("file: /edits/0/step: is missing"));
    EXPECT_THAT(problems("{\"step\": -1, \"remove_body\": \"body5\"}"),
                HasSubstr("/edits/0/step: must be a whole number"));
    EXPECT_THAT(problems("{\"step\": 0, \"remove_shape\": \"none\"}"), HasSubstr("unknown shape \"none\""));
    EXPECT_THAT(problems("{\"step\": 0, \"remove_body\": \"bidy5\"}"), HasSubstr("unknown body \"bidy5\""));
    EXPECT_THAT(problems("{\"step\": 0}"), HasSubstr("/edits/0: holds no edit"));
    EXPECT_THAT(problems("{\"step\": 0, \"remove\": 1}"), HasSubstr("/edits/0/remove: unknown key"));
    EXPECT_THAT(problems("{\"step\": 0, \"wake\": \"body5\", \"remove_body\": \"body5\"}"), HasSubstr("one edit"));
    EXPECT_THAT(problems("{\"step\": 0, \"set_pose\": {\"body\": \"body5\", \"pos\": [0,0,0]}}"),
                HasSubstr("/edits/0/set_pose/pos: unknown key"));
    EXPECT_THAT(problems("{\"step\": 0, \"set_gravity\": [0, 0]}"), HasSubstr("must be an array of 3 numbers"));
    EXPECT_THAT(problems("{\"step\": 0, \"add_body\": {\"name\": \"x\", \"shape\": \"nobody\"}}"),
                HasSubstr("/edits/0/add_body/shape: unknown shape"));
    EXPECT_THAT(problems("7"), HasSubstr("/edits/0: must be an object"));
    // What a faulty edit would have brought is known to later ones.
    const std::string chain =
        problems("{\"step\": 0, \"add_shape\": {\"name\": \"ball\", \"mesh\": \"none.obj\"}}, {\"step\": 0, "
                 "\"add_body\": {\"name\": "
                 "\"b\", \"shape\": \"ball\", \"velocity\": 1}}, {\"step\": 1, \"remove_body\": \"b\"}");
    EXPECT_THAT(chain, HasSubstr("/edits/0/add_shape/mesh: "));
    EXPECT_THAT(chain, HasSubstr("/edits/1/add_body/velocity: "));
    EXPECT_THAT(chain, Not(HasSubstr("unknown")));
    // Names mean who has them at the time, which is that of the step, not of the line.
    EXPECT_EQ(
        problems("{\"step\": 9, \"remove_body\": \"new\"}, {\"step\": 2, \"add_body\": {\"name\": \"new\", \"shape\": "
                 "\"shape1\", \"position\": [0, 0, 9]}}"),
        "");
    EXPECT_THAT(problems("{\"step\": 1, \"remove_body\": \"body5\"}, {\"step\": 2, \"wake\": \"body5\"}"),
                HasSubstr("/edits/1/wake: unknown body"));
}

} // namespace
} // namespace flotilla::test
