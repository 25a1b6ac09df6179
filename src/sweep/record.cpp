// SPDX-License-Identifier: MIT
#include "sweep/record.hpp"

#include <charconv>
#include <cmath>

#include <nlohmann/json.hpp>

#include <flotilla/build_info.hpp>
#include <flotilla/error.hpp>

#include "io/file.hpp"
#include "io/number.hpp"
#include "run_folder/run_files.hpp"

namespace flotilla::sweep {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr int kResumable = 6; // exit code of a run that stopped early

std::string hex(std::uint64_t value) {
    char text[24];
    return {text, std::to_chars(text, text + sizeof text, value, 16).ptr};
}

std::uint64_t from_hex(const std::string& text) {
    std::uint64_t value = 0;
    (void)std::from_chars(text.data(), text.data() + text.size(), value, 16);
    return value;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json value_json(const SweepValue& v) {
    return Json{{"mean", number(v.mean)}, {"spread", number(v.spread)}, {"starts", v.starts}};
}

Json members_json(const Record& record) {
    Json members = Json::object();
    for (const auto& [name, m] : record.members)
        members[name] = Json{{"input", hex(m.input)},
                             {"begun", m.begun},
                             {"exit_code", m.outcome.exit_code},
                             {"reason", m.outcome.reason},
                             {"cpu_s", m.outcome.cpu}};
    return members;
}

Json point_json(const SweepReport& report, const SweepPoint& point) {
    Json settings = Json::object(), metrics = Json::object();
    for (std::size_t a = 0; a < point.values.size(); ++a) settings[report.axes[a].key] = point.values[a];
    for (std::size_t m = 0; m < report.metrics.size(); ++m)
        metrics[std::string(report.metrics[m].name)] = Json{{"value", value_json(point.values_of[m])},
                                                            {"error", number(point.errors[m].mean)},
                                                            {"error_uncertainty", number(point.errors[m].spread)}};
    return Json{{"label", point.label},
                {"settings", settings},
                {"reference", point.reference},
                {"complete", point.complete},
                {"cost_s", value_json(point.cost)},
                {"on_front", point.on_front},
                {"metrics", metrics}};
}

Json report_json(const SweepReport& report) {
    Json points = Json::array(), changes = Json::array(), metrics = Json::array();
    for (const SweepPoint& p : report.points) points.push_back(point_json(report, p));
    for (const SweepMetric& m : report.metrics)
        metrics.push_back(Json{{"name", m.name}, {"unit", m.unit}, {"description", m.description}});
    for (const SweepChange& c : report.changes)
        changes.push_back(Json{{"key", c.key},
                               {"from", c.from},
                               {"to", c.to},
                               {"cost_ratio", c.cost_ratio},
                               {"error_ratio", c.error_ratio},
                               {"gain", c.gain}});
    return Json{{"metrics", metrics},
                {"headline", report.metrics[report.headline].name},
                {"chaotic", report.chaotic},
                {"body_size_m", report.size},
                {"starts", report.starts},
                {"points", points},
                {"base", report.points[report.base].label},
                {"changes", changes},
                {"advice", report.advice},
                {"remarks", report.remarks},
                {"problems", report.problems}};
}

void add_number(std::string& row, double value) {
    row += ',';
    if (std::isfinite(value)) io::append_number(row, value);
}

std::string points_csv(const SweepReport& report) {
    std::string text = "point";
    for (const SweepAxis& axis : report.axes) text += ',' + axis.key;
    text += ",reference,complete,cost_s,cost_s_spread,on_front";
    for (const SweepMetric& m : report.metrics)
        for (const char* part : {"", "_spread", "_error", "_error_uncertainty"})
            text += ',' + std::string(m.name) + part;
    for (const SweepPoint& p : report.points) {
        text += '\n' + csv_field(p.label);
        for (std::size_t a = 0; a < report.axes.size(); ++a)
            text += ',' + (p.values.empty() ? "" : csv_field(p.values[a]));
        text += std::string(p.reference ? ",1," : ",0,") + std::to_string(p.complete);
        add_number(text, p.cost.mean);
        add_number(text, p.cost.spread);
        text += p.on_front ? ",1" : ",0";
        for (std::size_t m = 0; m < report.metrics.size(); ++m)
            for (const double value :
                 {p.values_of[m].mean, p.values_of[m].spread, p.errors[m].mean, p.errors[m].spread})
                add_number(text, value);
    }
    return text + '\n';
}

std::string members_csv(const Plan& plan, const Record& record, const Measured& measured) {
    std::string text = "member,point,start,state,steps,cost_s,cpu_s";
    for (const SweepMetric& m : sweep_metrics()) text += ',' + std::string(m.name);
    for (const Member& member : plan.members) {
        const MemberState& state = record.members.at(member.run.name);
        const auto& values = measured[member.point][member.start];
        text += '\n' + csv_field(member.run.name) + ',' + csv_field(plan.points[member.point].label) + ',' +
                csv_field(plan.starts[member.start].name) + ',' + state_text(state) + ',' +
                std::to_string(member.run.steps);
        add_number(text, values ? values->cost : std::nan(""));
        add_number(text, state.outcome.cpu > 0 ? state.outcome.cpu : std::nan(""));
        for (std::size_t m = 0; m < kMetrics; ++m) add_number(text, values ? values->values[m] : std::nan(""));
    }
    return text + '\n';
}

} // namespace

std::string csv_field(std::string_view text) {
    if (text.find_first_of(",\"\n") == std::string_view::npos) return std::string(text);
    std::string out = "\"";
    for (const char c : text) out.append(c == '"' ? 2 : 1, c == '\n' ? ' ' : c);
    return out + '"';
}

std::string state_text(const MemberState& state) {
    if (!state.begun) return "not begun";
    if (state.outcome.exit_code == 0) return "complete";
    if (state.outcome.exit_code == kResumable) return "stopped";
    return "failed (" + std::to_string(state.outcome.exit_code) + ")";
}

Record read_record(const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / kSweepJson;
    Record record;
    try {
        const Json json = Json::parse(io::read_text(path));
        if (json.at("flotilla_sweep").get<int>() != kFormat)
            throw IoError(path.string() + ": written by another version of flotilla");
        record.duration = json.at("duration_s").get<double>();
        record.threads = json.at("threads").get<int>();
        record.commit = json.at("commit").get<std::string>();
        for (const auto& [name, m] : json.at("members").items())
            record.members[name] = {
                from_hex(m.at("input").get<std::string>()),
                m.at("begun").get<bool>(),
                {m.at("exit_code").get<int>(), m.at("reason").get<std::string>(), m.at("cpu_s").get<double>()}};
    } catch (const nlohmann::json::exception& e) {
        throw IoError(path.string() + ": damaged: " + e.what());
    }
    return record;
}

void write_record(const std::filesystem::path& folder, const Record& record, const SweepReport* report) {
    const BuildInfo build = build_info();
    Json json{{"flotilla_sweep", kFormat},           {"version", build.version},          {"commit", record.commit},
              {"compiler", build.compiler},          {"processor", io::processor_name()}, {"written", io::utc_now()},
              {"command_line", record.command_line}, {"duration_s", record.duration},     {"threads", record.threads},
              {"members", members_json(record)}};
    if (report != nullptr) json["results"] = report_json(*report);
    io::write_file(folder / kSweepJson, json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n');
}

void write_tables(const std::filesystem::path& folder, const Plan& plan, const Record& record, const Measured& measured,
                  const SweepReport& report) {
    io::write_file(folder / kSweepCsv, points_csv(report));
    io::write_file(folder / kMembersCsv, members_csv(plan, record, measured));
}

} // namespace flotilla::sweep
