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
#include "cli/enum_option.hpp"
#include "cli/progress.hpp"
#include "cli/value_checks.hpp"

namespace flotilla::cli {
namespace {

struct PictureArguments {
    std::string source, output;
    std::optional<std::int64_t> frame, step;
    PictureOptions options;
    StepPictureOptions step_options;
    bool quiet = false;
};

bool names_png(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension == ".png";
}

/// What is seen, and what the colours of lines tell.
void print(const std::string& output, const StepPictureReport& r, PairLines lines) {
    std::cerr << output << ": step " << r.step << ", t = " << r.time << " s, " << r.bodies << " bodies\n"
              << r.contacts << " contact points, largest impulse " << r.largest_impulse << " N s; ";
    if (lines == PairLines::proofs) {
        std::cerr << "pairs proved apart: " << r.proved_by_query << " by a query (blue), " << r.proved_by_boxes
                  << " by their swept boxes (green), " << r.proved_by_cluster << " as members of a cluster (red), "
                  << r.proved_by_rest << " where they stood before (violet); " << r.not_proved
                  << " not to be proved (grey)\n";
        return;
    }
    std::cerr << "pairs: " << r.loaded_pairs << " with an impulse (red), " << r.touching_pairs
              << " with contacts alone (orange), " << r.sleeping_pairs << " asleep (violet), " << r.near_pairs
              << " with boxes that meet (blue)\n";
}

StepPictureReport draw_step(const PictureArguments& arguments) {
    std::optional<Progress> shown; // of the steps to be made: known with the first
    StepPictureOptions options = arguments.step_options;
    options.progress = [&](std::int64_t done, std::int64_t total) {
        if (!shown) shown.emplace("step", total, arguments.quiet);
        shown->update(done, "to make step " + std::to_string(*arguments.step) + " again");
    };
    return write_step_picture(arguments.source, *arguments.step, arguments.output, arguments.options, options);
}

int run_picture(const PictureArguments& arguments) {
    if (!names_png(arguments.output))
        throw InputError("picture: --output " + arguments.output +
                         ": pictures are PNG; give a name that ends with .png");
    if (arguments.step) {
        print(arguments.output, draw_step(arguments), arguments.step_options.lines);
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
    auto* const step =
        command
            ->add_option(
                "--step", arguments->step,
                "Contacts and pairs of bodies after this step, which is made again: of a scene file from its start, "
                "of a run folder from its last checkpoint where that is not later")
            ->check(kCount)
            ->excludes(frame)
            ->excludes(camera_frame);
    add_enum_option<PairLines>(
        *command, "--lines", arguments->step_options.lines,
        {{"contacts", PairLines::contacts}, {"proofs", PairLines::proofs}},
        "What the lines of --step tell of pairs of bodies: contacts, or how they were proved apart")
        ->needs(step);
    command->add_flag("--quiet", arguments->quiet, "No progress of --step; what the picture shows is printed");
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
