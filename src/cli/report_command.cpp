// SPDX-License-Identifier: MIT
// flotilla report: a run as one HTML file.
#include <CLI/CLI.hpp>

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include <flotilla/html_report.hpp>

#include "cli/commands.hpp"
#include "cli/value_checks.hpp"

namespace flotilla::cli {
namespace {

struct ReportArguments {
    std::string folder, output;
    HtmlReportOptions options;
    bool quiet = false;
};

int run_report(ReportArguments& arguments) {
    const std::filesystem::path output = arguments.output.empty()
                                             ? std::filesystem::path(arguments.folder) / "report.html"
                                             : std::filesystem::path(arguments.output);
    if (arguments.options.verify && !arguments.quiet) arguments.options.verification.progress = verify_progress();
    const HtmlReport r = write_html_report(arguments.folder, output, arguments.options);
    for (const auto& problem : r.problems) std::cerr << "flotilla: " << problem << '\n';
    if (!arguments.quiet)
        std::cerr << "wrote " << output.string() << ": " << r.frames_shown << " of " << r.frames << " frames, "
                  << static_cast<double>(r.bytes) / 1e6 << " MB, positions within " << 1000 * r.position_error
                  << " mm, rotations within " << 1000 * r.rotation_error << " mrad\n";
    if (!r.verification) return kOk;
    const VerifyReport& v = *r.verification;
    if (!arguments.quiet || !v.proved())
        std::cerr << (!v.proved()            ? "verified: FAILED, see the report\n"
                      : v.unreadable.empty() ? "verified: no intersection found\n"
                                             : "verified what can be read: no intersection found\n");
    return v.proved() ? kOk : kBrokenPromise;
}

} // namespace

void register_report(CLI::App& app, Action& action) {
    const auto arguments = std::make_shared<ReportArguments>();
    CLI::App* command = app.add_subcommand(
        "report", "Write a run as one HTML file: animation, plots and tables; works offline, in any browser");
    command->add_option("DIR", arguments->folder, "Run folder")->required();
    command->add_option("--output", arguments->output, "File to write (default DIR/report.html)")->check(kNotEmpty);
    command->add_flag("--verify", arguments->options.verify,
                      "Prove the run free of intersections first and show the verdict; exit "
                      "code 3 where it is not");
    command
        ->add_option("--frame-every", arguments->options.frame_every,
                     "Frames of the run per frame shown (default: as few as the page can hold)")
        ->check(kPositiveCount);
    command->add_option("--threads", arguments->options.verification.threads, kThreadsHelp)->check(kPositiveCount);
    command->add_flag("--quiet", arguments->quiet, "Print problems only");
    command->callback([arguments, &action] { action = [arguments] { return run_report(*arguments); }; });
}

} // namespace flotilla::cli
