// SPDX-License-Identifier: MIT
#include "scene/description_checks.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include <flotilla/error.hpp>

#include "base/rotation.hpp"
#include "base/text.hpp"
#include "base/vec3.hpp"
#include "scene/scene.hpp"
#include "scene/settings_table.hpp"

namespace flotilla {

namespace {

// Problems of one object of the scene, at paths below its own.
class Checker {
  public:
    Checker(std::string path, ErrorList& errors) : path_(std::move(path)), errors_(errors) {}

    [[nodiscard]] std::string at(std::string_view key) const { return path_ + "/" + std::string(key); }
    [[nodiscard]] bool broken(std::string_view key) const { return errors_.any_under(at(key)); }
    void problem(std::string_view key, std::string reason) const {
        if (!broken(key)) errors_.add(at(key), std::move(reason));
    }

    void magnitude(std::string_view key, const Vec3& v, double limit, std::string_view unit) const {
        if (!is_finite(v))
            problem(key, "must be finite");
        else if (max_component(abs(v)) > limit)
            problem(key, "component " + to_text(max_component(abs(v))) + " exceeds the limit of " + to_text(limit) +
                             " " + std::string(unit));
    }

    // Written so that NaN is refused.
    void range(std::string_view key, double value, double low, double high, std::string_view unit) const {
        if (value >= low && value <= high) return;
        std::string reason = "must be in " + to_text(low) + " .. " + to_text(high);
        if (!unit.empty()) (reason += ' ') += unit;
        problem(key, reason + ", got " + to_text(value));
    }

    void rotation(std::string_view key, Quat& q) const {
        const double length = norm(q);
        if (!(std::abs(length - 1) <= kRotationTolerance)) {
            problem(key, "must be a unit quaternion [w, x, y, z]; its length is " + to_text(length) + ", more than " +
                             to_text(kRotationTolerance) + " from 1");
            return;
        }
        // Twice normalised must be once normalised, or a scene written and read again would differ in the last bit.
        if (std::abs(length - 1) > 4e-16) q = normalized(q);
    }

    void name(const std::string& text) const {
        if (text.empty())
            problem("name", "must not be empty");
        else if (text.size() > kMaxNameLength)
            problem("name", "must not be longer than " + std::to_string(kMaxNameLength) + " bytes");
        else if (std::any_of(text.begin(), text.end(),
                             [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }))
            problem("name", "must not contain control characters: " + in_quotes(text));
    }

  private:
    std::string path_;
    ErrorList& errors_;
};

template <class Named>
void check_names(const std::vector<Named>& items, const char* list, ErrorList& errors) {
    std::unordered_map<std::string_view, std::size_t> first;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Checker check(element_path(list, i), errors);
        if (check.broken("name") || errors.any_at(element_path(list, i))) continue;
        check.name(items[i].name);
        const auto [found, fresh] = first.try_emplace(items[i].name, i);
        if (!fresh)
            check.problem("name",
                          in_quotes(items[i].name) + " is already the name of " + element_path(list, found->second));
    }
}

std::string_view mass_key(MassKind kind) {
    switch (kind) {
    case MassKind::surface_density: return "surface_density";
    case MassKind::density: return "density";
    case MassKind::line_density: return "line_density";
    case MassKind::mass: return "mass";
    case MassKind::none: break;
    }
    return "mass";
}

const char* mass_unit(MassKind kind) {
    switch (kind) {
    case MassKind::surface_density: return "kg/m^2";
    case MassKind::density: return "kg/m^3";
    case MassKind::line_density: return "kg/m";
    case MassKind::mass:
    case MassKind::none: break;
    }
    return "kg";
}

void check_vertices(const ShapeDescription& shape, const Checker& check, const std::string& path, ErrorList& errors) {
    if (check.broken("vertices") || check.broken("mesh") || check.broken("scale")) return;
    for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
        const Vec3& v = shape.vertices[i];
        if (is_finite(v) && max_component(abs(v)) <= kMaxCoordinate) continue;
        const std::string where = shape.mesh_path.empty() ? path + "/vertices/" + std::to_string(i) : path + "/mesh";
        errors.add(where,
                   "vertex " + std::to_string(i) +
                       (is_finite(v) ? ", multiplied by scale, exceeds the limit of " + to_text(kMaxCoordinate) + " m"
                                     : std::string(" must be finite")));
    }
}

