// SPDX-License-Identifier: MIT
#include "scene/scene.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <map>
#include <unordered_map>

#include "base/error_list.hpp"
#include "base/random.hpp"
#include "base/rotation.hpp"
#include "base/text.hpp"
#include "parallel/parallel_for.hpp"
#include "scene/description_checks.hpp"
#include "scene/length_checks.hpp"

namespace flotilla {

namespace {

MassProperties plain_mass_properties(const ShapeDescription& shape, const TriangleMesh& mesh) {
    switch (shape.mass_kind) {
    case MassKind::surface_density: return shell_mass_properties(mesh, shape.mass_value, shape.name);
    case MassKind::density: return solid_mass_properties(mesh, shape.mass_value, shape.name);
    case MassKind::line_density: return line_mass_properties(mesh, shape.mass_value, shape.name);
    case MassKind::mass:
    case MassKind::none: break;
    }
    return spread_mass_properties(mesh, shape.mass_value, shape.name);
}

/// Of a shape whose vertices and triangles are in `mesh`.
std::optional<MassProperties> mass_properties_of(const ShapeDescription& shape, const TriangleMesh& mesh) {
    if (shape.mass_kind == MassKind::none) return {};
    // With everything given there is nothing to integrate, so surfaces without an area of their own are welcome too.
    if (shape.mass_kind == MassKind::mass && shape.inertia && shape.center_of_mass)
        return given_mass_properties(shape.mass_value, *shape.center_of_mass, *shape.inertia, shape.name);
    return with_overrides(plain_mass_properties(shape, mesh), shape.inertia, shape.center_of_mass, shape.name);
}

bool same_bits(const Vec3& a, const Vec3& b) {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    return bits(a.x) == bits(b.x) && bits(a.y) == bits(b.y) && bits(a.z) == bits(b.z);
}

bool same_shape(const ShapeDescription& a, const ShapeDescription& b) {
    return a.mass_kind == b.mass_kind && a.mass_value == b.mass_value && a.inertia == b.inertia &&
           a.center_of_mass == b.center_of_mass && a.triangles == b.triangles &&
           std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(), same_bits);
}

std::uint64_t hash_of(const ShapeDescription& shape) {
    std::uint64_t h = random_bits(shape.vertices.size(), shape.triangles.size());
    for (const Vec3& v : shape.vertices)
        h = random_bits(h, std::bit_cast<std::uint64_t>(v.x), std::bit_cast<std::uint64_t>(v.y),
                        std::bit_cast<std::uint64_t>(v.z));
    return h;
}

/// The least one of the mesh along the axes of a rotation, m.
double least_extent(const TriangleMesh& mesh, const Quat& axes) {
    Box box;
    for (const Vec3& v : mesh.vertices) box = extended(box, rotate(conjugate(axes), v));
    const Vec3 e = box.upper - box.lower;
    return std::min({e.x, e.y, e.z});
}

double longest_edge(const TriangleMesh& mesh) {
    double longest_sq = 0;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            longest_sq = std::max(longest_sq, length_sq(mesh.vertices[static_cast<std::size_t>(t[k])] -
                                                        mesh.vertices[static_cast<std::size_t>(t[(k + 1) % 3])]));
    return std::sqrt(longest_sq);
}

/// The size of a body, or ten times its thickness if that is less: the size / 330 at which a bar of aspect 1,000 would
/// rest is three times as far as it is thick. It would stand on forces far beside its long axis, about which it hardly
/// has inertia, and a heap of such bars has dozens of contacts for each where few can be told apart. Not less than a
/// hundredth of the size, or doubles would not resolve the separation far from the origin; what is thinner than even
/// the rest distance is then is a surface and keeps its size.
double extent_of(const Shape& shape) {
    constexpr double kAspect = 10, kLeastShare = 0.01;
    const double size = 2 * shape.sphere.radius;
    if (!shape.mass) return size;
    const double thickness =
        std::min(least_extent(shape.mesh, {}), least_extent(shape.mesh, shape.mass->principal_axes));
    if (thickness < kLeastShare * size / kSizePerRestDistance) return size;
    return std::clamp(kAspect * thickness, kLeastShare * size, size);
}

/// What needs nothing but the mesh is made side by side: a scene of one large shape has no other work to share.
Shape build_shape(ShapeDescription&& description) {
    Shape shape;
    shape.mesh = {std::move(description.vertices), std::move(description.triangles)};
    const std::array<std::function<void()>, 4> parts{
        [&] { shape.mass = mass_properties_of(description, shape.mesh); },
        [&] { shape.bvh = build_bvh(shape.mesh); },
        [&] { shape.sphere = bounding_sphere(shape.mesh); },
        [&] { shape.topology = build_topology(shape.mesh); },
    };
    parallel_for(parts.size(), free_threads(), [&](std::size_t k) { parts[k](); });
    shape.name = std::move(description.name);
    shape.extent = extent_of(shape);
    shape.center = shape.mass                   ? shape.mass->center_of_mass
                   : description.center_of_mass ? *description.center_of_mass
                                                : shape.sphere.center;
    shape.radius = bounding_radius(shape.mesh, shape.center);
    shape.longest_edge = longest_edge(shape.mesh);
    return shape;
}

// Moves the shapes into `scene`, each once, and returns where each one went.
std::vector<std::int32_t> build_shapes(std::vector<ShapeDescription>& descriptions, Scene& scene) {
    std::unordered_multimap<std::uint64_t, std::size_t> known;
    std::vector<std::int32_t> index(descriptions.size());
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < descriptions.size(); ++i) {
        const std::uint64_t hash = hash_of(descriptions[i]);
        const auto [first, last] = known.equal_range(hash);
        const auto same = std::find_if(
            first, last, [&](const auto& k) { return same_shape(descriptions[k.second], descriptions[i]); });
        if (same != last) {
            index[i] = index[same->second];
            continue;
        }
        known.emplace(hash, i);
        index[i] = static_cast<std::int32_t>(kept.size());
        kept.push_back(i);
    }
    scene.shapes.resize(kept.size());
    parallel_for(kept.size(), free_threads(),
                 [&](std::size_t k) { scene.shapes[k] = build_shape(std::move(descriptions[kept[k]])); });
    return index;
}

