// SPDX-License-Identifier: MIT
#include "random_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include <flotilla/error.hpp>
#include <flotilla/scene_check.hpp>

#include "base/rotation.hpp"
#include "base/vec3.hpp"
#include "draws.hpp"
#include "mesh/primitives.hpp"
#include "scene/library.hpp"

namespace flotilla::survey {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Ranges of the survey, SI units.
constexpr int kMinBodies = 2, kMaxBodies = 12;
constexpr double kMinSize = 1e-3, kMaxSize = 1e3;
constexpr double kMinMass = 1e-3, kMaxMass = 1e3; // of the lightest body
constexpr double kMaxMassRatio = 1e6;
constexpr double kMinStep = 1e-4, kMaxStep = 1;
constexpr double kMinSpeed = 1e-2, kMaxSpeed = 1e4; // sizes of the body a second
constexpr double kMinWay = 0.05; // sizes a step, of most scenes that move: within a few dozen steps bodies meet
constexpr double kMinSpin = 1e-2, kMaxSpin = 1e4; // rad/s
constexpr double kMaxAspect = 1e4;

// Shapes, all of about unit size. No two numbers are drawn in one expression: the order of evaluation is the
// compiler's.

TriangleMesh box(Draws& draws) {
    const double width = draws.uniform(0.2, 1);
    const double height = draws.uniform(0.2, 1);
    return make_box(1, width, height);
}

TriangleMesh plate(Draws& draws) {
    const double width = draws.uniform(0.1, 1);
    return make_plate(1, width, draws.integer(1, 3), 1);
}

TriangleMesh bar(Draws& draws) {
    const double width = 1 / draws.log_uniform(3, 100);
    return make_box(1, width, width * draws.uniform(0.5, 1));
}

TriangleMesh needle(Draws& draws) {
    const double width = 1 / draws.log_uniform(100, kMaxAspect);
    return make_box(1, width, width);
}

TriangleMesh octahedron(Draws& draws) {
    const double a = draws.uniform(0.2, 1);
    const double b = draws.uniform(0.2, 1);
    return {{{1, 0, 0}, {-1, 0, 0}, {0, a, 0}, {0, -a, 0}, {0, 0, b}, {0, 0, -b}},
            {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

TriangleMesh tetrahedron(Draws& draws) {
    const double top = draws.uniform(0, 1);
    const double height = draws.uniform(0.1, 1);
    return {{{0, 0, 0}, {1, 0, 0}, {top, 1, 0}, {0.3, 0.3, height}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

TriangleMesh torus(Draws& draws) {
    const double tube = draws.uniform(0.05, 0.5);
    const int segments = draws.integer(5, 10);
    return make_ring(1, tube, segments, draws.integer(3, 5));
}

TriangleMesh cup(Draws& draws) {
    const bool round = draws.chance(0.5);
    const int segments = draws.integer(4, 8);
    if (round) return library::bowl_mesh(1, draws.uniform(0.6, 2.2), 2, segments);
    return make_tube(draws.uniform(0.2, 1), 1, segments);
}

/// Triangles that share nothing.
TriangleMesh soup(Draws& draws) {
    TriangleMesh mesh;
    const int count = draws.integer(2, 8);
    for (int i = 0; i < count; ++i) {
        const Vec3 middle = draws.in_ball(1);
        for (int corner = 0; corner < 3; ++corner) mesh.vertices.push_back(middle + draws.in_ball(0.5));
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return mesh;
}

struct Kind {
    std::string_view name;
    TriangleMesh (*make)(Draws&);
};
constexpr std::array kKinds{Kind{"box", box},
                            Kind{"plate", plate},
                            Kind{"bar", bar},
                            Kind{"needle", needle},
                            Kind{"octahedron", octahedron},
                            Kind{"tetrahedron", tetrahedron},
                            Kind{"torus", torus},
                            Kind{"cup", cup},
                            Kind{"soup", soup}};

/// Centred in its bounds, whose diagonal becomes `size`.
void fit(TriangleMesh& mesh, double size) {
    Vec3 low = mesh.vertices.front(), high = low;
    for (const Vec3& v : mesh.vertices) low = min(low, v), high = max(high, v);
    const Vec3 middle = 0.5 * (low + high);
    const double scale = size / length(high - low);
    for (Vec3& v : mesh.vertices) v = scale * (v - middle);
}

/// Least and greatest value of a quantity within one scene.
struct Range {
    double low = 0, high = 0;
};

/// What the bodies of one scene have in common. In half of the scenes all have one size, and in half one mass.
struct Common {
    Range size, mass;
    std::string_view only_kind; ///< empty: mixed
    double min_speed = 0;       // sizes a second; 0: at rest
    bool turns = false;
    bool aimed = false;  // at the middle
    bool packed = false; // moved together until nearly touching
};

Common draw_common(Draws& draws, double time_step) {
    Common common;
    common.size.low = common.size.high = draws.log_uniform(kMinSize, kMaxSize);
    if (draws.chance(0.5)) common.size.high = draws.log_uniform(common.size.low, kMaxSize);
    common.mass.low = common.mass.high = draws.log_uniform(kMinMass, kMaxMass);
    if (draws.chance(0.5)) common.mass.high *= draws.log_uniform(1, kMaxMassRatio);
    if (draws.chance(0.5)) common.only_kind = draws.one_of(kKinds).name;
    const bool moves = draws.chance(0.7);
    const bool slow = draws.chance(0.2);
    if (moves) common.min_speed = slow ? kMinSpeed : std::max(kMinSpeed, kMinWay / time_step);
    common.turns = draws.chance(0.5);
    common.aimed = draws.chance(0.7);
    common.packed = draws.chance(0.5);
    return common;
}

Kind draw_kind(Draws& draws, const Common& common) {
    if (common.only_kind.empty()) return draws.one_of(kKinds);
    return *std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& k) { return k.name == common.only_kind; });
}

bool is_free(const SceneDescription& scene) { return check_scene(scene).intersections.empty(); }

/// Puts the last body in a free place: near the middle, ever further out while it meets those already there.
void place_last(SceneDescription& scene, Draws& draws, double& spread) {
    constexpr int kAttempts = 200;
    constexpr double kWiden = 1.1;
    BodyDescription& body = scene.bodies.back();
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        body.position = draws.in_ball(spread);
        body.rotation = draws.rotation();
        if (is_free(scene)) return;
        spread *= kWiden;
    }
    throw InputError("no free place for body " + body.name);
}

/// Moves the last body towards the middle until it nearly meets another; how nearly is drawn.
void pack_last(SceneDescription& scene, Draws& draws) {
    BodyDescription& body = scene.bodies.back();
    const Vec3 start = body.position;
    const int halvings = draws.integer(3, 14);
    body.position = {};
    if (is_free(scene)) return;
    double free = 1, meets = 0; // shares of the way out from the middle
    for (int i = 0; i < halvings; ++i) {
        const double share = 0.5 * (free + meets);
        body.position = share * start;
        (is_free(scene) ? free : meets) = share;
    }
    body.position = free * start;
}

ShapeDescription draw_shape(Draws& draws, const Common& common, const Kind& kind, const std::string& name) {
    const double size = draws.log_uniform(common.size.low, common.size.high);
    TriangleMesh mesh = kind.make(draws);
    fit(mesh, size);
    ShapeDescription shape = library::shape_of(name, std::move(mesh));
    shape.mass_kind = MassKind::mass;
    shape.mass_value = draws.log_uniform(common.mass.low, common.mass.high);
    return shape;
}

double size_of(const ShapeDescription& shape) {
    double radius = 0;
    for (const Vec3& v : shape.vertices) radius = std::max(radius, length(v));
    return 2 * radius;
}

void set_moving(BodyDescription& body, Draws& draws, const Common& common, double size, double spread) {
    const double speed = common.min_speed > 0 ? size * draws.log_uniform(common.min_speed, kMaxSpeed) : 0;
    const Vec3 inwards = normalized(draws.in_ball(0.3 * spread) - body.position);
    body.velocity = speed * (common.aimed ? inwards : draws.direction());
    if (!common.turns) return;
    const Vec3 axis = draws.direction();
    body.angular_velocity = draws.log_uniform(kMinSpin, kMaxSpin) * axis;
}

/// `spread` is how far from the middle bodies are put, m.
void add_body(SceneDescription& scene, Draws& draws, const Common& common, const Kind& kind, double& spread) {
    const std::string name = std::string(kind.name) + " " + std::to_string(scene.bodies.size());
    scene.shapes.push_back(draw_shape(draws, common, kind, name));
    scene.bodies.push_back(
        library::body_of(name, static_cast<std::int32_t>(scene.bodies.size()), BodyType::dynamic, {}));
    const double size = size_of(scene.shapes.back());
    spread = std::max(spread, 0.5 * size);
    place_last(scene, draws, spread);
    if (common.packed) pack_last(scene, draws);
    set_moving(scene.bodies.back(), draws, common, size, spread);
}

struct Bounds {
    Vec3 low, high;
    double radius = 0; ///< about the origin
    double smallest = kMaxSize;
};

Bounds bounds_of(const SceneDescription& scene) {
    Bounds bounds;
    bool first = true;
    for (const BodyDescription& body : scene.bodies) {
        Vec3 low, high;
        for (const Vec3& v : scene.shapes[static_cast<std::size_t>(body.shape)].vertices) {
            const Vec3 p = body.position + rotate(body.rotation, v);
            bounds.low = first ? p : min(bounds.low, p);
            bounds.high = first ? p : max(bounds.high, p);
            bounds.radius = std::max(bounds.radius, length(p));
            first = false;
            low = min(low, v), high = max(high, v);
        }
        bounds.smallest = std::min(bounds.smallest, length(high - low));
    }
    return bounds;
}

/// A fixed body that holds the others: with `gap` to the nearest of them (floor, box), or half as much again as they
/// need (bowl).
void add_place(SceneDescription& scene, Draws& draws, std::string_view place) {
    if (place == "free") return;
    const Bounds bounds = bounds_of(scene);
    const double gap = bounds.smallest * draws.log_uniform(1e-4, 1);
    const Vec3 extent = bounds.high - bounds.low + 2 * gap * Vec3{1, 1, 1}, middle = 0.5 * (bounds.low + bounds.high);
    TriangleMesh mesh;
    Vec3 position;
    if (place == "floor") {
        const double side = 20 * length(extent);
        mesh = make_plate(side, side);
        position = {middle.x, middle.y, bounds.low.z - gap};
    } else if (place == "box") {
        mesh = make_box(extent.x, extent.y, extent.z);
        position = middle;
    } else {
        const double radius = 1.5 * bounds.radius;
        mesh = library::bowl_mesh(radius, 0.45 * kPi, 6, 16);
        position = {0, 0, -radius};
    }
    scene.shapes.push_back(library::shape_of(std::string(place), std::move(mesh)));
    scene.bodies.push_back(library::body_of(std::string(place), static_cast<std::int32_t>(scene.bodies.size()),
                                            BodyType::fixed, position));
}

std::string list_kinds(const std::map<std::string_view, int>& counts) {
    std::string text;
    for (const auto& [name, count] : counts)
        text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + std::string(name);
    return text;
}

} // namespace

RandomScene make_random_scene(std::uint64_t seed, std::uint64_t index) {
    Draws draws(seed, index);
    RandomScene out;
    SceneDescription& scene = out.scene;
    scene.settings.time_step = draws.log_uniform(kMinStep, kMaxStep);
    scene.settings.friction = draws.one_of(std::array{0.0, 0.1, 0.5, 2.0, 10.0});
    scene.settings.restitution = draws.one_of(std::array{0.0, 0.1, 0.5, 1.0});
    scene.settings.seed = index;
    scene.gravity = {0, 0, draws.chance(0.7) ? -9.8 : 0.0};
    const auto place = draws.one_of(std::array<std::string_view, 4>{"free", "floor", "box", "bowl"});
    const Common common = draw_common(draws, scene.settings.time_step);
    const int bodies = draws.integer(kMinBodies, kMaxBodies);
    std::map<std::string_view, int> counts;
    double spread = 0;
    for (int i = 0; i < bodies; ++i) {
        const Kind kind = draw_kind(draws, common);
        add_body(scene, draws, common, kind, spread);
        ++counts[kind.name];
    }
    add_place(scene, draws, place);
    for (BodyDescription& body : scene.bodies) {
        body.friction = scene.settings.friction;
        body.restitution = scene.settings.restitution;
    }
    out.kinds = list_kinds(counts);
    out.place = place;
    return out;
}

} // namespace flotilla::survey
