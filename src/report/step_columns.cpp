// SPDX-License-Identifier: MIT
#include "report/step_columns.hpp"

#include <limits>
#include <optional>

#include "io/number.hpp"
#include "run_folder/step_csv.hpp"

namespace flotilla::report {
namespace {

constexpr std::string_view kStateHash = "state_hash"; // 64 bits in hexadecimal: no number for a plot

/// The numbers of a row; nothing where it is none.
std::optional<std::vector<double>> parse_row(std::string_view line, const std::vector<std::string_view>& header) {
    const auto fields = io::step_csv_fields(line);
    if (fields.size() != header.size()) return {};
    std::vector<double> row(fields.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < fields.size(); ++i)
        if (!fields[i].empty() && header[i] != kStateHash && !io::parse_number(fields[i], row[i])) return {};
    return row;
}

} // namespace

const std::vector<double>& StepColumns::column(std::string_view name) const {
    static const std::vector<double> none;
    const auto found = columns.find(name);
    return found == columns.end() ? none : found->second;
}

StepColumns read_step_columns(std::string_view csv) {
    StepColumns table;
    std::vector<std::string_view> header;
    std::size_t number = 0;
    for (std::size_t begin = 0, end = csv.find('\n'); end != std::string_view::npos;
         begin = end + 1, end = csv.find('\n', begin)) {
        const std::string_view line = csv.substr(begin, end - begin);
        if (++number == 1) {
            header = io::step_csv_fields(line);
            for (const auto name : header) table.columns.emplace(name, std::vector<double>{});
            continue;
        }
        const auto row = parse_row(line, header);
        if (!row) {
            table.problems.push_back("steps.csv: line " + std::to_string(number) + " is damaged and left out");
            continue;
        }
        const auto fields = io::step_csv_fields(line);
        for (std::size_t i = 0; i < header.size(); ++i) {
            table.columns.find(header[i])->second.push_back((*row)[i]);
            if (header[i] == kStateHash) table.last_state_hash = fields[i];
        }
    }
    if (number == 0) table.problems.emplace_back("steps.csv: is empty");
    return table;
}

} // namespace flotilla::report
