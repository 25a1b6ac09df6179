// SPDX-License-Identifier: MIT
// scene.schema.json says what the reader accepts: the same keys, the same types and limits of settings.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <span>

#include <flotilla/settings.hpp>

#include <nlohmann/json.hpp>

#include "io/scene_keys.hpp"
#include "scene/settings_table.hpp"

namespace flotilla {
namespace {

using nlohmann::json;

const json& schema() {
    static const json document = [] {
        std::ifstream in(FLOTILLA_SOURCE_DIR "/src/io/scene.schema.json");
        return json::parse(in);
    }();
    return document;
}

std::set<std::string> keys_of(const json& object) {
    std::set<std::string> keys;
    for (const auto& item : object.at("properties").items()) keys.insert(item.key());
    return keys;
}
std::set<std::string> set_of(std::span<const std::string_view> names) { return {names.begin(), names.end()}; }

TEST(SceneSchema, ListsTheKeysOfTheReader) {
    const json& top = schema();
    const json& body = top["properties"]["bodies"]["items"];
    EXPECT_EQ(keys_of(top), set_of(io::kSceneKeys));
    EXPECT_EQ(keys_of(top["properties"]["shapes"]["items"]), set_of(io::kShapeKeys));
    EXPECT_EQ(keys_of(body), set_of(io::kBodyKeys));
    EXPECT_EQ(keys_of(body["properties"]["keyframes"]["items"]), set_of(io::kKeyframeKeys));
    EXPECT_EQ(keys_of(top["properties"]["settings"]), set_of(setting_keys()));
}

TEST(SceneSchema, ForbidsOtherKeysEverywhere) {
    const json& p = schema()["properties"];
    EXPECT_EQ(schema()["additionalProperties"], false);
    for (const json& object : {p["settings"], p["shapes"]["items"], p["bodies"]["items"],
                               p["bodies"]["items"]["properties"]["keyframes"]["items"]})
        EXPECT_EQ(object["additionalProperties"], false);
}

TEST(SceneSchema, AgreesWithTheSettingsTable) {
    const json& settings = schema()["properties"]["settings"]["properties"];
    for (const SettingRow& row : settings_table()) {
        const json& entry = settings.at(std::string(row.key));
        if (const auto* choice = std::get_if<ChoiceField>(&row.field)) {
            EXPECT_EQ(entry.at("enum").get<std::vector<std::string>>(),
                      std::vector<std::string>(choice->names.begin(), choice->names.end()))
                << row.key;
            continue;
        }
        if (std::holds_alternative<bool Settings::*>(row.field)) {
            EXPECT_EQ(entry.at("type"), "boolean") << row.key;
            continue;
        }
        const json& limits = row.derived ? entry.at("anyOf")[1] : entry;
        if (row.derived) {
            EXPECT_EQ(entry.at("anyOf")[0].at("const").get<double>(), *row.derived) << row.key;
        }
        const bool real = std::holds_alternative<double Settings::*>(row.field);
        EXPECT_EQ(limits.at("type"), real ? "number" : "integer") << row.key;
        EXPECT_EQ(limits.at("minimum").get<double>(), row.low) << row.key;
        EXPECT_EQ(limits.at("maximum").get<double>(), row.high) << row.key;
    }
}

} // namespace
} // namespace flotilla
