// SPDX-License-Identifier: MIT
// CSV and OBJ.
#include "io/number.hpp"
#include "mesh/placement.hpp"
#include "run_folder/export.hpp"
#include "run_folder/frames_in_order.hpp"
#include "run_folder/poses_csv.hpp"
#include "run_folder/run_files.hpp"

namespace flotilla::io {
namespace {

/// OBJ takes a name up to the end of the line.
std::string one_line(std::string name) {
    for (char& c : name)
        if (c == '\n' || c == '\r') c = ' ';
    return name;
}

void append_object(std::string& text, const RunShape& shape, const std::string& name, std::span<const Vec3> world,
                   std::size_t first_vertex) {
    text.append("o ").append(one_line(name)).append("\n");
    for (const Vec3& v : world) {
        text += 'v';
        for (const double x : {v.x, v.y, v.z}) {
            text += ' ';
            append_number(text, x);
        }
        text += '\n';
    }
    for (const Triangle& t : shape.mesh.triangles) {
        constexpr std::array kKeywords{'p', 'l', 'f'};
        const auto corners = static_cast<std::size_t>(element_of(t));
        const auto [a, b] = segment_ends(t);
        const Triangle elements = corners == 2 ? t : Triangle{a, b, b};
        text += kKeywords[corners];
        for (const std::int32_t i : std::span(elements).first(corners + 1)) {
            text += ' ';
            append_number(text, first_vertex + static_cast<std::size_t>(i) + 1);
        }
        text += '\n';
    }
}

} // namespace

void export_csv(RunReader& run, const FrameRange& range, const std::function<void(std::string_view)>& write) {
    std::vector<std::string> names;
    for (const auto& body : run.scene().bodies) names.push_back(body.name);
    write(std::string(kPosesHeader) + "\n");
    frames_in_order(
        run, range, [&](const Frame& frame) { return poses_csv_rows(frame, names); },
        [&](const std::string& rows, std::int64_t) { write(rows); });
}

void export_obj(RunReader& run, const FrameRange& range, const std::filesystem::path& folder) {
    create_folder(folder);
    const RunScene& scene = run.scene();
    const auto make = [&](const Frame& frame) {
        std::string text;
        std::vector<Vec3> world;
        std::size_t vertices = 0;
        for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
            if (frame.absent(i)) continue;
            const RunShape& shape = scene.shapes[static_cast<std::size_t>(scene.bodies[i].shape)];
            world.resize(shape.mesh.vertices.size());
            world_vertices(shape.mesh.vertices, frame.position[i], frame.rotation[i], world);
            append_object(text, shape, scene.bodies[i].name, world, vertices);
            vertices += world.size();
        }
        return text;
    };
    frames_in_order(run, range, make, [&](const std::string& text, std::int64_t k) {
        write_file(folder / ("frame-" + padded(k) + ".obj"), text);
    });
}

} // namespace flotilla::io
