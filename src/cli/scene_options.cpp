// SPDX-License-Identifier: MIT
#include "cli/scene_options.hpp"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <sstream>

#include <CLI/CLI.hpp>

#include <flotilla/error.hpp>

namespace flotilla::cli {

SceneFileOptions SceneArguments::resolve() const {
    SceneFileOptions options{preset, {}};
    Settings scratch = flotilla::preset(preset);
    for (const std::string& text : set) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos) throw InputError("--set " + text + ": must be key=value");
        options.overrides.emplace_back(text.substr(0, equals), text.substr(equals + 1));
        set_setting(scratch, options.overrides.back().first, options.overrides.back().second);
    }
    return options;
}

std::vector<std::string> SceneArguments::overridden_by_scene(const Settings& settings) const {
    const Settings asked = flotilla::preset(preset);
    std::vector<std::string> lines;
    for (const SettingInfo& info : list_settings()) {
        const std::string wanted = setting_value(asked, info.key), used = setting_value(settings, info.key);
        // A tolerance that is given leaves nothing to the preset's share of the other one.
        const bool shared = info.key == "static_tolerance" && asked.tolerance_share != Settings{}.tolerance_share;
        const bool by_preset = shared || wanted != setting_value(Settings{}, info.key);
        const bool by_option = std::any_of(set.begin(), set.end(), [&](const std::string& text) {
            return text.compare(0, info.key.size() + 1, std::string(info.key) + "=") == 0;
        });
        if (by_preset && !by_option && used != wanted)
            lines.push_back("the scene sets " + std::string(info.key) + " to " + used + ", the preset " + preset +
                            " asks for " + wanted);
    }
    return lines;
}

LoadedScene load_scene(const std::string& argument, const SceneFileOptions& options) {
    LoadedScene loaded{argument, {}, {}, {}};
    std::ostringstream text;
    if (argument == kStandardInput) {
        loaded.source = "standard input";
        text << std::cin.rdbuf();
        loaded.scene = parse_scene(text.str(), loaded.source, ".", options, &loaded.origin);
    } else {
        loaded.scene = read_scene(argument, options, &loaded.origin);
        text << std::ifstream(argument, std::ios::binary).rdbuf();
    }
    for (const std::string& warning : loaded.origin.warnings) std::cerr << "warning: " << warning << '\n';
    if (!loaded.origin.format.empty()) {
        text.str({});
        write_scene(text, loaded.scene);
    }
    loaded.text = text.str();
    return loaded;
}

void add_scene_options(CLI::App& command, SceneArguments& arguments) {
    command
        .add_option("--preset", arguments.preset,
                    "Settings to start from: paper, preview, balanced, accurate, reference")
        ->capture_default_str();
    // One value per --set, or it would swallow what follows it.
    command
        .add_option("--set", arguments.set,
                    "key=value: a setting that replaces the scene's (plan --settings lists them)")
        ->allow_extra_args(false)
        ->type_name("KEY=VALUE");
}

} // namespace flotilla::cli
