// SPDX-License-Identifier: MIT
// flotilla plan: what will be modelled of a scene and why; with --settings, what can be set and what each setting
// costs.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>

#include <flotilla/error.hpp>
#include <flotilla/plan.hpp>
#include <flotilla/settings.hpp>

#include "cli/commands.hpp"
#include "cli/scene_options.hpp"

namespace flotilla::cli {
namespace {

struct PlanArguments {
    bool settings = false;
    std::string scene;
    SceneArguments options;
};

void print_setting(const SettingInfo& info) {
    std::cout << info.key << " = " << info.default_value;
    if (!info.unit.empty()) std::cout << ' ' << info.unit;
    std::cout << "\n    " << info.type;
    if (!info.range.empty()) std::cout << ", " << info.range;
    std::cout << "\n    " << info.description << "\n    effect: " << info.effect << '\n';
}

// What each preset changes, so that the listing is the whole truth about settings.
void print_presets() {
    std::cout << "\npresets, and where they differ from the defaults:\n";
    for (const std::string_view name : preset_names()) {
        std::cout << "  " << name << ':';
        const Settings changed = preset(name);
        for (const SettingInfo& info : list_settings())
            if (setting_value(changed, info.key) != info.default_value)
                std::cout << ' ' << info.key << '=' << setting_value(changed, info.key);
        std::cout << '\n';
    }
}

int print_plan(const PlanArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene, arguments.options.resolve());
    for (const PlanLine& line : plan_scene(loaded.scene, loaded.source)) {
        std::string topic = line.topic + ':';
        topic.resize(std::max<std::size_t>(topic.size() + 1, 14), ' ');
        std::cout << topic << line.text << '\n';
    }
    return kOk;
}

int run_plan(const PlanArguments& arguments) {
    if (arguments.settings == !arguments.scene.empty()) throw InputError("plan: give a scene file or --settings");
    if (!arguments.settings) return print_plan(arguments);
    for (const SettingInfo& info : list_settings()) print_setting(info);
    print_presets();
    return kOk;
}

} // namespace

void register_plan(CLI::App& app, Action& action) {
    const auto arguments = std::make_shared<PlanArguments>();
    CLI::App* command = app.add_subcommand("plan", "Say what will be modelled of a scene, or list the settings");
    command->add_option("SCENE", arguments->scene, "Scene file (JSON), or - for standard input");
    add_scene_options(*command, arguments->options);
    command->add_flag("--settings", arguments->settings, "Every key of a scene's settings and of --set, with presets");
    command->callback([arguments, &action] { action = [arguments] { return run_plan(*arguments); }; });
}

} // namespace flotilla::cli
