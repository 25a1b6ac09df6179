// SPDX-License-Identifier: MIT
// USD as text (usda): one UsdGeomPointInstancer with a prototype per shape and an instance per body.
#include <cmath>
#include <numbers>

#include "io/number.hpp"
#include "run_folder/drawn_mesh.hpp"
#include "run_folder/export.hpp"
#include "run_folder/file_stream.hpp"
#include "run_folder/frames_in_order.hpp"
#include "run_folder/held_poses.hpp"

namespace flotilla::io {
namespace {

/// USD's arrays of points and quaternions are single precision or less: more digits would be noise.
void append_float(std::string& text, double value) {
    char buffer[32];
    text.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, static_cast<float>(value)).ptr);
}

void append_tuple(std::string& text, std::initializer_list<double> values) {
    char separator = '(';
    for (const double value : values) {
        text += separator;
        append_float(text, value);
        separator = ',';
    }
    text += ')';
}
void append_item(std::string& text, const Vec3& v) { append_tuple(text, {v.x, v.y, v.z}); }
void append_item(std::string& text, const Quat& q) { append_tuple(text, {q.w, q.x, q.y, q.z}); }
void append_item(std::string& text, std::integral auto value) { append_number(text, value); }

/// In quotes; USD takes UTF-8, and backslashes as C does.
void append_item(std::string& text, const std::string& value) {
    text += '"';
    for (const char c : value) {
        if (c == '"' || c == '\\') text += '\\';
        text += c == '\n' || c == '\r' ? ' ' : c;
    }
    text += '"';
}

template <class Items>
std::string list(const Items& items) {
    std::string text = "[";
    for (const auto& item : items) {
        if (text.size() > 1) text += ',';
        append_item(text, item);
    }
    return text + "]";
}

/// Names of prims are identifiers; the number keeps them apart.
std::string prim_name(std::size_t index, const std::string& name) {
    std::string safe = "shape_" + std::to_string(index) + "_";
    for (const char c : name.substr(0, 60))
        safe += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
    return safe;
}

std::string header(const RunReader& run, const FrameRange& range) {
    std::string text =
        "#usda 1.0\n(\n    defaultPrim = \"run\"\n    metersPerUnit = 1\n    upAxis = \"Z\"\n    startTimeCode = ";
    append_number(text, range.first);
    text += "\n    endTimeCode = ";
    append_number(text, range.last);
    text += "\n    timeCodesPerSecond = ";
    append_number(text, 1 / (run.info().time_step * run.info().frame_every));
    return text + "\n)\n\n";
}

/// Segments and points as tubes and balls: an instancer's prototypes are easiest on readers when they are meshes.
std::string prototype(std::size_t index, const RunShape& shape) {
    const TriangleMesh mesh = drawn_triangles(shape.mesh);
    std::vector<std::int32_t> corners;
    for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
    const std::vector<std::int32_t> counts(mesh.triangles.size(), 3);
    return "            def Mesh \"" + prim_name(index, shape.name) +
           "\"\n            {\n                uniform bool doubleSided = 1\n"
           "                uniform token subdivisionScheme = \"none\"\n                int[] faceVertexCounts = " +
           list(counts) + "\n                int[] faceVertexIndices = " + list(corners) +
           "\n                point3f[] points = " + list(mesh.vertices) + "\n            }\n";
}

/// The attributes that do not change.
std::string instances(const RunScene& scene) {
    std::string text = "        rel prototypes = [";
    for (std::size_t i = 0; i < scene.shapes.size(); ++i)
        text += (i == 0 ? "</run/bodies/prototypes/" : ", </run/bodies/prototypes/") +
                prim_name(i, scene.shapes[i].name) + ">";
    std::vector<std::int32_t> shapes;
    std::vector<std::int64_t> ids;
    std::vector<std::string> names;
    for (const auto& body : scene.bodies) {
        ids.push_back(static_cast<std::int64_t>(ids.size()));
        shapes.push_back(body.shape);
        names.push_back(body.name);
    }
    return text + "]\n        int64[] ids = " + list(ids) + "\n        int[] protoIndices = " + list(shapes) +
           "\n        string[] primvars:name = " + list(names) +
           " (\n            interpolation = \"vertex\"\n        )\n";
}

/// One attribute over all frames. The file has attribute after attribute, so that a run is read once for each and never
/// held.
template <class Values>
void write_samples(RunReader& run, const FrameRange& range, OutputStream& out, const std::string& attribute,
                   Values values) {
    out.write("        " + attribute + ".timeSamples = {\n");
    frames_in_order(
        run, range, [&](const Frame& frame) { return list(values(frame)); },
        [&](const std::string& made, std::int64_t k) {
            out.write("            " + std::to_string(k) + ": " + made + ",\n");
        });
    out.write("        }\n");
}

/// Bodies that are not there, by number.
std::vector<std::int64_t> absent_ids(const Frame& frame) {
    std::vector<std::int64_t> ids;
    for (std::size_t i = 0; i < frame.position.size(); ++i)
        if (frame.absent(i)) ids.push_back(static_cast<std::int64_t>(i));
    return ids;
}

/// USD's angular velocities are in degrees per second.
std::vector<Vec3> in_degrees(std::vector<Vec3> values) {
    constexpr double kDegrees = 180 / std::numbers::pi;
    for (Vec3& v : values) v = {kDegrees * v.x, kDegrees * v.y, kDegrees * v.z};
    return values;
}

} // namespace

void export_usd(RunReader& run, const FrameRange& range, const std::filesystem::path& file) {
    OutputStream out(file);
    const RunScene& scene = run.scene();
    out.write(header(run, range) + "def Xform \"run\"\n{\n    def PointInstancer \"bodies\"\n    {\n" +
              instances(scene));
    const HeldPoses held(run, range);
    const auto positions = [&](const Frame& f) { return held.any() ? held.hold(f).position : f.position; };
    const auto rotations = [&](const Frame& f) { return held.any() ? held.hold(f).rotation : f.rotation; };
    write_samples(run, range, out, "point3f[] positions", positions);
    // The schema's orientations are half precision, 0.0005 rad; newer readers prefer orientationsf.
    write_samples(run, range, out, "quath[] orientations", rotations);
    write_samples(run, range, out, "quatf[] orientationsf", rotations);
    write_samples(run, range, out, "vector3f[] velocities", [](const Frame& f) { return f.velocity; });
    write_samples(run, range, out, "vector3f[] angularVelocities",
                  [](const Frame& f) { return in_degrees(f.angular_velocity); });
    if (held.any()) write_samples(run, range, out, "int64[] invisibleIds", absent_ids);
    out.write("\n        def Scope \"prototypes\"\n        {\n");
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) out.write(prototype(i, scene.shapes[i]));
    out.write("        }\n    }\n}\n");
    out.close();
}

} // namespace flotilla::io
