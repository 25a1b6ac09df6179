// SPDX-License-Identifier: MIT
#include "run_folder/recorded_scene.hpp"

#include <string>

#include <nlohmann/json.hpp>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "run_folder/run_files.hpp"

namespace flotilla::io {

SceneDescription recorded_scene(const RunReader& run) {
    const std::filesystem::path file = run.folder() / kSceneJson;
    const std::string text = read_text(file);
    if (text.empty()) throw InputError(file.string() + ": empty: the run was made of no scene file");
    SceneFileOptions options;
    const nlohmann::json settings = nlohmann::json::parse(run.info().settings_json, nullptr, false);
    if (!settings.is_object()) throw InputError(run.folder().string() + ": run.json has no settings");
    for (const auto& [key, value] : settings.items())
        options.overrides.emplace_back(key, value.is_string() ? value.get<std::string>() : value.dump());
    return parse_scene(text, file.string(), run.folder(), options);
}

} // namespace flotilla::io