void check_triangles(const ShapeDescription& shape, const Checker& check, const std::string& path, ErrorList& errors) {
    if (check.broken("triangles") || check.broken("vertices") || check.broken("mesh")) return;
    if (shape.triangles.empty())
        check.problem("triangles", "must hold at least one triangle, unless there are segments or points");
    const auto count = static_cast<std::int64_t>(shape.vertices.size());
    for (std::size_t i = 0; i < shape.triangles.size(); ++i)
        for (const std::int32_t v : shape.triangles[i])
            if (v < 0 || v >= count)
                errors.add(path + "/triangles/" + std::to_string(i),
                           "vertex " + std::to_string(v) + " does not exist; there are " + std::to_string(count));
}

void check_shape(const ShapeDescription& shape, const std::string& path, ErrorList& errors) {
    const Checker check(path, errors);
    check.range("scale", shape.scale, kMinScale, kMaxScale, "");
    check_vertices(shape, check, path, errors);
    check_triangles(shape, check, path, errors);
    if (shape.mass_kind != MassKind::none)
        check.range(mass_key(shape.mass_kind), shape.mass_value, kMinMassValue, kMaxMassValue,
                    mass_unit(shape.mass_kind));
    else if (shape.inertia && !errors.any_under(path))
        check.problem("inertia", "needs one of surface_density, density, line_density and mass");
    if (shape.center_of_mass) check.magnitude("center_of_mass", *shape.center_of_mass, kMaxCoordinate, "m");
    if (shape.mass_kind == MassKind::none || errors.any_under(path)) return;
    try {
        (void)shape_mass_properties(shape);
    } catch (const InputError& error) {
        errors.add(path, error.what());
    }
}

void check_keyframes(BodyDescription& body, const std::string& path, ErrorList& errors) {
    const Checker check(path, errors);
    if (check.broken("keyframes")) return;
    if (body.keyframes.empty()) return check.problem("keyframes", "a kinematic body needs at least one keyframe");
    // A script may have a million keyframes; more problems than a message shows are not searched for.
    const std::size_t most = errors.problems().size() + ErrorList::kMaxLines;
    for (std::size_t i = 0; i < body.keyframes.size() && errors.problems().size() <= most; ++i) {
        Keyframe& frame = body.keyframes[i];
        const Checker at(path + "/keyframes/" + std::to_string(i), errors);
        at.range("time", frame.time, 0, kMaxTime, "s");
        at.magnitude("position", frame.position, kMaxCoordinate, "m");
        at.rotation("rotation", frame.rotation);
        if (i == 0 && frame.time != 0)
            at.problem("time", "the first keyframe must be at time 0, got " + to_text(frame.time));
        if (i > 0 && !(frame.time > body.keyframes[i - 1].time))
            at.problem("time", "must be later than the keyframe before, " + to_text(body.keyframes[i - 1].time) +
                                   " s; got " + to_text(frame.time) + " s");
    }
}

// A kinematic body starts where its script does; a pose of its own may only repeat that.
void take_first_pose(BodyDescription& body, const Checker& check) {
    if (body.keyframes.empty() || check.broken("keyframes")) return;
    const Keyframe& first = body.keyframes.front();
    if (body.position != Vec3{} && body.position != first.position)
        check.problem("position", "differs from the keyframe at time 0, which is the start of a kinematic body");
    if (body.rotation != Quat{} && body.rotation != first.rotation)
        check.problem("rotation", "differs from the keyframe at time 0, which is the start of a kinematic body");
    body.position = first.position;
    body.rotation = first.rotation;
}

