// SPDX-License-Identifier: MIT
#include "run_folder/step_csv.hpp"

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "io/number.hpp"

namespace flotilla::io {
namespace {

constexpr std::string_view kColumnsAfterPhases =
    "pairs,collisions,contacts,iterations,residual,merges,rung_changes,held,energy,momentum_x,momentum_y,momentum_z,"
    "min_distance,state_hash,angular_momentum_x,angular_momentum_y,angular_momentum_z,kinetic_energy,kinematic_bodies,"
    "rigid_bodies,largest_cluster,trigger_a,trigger_b,sleeping,warnings,"
    "proximities,pruned_end_points,pruned_same_direction,pruned_angle,pruned_occluded,"
    "energy_corrections,energy_removed,lift,sleeping_contacts";

std::string hex(std::uint64_t value) {
    char buffer[16];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, 16).ptr;
    std::string text(buffer, end);
    return std::string(16 - text.size(), '0') + text;
}

} // namespace

std::string step_csv_header() {
    std::string text = "step,time,total_ms";
    for (const auto name : kPhaseNames) text.append(",").append(name).append("_ms");
    return text.append(",").append(kColumnsAfterPhases).append("\n");
}

std::string step_csv_row(const StepReport& row) {
    std::string text;
    append_number(text, row.step);
    const auto add = [&text](auto value) {
        text += ',';
        append_number(text, value);
    };
    const auto add_vector = [&add](const Vec3& v) { add(v.x), add(v.y), add(v.z); };
    add(row.time), add(row.total_ms);
    for (const double ms : row.phase_ms) add(ms);
    add(row.pairs), add(row.collisions), add(row.contacts), add(row.iterations), add(row.residual);
    add(row.merges), add(row.rung_changes), add(row.held), add(row.energy);
    add_vector(row.momentum);
    if (std::isinf(row.min_distance))
        text += ',';
    else
        add(row.min_distance);
    text.append(",").append(hex(row.state_hash));
    add_vector(row.angular_momentum);
    add(row.kinetic_energy), add(row.kinematic_bodies), add(row.rigid_bodies), add(row.largest_cluster);
    add(row.trigger_a), add(row.trigger_b), add(row.sleeping), add(row.warnings);
    add(row.proximities), add(row.pruned_end_points), add(row.pruned_same_direction), add(row.pruned_angle);
    add(row.pruned_occluded);
    add(row.energy_corrections), add(row.energy_removed), add(row.lift);
    add(row.sleeping_contacts);
    return text.append("\n");
}

std::string step_csv_difference(std::string_view text) {
    if (text.empty()) return "";
    const std::string header = step_csv_header();
    const auto first_line = [](std::string_view lines) { return step_csv_fields(lines.substr(0, lines.find('\n'))); };
    const std::vector<std::string_view> expected = first_line(header), found = first_line(text);
    const auto [e, f] = std::mismatch(expected.begin(), expected.end(), found.begin(), found.end());
    if (e == expected.end() && f == found.end()) return "";
    if (f == found.end()) return "it has no column " + in_quotes(*e);
    if (e == expected.end()) return "column " + in_quotes(*f) + " is not known";
    return "it has column " + in_quotes(*f) + " where " + in_quotes(*e) + " is expected";
}

std::string step_csv_until(std::string_view text, std::int64_t last_step) {
    std::string kept = step_csv_header();
    std::size_t begin = text.find('\n');
    while (begin != std::string_view::npos && ++begin < text.size()) {
        const std::size_t end = text.find('\n', begin);
        if (end == std::string_view::npos) break;
        const std::string_view line = text.substr(begin, end + 1 - begin);
        std::int64_t step = 0;
        if (parse_number(line.substr(0, line.find(',')), step) && step <= last_step) kept += line;
        begin = end;
    }
    return kept;
}

std::vector<std::string_view> step_csv_fields(std::string_view line) {
    std::vector<std::string_view> fields;
    for (std::size_t comma = line.find(','); comma != std::string_view::npos; comma = line.find(',')) {
        fields.push_back(line.substr(0, comma));
        line.remove_prefix(comma + 1);
    }
    fields.push_back(line);
    return fields;
}

StepTable read_step_table(std::string_view text) {
    StepTable table;
    std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return table;
    for (const std::string_view name : step_csv_fields(text.substr(0, end))) table.columns.emplace_back(name);
    for (std::size_t begin = end + 1; (end = text.find('\n', begin)) != std::string_view::npos; begin = end + 1) {
        const std::string_view line = text.substr(begin, end - begin);
        std::int64_t step = 0;
        if (parse_number(line.substr(0, line.find(',')), step)) table.rows.emplace_back(step, line);
    }
    return table;
}

} // namespace flotilla::io
