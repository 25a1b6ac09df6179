// SPDX-License-Identifier: MIT
#include "io/rigid_ipc.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include <flotilla/error.hpp>
#include <flotilla/names.hpp>

#include "base/rotation.hpp"
#include "base/text.hpp"
#include "base/vec3.hpp"
#include "io/json_reader.hpp"
#include "io/rigid_ipc_keys.hpp"
#include "io/rigid_ipc_mesh.hpp"
#include "io/rigid_ipc_script.hpp"
#include "mesh/topology.hpp"
#include "scene/description_checks.hpp"
#include "scene/scene.hpp"

namespace flotilla::io {

namespace {

using std::string_view_literals::operator""sv;
using namespace rigid_ipc;

constexpr double kDefaultTimeStep = 0.01; // s
constexpr double kDefaultSteps = 1000;
constexpr double kMostKeyframes =
    1e6; // of bodies that turn by scripts, 64 MB: more is a slip of a digit in step or end
constexpr double kDegree = 3.14159265358979323846 / 180;

/// 0 - x, and not -x, because zero has no sign worth keeping.
Vec3 z_up(const Vec3& v) { return {v.x, 0 - v.z, v.y}; }
Quat z_up(const Quat& q) { return {q.w, q.x, 0 - q.z, q.y}; }

Quat about(const Vec3& axis, double degrees) {
    const SinCos half = sin_cos(degrees * kDegree / 2);
    return {half.cos, half.sin * axis.x, half.sin * axis.y, half.sin * axis.z};
}

/// About z after y after x.
Quat from_euler_angles(const Vec3& degrees) {
    return normalized(about({0, 0, 1}, degrees.z) * about({0, 1, 0}, degrees.y) * about({1, 0, 0}, degrees.x));
}

/// A body as the file gives it, in its axes, with units of ours.
struct FileBody {
    std::size_t index = 0; ///< in the file
    std::string stem;      ///< of its mesh
    TriangleMesh mesh;     ///< scaled
    BodyType type = BodyType::dynamic;
    std::array<bool, 6> fixed{};
    Vec3 position;
    Quat rotation;
    Vec3 velocity, angular_velocity;
    Vec3 force, torque; ///< N, N m
    std::string group;  ///< empty: none
    double density = 1000;
    double script_end = std::numeric_limits<double>::infinity(); ///< s
    std::vector<PrincipalPose> poses;
    bool split = false;
    std::string at; ///< place in the file
};

class RigidIpcReader : JsonReader {
  public:
    RigidIpcReader(const std::filesystem::path& folder, SceneDescription& scene, SceneOrigin& origin, ErrorList& errors)
        : JsonReader(errors), scene_(scene), origin_(origin), warnings_(errors.source()), meshes_(folder) {}

    void read(const Json& document, const SceneFileOptions& options);

  private:
    using JsonReader::to;
    template <class Value>
    void get(Value& out, const Json& object, const JsonPlace& at, std::string_view key) {
        if (const Json* value = member(object, at, key)) to(out, *value, at.member(key));
    }
    bool to(PrincipalPose& out, const Json& value, const JsonPlace& at);
    template <class Value>
    bool to(std::vector<Value>& out, const Json& value, const JsonPlace& at);

    void warn(const JsonPlace& at, std::string reason) { warnings_.add(at.text(), std::move(reason)); }
    void warn_of_unknown_keys(const Json& object, const JsonPlace& at, std::span<const std::string_view> known);
    void read_options(const Json& document, const JsonPlace& at);
    void read_problem(const Json& document, const JsonPlace& at);
    void read_friction(const Json& document, const JsonPlace& at);
    void read_body(const Json& value, const JsonPlace& at, std::size_t index);
    void read_type(const Json& value, const JsonPlace& at, FileBody& body);
    void read_fixed(const Json& value, const JsonPlace& at, FileBody& body);
    bool read_geometry(const Json& value, const JsonPlace& at, FileBody& body);
    TriangleMesh inline_mesh(const Json& value, const JsonPlace& at);
    Vec3 read_scale(const Json& value, const JsonPlace& at, const TriangleMesh& mesh);
    void read_motion(const Json& value, const JsonPlace& at, FileBody& body);
    void read_loads(const Json& value, const JsonPlace& at, FileBody& body);
    void read_script(const Json& value, const JsonPlace& at, FileBody& body);
    void check_turns(const JsonPlace& at, FileBody& body);
    void read_group(const Json& value, const JsonPlace& at, FileBody& body);
    void list_groups();
    void add_body(const FileBody& file, const std::string& name);
    std::int32_t add_shape(const FileBody& file);
    std::vector<Keyframe> keyframes(const FileBody& file, const ShapeDescription& shape);
    [[nodiscard]] std::string place_of(const std::string& where) const;
    void check();

