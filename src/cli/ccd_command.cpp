// SPDX-License-Identifier: MIT
// flotilla ccd: how a CCD method does on files of queries with known answers.
#include <CLI/CLI.hpp>

#include <array>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <flotilla/ccd.hpp>

#include "cli/commands.hpp"
#include "cli/enum_option.hpp"
#include "cli/value_checks.hpp"

namespace flotilla::cli {
namespace {

struct CcdArguments {
    std::vector<std::string> files;
    CcdFileOptions options;
    bool csv = false;
};

constexpr std::array<const char*, 7> kColumns{"file", "rows",       "positives",   "missed",
                                              "late", "false_hits", "ns_per_query"};
using Line = std::array<std::string, kColumns.size()>;

Line line_of(const std::string& file, const CcdFileReport& r) {
    std::array<char, 32> ns{};
    std::snprintf(ns.data(), ns.size(), "%.1f", r.ns_per_query);
    return {file,
            std::to_string(r.rows),
            std::to_string(r.positives),
            std::to_string(r.missed),
            std::to_string(r.late),
            std::to_string(r.false_hits),
            ns.data()};
}

/// A CSV field; quoted only where it must be.
std::string quoted(const std::string& field) {
    if (field.find_first_of(",\"\n") == std::string::npos) return field;
    std::string out = "\"";
    for (const char c : field) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + '"';
}

void print_csv(const Line& line) {
    for (std::size_t i = 0; i < line.size(); ++i) std::cout << (i > 0 ? "," : "") << quoted(line[i]);
    std::cout << std::endl;
}

/// The file left-aligned, numbers right-aligned.
void print_table(const std::vector<Line>& lines) {
    std::array<std::size_t, kColumns.size()> width{};
    for (const Line& line : lines)
        for (std::size_t i = 0; i < line.size(); ++i) width[i] = std::max(width[i], line[i].size());
    for (const Line& line : lines) {
        for (std::size_t i = 0; i < line.size(); ++i) {
            const std::string padding(width[i] - line[i].size(), ' ');
            std::cout << (i > 0 ? "  " + padding + line[i] : line[i] + padding);
        }
        std::cout << '\n';
    }
}

int run_ccd(const CcdArguments& arguments) {
    Line header;
    std::copy(kColumns.begin(), kColumns.end(), header.begin());
    std::vector<Line> lines{header};
    if (arguments.csv) print_csv(header);
    bool kept = true;
    for (const std::string& file : arguments.files) {
        const CcdFileReport report = evaluate_ccd_file(file, arguments.options);
        kept = kept && report.missed == 0 && report.late == 0;
        lines.push_back(line_of(file, report));
        if (arguments.csv) print_csv(lines.back());
    }
    if (!arguments.csv) print_table(lines);
    // Only the conservative method promises anything.
    return kept || arguments.options.method != CcdMethod::conservative ? kOk : kBrokenPromise;
}

} // namespace

void register_ccd(CLI::App& app, Action& action) {
    const auto arguments = std::make_shared<CcdArguments>();
    CLI::App* command = app.add_subcommand("ccd", "Judge continuous collision detection on queries with known answers");
    command->add_option("FILE", arguments->files, "CSV or BIN files of queries")->required();
    command
        ->add_option("--separation", arguments->options.separation,
                     "Distance in m that counts as a hit (cubic: its tolerance, 1e-4 where 0)")
        ->check(kNonNegative)
        ->capture_default_str();
    add_enum_option<CcdMethod>(*command, "--method", arguments->options.method,
                               {{"conservative", CcdMethod::conservative}, {"cubic", CcdMethod::cubic}},
                               "conservative (proved) or cubic (baseline, proves nothing)");
    command->add_flag("--csv", arguments->csv, "Print CSV instead of an aligned table");
    command->callback([arguments, &action] { action = [arguments] { return run_ccd(*arguments); }; });
}

} // namespace flotilla::cli
