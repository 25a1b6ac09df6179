// SPDX-License-Identifier: MIT
#include "mpi/ensemble_files.hpp"

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

#include <flotilla/build_info.hpp>
#include <flotilla/error.hpp>

#include "io/file.hpp"
#include "io/number.hpp"
#include "report/step_columns.hpp"
#include "run_folder/run_files.hpp"
#include "sweep/record.hpp"

namespace flotilla::mpi {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr std::array<std::string_view, 5> kStates{"waiting", "running", "stopped", "failed", "complete"};

Json to_json(const Holder& h) { return {{"job", h.job}, {"rank", h.rank}, {"host", h.host}, {"process", h.process}}; }

Holder holder_from(const Json& json) {
    return {json.at("job").get<std::int64_t>(), json.at("rank").get<int>(), json.at("host").get<std::string>(),
            json.at("process").get<std::int64_t>()};
}

Json to_json(const MemberRecord& record) {
    Json lost = Json::array();
    for (const Holder& holder : record.lost) lost.push_back(to_json(holder));
    return {{"input", std::to_string(record.input)},
            {"state", to_text(record.state)},
            {"holder", to_json(record.holder)},
            {"left_to_job", record.left_to_job},
            {"exit_code", record.exit_code},
            {"reason", record.reason},
            {"cpu_s", record.cpu},
            {"lost", lost}};
}

MemberRecord record_from(const Json& json) {
    MemberRecord record;
    if (!io::parse_number(json.at("input").get<std::string>(), record.input)) throw InputError("input: not a number");
    const auto state = json.at("state").get<std::string>();
    const auto* const found = std::find(kStates.begin(), kStates.end(), state);
    if (found == kStates.end()) throw InputError("state: unknown");
    record.state = static_cast<MemberState>(found - kStates.begin());
    record.holder = holder_from(json.at("holder"));
    record.left_to_job = json.at("left_to_job").get<bool>();
    record.exit_code = json.at("exit_code").get<int>();
    record.reason = json.at("reason").get<std::string>();
    record.cpu = json.at("cpu_s").get<double>();
    for (const Json& lost : json.at("lost")) record.lost.push_back(holder_from(lost));
    return record;
}

std::filesystem::path record_file(const sweep::Member& member) {
    return member.run.folder.parent_path() / (member.run.name + ".json");
}

/// What `read` makes of the file. IoError where that is not what this version writes.
template <class Read>
auto read_json(const std::filesystem::path& file, Read&& read) {
    const std::string text = io::read_text(file);
    try {
        return read(Json::parse(text));
    } catch (const nlohmann::json::exception& e) {
        throw IoError(file.string() + ": damaged: " + e.what());
    } catch (const InputError& e) {
        throw IoError(file.string() + ": damaged: " + e.what());
    }
}

void write_json(const std::filesystem::path& file, const Json& json) {
    io::write_file(file, json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n');
}

Json member_json(const sweep::Plan& plan, const sweep::Member& member, const MemberRecord& record,
                 const std::optional<MemberEnd>& end) {
    const sweep::Start& start = plan.starts[member.start];
    const sweep::Point& point = plan.points[member.point];
    Json settings = Json::object();
    for (std::size_t a = 0; a < point.values.size(); ++a) settings[plan.axes[a].key] = point.values[a];
    Json json{{"start", start.name}, {"settings", settings}};
    if (start.seed) json["seed"] = *start.seed;
    json.update(to_json(record));
    if (end) json.update(Json{{"step", end->step}, {"time_s", end->time}, {"state_hash", end->state_hash}});
    return json;
}

std::string csv_header(const sweep::Plan& plan) {
    std::string text = "member,start,seed";
    for (const SweepAxis& axis : plan.axes) text += ',' + axis.key;
    return text + ",state,step,time,energy,kinetic_energy,state_hash,cpu_s,rank,host,lost\n";
}

std::string csv_row(const sweep::Plan& plan, const sweep::Member& member, const MemberRecord& record,
                    const std::optional<MemberEnd>& end) {
    const sweep::Start& start = plan.starts[member.start];
    std::string row = sweep::csv_field(member.run.name) + ',' + sweep::csv_field(start.name) + ',' +
                      (start.seed ? std::to_string(*start.seed) : "");
    for (const std::string& value : plan.points[member.point].values) row += ',' + sweep::csv_field(value);
    (row += ',') += to_text(record.state);
    if (end) {
        row += ',' + std::to_string(end->step);
        for (const double value : {end->time, end->energy, end->kinetic_energy}) {
            row += ',';
            io::append_number(row, value);
        }
        row += ',' + end->state_hash + ',';
    } else {
        row += ",,,,,,";
    }
    io::append_number(row, record.cpu);
    row += ',' + std::to_string(record.holder.rank) + ',' + sweep::csv_field(record.holder.host) + ',' +
           std::to_string(record.lost.size());
    return row + '\n';
}

} // namespace

std::string to_text(const Holder& holder) {
    return "rank " + std::to_string(holder.rank) + " (" + holder.host + ", process " + std::to_string(holder.process) +
           ")";
}

std::string_view to_text(MemberState state) { return kStates[static_cast<std::size_t>(state)]; }

bool MemberRecord::settled(std::int64_t job) const {
    if (state == MemberState::complete) return true;
    return (state == MemberState::failed || state == MemberState::stopped) && holder.job == job && !left_to_job;
}

std::filesystem::path claim_file(const sweep::Member& member) {
    return member.run.folder.parent_path() / (member.run.name + ".claim");
}

MemberRecord read_member(const sweep::Member& member) {
    const std::filesystem::path file = record_file(member);
    if (!std::filesystem::exists(file)) return {member.input, {}, {}, {}, {}, {}, {}, {}};
    MemberRecord record = read_json(file, record_from);
    if (record.state == MemberState::complete && !std::filesystem::exists(member.run.folder / io::kRunJson))
        record.state = MemberState::waiting; // somebody took the run away
    return record;
}

void write_member(const sweep::Member& member, const MemberRecord& record) {
    write_json(record_file(member), to_json(record));
}

std::optional<MemberEnd> read_end(const sweep::Member& member) {
    const std::filesystem::path file = member.run.folder / io::kStepsCsv;
    if (!std::filesystem::exists(file)) return {};
    const report::StepColumns steps = report::read_step_columns(io::read_text(file));
    if (steps.rows() == 0) return {};
    const auto last = [&](const char* column) {
        const std::vector<double>& values = steps.column(column);
        return values.empty() ? 0.0 : values.back();
    };
    return MemberEnd{static_cast<std::int64_t>(last("step")), last("time"), last("energy"), last("kinetic_energy"),
                     steps.last_state_hash};
}

std::optional<Job> read_job(const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / kEnsembleJson;
    if (!std::filesystem::exists(file)) return {};
    return read_json(file, [&](const Json& json) {
        if (json.at("flotilla_ensemble").get<int>() != kFormat)
            throw IoError(file.string() + ": written by another version of flotilla");
        return Job{json.at("job").get<std::int64_t>(), json.at("ranks").get<int>(), {}};
    });
}

void write_ensemble(const std::filesystem::path& folder, const sweep::Plan& plan, const Job& job,
                    const std::vector<MemberRecord>& records) {
    const BuildInfo build = build_info();
    Json members = Json::object();
    std::string table = csv_header(plan);
    for (std::size_t i = 0; i < records.size(); ++i) {
        const sweep::Member& member = plan.members[i];
        const std::optional<MemberEnd> end = read_end(member);
        members[member.run.name] = member_json(plan, member, records[i], end);
        table += csv_row(plan, member, records[i], end);
    }
    write_json(folder / kEnsembleJson, {{"flotilla_ensemble", kFormat},
                                        {"version", build.version},
                                        {"commit", build.commit},
                                        {"compiler", build.compiler},
                                        {"written", io::utc_now()},
                                        {"command_line", job.command_line},
                                        {"job", job.number},
                                        {"ranks", job.ranks},
                                        {"duration_s", plan.duration},
                                        {"members", members}});
    io::write_file(folder / kEnsembleCsv, table);
}

} // namespace flotilla::mpi
