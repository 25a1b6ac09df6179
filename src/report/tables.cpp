// SPDX-License-Identifier: MIT
#include "report/tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string_view>

#include <nlohmann/json.hpp>

#include <flotilla/report.hpp>

#include "scene/settings_table.hpp"

namespace flotilla::report {
namespace {

using Json = nlohmann::ordered_json;

double total(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// The row of the largest, or with `sign` -1 smallest, value; nan never is; -1 without any.
std::ptrdiff_t extreme(const std::vector<double>& values, double sign) {
    std::ptrdiff_t best = -1;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isnan(values[i]) && (best < 0 || sign * values[i] > sign * values[static_cast<std::size_t>(best)]))
            best = static_cast<std::ptrdiff_t>(i);
    return best;
}

std::string count_text(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.0f", value);
    return text;
}

/// "VALUE UNIT at step S".
std::string at_step(const StepColumns& steps, const std::vector<double>& values, std::ptrdiff_t row,
                    const std::string& unit) {
    const auto i = static_cast<std::size_t>(row);
    std::string text = short_number(values[i]) + " " + unit;
    const auto& step = steps.column("step");
    if (i < step.size()) text += " (step " + count_text(step[i]) + ")";
    return text;
}

void add_step_times(Table& table, const StepColumns& steps) {
    const auto& ms = steps.column("total_ms");
    if (ms.empty()) return;
    table.rows.push_back({"mean time per step", short_number(total(ms) / static_cast<double>(ms.size())) + " ms"});
    const std::ptrdiff_t worst = extreme(ms, 1);
    if (worst >= 0) table.rows.push_back({"slowest step", at_step(steps, ms, worst, "ms")});
    table.rows.push_back({"time in steps", short_number(total(ms) / 1000) + " s"});
}

void add_failsafe(Table& table, const StepColumns& steps) {
    const auto sum = [&](const char* name) { return count_text(total(steps.column(name))); };
    table.rows.push_back({"failsafe, all steps together", sum("merges") + " merges, " + sum("rung_changes") +
                                                              " rung changes, " + sum("held") + " bodies held"});
}

struct WarningText {
    StepWarning bit;
    const char* what;
    const char* advice;
};
constexpr std::array kWarnings{
    WarningText{kCollisionLimit,
                "collisions: stage 1 ended before it was quiet, at the limit of sweeps or as they gained nothing",
                "raise collision_iterations"},
    WarningText{kDynamicLimit,
                "dynamic contact: the failsafe had to finish, after the limit of sweeps or as they gained nothing",
                "raise dynamic_iterations"},
    WarningText{kStaticLimit,
                "static contact: a solve ended above its tolerance, at the limit of sweeps or as they gained nothing",
                "raise static_iterations, or static_tolerance"},
    WarningText{kScriptDelayed, "a scripted body waited, as bodies are in its way or were of late",
                "see unsatisfiable_script"},
    WarningText{kReboundLost, "a held body, or one hit without end, lost a rebound", "raise dynamic_iterations"},
};

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

std::string setting_text(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

} // namespace

std::string short_number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

Table summary_table(const io::RunReader& run, const StepColumns& steps) {
    Table table{"Summary", {}};
    table.rows.push_back({"status", run.info().record.status});
    table.rows.push_back({"steps", std::to_string(steps.rows())});
    const auto& time = steps.column("time");
    if (!time.empty()) table.rows.push_back({"time simulated", short_number(time.back()) + " s"});
    table.rows.push_back(
        {"time step",
         short_number(run.info().time_step) + " s" +
             (run.info().substeps > 1 ? ", of " + std::to_string(run.info().substeps) + " inner ones" : "")});
    table.rows.push_back({"frames", std::to_string(run.frames())});
    if (steps.rows() == 0) return table;
    add_step_times(table, steps);
    add_failsafe(table, steps);
    const auto& distance = steps.column("min_distance");
    const std::ptrdiff_t smallest = extreme(distance, -1);
    table.rows.push_back({"smallest distance at the end of a step", smallest < 0
                                                                        ? "nothing came within the proximity distance"
                                                                        : at_step(steps, distance, smallest, "m")});
    const auto& energy = steps.column("energy");
    if (!energy.empty())
        table.rows.push_back(
            {"energy, start to end", short_number(energy.front()) + " J to " + short_number(energy.back()) + " J"});
    const double removed = total(steps.column("energy_removed"));
    table.rows.push_back(
        {"energy taken by the last resort",
         short_number(removed) + " J from " + count_text(total(steps.column("energy_corrections"))) + " islands"});
    if (!steps.last_state_hash.empty()) table.rows.push_back({"state hash after the last step", steps.last_state_hash});
    return table;
}

Table warning_table(const StepColumns& steps) {
    Table table{"Warnings", {}};
    const auto& warnings = steps.column("warnings");
    for (const WarningText& warning : kWarnings) {
        std::int64_t count = 0;
        std::size_t first = 0;
        for (std::size_t i = 0; i < warnings.size(); ++i) {
            const bool has = std::isfinite(warnings[i]) && (static_cast<std::uint64_t>(warnings[i]) & warning.bit) != 0;
            if (has && count++ == 0) first = i;
        }
        if (count > 0)
            table.rows.push_back({warning.what,
                                  std::to_string(count) + (count == 1 ? " step" : " steps") + ", first at step " +
                                      count_text(steps.column("step").at(first)),
                                  warning.advice});
    }
    if (table.rows.empty()) table.rows.push_back({"none", "no step had a warning"});
    return table;
}

Table provenance_table(const io::RunReader& run) {
    const io::RunInfo& info = run.info();
    const io::RunScene& scene = run.scene();
    std::size_t dynamic = 0, triangles = 0;
    for (const auto& body : scene.bodies) {
        dynamic += body.type == BodyType::dynamic ? 1 : 0;
        triangles += scene.shapes[static_cast<std::size_t>(body.shape)].mesh.triangles.size();
    }
    return {"Provenance",
            {{"flotilla", info.record.version},
             {"commit", info.record.commit},
             {"compiler", info.record.compiler},
             {"flags", info.record.flags},
             {"processor", info.record.processor},
             {"threads", std::to_string(info.threads)},
             {"started", info.record.started},
             {"last written", info.record.updated},
             {"command line", joined(info.command_line)},
             {"bodies", std::to_string(scene.bodies.size()) + " (" + std::to_string(dynamic) + " dynamic)"},
             {"shapes", std::to_string(scene.shapes.size())},
             {"triangles of all bodies", std::to_string(triangles)}}};
}

Table settings_table(const io::RunInfo& info) {
    Table table{"Settings", {}};
    const Json settings = Json::parse(info.settings_json, nullptr, false);
    if (!settings.is_object()) return table;
    for (const auto& [key, value] : settings.items()) {
        const SettingRow* row = find_setting(key);
        std::string text = setting_text(value);
        if (row != nullptr && !row->unit.empty()) text.append(" ").append(row->unit);
        table.rows.push_back({key, text, row == nullptr ? std::string() : std::string(row->description)});
    }
    return table;
}

Table verification_table(const Verification& verification) {
    Table table{"Verification", {{"verdict", verification.text}}};
    for (const auto& [label, value] : verification.rows) table.rows.push_back({label, value});
    for (const auto& fault : verification.faults) table.rows.push_back({"fault", fault});
    return table;
}

Table page_table(const PoseTrack& track, std::size_t rows_every) {
    Table table{"This page", {}};
    table.rows.push_back(
        {"frames shown",
         std::to_string(track.frames.size()) + " of " + std::to_string(track.frames_in_run) +
             (track.frame_every > 1 ? " (every " + std::to_string(track.frame_every) + "th, and the last)" : "")});
    if (rows_every > 1)
        table.rows.push_back({"plots", "every " + std::to_string(rows_every) + "th step; sums are over all steps"});
    table.rows.push_back({"largest error of a drawn position", short_number(1000 * track.position_error) + " mm"});
    table.rows.push_back({"largest error of a drawn rotation", short_number(1000 * track.rotation_error) + " mrad"});
    table.rows.push_back({"between frames", "the animation interpolates; that is a picture and no result of the run"});
    return table;
}

} // namespace flotilla::report