void check_motion(const BodyDescription& body, const Checker& check) {
    check.magnitude("velocity", body.velocity, kMaxCoordinate, "m/s");
    check.magnitude("angular_velocity", body.angular_velocity, kMaxAngularVelocity, "rad/s");
    if (body.type == BodyType::dynamic) return;
    const std::string_view reason = body.type == BodyType::fixed
                                        ? "must be zero: a static body does not move"
                                        : "must be zero: a kinematic body moves by its keyframes";
    if (body.velocity != Vec3{}) check.problem("velocity", std::string(reason));
    if (body.angular_velocity != Vec3{}) check.problem("angular_velocity", std::string(reason));
}

/// A velocity along a locked axis contradicts the lock: whoever wrote both means something else by one of them.
void check_locked(std::string_view key, const Vec3& velocity, const std::array<bool, 3>& locked, const char* axes,
                  const Checker& check) {
    for (int axis = 0; axis < 3; ++axis)
        if (locked[static_cast<std::size_t>(axis)] && component(velocity, axis) != 0)
            check.problem(key, "must be zero along " + std::string(1, "xyz"[axis]) + ", as " + axes + "xyz"[axis] +
                                   "\" is locked, got " + to_text(component(velocity, axis)));
}

void check_locks_and_loads(const BodyDescription& body, const Checker& check) {
    check.magnitude("force", body.force, kMaxForce, "N");
    check.magnitude("torque", body.torque, kMaxForce, "N m");
    if (body.type == BodyType::dynamic) {
        check_locked("velocity", body.velocity, body.locked_translation, "\"", check);
        check_locked("angular_velocity", body.angular_velocity, body.locked_rotation, "\"r", check);
        return;
    }
    const auto any = [](const std::array<bool, 3>& axes) { return axes[0] || axes[1] || axes[2]; };
    if (any(body.locked_translation) || any(body.locked_rotation))
        check.problem("locked", "only a dynamic body has locked axes");
    if (body.force != Vec3{}) check.problem("force", "only a dynamic body has a force");
    if (body.torque != Vec3{}) check.problem("torque", "only a dynamic body has a torque");
}

void check_body_shape(const BodyDescription& body, const SceneDescription& scene, const Checker& check,
                      ErrorList& errors) {
    if (check.broken("shape")) return;
    const auto index = static_cast<std::size_t>(body.shape);
    if (body.shape < 0 || index >= scene.shapes.size())
        return check.problem("shape", "shape " + std::to_string(body.shape) + " does not exist; there are " +
                                          std::to_string(scene.shapes.size()));
    const bool needs_mass = body.type == BodyType::dynamic && !check.broken("type");
    if (needs_mass && scene.shapes[index].mass_kind == MassKind::none &&
        !errors.any_under(element_path("shapes", index)))
        check.problem("shape", "shape " + in_quotes(scene.shapes[index].name) +
                                   " has no mass: a dynamic body needs surface_density, density, line_density or mass");
}

/// Pairs of names that there are.
void check_ignored(const std::vector<NamedPair>& pairs, const std::set<std::string_view>& names, const char* what,
                   const std::string& path, ErrorList& errors) {
    for (std::size_t i = 0; i < pairs.size(); ++i)
        for (const std::string* name : {&pairs[i].a, &pairs[i].b})
            if (!names.contains(*name) && !errors.any_at(path + "/" + std::to_string(i)))
                errors.add(path + "/" + std::to_string(i),
                           std::string("no body has the ") + what + " " + in_quotes(*name));
}

void check_ignored(const SceneDescription& scene, ErrorList& errors) {
    std::set<std::string_view> groups, names;
    for (const BodyDescription& body : scene.bodies) groups.insert(body.group), names.insert(body.name);
    groups.erase("");
    check_ignored(scene.ignored_groups, groups, "group", "/ignore/groups", errors);
    check_ignored(scene.ignored_bodies, names, "name", "/ignore/bodies", errors);
    for (std::size_t i = 0; i < scene.ignored_bodies.size(); ++i)
        if (const auto& [a, b] = scene.ignored_bodies[i]; a == b)
            errors.add("/ignore/bodies/" + std::to_string(i), "a body cannot meet itself: " + in_quotes(a));
}

} // namespace