void warn_of_unused_shapes(const SceneDescription& description, std::vector<std::string>& warnings) {
    std::vector<bool> used(description.shapes.size(), false);
    for (const BodyDescription& body : description.bodies) used[static_cast<std::size_t>(body.shape)] = true;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (!used[i]) warnings.push_back("no body has the shape " + in_quotes(description.shapes[i].name));
}

// World coordinates become coarser with the distance from the origin. Where a thousand roundings of them reach the
// separation that the body's size asks for, resting contacts can no longer be kept apart by it.
void warn_of_far_bodies(const Scene& scene, std::vector<std::string>& warnings) {
    constexpr double kRoundings = 1024;
    constexpr double kUnitRoundoff = 0x1p-53;
    for (const BodyDescription& body : scene.bodies) {
        if (body.type != BodyType::dynamic) continue;
        const Shape& shape = scene.shapes[static_cast<std::size_t>(body.shape)];
        const double separation = lengths_of_size({}, shape.extent).separation;
        const Vec3 c = world_center(scene, body);
        const double reach = max_component(abs(c)) + shape.radius;
        if (kRoundings * kUnitRoundoff * reach > separation)
            warnings.push_back("body " + in_quotes(body.name) + " is too far from the origin for its size: at " +
                               to_text(reach) + " m coordinates are too coarse for a body of " +
                               to_text(2 * shape.sphere.radius) + " m");
    }
}

/// What nothing is promised of is said.
void warn_of_ignored_pairs(const Scene& scene, std::vector<std::string>& warnings) {
    if (scene.filtered.filter.empty()) return;
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        for (std::size_t k = i + 1; k < scene.bodies.size(); ++k) pairs += scene.filtered.ignores(i, k) ? 1U : 0U;
    warnings.push_back(std::to_string(pairs) + (pairs == 1 ? " pair" : " pairs") +
                       " of bodies may pass through each other (ignore): nothing is promised of such pairs");
}

} // namespace

