// SPDX-License-Identifier: MIT
#include "run_folder/run_files.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>
#include <fstream>

#include <sys/utsname.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include <flotilla/build_info.hpp>
#include <flotilla/error.hpp>

#include "io/flat.hpp"
#include "io/number.hpp"

namespace flotilla::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kMostSubsteps = 1000; // that the settings allow

/// "frames-A-B.h5"
std::optional<SegmentFile> parse_segment(const fs::path& path) {
    const std::string name = path.filename().string();
    const std::string_view view = name;
    if (!view.starts_with("frames-") || !view.ends_with(".h5")) return {};
    const std::string_view range = view.substr(7, view.size() - 10);
    const std::size_t dash = range.find('-');
    SegmentFile segment{0, 0, path};
    if (dash == std::string_view::npos || !parse_number(range.substr(0, dash), segment.first) ||
        !parse_number(range.substr(dash + 1), segment.last) || segment.first < 0 || segment.last < segment.first)
        return {};
    return segment;
}

bool is_run_file(const std::string& name) {
    const std::string_view view = name;
    const std::string_view base =
        view.ends_with(kTemporarySuffix) ? view.substr(0, view.size() - kTemporarySuffix.size()) : view;
    return base == kRunJson || base == kSceneJson || base == kMeshes || base == kStepsCsv || base == kEditsJson ||
           (base.ends_with(".h5") && (base.starts_with("frames-") || base.starts_with("checkpoint-")));
}

std::vector<fs::path> entries(const fs::path& folder) {
    std::error_code error;
    std::vector<fs::path> paths;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
        paths.push_back(it->path());
    if (error) throw IoError(folder.string() + ": cannot read the folder: " + error.message());
    return paths;
}

Json machine() {
    utsname name{};
    ::uname(&name);
    return {{"host", name.nodename},
            {"system", std::string(name.sysname) + " " + name.release},
            {"architecture", name.machine},
            {"processor", processor_name()},
            {"cores", ::sysconf(_SC_NPROCESSORS_ONLN)}};
}

std::string hex(std::uint64_t value) {
    char buffer[16];
    return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value, 16).ptr};
}

} // namespace

std::string processor_name() {
    std::ifstream cpuinfo("/proc/cpuinfo");
    for (std::string line; std::getline(cpuinfo, line);)
        if (line.starts_with("model name") && line.find(": ") != std::string::npos)
            return line.substr(line.find(": ") + 2);
    return "unknown";
}

std::string padded(std::int64_t value) {
    const std::string digits = std::to_string(value);
    return std::string(digits.size() < 8 ? 8 - digits.size() : 0, '0') + digits;
}

fs::path segment_path(const fs::path& folder, std::int64_t first, std::int64_t last) {
    return folder / ("frames-" + padded(first) + "-" + padded(last) + ".h5");
}

std::vector<SegmentFile> list_segments(const fs::path& folder) {
    std::vector<SegmentFile> all;
    for (const auto& path : entries(folder))
        if (auto segment = parse_segment(path)) all.push_back(*std::move(segment));
    std::sort(all.begin(), all.end(), [](const SegmentFile& a, const SegmentFile& b) {
        return a.first != b.first ? a.first < b.first : a.last > b.last;
    });
    std::vector<SegmentFile> kept;
    for (auto& segment : all)
        if (kept.empty() || segment.last > kept.back().last) kept.push_back(std::move(segment));
    return kept;
}

void remove_run_files(const fs::path& folder) {
    for (const auto& path : entries(folder)) {
        if (!is_run_file(path.filename().string())) continue;
        std::error_code error;
        fs::remove(path, error);
        if (error) throw IoError(path.string() + ": cannot remove: " + error.message());
    }
}

