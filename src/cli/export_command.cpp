// SPDX-License-Identifier: MIT
// flotilla export: a run in the formats of other programs.
#include <CLI/CLI.hpp>

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include <flotilla/run_folder.hpp>

#include "cli/commands.hpp"
#include "cli/enum_option.hpp"

namespace flotilla::cli {
namespace {

struct ExportArguments {
    std::string folder, output;
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

int run_export(const ExportArguments& arguments) {
    std::filesystem::path output = arguments.output;
    if (output.empty()) output = default_output(arguments);
    if (output.empty()) {
        export_csv(arguments.folder, std::cout);
        return kOk;
    }
    export_run(arguments.folder, arguments.format, output);
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
    command->add_option("--output", arguments->output,
                        "File (csv, glb, usd) or folder (vtp, obj); default: stdout for csv, else inside DIR");
    command->callback([arguments, &action] { action = [arguments] { return run_export(*arguments); }; });
}

} // namespace flotilla::cli
