// SPDX-License-Identifier: MIT
// VTK's XML format for polygonal data, arrays as base64 so that files stay small and exact.
#include <algorithm>
#include <array>
#include <bit>

#include "base/vec3.hpp"
#include "io/base64.hpp"
#include "io/number.hpp"
#include "run_folder/export.hpp"
#include "run_folder/frames_in_order.hpp"
#include "run_folder/run_files.hpp"

namespace flotilla::io {
namespace {

template <typename T>
std::string type_name();
template <>
std::string type_name<double>() {
    return "Float64";
}
template <>
std::string type_name<std::int64_t>() {
    return "Int64";
}

/// <DataArray>: the number of bytes and the bytes, in one base64 stream.
template <typename T>
std::string data_array(const std::string& name, std::size_t components, std::span<const T> values) {
    static_assert(std::endian::native == std::endian::little);
    const std::uint64_t size = values.size_bytes();
    std::vector<std::byte> bytes(sizeof size + size);
    std::copy_n(reinterpret_cast<const std::byte*>(&size), sizeof size, bytes.begin());
    const auto data = std::as_bytes(values);
    std::copy(data.begin(), data.end(), bytes.begin() + sizeof size);
    return "<DataArray type=\"" + type_name<T>() + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
           std::to_string(components) + "\" format=\"binary\">" + base64(bytes) + "</DataArray>\n";
}

std::vector<double> flat(std::span<const Vec3> vectors) {
    std::vector<double> values;
    for (const Vec3& v : vectors) values.insert(values.end(), {v.x, v.y, v.z});
    return values;
}

/// 0, step, 2 step, ...
std::vector<std::int64_t> multiples(std::size_t count, std::int64_t step, std::int64_t first) {
    std::vector<std::int64_t> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(first + static_cast<std::int64_t>(i) * step);
    return values;
}

constexpr std::string_view kFileBegin = "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
                                        "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n";
constexpr std::string_view kFileEnd = "</Piece>\n</PolyData>\n</VTKFile>\n";

std::string piece(std::size_t points, std::size_t vertices, std::size_t lines, std::size_t polygons) {
    return "<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfVerts=\"" + std::to_string(vertices) +
           "\" NumberOfLines=\"" + std::to_string(lines) + "\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
           std::to_string(polygons) + "\">\n";
}

std::string points(std::span<const Vec3> positions) {
    return "<Points>\n" + data_array<double>("Points", 3, flat(positions)) + "</Points>\n";
}

/// Cells whose corners are numbered one after the other.
std::string cells(const std::string& tag, std::span<const std::int64_t> corners, std::size_t count,
                  std::int64_t corners_each) {
    return "<" + tag + ">\n" + data_array<std::int64_t>("connectivity", 1, corners) +
           data_array<std::int64_t>("offsets", 1, multiples(count, corners_each, corners_each)) + "</" + tag + ">\n";
}

std::string mesh_file(const TriangleMesh& mesh) {
    std::array<std::vector<std::int64_t>, 3> corners; // by dimension
    for (const Triangle& t : mesh.triangles) {
        const ElementKind kind = element_of(t);
        const auto [a, b] = segment_ends(t);
        const Triangle named = kind == ElementKind::triangle ? t : Triangle{a, b, b};
        const auto used = std::span(named).first(static_cast<std::size_t>(kind) + 1);
        corners[used.size() - 1].insert(corners[used.size() - 1].end(), used.begin(), used.end());
    }
    const auto count = [&](std::size_t dimension) { return corners[dimension].size() / (dimension + 1); };
    std::string text =
        std::string(kFileBegin) + piece(mesh.vertices.size(), count(0), count(1), count(2)) + points(mesh.vertices);
    if (count(0) > 0) text += cells("Verts", corners[0], count(0), 1);
    if (count(1) > 0) text += cells("Lines", corners[1], count(1), 2);
    return text + cells("Polys", corners[2], count(2), 3) + std::string(kFileEnd);
}

/// Those of the bodies in `there`.
template <class T>
std::vector<T> of(const std::vector<std::size_t>& there, const std::vector<T>& values) {
    std::vector<T> out;
    for (const std::size_t i : there) out.push_back(values[i]);
    return out;
}

std::string activity_arrays(const Activity& activity, const std::vector<std::size_t>& there) {
    if (activity.empty()) return "";
    const auto integers = [&](const auto& values) {
        const auto present = of(there, values);
        return std::vector<std::int64_t>(present.begin(), present.end());
    };
    return data_array<std::int64_t>("contacts", 1, integers(activity.contacts)) +
           data_array<std::int64_t>("cluster", 1, integers(activity.cluster)) +
           data_array<std::int64_t>("cost", 1, integers(activity.cost));
}

std::string frame_file(const RunScene& scene, const Frame& frame) {
    std::vector<std::size_t> there;
    std::vector<std::int64_t> body, shape, type;
    std::vector<double> quaternion, speed;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        if (frame.absent(i)) continue;
        there.push_back(i);
        body.push_back(static_cast<std::int64_t>(i));
        shape.push_back(scene.bodies[i].shape);
        type.push_back(static_cast<std::int64_t>(scene.bodies[i].type));
        const Quat& q = frame.rotation[i];
        quaternion.insert(quaternion.end(), {q.w, q.x, q.y, q.z});
        speed.push_back(length(frame.velocity[i]));
    }
    const std::size_t n = there.size();
    return std::string(kFileBegin) + piece(n, n, 0, 0) + "<PointData>\n" + data_array<std::int64_t>("body", 1, body) +
           data_array<std::int64_t>("shape", 1, shape) + data_array<std::int64_t>("type", 1, type) +
           data_array<double>("quaternion", 4, quaternion) +
           data_array<double>("velocity", 3, flat(of(there, frame.velocity))) +
           data_array<double>("angular_velocity", 3, flat(of(there, frame.angular_velocity))) +
           data_array<double>("speed", 1, speed) + activity_arrays(frame.activity, there) + "</PointData>\n" +
           points(of(there, frame.position)) + cells("Verts", multiples(n, 1, 0), n, 1) + std::string(kFileEnd);
}

/// A shape's name as part of a file name.
std::string file_name(const std::string& name) {
    std::string safe;
    for (const char c : name.substr(0, 60))
        safe += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ? c : '_';
    return safe;
}

} // namespace

void export_vtp(RunReader& run, const FrameRange& range, const std::filesystem::path& folder) {
    create_folder(folder / "frames");
    create_folder(folder / "meshes");
    const RunScene& scene = run.scene();
    for (std::size_t i = 0; i < scene.shapes.size(); ++i)
        write_file(folder / "meshes" / (std::to_string(i) + "-" + file_name(scene.shapes[i].name) + ".vtp"),
                   mesh_file(scene.shapes[i].mesh));
    std::string collection = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
    const auto make = [&](const Frame& frame) { return std::pair(frame.time, frame_file(scene, frame)); };
    const auto use = [&](const std::pair<double, std::string>& made, std::int64_t k) {
        const std::string name = "frames/bodies-" + padded(k) + ".vtp";
        write_file(folder / name, made.second);
        collection += "<DataSet timestep=\"";
        append_number(collection, made.first);
        collection += "\" part=\"0\" file=\"" + name + "\"/>\n";
    };
    frames_in_order(run, range, make, use);
    write_file(folder / "bodies.pvd", collection + "</Collection>\n</VTKFile>\n");
}

} // namespace flotilla::io