Vec3 world_center(const Scene& scene, const BodyDescription& body) {
    return body.position + rotate(body.rotation, scene.shapes[static_cast<std::size_t>(body.shape)].center);
}

bool PairFilter::ignores(std::int32_t a, std::int32_t group_a, std::int32_t b, std::int32_t group_b) const {
    const auto has = [](const auto& list, std::int32_t x, std::int32_t y) {
        return std::binary_search(list.begin(), list.end(), std::pair(std::min(x, y), std::max(x, y)));
    };
    return (group_a >= 0 && group_b >= 0 && has(groups, group_a, group_b)) || has(bodies, a, b);
}

FilteredBodies make_filter(std::span<const BodyDescription> bodies, std::span<const NamedPair> ignored_groups,
                           std::span<const NamedPair> ignored_bodies) {
    // Groups are numbered as they are ignored: bodies that come and go change no number, and where none is ignored
    // nobody has one.
    std::map<std::string_view, std::int32_t> numbers, groups, names;
    for (const NamedPair& pair : ignored_groups)
        for (const std::string_view group : {std::string_view(pair.a), std::string_view(pair.b)})
            numbers.try_emplace(group, static_cast<std::int32_t>(numbers.size()));
    FilteredBodies out;
    for (const BodyDescription& body : bodies) {
        const auto known = numbers.find(body.group);
        out.group.push_back(known == numbers.end() ? -1 : known->second);
        if (known != numbers.end()) groups.insert(*known);
    }
    if (!ignored_bodies.empty())
        for (std::size_t i = 0; i < bodies.size(); ++i) names.emplace(bodies[i].name, static_cast<std::int32_t>(i));
    const auto list = [](std::span<const NamedPair> from, const auto& number, auto& to) {
        for (const NamedPair& pair : from) {
            const auto a = number.find(pair.a), b = number.find(pair.b);
            if (a != number.end() && b != number.end()) to.push_back(std::minmax(a->second, b->second));
        }
        std::sort(to.begin(), to.end());
        to.erase(std::unique(to.begin(), to.end()), to.end());
    };
    list(ignored_groups, groups, out.filter.groups);
    list(ignored_bodies, names, out.filter.bodies);
    return out;
}

std::optional<MassProperties> shape_mass_properties(const ShapeDescription& shape) {
    return mass_properties_of(shape, {shape.vertices, shape.triangles});
}

namespace {

void check_all_loads(const Scene& scene, ErrorList& errors) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyDescription& body = scene.bodies[i];
        const auto& mass = scene.shapes[static_cast<std::size_t>(body.shape)].mass;
        if (body.type != BodyType::dynamic || !mass) continue;
        const Vec3& inertia = mass->principal_inertia;
        check_loads(body, mass->mass, mass->line == Vec3{} ? inertia.x : inertia.y, scene.settings.time_step,
                    element_path("bodies", i), errors);
    }
}

} // namespace

Scene build_scene(SceneDescription description, const std::string& source) {
    ErrorList errors(source);
    check_description(description, errors);
    errors.throw_if_any();

    Scene scene;
    scene.gravity = description.gravity;
    scene.settings = description.settings;
    warn_of_unused_shapes(description, scene.warnings);
    scene.shape_of = build_shapes(description.shapes, scene);
    scene.bodies = std::move(description.bodies);
    for (BodyDescription& body : scene.bodies) body.shape = scene.shape_of[static_cast<std::size_t>(body.shape)];
    scene.filtered = make_filter(scene.bodies, description.ignored_groups, description.ignored_bodies);
    check_all_loads(scene, errors);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        if (const auto& mass = scene.shapes[static_cast<std::size_t>(scene.bodies[i].shape)].mass)
            check_line(scene.bodies[i], mass->line, element_path("bodies", i), errors);
    check_lengths(scene, errors);
    errors.throw_if_any();
    warn_of_far_bodies(scene, scene.warnings);
    warn_of_ignored_pairs(scene, scene.warnings);
    return scene;
}

} // namespace flotilla
