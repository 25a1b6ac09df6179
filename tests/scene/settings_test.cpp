// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include <flotilla/error.hpp>
#include <flotilla/settings.hpp>

#include "scene/settings_table.hpp"

namespace flotilla {
namespace {

// Counts the fields of an aggregate: the longest list of values that initialises it.
struct Anything {
    template <class T>
    operator T() const; // NOLINT(google-explicit-constructor)
};
template <class Aggregate, class... Values>
constexpr std::size_t field_count() {
    if constexpr (requires { Aggregate{Values{}..., Anything{}}; })
        return field_count<Aggregate, Values..., Anything>();
    else
        return sizeof...(Values);
}

// A valid value that differs from the default.
std::string other_value(const SettingInfo& info) {
    if (info.type == "boolean") return info.default_value == "true" ? "false" : "true";
    if (info.type == "number")
        return info.key == "time_step" ? "0.01" : info.key == "approach_threshold" ? "0" : "0.25";
    if (info.type == "integer") return "7";
    const std::size_t bar = info.type.find(" | ");
    if (bar == std::string::npos) return info.type;
    const std::string first = info.type.substr(0, bar), last = info.type.substr(info.type.rfind(" | ") + 3);
    return first == info.default_value ? last : first;
}

std::string refusal(std::string_view key, std::string_view value) {
    Settings settings;
    try {
        set_setting(settings, key, value);
    } catch (const InputError& error) {
        EXPECT_EQ(settings, Settings{}) << "a refused value must change nothing";
        return error.what();
    }
    return "accepted";
}

TEST(SettingsTable, KnowsEveryFieldOfTheStruct) {
    EXPECT_EQ(list_settings().size(), field_count<Settings>());
    std::set<std::string_view> keys;
    for (const SettingInfo& info : list_settings()) {
        EXPECT_TRUE(keys.insert(info.key).second) << info.key;
        EXPECT_FALSE(info.description.empty()) << info.key;
        EXPECT_FALSE(info.effect.empty()) << info.key;
    }
}

TEST(SettingsTable, EveryKeyChangesAFieldOfItsOwn) {
    for (const SettingInfo& info : list_settings()) {
        const std::string value = other_value(info);
        Settings settings;
        set_setting(settings, info.key, value);
        EXPECT_EQ(setting_value(settings, info.key), value);
        if (value == info.default_value) continue; // a single choice so far
        EXPECT_NE(settings, Settings{}) << info.key;
        set_setting(settings, info.key, info.default_value);
        EXPECT_EQ(settings, Settings{}) << info.key;
    }
}

TEST(SettingsTable, HasTheKeysOfTheContract) {
    for (const char* key :
         {"time_step", "friction", "restitution", "sleeping", "trajectory", "ccd", "contact_solver", "tangents",
          "collision_iterations", "dynamic_iterations", "static_iterations", "static_tolerance"})
        EXPECT_NE(find_setting(key), nullptr) << key;
}

TEST(SetSetting, RefusesUnknownKeysNamingTheNearest) {
    EXPECT_EQ(refusal("static_tolerence", "1"),
              "unknown setting \"static_tolerence\"; did you mean \"static_tolerance\"?");
    EXPECT_EQ(refusal("viscosity", "1"), "unknown setting \"viscosity\"");
}

TEST(SetSetting, RefusesWrongTypesAndRanges) {
    EXPECT_EQ(refusal("time_step", "fast"), "setting time_step: must be a number, got \"fast\"");
    EXPECT_EQ(refusal("time_step", "0"), "setting time_step: must be in 1e-09 .. 10 s, got 0");
    EXPECT_EQ(refusal("time_step", "nan"), "setting time_step: must be in 1e-09 .. 10 s, got nan");
    EXPECT_EQ(refusal("restitution", "1.5"), "setting restitution: must be in 0 .. 1, got 1.5");
    EXPECT_EQ(refusal("static_iterations", "2.5"), "setting static_iterations: must be an integer, got 2.5");
    EXPECT_EQ(refusal("static_iterations", "-1"), "setting static_iterations: must be in 0 .. 1e+06, got -1");
    EXPECT_EQ(refusal("sleeping", "maybe"), "setting sleeping: must be true or false, got \"maybe\"");
    EXPECT_EQ(refusal("trajectory", "curved"), "setting trajectory: must be one of linear, rigid; got \"curved\"");
    EXPECT_EQ(refusal("seed", "-3"), "setting seed: must be an integer in 0 .. 2^64 - 1, got -3");
    EXPECT_EQ(refusal("friction", "0.1 "), "setting friction: must be a number, got \"0.1 \"");
}

TEST(SetSetting, KeepsAllBitsOfASeed) {
    Settings settings;
    set_setting(settings, "seed", "18446744073709551615");
    EXPECT_EQ(settings.seed, std::numeric_limits<std::uint64_t>::max());
}

TEST(ValidateSettings, ReportsAllProblemsAtOnce) {
    Settings settings;
    EXPECT_TRUE(validate_settings(settings).empty());
    settings.time_step = std::numeric_limits<double>::quiet_NaN();
    settings.restitution = -1;
    settings.rest_distance = 0.01;
    settings.proximity_distance = 0.01;
    settings.separation = 0.02;
    settings.tangents = static_cast<Tangents>(9);
    const std::vector<std::string> problems = validate_settings(settings);
    ASSERT_EQ(problems.size(), 5U);
    EXPECT_EQ(problems[0], "time_step: must be in 1e-09 .. 10 s, got nan");
    EXPECT_EQ(problems[2], "tangents: must be one of random, aligned, cone");
    EXPECT_EQ(problems[3], "proximity_distance: must exceed rest_distance (0.01 m), got 0.01");
    EXPECT_EQ(problems[4], "separation: must be below rest_distance (0.01 m), got 0.02");
}

TEST(Presets, AreValidAndBalancedIsTheDefault) {
    EXPECT_EQ(preset_names(), (std::vector<std::string_view>{"paper", "preview", "balanced", "accurate", "reference"}));
    for (const std::string_view name : preset_names()) EXPECT_TRUE(validate_settings(preset(name)).empty()) << name;
    EXPECT_EQ(preset("balanced"), Settings{});
}

TEST(Presets, AccurateIsWhatTheContractSays) {
    for (const char* name : {"accurate", "reference"}) {
        const Settings s = preset(name);
        EXPECT_EQ(s.tangents, Settings{}.tangents) << "Coulomb's cone, which is the default";
        EXPECT_NE(s.tangents, Tangents::random);
        EXPECT_EQ(s.contact_solver, ContactSolver::exact);
        EXPECT_EQ(s.trajectory, Trajectory::rigid);
        EXPECT_FALSE(s.sleeping);
        EXPECT_LT(s.static_tolerance, 0) << "by gravity and size: the same at any scale";
        EXPECT_LE(s.tolerance_share / s.substeps, 0.005) << "of what gravity adds in a step, not in an inner one";
        EXPECT_GE(s.substeps, 4);
    }
}

// Figure 20 has no setting for the solver of section 4.3.2 and its tangents: there is only one.
TEST(Presets, PaperIsFigureTwentyAsPrinted) {
    const Settings s = preset("paper");
    EXPECT_EQ(s.tangents, Tangents::random);
    EXPECT_EQ(s.contact_solver, ContactSolver::pgs);
    EXPECT_EQ(s.static_tolerance, 1e-6);
    EXPECT_EQ(s.static_iterations, 1000);
    EXPECT_FALSE(s.warm_start);
}

TEST(Presets, UnknownNamesAreRefused) {
    try {
        (void)preset("acurate");
        FAIL() << "accepted";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(),
                     "unknown preset \"acurate\"; did you mean \"accurate\"? (presets: paper, preview, balanced, "
                     "accurate, reference)");
    }
}

} // namespace
} // namespace flotilla
