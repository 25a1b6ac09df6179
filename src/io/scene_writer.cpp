// SPDX-License-Identifier: MIT
// Writing of scene files: one line per vertex list, triangle list and body, so that scenes of thousands of bodies stay
// readable and can be compared line by line. Numbers are the shortest text that reads back to the same bits.
#include <array>
#include <cmath>
#include <ostream>
#include <span>
#include <sstream>

#include <flotilla/scene_file.hpp>

#include "base/floating_point.hpp"
#include "base/text.hpp"
#include "base/vec3.hpp"
#include "io/json_document.hpp"
#include "io/scene_keys.hpp"
#include "io/scene_parts.hpp"
#include "mesh/triangle_mesh.hpp"
#include "scene/settings_table.hpp"

namespace flotilla {

namespace {

std::string json_string(const std::string& text) {
    return io::Json(text).dump(-1, ' ', false, io::Json::error_handler_t::replace);
}

// "-0" would be read as the integer 0, which has no sign.
std::string json(double value) { return value == 0 && std::signbit(value) ? "-0.0" : to_text(value); }

std::string json_numbers(std::span<const double> values) {
    std::string text = "[";
    for (std::size_t i = 0; i < values.size(); ++i) (text += i > 0 ? ", " : "") += json(values[i]);
    return text += ']';
}

std::string json(const Vec3& v) { return json_numbers(std::array{v.x, v.y, v.z}); }
std::string json(const Quat& q) { return json_numbers(std::array{q.w, q.x, q.y, q.z}); }
std::string json(std::int32_t i) { return std::to_string(i); }
template <std::size_t N>
std::string json(const std::array<std::int32_t, N>& indices) {
    std::string text = "[";
    for (std::size_t i = 0; i < N; ++i) (text += i > 0 ? ", " : "") += std::to_string(indices[i]);
    return text += ']';
}

std::string json(const NamedPair& pair) {
    std::string text = "[";
    text.append(json_string(pair.a)).append(", ").append(json_string(pair.b));
    return text += ']';
}

template <class Items>
void write_list(std::ostream& out, const Items& items) {
    out << '[';
    for (std::size_t i = 0; i < items.size(); ++i) out << (i > 0 ? ", " : "") << json(items[i]);
    out << ']';
}

void write_settings(std::ostream& out, const Settings& settings) {
    bool first = true;
    for (const SettingRow& row : settings_table()) {
        const std::string value = setting_value(settings, row.key);
        if (value == setting_value(Settings{}, row.key)) continue;
        const bool is_text = std::holds_alternative<ChoiceField>(row.field);
        out << (first ? "  \"settings\": {\n" : ",\n") << "    \"" << row.key
            << "\": " << (is_text ? json_string(value) : value);
        first = false;
    }
    if (!first) out << "\n  },\n";
}

void write_mass(std::ostream& out, const ShapeDescription& shape) {
    switch (shape.mass_kind) {
    case MassKind::surface_density: out << ", \"surface_density\": " << json(shape.mass_value); break;
    case MassKind::density: out << ", \"density\": " << json(shape.mass_value); break;
    case MassKind::line_density: out << ", \"line_density\": " << json(shape.mass_value); break;
    case MassKind::mass: out << ", \"mass\": " << json(shape.mass_value); break;
    case MassKind::none: break;
    }
    if (shape.inertia) out << ", \"inertia\": " << json_numbers(shape.inertia->m);
    if (shape.center_of_mass) out << ", \"center_of_mass\": " << json(*shape.center_of_mass);
}

/// The lists that a reader appends to each other, or all as triangles where that would be other elements or another
/// order.
void write_elements(std::ostream& out, const std::vector<Triangle>& triangles) {
    std::vector<Triangle> faces, elements;
    std::vector<std::array<std::int32_t, 2>> segments;
    std::vector<std::int32_t> points;
    for (const Triangle& t : triangles) {
        if (element_of(t) == ElementKind::triangle) faces.push_back(t);
        if (element_of(t) == ElementKind::segment) segments.push_back(segment_ends(t));
        if (element_of(t) == ElementKind::point) points.push_back(t[0]);
    }
    elements = faces;
    for (const auto& [a, b] : segments) elements.push_back(segment_element(a, b));
    for (const std::int32_t i : points) elements.push_back(point_element(i));
    const bool apart = elements == triangles;
    if (!apart || !faces.empty() || elements.empty()) {
        out << ",\n     \"triangles\": ";
        write_list(out, apart ? faces : triangles);
    }
    if (!apart) return;
    if (!segments.empty()) write_list(out << ",\n     \"segments\": ", segments);
    if (!points.empty()) write_list(out << ",\n     \"points\": ", points);
}

void write_shape(std::ostream& out, const ShapeDescription& shape) {
    out << "{\"name\": " << json_string(shape.name);
    if (!shape.mesh_path.empty()) {
        out << ", \"mesh\": " << json_string(shape.mesh_path);
        if (shape.scale != 1) out << ", \"scale\": " << json(shape.scale);
        write_mass(out, shape);
    } else {
        write_mass(out, shape);
        out << ",\n     \"vertices\": ";
        write_list(out, shape.vertices);
        write_elements(out, shape.triangles);
    }
    out << '}';
}

void write_keyframes(std::ostream& out, const std::vector<Keyframe>& keyframes) {
    out << ", \"keyframes\": [";
    for (std::size_t i = 0; i < keyframes.size(); ++i)
        out << (i > 0 ? ", " : "") << "{\"time\": " << json(keyframes[i].time)
            << ", \"position\": " << json(keyframes[i].position) << ", \"rotation\": " << json(keyframes[i].rotation)
            << '}';
    out << ']';
}

void write_locked(std::ostream& out, const BodyDescription& body) {
    std::string list;
    for (std::size_t axis = 0; axis < io::kLockedAxes.size(); ++axis)
        if (axis < 3 ? body.locked_translation[axis] : body.locked_rotation[axis - 3])
            list += (list.empty() ? "" : ", ") + json_string(std::string(io::kLockedAxes[axis]));
    if (!list.empty()) out << ", \"locked\": [" << list << ']';
}

void write_body(std::ostream& out, const BodyDescription& body, const SceneDescription& scene) {
    out << "{\"name\": " << json_string(body.name)
        << ", \"shape\": " << json_string(scene.shapes[static_cast<std::size_t>(body.shape)].name);
    if (body.type == BodyType::fixed) out << ", \"type\": \"static\"";
    if (body.type == BodyType::kinematic) out << ", \"type\": \"kinematic\"";
    if (body.position != Vec3{}) out << ", \"position\": " << json(body.position);
    if (body.rotation != Quat{}) out << ", \"rotation\": " << json(body.rotation);
    if (body.velocity != Vec3{}) out << ", \"velocity\": " << json(body.velocity);
    if (body.angular_velocity != Vec3{}) out << ", \"angular_velocity\": " << json(body.angular_velocity);
    if (body.friction != scene.settings.friction) out << ", \"friction\": " << json(body.friction);
    if (body.restitution != scene.settings.restitution) out << ", \"restitution\": " << json(body.restitution);
    if (!body.keyframes.empty()) write_keyframes(out, body.keyframes);
    if (!body.group.empty()) out << ", \"group\": " << json_string(body.group);
    write_locked(out, body);
    if (body.force != Vec3{}) out << ", \"force\": " << json(body.force);
    if (body.torque != Vec3{}) out << ", \"torque\": " << json(body.torque);
    out << '}';
}

void write_ignored(std::ostream& out, const SceneDescription& scene) {
    if (scene.ignored_groups.empty() && scene.ignored_bodies.empty()) return;
    out << ",\n  \"ignore\": {\"groups\": ";
    write_list(out, scene.ignored_groups);
    out << ", \"bodies\": ";
    write_list(out, scene.ignored_bodies);
    out << '}';
}

} // namespace

std::string io::shape_json(const ShapeDescription& shape) {
    std::ostringstream out;
    write_shape(out, shape);
    return out.str();
}

std::string io::body_json(const BodyDescription& body, const SceneDescription& scene) {
    std::ostringstream out;
    write_body(out, body, scene);
    return out.str();
}

void write_scene(std::ostream& out, const SceneDescription& scene) {
    const DefaultFloatingPoint environment;
    out << "{\n  \"flotilla_scene\": 1,\n  \"gravity\": " << json(scene.gravity) << ",\n";
    write_settings(out, scene.settings);
    out << "  \"shapes\": [";
    for (std::size_t i = 0; i < scene.shapes.size(); ++i)
        write_shape(out << (i > 0 ? ",\n    " : "\n    "), scene.shapes[i]);
    out << "\n  ],\n  \"bodies\": [";
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        write_body(out << (i > 0 ? ",\n    " : "\n    "), scene.bodies[i], scene);
    out << "\n  ]";
    write_ignored(out, scene);
    out << "\n}\n";
}

} // namespace flotilla
