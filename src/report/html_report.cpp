// SPDX-License-Identifier: MIT
#include "report/html_report.hpp"

#include <bit>
#include <cmath>
#include <span>
#include <string_view>

#include <nlohmann/json.hpp>

#include <flotilla/error.hpp>

#include "io/base64.hpp"
#include "report/page.hpp"
#include "report/pose_track.hpp"
#include "report/step_columns.hpp"
#include "report/tables.hpp"
#include "run_folder/drawn_mesh.hpp"
#include "run_folder/file_stream.hpp"
#include "run_folder/run_files.hpp"

namespace flotilla::report {
namespace {

using Json = nlohmann::ordered_json;

/// Rows beyond this are thinned out: more than a plot has pixels.
constexpr std::size_t kPlotRows = 20000;

template <typename T>
std::string packed(std::span<const T> values) {
    static_assert(std::endian::native == std::endian::little);
    return io::base64(std::as_bytes(values));
}

/// Of whatever path names the folder, "." included.
std::string name_of(const std::filesystem::path& folder) {
    std::error_code error;
    const auto path = std::filesystem::weakly_canonical(folder, error);
    const auto name = (error ? folder : path).filename().string();
    return name.empty() ? folder.string() : name;
}

/// Vertices about the middle of the bounding box, in single precision: r places that point.
Json shape_json(const io::RunShape& shape) {
    const Vec3 center = middle(shape.mesh);
    const TriangleMesh mesh = io::drawn_triangles(shape.mesh);
    std::vector<float> vertices;
    for (const Vec3& v : mesh.vertices)
        for (const double x : {v.x - center.x, v.y - center.y, v.z - center.z})
            vertices.push_back(static_cast<float>(x));
    std::vector<std::uint32_t> corners;
    for (const Triangle& t : mesh.triangles)
        for (const std::int32_t i : t) corners.push_back(static_cast<std::uint32_t>(i));
    return Json{
        {"name", shape.name}, {"vertices", packed<float>(vertices)}, {"triangles", packed<std::uint32_t>(corners)}};
}

Json shapes_json(const io::RunScene& scene) {
    Json shapes = Json::array();
    for (const io::RunShape& shape : scene.shapes) shapes.push_back(shape_json(shape));
    return shapes;
}

Json groups_json(const DrawOrder& order) {
    Json groups = Json::array();
    for (const DrawGroup& group : order.groups)
        groups.push_back(
            Json{{"shape", group.shape}, {"fixed", group.fixed}, {"first", group.first}, {"count", group.count}});
    return groups;
}

Json bodies_json(const io::RunScene& scene, const DrawOrder& order) {
    Json names = Json::array();
    for (const std::int32_t i : order.bodies) names.push_back(scene.bodies[static_cast<std::size_t>(i)].name);
    return Json{{"count", order.bodies.size()}, {"names", std::move(names)}, {"indices", order.bodies}};
}

Json track_json(const PoseTrack& track) {
    return Json{{"frames", track.frames},
                {"times", track.times},
                {"frames_in_run", track.frames_in_run},
                {"frame_every", track.frame_every},
                {"origin", {track.origin.x, track.origin.y, track.origin.z}},
                {"top_speed", track.top_speed},
                {"boxes", packed<float>(track.boxes)},
                {"position_error", track.position_error},
                {"rotation_error", track.rotation_error}};
}

/// Columns as float32: a plot needs no more.
Json plots_json(const StepColumns& steps, std::size_t every) {
    Json columns = Json::object();
    for (const auto& [name, values] : steps.columns) {
        if (name == "state_hash") continue;
        std::vector<float> kept;
        for (std::size_t i = 0; i < values.size(); i += every) kept.push_back(static_cast<float>(values[i]));
        columns[name] = packed<float>(kept);
    }
    return columns;
}

Json tables_json(const std::vector<Table>& tables) {
    Json json = Json::array();
    for (const Table& table : tables) json.push_back(Json{{"title", table.title}, {"rows", table.rows}});
    return json;
}

const char* verdict_name(Verification::Verdict verdict) {
    switch (verdict) {
    case Verification::Verdict::not_verified: break;
    case Verification::Verdict::proved: return "proved";
    case Verification::Verdict::failed: return "failed";
    case Verification::Verdict::incomplete: return "incomplete";
    }
    return "not verified";
}

/// A script element ends at "</script" and can be thrown off by "<!--": no "<" is left. It occurs in strings only.
std::string script_text(const Json& json) {
    const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::string escaped;
    escaped.reserve(text.size());
    for (const char c : text)
        if (c == '<')
            escaped += "\\u003c";
        else
            escaped += c;
    return escaped;
}

StepColumns read_steps(const io::RunReader& run) {
    try {
        return read_step_columns(io::read_text(run.folder() / io::kStepsCsv));
    } catch (const IoError& error) {
        return {{}, {}, {error.what()}};
    }
}

/// The page with its placeholders replaced.
void write_parts(const std::filesystem::path& output, std::string_view data, std::string_view poses) {
    io::OutputStream file(output);
    std::string_view rest = page_html();
    for (const auto& [mark, content] : {std::pair<std::string_view, std::string_view>{"{{style}}", page_style()},
                                        {"{{data}}", data},
                                        {"{{poses}}", poses},
                                        {"{{script}}", page_script()}}) {
        const std::size_t at = rest.find(mark);
        file.write(rest.substr(0, at));
        file.write(content);
        rest.remove_prefix(at + mark.size());
    }
    file.write(rest);
    file.close();
}

} // namespace

PageReport write_page(io::RunReader& run, const Verification& verification, std::int64_t frame_every, int threads,
                      const std::filesystem::path& output) {
    const DrawOrder order = draw_order(run.scene());
    const PoseTrack track = encode_poses(run, order, frame_every, threads);
    const StepColumns steps = read_steps(run);
    const std::size_t rows_every = steps.rows() / kPlotRows + 1;

    PageReport report{static_cast<std::int64_t>(track.frames.size()), track.position_error, track.rotation_error, 0,
                      track.problems};
    report.problems.insert(report.problems.end(), steps.problems.begin(), steps.problems.end());

    const Json data{
        {"name", name_of(run.folder())},
        {"status", run.info().record.status},
        {"verdict", verdict_name(verification.verdict)},
        {"verdict_text", verification.text},
        {"problems", report.problems},
        {"bodies", bodies_json(run.scene(), order)},
        {"groups", groups_json(order)},
        {"shapes", shapes_json(run.scene())},
        {"track", track_json(track)},
        {"plots", plots_json(steps, rows_every)},
        {"tables", tables_json({summary_table(run, steps), provenance_table(run), verification_table(verification),
                                page_table(track, rows_every), warning_table(steps), settings_table(run.info())})}};
    write_parts(output, script_text(data), io::base64(track.stream));
    std::error_code error;
    report.bytes = std::filesystem::file_size(output, error);
    return report;
}

} // namespace flotilla::report