    SceneDescription& scene_;
    SceneOrigin& origin_;
    ErrorList warnings_;
    double keyframes_ = 0;                ///< of bodies that turn by scripts
    double file_step_ = kDefaultTimeStep; ///< s; that of the scene may be another, asked for by the caller
    RigidIpcMeshes meshes_;
    std::vector<std::string> body_places_, shape_places_; ///< of the scene's bodies and shapes in the file
};

bool RigidIpcReader::to(PrincipalPose& out, const Json& value, const JsonPlace& at) {
    if (!is_object(value, at)) return false;
    get(out.position, value, at, "position");
    get(out.rotation, value, at, "rotation");
    return true;
}

template <class Value>
bool RigidIpcReader::to(std::vector<Value>& out, const Json& value, const JsonPlace& at) {
    if (!is_array(value, at, "an array")) return false;
    out.resize(value.size());
    bool good = true;
    for (std::size_t i = 0; i < out.size(); ++i) good &= to(out[i], value[i], at.element(i));
    return good;
}

void RigidIpcReader::warn_of_unknown_keys(const Json& object, const JsonPlace& at,
                                          std::span<const std::string_view> known) {
    for (const auto& item : object.items()) {
        if (item.key().starts_with('#')) continue; // a comment
        if (std::find(known.begin(), known.end(), item.key()) == known.end())
            warn(at.member(item.key()), unknown_name("key", item.key(), known) + "; ignored, as Rigid-IPC does");
    }
}

void RigidIpcReader::read_options(const Json& document, const JsonPlace& at) {
    std::string kind = "distance_barrier_rb_problem";
    get(kind, document, at, "scene_type");
    if (kind != "distance_barrier_rb_problem")
        problem(at.member("scene_type"),
                in_quotes(kind) + " is not supported, distance_barrier_rb_problem is: rigid bodies in 3-D");
    double step = kDefaultTimeStep, time = -1, steps = -1;
    get(step, document, at, "timestep");
    get(time, document, at, "max_time");
    get(steps, document, at, "max_iterations");
    if (!(step > 0)) {
        problem(at.member("timestep"), "must be positive, got " + to_text(step));
        step = kDefaultTimeStep;
    }
    scene_.settings.time_step = file_step_ = step;
    scene_.settings.restitution = 0; // it has none in 3-D
    if (time > 0) steps = std::ceil(time / step - 1e-9);
    origin_.duration = step * (steps > 0 ? steps : kDefaultSteps);
    if (const Json* barrier = member(document, at, "distance_barrier_constraint")) {
        const JsonPlace place = at.member("distance_barrier_constraint");
        double least = 0;
        if (is_object(*barrier, place)) get(least, *barrier, place, "minimum_separation_distance");
        if (least != 0)
            warn(place.member("minimum_separation_distance"),
                 "ignored; the setting rest_distance says how far bodies are to stay apart");
    }
}

void RigidIpcReader::read_friction(const Json& document, const JsonPlace& at) {
    double friction = 0, iterations = 1;
    const JsonPlace problem_at = at.member(kProblem), options_at = at.member("friction_constraints");
    get(friction, document[kProblem], problem_at, "coefficient_friction");
    if (const Json* options = member(document, at, "friction_constraints");
        options != nullptr && is_object(*options, options_at))
        get(iterations, *options, options_at, "iterations");
    scene_.settings.friction = iterations == 0 ? 0 : friction;
}

void RigidIpcReader::read_problem(const Json& document, const JsonPlace& at) {
    const Json& value = document[kProblem];
    warn_of_unknown_keys(value, at, kProblemKeys);
    Vec3 gravity;
    get(gravity, value, at, "gravity");
    scene_.gravity = z_up(gravity);
    double restitution = -1;
    get(restitution, value, at, "coefficient_restitution");
    if (restitution > 0) warn(at.member("coefficient_restitution"), "ignored, as Rigid-IPC does in 3-D");
    const Json* bodies = member(value, at, kBodies);
    const JsonPlace place = at.member(kBodies);
    if (bodies == nullptr || !is_array(*bodies, place, "an array of bodies")) return;
    for (std::size_t i = 0; i < bodies->size(); ++i) read_body((*bodies)[i], place.element(i), i);
}

void RigidIpcReader::read_body(const Json& value, const JsonPlace& at, std::size_t index) {
    if (!is_object(value, at)) return;
    warn_of_unknown_keys(value, at, kBodyKeys);
    bool enabled = true;
    get(enabled, value, at, "enabled");
    if (!enabled) return;
    FileBody body;
    body.index = index;
    body.at = at.text();
    read_type(value, at, body);
    read_motion(value, at, body);
    read_loads(value, at, body);
    if (body.type == BodyType::kinematic) read_script(value, at, body);
    read_group(value, at, body);
    if (!read_geometry(value, at, body)) return;
    const std::string name = body.stem + "-" + std::to_string(index);
    if (!body.split) return add_body(body, name);
    const std::vector<TriangleMesh> parts = components(body.mesh);
    for (std::size_t k = 0; k < parts.size(); ++k) {
        body.mesh = parts[k];
        add_body(body, name + "-part" + std::to_string(k));
    }
}

void RigidIpcReader::read_type(const Json& value, const JsonPlace& at, FileBody& body) {
    constexpr std::array kTypes{"dynamic"sv, "static"sv, "kinematic"sv}; // in the order of BodyType
    std::string name{kTypes.front()};
    get(name, value, at, "type");
    const auto found = std::find(kTypes.begin(), kTypes.end(), name);
    if (found == kTypes.end())
        problem(at.member("type"), unknown_name("body type", name, kTypes) + " (dynamic, static, kinematic)");
    else
        body.type = static_cast<BodyType>(found - kTypes.begin());
    read_fixed(value, at, body);
    if (std::all_of(body.fixed.begin(), body.fixed.end(), [](bool fixed) { return fixed; }))
        body.type = BodyType::fixed;
}

void RigidIpcReader::read_fixed(const Json& value, const JsonPlace& at, FileBody& body) {
    const Json* fixed = member(value, at, "is_dof_fixed");
    if (fixed == nullptr) return;
    const JsonPlace place = at.member("is_dof_fixed");
    if (fixed->is_boolean()) return body.fixed.fill(fixed->get<bool>());
    if (!fixed->is_array() || fixed->size() != body.fixed.size())
        return problem(place, "must be true, false or an array of 6 of them (x, y, z, and turns about them), got " +
                                  kind_of(*fixed));
    for (std::size_t k = 0; k < body.fixed.size(); ++k) to(body.fixed[k], (*fixed)[k], place.element(k));
}

void RigidIpcReader::read_motion(const Json& value, const JsonPlace& at, FileBody& body) {
    get(body.position, value, at, "position");
    Vec3 degrees, turning;
    get(degrees, value, at, "rotation");
    body.rotation = from_euler_angles(degrees);
    get(body.velocity, value, at, "linear_velocity");
    get(turning, value, at, "angular_velocity");
    body.angular_velocity = kDegree * turning;
    const auto free = [&](std::size_t axis) { return body.fixed[axis] ? 0.0 : 1.0; };
    body.velocity = {free(0) * body.velocity.x, free(1) * body.velocity.y, free(2) * body.velocity.z};
    body.angular_velocity = {free(3) * body.angular_velocity.x, free(4) * body.angular_velocity.y,
                             free(5) * body.angular_velocity.z};
}

void RigidIpcReader::read_loads(const Json& value, const JsonPlace& at, FileBody& body) {
    Vec3 torque;
    get(body.force, value, at, "force");
    get(torque, value, at, "torque");
    body.torque = kDegree * torque; // it takes a torque for an angle: 300 means 300 pi / 180 N m
}

/// Keyframes are made of turns, and none of their numbers would tell that a turn was beyond all reach.
void RigidIpcReader::check_turns(const JsonPlace& at, FileBody& body) {
    const auto check = [&](const JsonPlace& place, Vec3& turn, double most, const char* unit) {
        const double largest = max_component(abs(turn));
        if (largest <= most) return;
        problem(place, "component " + to_text(largest) + " exceeds the limit of " + to_text(most) + unit);
        turn = {};
    };
    check(at.member("angular_velocity"), body.angular_velocity, kMaxAngularVelocity, " rad/s");
    for (std::size_t k = 0; k < body.poses.size(); ++k)
        check(at.member("kinematic_poses").element(k).member("rotation"), body.poses[k].rotation,
              kMaxAngularVelocity * kMaxTime, " rad");
}

void RigidIpcReader::read_script(const Json& value, const JsonPlace& at, FileBody& body) {
    double most = -1;
    get(most, value, at, "kinematic_max_time");
    if (most >= 0) body.script_end = most;
    get(body.poses, value, at, "kinematic_poses");
    check_turns(at, body);
    const double end = std::min(body.script_end, origin_.duration), steps = end / file_step_;
    if (!body.poses.empty() && static_cast<double>(body.poses.size()) < steps - 1e-9)
        warn(at.member("kinematic_poses"), "end before the body does at " + to_text(end) + " s; it keeps the last");
    if (!body.poses.empty() || body.angular_velocity == Vec3{}) return;
    keyframes_ += steps;
    if (keyframes_ <= kMostKeyframes) return;
    problem(at.member("angular_velocity"), "needs " + to_text(steps) +
                                               " keyframes, one a step; all scripts together may have " +
                                               to_text(kMostKeyframes));
    body.angular_velocity = {};
}

/// Bodies of one group pass through each other.
void RigidIpcReader::read_group(const Json& value, const JsonPlace& at, FileBody& body) {
    double group = -1;
    get(group, value, at, "group_id");
    if (group >= 0) body.group = "group " + to_text(group);
}

/// Groups with whom nobody could meet anyway are none.
void RigidIpcReader::list_groups() {
    std::map<std::string, std::pair<int, int>> members; // bodies in all, and those that move freely
    for (const BodyDescription& body : scene_.bodies)
        if (!body.group.empty()) {
            ++members[body.group].first;
            members[body.group].second += body.type == BodyType::dynamic ? 1 : 0;
        }
    const auto meets = [&](const std::string& group) { return members[group].first > 1 && members[group].second > 0; };
    for (BodyDescription& body : scene_.bodies)
        if (!body.group.empty() && !meets(body.group)) body.group.clear();
    for (const auto& [group, count] : members)
        if (meets(group)) scene_.ignored_groups.push_back({group, group});
}

TriangleMesh RigidIpcReader::inline_mesh(const Json& value, const JsonPlace& at) {
    TriangleMesh mesh;
    get(mesh.vertices, value, at, "vertices");
    get(mesh.triangles, value, at, "faces");
    const auto is_vertex = [&](std::int32_t i) { return static_cast<std::size_t>(i) < mesh.vertices.size(); };
    for (const Triangle& t : mesh.triangles)
        if (!std::all_of(t.begin(), t.end(), is_vertex))
            throw InputError("a face names a vertex that does not exist; there are " +
                             std::to_string(mesh.vertices.size()));
    const Topology topology = build_topology(mesh);
    if (const Json* edges = member(value, at, "edges"); edges != nullptr && edges->is_array())
        for (const Json& edge : *edges) {
            if (!edge.is_array() || edge.size() != 2 || !edge[0].is_number_integer() || !edge[1].is_number_integer())
                throw InputError("an edge must be an array of 2 vertex numbers");
            const auto [a, b] = std::minmax({edge[0].get<std::int32_t>(), edge[1].get<std::int32_t>()});
            if (a < 0 || a == b || !is_vertex(b)) throw InputError("an edge must join two of the vertices");
            if (!std::binary_search(topology.edges.begin(), topology.edges.end(), Edge{a, b}))
                mesh.triangles.push_back(segment_element(a, b));
        }
    add_loose_points(mesh);
    if (mesh.triangles.empty()) throw InputError("has neither a mesh nor vertices");
    return mesh;
}

Vec3 RigidIpcReader::read_scale(const Json& value, const JsonPlace& at, const TriangleMesh& mesh) {
    Vec3 scale{1, 1, 1}, dimensions;
    if (const Json* given = member(value, at, "dimensions"))
        return to(dimensions, *given, at.member("dimensions")) ? scale_to(mesh, dimensions) : scale;
    const Json* given = member(value, at, "scale");
    if (given == nullptr) return scale;
    double all = 1;
    if (!given->is_number()) {
        to(scale, *given, at.member("scale"));
        return scale;
    }
    to(all, *given, at.member("scale"));
    return {all, all, all};
}

/// Whether there is one.
bool RigidIpcReader::read_geometry(const Json& value, const JsonPlace& at, FileBody& body) {
    std::string file;
    get(file, value, at, "mesh");
    get(body.density, value, at, "density");
    get(body.split, value, at, "split_components");
    body.stem = file.empty() ? "body" : std::filesystem::path(file).stem().string();
    try {
        body.mesh = file.empty() ? inline_mesh(value, at) : meshes_.read(file);
    } catch (const std::runtime_error& error) { // InputError or IoError: either way the scene's body has no mesh
        problem(file.empty() ? at : at.member("mesh"),
                file.empty() ? error.what() : in_quotes(file) + ": " + error.what());
        return false;
    }
    const Vec3 scale = read_scale(value, at, body.mesh);
    for (Vec3& v : body.mesh.vertices) v = {scale.x * v.x, scale.y * v.y, scale.z * v.z};
    return true;
}

/// The density is per volume, area, length or point, by what the body is made of.
void set_mass(const FileBody& file, ShapeDescription& shape) {
    const ElementKind highest = highest_element(file.mesh.triangles);
    shape.mass_kind = highest == ElementKind::point     ? MassKind::mass
                      : highest == ElementKind::segment ? MassKind::line_density
                      : closedness(file.mesh).oriented  ? MassKind::density
                                                        : MassKind::surface_density;
    const double points = highest == ElementKind::point ? static_cast<double>(file.mesh.triangles.size()) : 1;
    shape.mass_value = points * file.density;
}

std::int32_t RigidIpcReader::add_shape(const FileBody& file) {
    ShapeDescription shape;
    shape.triangles = file.mesh.triangles;
    for (const Vec3& v : file.mesh.vertices) shape.vertices.push_back(z_up(v));
    if (file.type == BodyType::dynamic) {
        set_mass(file, shape);
    }
    const auto same = [&](const ShapeDescription& known) {
        return known.vertices == shape.vertices && known.triangles == shape.triangles &&
               known.mass_kind == shape.mass_kind && known.mass_value == shape.mass_value;
    };
    const auto found = std::find_if(scene_.shapes.begin(), scene_.shapes.end(), same);
    if (found != scene_.shapes.end()) return static_cast<std::int32_t>(found - scene_.shapes.begin());
    if (shape.mass_kind != MassKind::none && shape.mass_kind != MassKind::density && !warnings_.any_at(file.at))
        warnings_.add(file.at, "its mesh bounds no volume: the density " + to_text(file.density) + " is taken as " +
                                   (shape.mass_kind == MassKind::surface_density ? "kg/m^2 of a shell"
                                    : shape.mass_kind == MassKind::line_density  ? "kg/m of its edges"
                                                                                 : "kg of each point"));
    shape.name = file.stem + "-" + std::to_string(scene_.shapes.size());
    scene_.shapes.push_back(std::move(shape));
    shape_places_.push_back(file.at);
    return static_cast<std::int32_t>(scene_.shapes.size() - 1);
}

std::vector<Keyframe> RigidIpcReader::keyframes(const FileBody& file, const ShapeDescription& shape) {
    const Pose start{z_up(file.position), z_up(file.rotation)};
    const double end = std::min(file.script_end, origin_.duration), step = file_step_;
    const TriangleMesh mesh{shape.vertices, shape.triangles};
    const bool closed = closedness(mesh).oriented;
    if (file.poses.empty()) {
        const MassProperties mass =
            closed ? solid_mass_properties(mesh, 1, shape.name) : spread_mass_properties(mesh, 1, shape.name);
        return constant_motion_keyframes(start, {z_up(file.velocity), z_up(file.angular_velocity)}, mass.center_of_mass,
                                         step, end);
    }
    if (!closed)
        throw InputError(
            "the frame of the poses is that of the principal axes, which Rigid-IPC has for closed meshes only");
    // In the file's axes, because the axes that are found depend on those that they are looked for in.
    const PrincipalFrame frame = principal_frame(file.mesh, file.rotation);
    if (!frame.unique)
        warnings_.add(
            file.at + "/kinematic_poses",
            "two principal moments are equal: which axes Rigid-IPC turns the body about is its solver's choice");
    std::vector<Keyframe> list = pose_keyframes({file.position, file.rotation}, file.poses, frame, step, end);
    for (Keyframe& k : list) k.position = z_up(k.position), k.rotation = z_up(k.rotation);
    return list;
}

void RigidIpcReader::add_body(const FileBody& file, const std::string& name) {
    BodyDescription body;
    body.name = name;
    body.group = file.group;
    body.shape = add_shape(file);
    body.type = file.type;
    body.position = z_up(file.position);
    body.rotation = z_up(file.rotation);
    body.friction = scene_.settings.friction;
    body.restitution = scene_.settings.restitution;
    if (file.type == BodyType::dynamic) {
        body.velocity = z_up(file.velocity);
        body.angular_velocity = z_up(file.angular_velocity);
        body.force = z_up(file.force);
        body.torque = z_up(file.torque);
        body.locked_translation = {file.fixed[0], file.fixed[2], file.fixed[1]}; // x, -z and y of the file
        body.locked_rotation = {file.fixed[3], file.fixed[5], file.fixed[4]};
    }
    try {
        if (file.type == BodyType::kinematic)
            body.keyframes = keyframes(file, scene_.shapes[static_cast<std::size_t>(body.shape)]);
    } catch (const InputError& error) {
        errors().add(file.at, error.what());
    }
    scene_.bodies.push_back(std::move(body));
    body_places_.push_back(file.at);
}

/// The place in the file of what a place in the scene is made of.
std::string RigidIpcReader::place_of(const std::string& where) const {
    constexpr std::array kSame{"position"sv, "rotation"sv, "density"sv, "angular_velocity"sv, "force"sv, "torque"sv};
    const auto first = where.find('/', 1), second = first == std::string::npos ? first : where.find('/', first + 1);
    const std::string list = where.substr(0, first);
    const std::string top = "/" + std::string(kProblem);
    if (list == "/gravity") return top + "/gravity";
    const std::string entry = first == std::string::npos ? "" : where.substr(first + 1, second - first - 1);
    if (list == "/settings")
        return entry == "time_step" ? "/timestep" : entry == "friction" ? top + "/coefficient_friction" : "";
    const std::vector<std::string>& places = list == "/shapes" ? shape_places_ : body_places_;
    const std::string at = places.at(std::stoul(entry));
    const std::string key =
        second == std::string::npos ? "" : where.substr(second + 1, where.find('/', second + 1) - second - 1);
    if (key == "friction") return top + "/coefficient_friction";
    if (key == "velocity") return at + "/linear_velocity";
    if (key == "surface_density" || key == "line_density" || key == "mass") return at + "/density";
    return std::find(kSame.begin(), kSame.end(), key) != kSame.end() ? at + "/" + key : at;
}

/// What the values mean, with every problem once.
void RigidIpcReader::check() {
    list_groups();
    ErrorList problems(errors().source());
    check_description(scene_, problems);
    for (const InputProblem& p : problems.problems()) {
        std::string where = place_of(p.where);
        if (!errors().any_at(where)) errors().add(std::move(where), p.reason);
    }
}

void RigidIpcReader::read(const Json& document, const SceneFileOptions& options) {
    const JsonPlace top, problem_at = top.member(kProblem);
    if (!is_object(document[kProblem], problem_at)) return;
    warn_of_unknown_keys(document, top, kSceneKeys);
    read_options(document, top);
    read_friction(document, top);
    for (const auto& [key, value] : options.overrides) set_setting(scene_.settings, key, value);
    read_problem(document, problem_at);
    check();
    for (const InputProblem& w : warnings_.problems())
        origin_.warnings.push_back(errors().source() + ": " + w.where + ": " + w.reason);
}

} // namespace

bool is_rigid_ipc(const Json& document) { return document.is_object() && document.contains(kProblem); }

void read_rigid_ipc(const Json& document, const std::filesystem::path& folder, const SceneFileOptions& options,
                    SceneDescription& scene, SceneOrigin& origin, ErrorList& errors) {
    origin.format = "Rigid-IPC";
    RigidIpcReader(folder, scene, origin, errors).read(document, options);
}

} // namespace flotilla::io
