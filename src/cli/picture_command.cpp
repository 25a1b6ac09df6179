// SPDX-License-Identifier: MIT
// flotilla picture: a PNG of a frame of a run, or of a scene.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <flotilla/error.hpp>
#include <flotilla/picture.hpp>
#include <flotilla/step_picture.hpp>

#include "cli/commands.hpp"
#include "cli/value_checks.hpp"

namespace flotilla::cli {
namespace {

struct PictureArguments {
    std::string source, output;
    std::optional<std::int64_t> frame, step;
    PictureOptions options;
};

bool names_png(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension == ".png";
}

void print(const std::string& output, const StepPictureReport& r) {
    std::cerr << output << ": step " << r.step << ", t = " << r.time << " s, " << r.bodies << " bodies\n"
              << r.contacts << " contact points, largest impulse " << r.largest_impulse
              << " N s; pairs: " << r.loaded_pairs << " with an impulse (red), " << r.touching_pairs
              << " with contacts alone (orange), " << r.sleeping_pairs << " asleep (violet), " << r.near_pairs
              << " with boxes that meet (blue)\n";
}

int run_picture(const PictureArguments& arguments) {
    if (!names_png(arguments.output))
        throw InputError("picture: --output " + arguments.output +
                         ": pictures are PNG; give a name that ends with .png");
    if (arguments.step) {
        print(arguments.output,
              write_step_picture(arguments.source, *arguments.step, arguments.output, arguments.options));
        return kOk;
    }
    const PictureReport r = write_picture(arguments.source, arguments.output, arguments.options, arguments.frame);
    std::cerr << arguments.output << ": frame " << r.frame << " of " << r.frames << ", t = " << r.time << " s, "
              << r.bodies << " bodies\n";
    return kOk;
}

} // namespace

void register_picture(CLI::App& app, Action& action) {
    const auto arguments = std::make_shared<PictureArguments>();
    PictureOptions& options = arguments->options;
    CLI::App* command = app.add_subcommand("picture", "Render a frame of a run, or a scene, to a PNG file");
    command->add_option("SOURCE", arguments->source, "Run folder or scene file")->required();
    command->add_option("--output", arguments->output, "PNG file to write")->required()->check(kNotEmpty);
    auto* const frame = command->add_option("--frame", arguments->frame, "Frame, from 0 (default: the last)");
    auto* const camera_frame =
        command->add_option("--camera-frame", options.camera_frame,
                            "Frame that the camera is fitted to, for films (default: the one shown)");
    command
        ->add_option(
            "--step", arguments->step,
            "Contacts and pairs of bodies after this step, which is made again: of a scene file from its start, "
            "of a run folder from its last checkpoint where that is not later")
        ->check(kCount)
        ->excludes(frame)
        ->excludes(camera_frame);
    const auto add = [command](const char* name, auto& value, const char* text) {
        command->add_option(name, value, text)->capture_default_str();
    };
    add("--width", options.width, "Pixels");
    add("--height", options.height, "Pixels");
    add("--azimuth", options.azimuth, "Degrees from +x towards +y: where the camera stands");
    add("--elevation", options.elevation, "Degrees above the horizon");
    add("--zoom", options.zoom, "1: everything just fits; larger: closer");
    add("--field-of-view", options.field_of_view, "Degrees, of the longer side");
    add("--supersampling", options.supersampling, "Samples per pixel and axis, 1 to 4");
    add("--outlines", options.outlines, "Strength of dark lines between bodies, 0 to 1");
    command->callback([arguments, &action] { action = [arguments] { return run_picture(*arguments); }; });
}

} // namespace flotilla::cli
