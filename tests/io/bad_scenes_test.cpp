// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <string>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "support/bad_scenes.hpp"

namespace flotilla::test {
namespace {

std::string refusal(const std::string& text) {
    try {
        (void)parse_scene(text, "scene", ".");
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(BadScenes, AreMadeFromGoodOnes) {
    for (const std::string& text : good_scenes()) EXPECT_EQ(refusal(text), "accepted");
}

TEST(BadScenes, CoverAtLeastFortyKinds) { EXPECT_GE(bad_scenes().size(), 40U); }

TEST(BadScenes, EachIsRefusedWithAllItsMessages) {
    for (const BadScene& scene : bad_scenes()) {
        std::string expected;
        for (const std::string& problem : scene.problems)
            expected += (expected.empty() ? "scene: " : "\nscene: ") + problem;
        EXPECT_EQ(refusal(scene.text), expected) << scene.kind;
    }
}

TEST(BadScenes, DeepNestingIsRefused) {
    EXPECT_NE(refusal(std::string(100000, '[')).find("nested deeper than 64 levels"), std::string::npos);
}

TEST(BadScenes, EveryTruncationOfAGoodSceneIsRefused) {
    for (const std::string& text : good_scenes())
        for (std::size_t n = 0; n < text.size(); ++n) EXPECT_NE(refusal(text.substr(0, n)), "accepted") << n;
}

} // namespace
} // namespace flotilla::test