std::string utc_now() {
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

namespace {

Json pairs_json(const std::vector<NamedPair>& pairs) {
    Json list = Json::array();
    for (const NamedPair& pair : pairs) list.push_back({pair.a, pair.b});
    return list;
}

std::vector<NamedPair> parse_pairs(const Json& list) {
    std::vector<NamedPair> pairs;
    for (const Json& pair : list) pairs.push_back({pair.at(0).get<std::string>(), pair.at(1).get<std::string>()});
    return pairs;
}

} // namespace

std::string run_json_text(const RunInfo& info, std::size_t bodies, const std::string& started,
                          const std::string& status, std::int64_t frames) {
    const BuildInfo build = build_info();
    Json json{{"flotilla_run", 1},
              {"status", status},
              {"version", build.version},
              {"commit", build.commit},
              {"compiler", build.compiler},
              {"flags", build.flags},
              {"machine", machine()},
              {"threads", info.threads},
              {"seed", info.seed},
              {"scene_hash", hex(info.scene_hash)},
              {"command_line", info.command_line},
              {"started", started},
              {"updated", utc_now()},
              {"bodies", bodies},
              {"frames", frames},
              {"frame_every", info.frame_every},
              {"time_step", info.time_step},
              {"trajectory", info.trajectory == Trajectory::rigid ? "rigid" : "linear"}};
    if (info.substeps > 1) json["substeps"] = info.substeps;
    if (!info.edits_json.empty()) json["scene_bodies"] = info.scene_bodies;
    if (!info.ignored_groups.empty() || !info.ignored_bodies.empty() || !info.groups.empty())
        json["ignore"] = {{"groups", pairs_json(info.ignored_groups)},
                          {"bodies", pairs_json(info.ignored_bodies)},
                          {"groups_of_bodies", pairs_json(info.groups)}};
    json["resumed"] = Json::parse(info.record.resumed);
    json["settings"] = Json::parse(info.settings_json);
    return json.dump(2) + "\n";
}

std::string resumed_json(const std::string& earlier, const RunInfo& info, std::int64_t step) {
    Json list = Json::parse(earlier);
    list.push_back({{"after_step", step},
                    {"time", utc_now()},
                    {"commit", build_info().commit},
                    {"machine", machine()},
                    {"threads", info.threads},
                    {"command_line", info.command_line}});
    return list.dump();
}

RunInfo parse_run_json(const fs::path& path, const std::string& text) {
    try {
        const Json json = Json::parse(text);
        if (json.at("flotilla_run") != 1) throw IoError(path.string() + ": written by a newer version of flotilla");
        RunInfo info;
        info.command_line = json.at("command_line").get<std::vector<std::string>>();
        info.threads = json.at("threads").get<int>();
        info.seed = json.at("seed").get<std::uint64_t>();
        info.settings_json = json.at("settings").dump();
        info.scene_hash = std::stoull(json.at("scene_hash").get<std::string>(), nullptr, 16);
        info.trajectory = json.at("trajectory") == "rigid" ? Trajectory::rigid : Trajectory::linear;
        info.time_step = json.at("time_step").get<double>();
        info.substeps = json.value("substeps", 1);
        info.frame_every = json.at("frame_every").get<int>();
        if (info.threads < 1 || info.substeps < 1 || info.substeps > kMostSubsteps || info.frame_every < 1 ||
            !(info.time_step > 0) || !json.value("resumed", Json::array()).is_array())
            throw IoError(path.string() + ": damaged: a value is out of range");
        info.scene_bodies = json.value("scene_bodies", std::size_t{0});
        if (json.contains("ignore")) {
            const Json& ignored = json.at("ignore");
            info.ignored_groups = parse_pairs(ignored.at("groups"));
            info.ignored_bodies = parse_pairs(ignored.at("bodies"));
            info.groups = parse_pairs(ignored.at("groups_of_bodies"));
        }
        const auto text_of = [&json](const char* key) { return json.at(key).get<std::string>(); };
        info.record = {text_of("status"),   text_of("version"), text_of("commit"),
                       text_of("compiler"), text_of("flags"),   json.at("machine").at("processor").get<std::string>(),
                       text_of("started"),  text_of("updated"), json.value("resumed", Json::array()).dump()};
        return info;
    } catch (const Json::exception& error) {
        throw IoError(path.string() + ": damaged: " + error.what());
    } catch (const std::logic_error&) { // a hash that is no number
        throw IoError(path.string() + ": damaged: bad scene_hash");
    }
}

namespace {

std::uint64_t scene_checksum(const RunScene& scene) {
    std::vector<std::uint64_t> parts;
    const auto add = [&parts](auto span) { parts.push_back(checksum(std::as_bytes(span))); };
    for (const auto& shape : scene.shapes) {
        add(std::span(shape.name));
        add(flat(std::span(shape.mesh.vertices)));
        add(flat(std::span(shape.mesh.triangles)));
        add(std::span<const Vec3>(&shape.center_of_mass, 1));
    }
    for (const auto& body : scene.bodies) {
        add(std::span(body.name));
        parts.push_back(static_cast<std::uint64_t>(body.shape));
        parts.push_back(static_cast<std::uint64_t>(body.type));
    }
    return checksum(std::as_bytes(std::span(parts)));
}

std::string shape_group(std::size_t index) { return "/shapes/" + std::to_string(index); }

void write_shape(Hdf5Writer& file, const std::string& group, const RunShape& shape) {
    file.create_group(group);
    file.attribute(group, "name", shape.name);
    file.write<double>(group + "/vertices", flat(std::span(shape.mesh.vertices)), {shape.mesh.vertices.size(), 3});
    file.write<std::int32_t>(group + "/triangles", flat(std::span(shape.mesh.triangles)),
                             {shape.mesh.triangles.size(), 3});
    file.write<double>(group + "/center_of_mass", flat(std::span<const Vec3>(&shape.center_of_mass, 1)), {3});
}

[[noreturn]] void fail_damaged(const Hdf5Reader& file, const std::string& what) {
    throw IoError(file.path().string() + ": damaged: " + what + "; the run's frames cannot be placed without it");
}

RunShape read_shape(const Hdf5Reader& file, const std::string& group) {
    RunShape shape;
    shape.name = file.string_attribute(group, "name");
    const auto vertices = file.read<double>(group + "/vertices");
    const auto triangles = file.read<std::int32_t>(group + "/triangles");
    const auto center = file.read<double>(group + "/center_of_mass");
    if (vertices.size() % 3 != 0 || triangles.size() % 3 != 0 || center.size() != 3) fail_damaged(file, group);
    shape.mesh.vertices.resize(vertices.size() / 3);
    std::memcpy(static_cast<void*>(shape.mesh.vertices.data()), vertices.data(), vertices.size() * sizeof(double));
    shape.mesh.triangles.resize(triangles.size() / 3);
    std::memcpy(shape.mesh.triangles.data(), triangles.data(), triangles.size() * sizeof(std::int32_t));
    shape.center_of_mass = {center[0], center[1], center[2]};
    const auto num_vertices = static_cast<std::int32_t>(shape.mesh.vertices.size());
    for (const std::int32_t v : triangles)
        if (v < 0 || v >= num_vertices) fail_damaged(file, group);
    return shape;
}

} // namespace

void write_meshes(const fs::path& path, const RunScene& scene) {
    Hdf5Writer file;
    file.create_group("/shapes");
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) write_shape(file, shape_group(i), scene.shapes[i]);
    file.attribute("/shapes", "count", static_cast<std::int64_t>(scene.shapes.size()));
    std::vector<std::string> names;
    std::vector<std::int32_t> shapes;
    std::vector<std::uint8_t> types;
    for (const auto& body : scene.bodies) {
        names.push_back(body.name);
        shapes.push_back(body.shape);
        types.push_back(static_cast<std::uint8_t>(body.type));
    }
    file.create_group("/bodies");
    file.write_strings("/bodies/name", names);
    file.write<std::int32_t>("/bodies/shape", shapes, {shapes.size()});
    file.write<std::uint8_t>("/bodies/type", types, {types.size()});
    file.attribute("/", "flotilla_meshes", std::int64_t{1});
    file.attribute("/", "checksum", static_cast<std::int64_t>(scene_checksum(scene)));
    write_file(path, file.finish());
}

RunScene read_meshes(const fs::path& path) {
    const Hdf5Reader file(path);
    RunScene scene;
    const auto count = file.int_attribute("/shapes", "count");
    for (std::int64_t i = 0; i < count; ++i)
        scene.shapes.push_back(read_shape(file, shape_group(static_cast<std::size_t>(i))));
    const auto names = file.read_strings("/bodies/name");
    const auto shapes = file.read<std::int32_t>("/bodies/shape");
    const auto types = file.read<std::uint8_t>("/bodies/type");
    if (shapes.size() != names.size() || types.size() != names.size()) fail_damaged(file, "/bodies");
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (shapes[i] < 0 || shapes[i] >= count || types[i] > static_cast<std::uint8_t>(BodyType::kinematic))
            fail_damaged(file, "/bodies");
        scene.bodies.push_back({names[i], shapes[i], static_cast<BodyType>(types[i])});
    }
    if (scene_checksum(scene) != static_cast<std::uint64_t>(file.int_attribute("/", "checksum")))
        fail_damaged(file, "the meshes do not match their checksum");
    return scene;
}

} // namespace flotilla::io