void check_name(const std::string& name, const std::string& path, ErrorList& errors) {
    Checker(path, errors).name(name);
}

void check_body(BodyDescription& body, const SceneDescription& scene, const std::string& path, ErrorList& errors) {
    const Checker check(path, errors);
    check_body_shape(body, scene, check, errors);
    check.magnitude("position", body.position, kMaxCoordinate, "m");
    check.rotation("rotation", body.rotation);
    check_motion(body, check);
    check.range("friction", body.friction, 0, kMaxFriction, "");
    check.range("restitution", body.restitution, 0, 1, "");
    if (check.broken("type")) return;
    check_locks_and_loads(body, check);
    if (body.type == BodyType::kinematic) {
        check_keyframes(body, path, errors);
        take_first_pose(body, check);
    } else if (!body.keyframes.empty()) {
        check.problem("keyframes", "only a kinematic body has keyframes");
    }
}

void check_loads(const BodyDescription& body, double mass, double least_inertia, double time_step,
                 const std::string& path, ErrorList& errors) {
    const double linear = length(body.force) / mass, angular = length(body.torque) / least_inertia * time_step;
    if (!(linear <= kMaxGravity))
        errors.add(path + "/force",
                   "accelerates the body by " + to_text(linear) + " m/s^2, more than " + to_text(kMaxGravity));
    if (!(angular <= kMaxAngularVelocity))
        errors.add(path + "/torque", "may turn the body by " + to_text(angular) + " rad/s more in a step, more than " +
                                         to_text(kMaxAngularVelocity));
}

void check_line(const BodyDescription& body, const Vec3& line, const std::string& path, ErrorList& errors) {
    std::vector<int> free;
    for (int axis = 0; axis < 3; ++axis)
        if (!body.locked_rotation[static_cast<std::size_t>(axis)]) free.push_back(axis);
    if (line == Vec3{} || free.size() == 3 || free.empty()) return;
    const double along = component(rotate(body.rotation, line), free.front());
    if (free.size() == 1 && 1 - along * along > kMinInertiaRatio) return;
    Checker(path, errors)
        .problem("locked", "a straight line has no inertia about itself: its turns may be locked about all axes, or "
                           "about all but one that is not along it (or give the shape an inertia)");
}

std::string default_body_name(std::size_t place, std::uint32_t generation) {
    std::string name = "body ";
    name += std::to_string(place);
    if (generation > 0) name.append(".").append(std::to_string(generation));
    return name;
}

std::string default_shape_name(const std::vector<ShapeDescription>& shapes) {
    for (std::size_t k = shapes.size();; ++k) {
        std::string name = "shape" + std::to_string(k);
        if (std::none_of(shapes.begin(), shapes.end(), [&](const auto& shape) { return shape.name == name; }))
            return name;
    }
}

std::string element_path(const char* list, std::size_t index) {
    return std::string("/") + list + "/" + std::to_string(index);
}

void check_description(SceneDescription& scene, ErrorList& errors) {
    const Checker top("", errors);
    top.magnitude("gravity", scene.gravity, kMaxGravity, "m/s^2");
    check_settings(scene.settings, "/settings", errors);
    check_names(scene.shapes, "shapes", errors);
    check_names(scene.bodies, "bodies", errors);
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        const std::string path = element_path("shapes", i);
        if (!errors.any_at(path)) check_shape(scene.shapes[i], path, errors);
    }
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const std::string path = element_path("bodies", i);
        if (!errors.any_at(path)) check_body(scene.bodies[i], scene, path, errors);
    }
    check_ignored(scene, errors);
}

} // namespace flotilla
