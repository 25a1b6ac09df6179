// SPDX-License-Identifier: MIT
// flotilla plan --settings: what can be set, and what each setting does to speed and accuracy.
#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>
#include <string>

#include <flotilla/error.hpp>
#include <flotilla/settings.hpp>

#include "cli/commands.hpp"

namespace flotilla::cli {
namespace {

struct PlanArguments {
    bool settings = false;
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

int run_plan(const PlanArguments& arguments) {
    if (!arguments.settings) throw InputError("plan: give --settings");
    for (const SettingInfo& info : list_settings()) print_setting(info);
    print_presets();
    return kOk;
}

} // namespace

void register_plan(CLI::App& app, Action& action) {
    const auto arguments = std::make_shared<PlanArguments>();
    CLI::App* command = app.add_subcommand("plan", "List the settings");
    command->add_flag("--settings", arguments->settings, "Every key of a scene's settings and of --set, with presets");
    command->callback([arguments, &action] { action = [arguments] { return run_plan(*arguments); }; });
}

} // namespace flotilla::cli
