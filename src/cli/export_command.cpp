// SPDX-License-Identifier: MIT
// flotilla export: a run in the formats of other programs.
#include <CLI/CLI.hpp>

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <flotilla/error.hpp>
#include <flotilla/run_folder.hpp>

#include "cli/commands.hpp"
#include "cli/enum_option.hpp"
#include "cli/value_checks.hpp"

namespace flotilla::cli {
namespace {

struct ExportArguments {
    std::string folder, output, frames;
    ExportFormat format = ExportFormat::csv;
};

/// Beside the run's own files: DIR/vtp, DIR/obj, DIR/run.glb, DIR/run.usda.
std::filesystem::path default_output(const ExportArguments& arguments) {
    const std::filesystem::path folder = arguments.folder;
    switch (arguments.format) {
    case ExportFormat::vtp: return folder / "vtp";
    case ExportFormat::obj: return folder / "obj";
    case ExportFormat::glb: return folder / "run.glb";
    case ExportFormat::usd: return folder / "run.usda";
    case ExportFormat::csv: break;
    }
    return {};
}

/// FIRST:LAST:EVERY, of which each may be missing, or one number.
FrameRange parse_range(const std::string& text) {
    FrameRange range;
    if (text.empty()) return range;
    std::vector<std::string> parts(1);
    for (const char c : text)
        if (c == ':')
            parts.emplace_back();
        else
            parts.back() += c;
    const InputError refused("export: --frames wants FIRST:LAST:EVERY, got \"" + text + "\"");
    if (parts.size() > 3) throw InputError(refused);
    const auto number = [&](std::size_t k, std::int64_t missing) {
        if (k >= parts.size() || parts[k].empty()) return missing;
        std::int64_t value = -1;
        const char* const end = parts[k].data() + parts[k].size();
        const auto parsed = std::from_chars(parts[k].data(), end, value);
        if (parsed.ec != std::errc{} || parsed.ptr != end || value < (k == 2 ? 1 : 0)) throw InputError(refused);
        return value;
    };
    range.first = number(0, 0);
    range.last = parts.size() == 1 ? range.first : number(1, range.last);
    range.every = number(2, 1);
    return range;
}

/// Before gigabytes are written.
void warn_of_size(const ExportSize& size) {
    constexpr double kGigabyte = 1e9;
    const double gigabytes = static_cast<double>(size.bytes) / kGigabyte;
    if (gigabytes < 1) return;
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", gigabytes);
    std::cerr << "flotilla: export writes about " << text << " GB in " << size.frames
              << (size.frames == 1 ? " frame" : " frames") << "; --frames FIRST:LAST:EVERY takes fewer\n";
}

int run_export(const ExportArguments& arguments) {
    const FrameRange range = parse_range(arguments.frames);
    warn_of_size(estimate_export(arguments.folder, arguments.format, range));
    std::filesystem::path output = arguments.output;
    if (output.empty()) output = default_output(arguments);
    if (output.empty()) {
        export_csv(arguments.folder, std::cout, range);
        return kOk;
    }
    export_run(arguments.folder, arguments.format, output, range);
    std::cerr << "wrote " << output.string() << '\n';
    return kOk;
}

} // namespace

void register_export(CLI::App& app, Action& action) {
    const auto arguments = std::make_shared<ExportArguments>();
    CLI::App* command =
        app.add_subcommand("export", "Convert a run: csv, vtp (ParaView), obj, glb (glTF) or usd (usda text)");
    command->add_option("DIR", arguments->folder, "Run folder")->required();
    add_enum_option<ExportFormat>(*command, "--format", arguments->format,
                                  {{"csv", ExportFormat::csv},
                                   {"vtp", ExportFormat::vtp},
                                   {"obj", ExportFormat::obj},
                                   {"glb", ExportFormat::glb},
                                   {"usd", ExportFormat::usd}},
                                  "What to write");
    command
        ->add_option("--output", arguments->output,
                     "File (csv, glb, usd) or folder (vtp, obj); default: stdout for csv, else inside DIR")
        ->check(kNotEmpty);
    command->add_option(
        "--frames", arguments->frames,
        "frames FIRST:LAST:EVERY, each may be missing, or one frame; default: all. They keep their numbers");
    command->callback([arguments, &action] { action = [arguments] { return run_export(*arguments); }; });
}

} // namespace flotilla::cli
