// SPDX-License-Identifier: MIT
#include "picture/model.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <unordered_map>

#include "base/index.hpp"
#include "base/rotation.hpp"
#include "run_folder/body_colour.hpp"
#include "run_folder/drawn_mesh.hpp"

namespace flotilla::picture {
namespace {

using Index = std::size_t;

constexpr double kCreaseCosine = 0.77; // faces that meet at less than 40 degrees are shaded as one smooth surface
constexpr Index kLargestFan = 64;      // a vertex with more faces is shaded flat: the sum over pairs would be slow

std::vector<Vec3> area_normals(const TriangleMesh& mesh, double inv_size) {
    std::vector<Vec3> normals;
    normals.reserve(mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
        const Vec3 a = mesh.vertices[at(t[0])];
        normals.push_back(cross(inv_size * (mesh.vertices[at(t[1])] - a), inv_size * (mesh.vertices[at(t[2])] - a)));
    }
    return normals;
}

/// The faces around each vertex, as offsets and a list.
struct Fans {
    std::vector<std::uint32_t> first, faces;
    explicit Fans(const TriangleMesh& mesh) : first(mesh.vertices.size() + 1), faces(3 * mesh.triangles.size()) {
        for (const Triangle& t : mesh.triangles)
            for (std::int32_t v : t) ++first[at(v) + 1];
        for (Index v = 1; v < first.size(); ++v) first[v] += first[v - 1];
        std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
        for (Index f = 0; f < mesh.triangles.size(); ++f)
            for (std::int32_t v : mesh.triangles[f]) faces[next[at(v)]++] = static_cast<std::uint32_t>(f);
    }
};

/// Normals of a soup need no consistent orientation: a neighbour counts with the sign that agrees with the face itself.
std::vector<Float3> smooth_normals(const TriangleMesh& mesh, const std::vector<Vec3>& weighted) {
    std::vector<Vec3> unit(weighted.size());
    std::ranges::transform(weighted, unit.begin(), [](const Vec3& n) { return flotilla::normalized(n); });
    const Fans fans(mesh);
    std::vector<Float3> normals;
    normals.reserve(3 * mesh.triangles.size());
    for (Index f = 0; f < mesh.triangles.size(); ++f)
        for (std::int32_t v : mesh.triangles[f]) {
            Vec3 sum = weighted[f];
            const Index begin = fans.first[at(v)], end = fans.first[at(v) + 1];
            for (Index k = begin; k < end && end - begin <= kLargestFan; ++k) {
                const Index g = fans.faces[k];
                const double cosine = dot(unit[f], unit[g]);
                if (g != f && std::abs(cosine) > kCreaseCosine) sum += (cosine < 0 ? -1.0 : 1.0) * weighted[g];
            }
            normals.push_back(to_float(flotilla::normalized(sum)));
        }
    return normals;
}

void set_normals(MeshData& data) {
    double outward = 0;
    const double inv_size = data.radius > 0 ? 1 / data.radius : 1;
    const std::vector<Vec3> normals = area_normals(*data.mesh, inv_size);
    for (Index f = 0; f < normals.size(); ++f)
        outward += dot(normals[f], inv_size * (data.mesh->vertices[at(data.mesh->triangles[f][0])] - data.center));
    data.inside_out = outward < 0;
    data.corner_normals = smooth_normals(*data.mesh, normals);
}

MeshData mesh_data(const TriangleMesh& mesh) {
    MeshData data{.mesh = &mesh, .drawn = {}, .corner_normals = {}, .center = {}, .radius = 0, .inside_out = false};
    if (mesh.vertices.empty()) return data;
    Vec3 low = mesh.vertices.front(), high = low;
    for (const Vec3& v : mesh.vertices) low = min(low, v), high = max(high, v);
    data.center = 0.5 * low + 0.5 * high;
    for (const Vec3& v : mesh.vertices) data.radius = std::max(data.radius, flotilla::length(v - data.center));
    if (io::has_thin_elements(mesh)) {
        data.drawn = std::make_shared<TriangleMesh>(io::drawn_mesh(mesh, io::drawn_radius(2 * data.radius)));
        data.mesh = data.drawn.get();
    }
    set_normals(data);
    return data;
}

Float3 palette(std::uint32_t number) {
    const io::BodyColour colour = io::colour_of(number);
    const auto& c = io::kBodyColours[colour.colour];
    const auto linear = [&](int v) { return colour.shade * io::linear_of_srgb(v); };
    return {linear(c[0]), linear(c[1]), linear(c[2])};
}

struct Sphere {
    Vec3 center;
    double radius = 0;
};

struct Box {
    Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
             std::numeric_limits<double>::infinity()};
    Vec3 high = -low;
    void add(const Sphere& s) {
        low = min(low, s.center - Vec3{s.radius, s.radius, s.radius});
        high = max(high, s.center + Vec3{s.radius, s.radius, s.radius});
    }
    [[nodiscard]] Sphere sphere() const {
        if (!(low.x <= high.x)) return {};
        return {0.5 * low + 0.5 * high, 0.5 * flotilla::length(high - low)};
    }
};

double quantile(std::vector<double> values, double q) {
    if (values.empty()) return 0;
    const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return values[static_cast<Index>(k)];
}

/// Marks the dynamic bodies that belong together: one that flew off far away must not shrink the rest to a dot.
Sphere focus_on_dynamic(std::span<const Sphere> spheres, std::vector<BodyData>& bodies) {
    constexpr double kFar = 8; // times the distance that 9 of 10 bodies keep
    std::array<std::vector<double>, 3> coordinates;
    for (Index i = 0; i < bodies.size(); ++i)
        for (int axis = 0; axis < 3 && !bodies[i].fixed; ++axis)
            coordinates[static_cast<Index>(axis)].push_back(component(spheres[i].center, axis));
    const Vec3 middle{quantile(coordinates[0], 0.5), quantile(coordinates[1], 0.5), quantile(coordinates[2], 0.5)};
    std::vector<double> reach;
    for (Index i = 0; i < bodies.size(); ++i)
        if (!bodies[i].fixed) reach.push_back(flotilla::length(spheres[i].center - middle) + spheres[i].radius);
    const double limit = kFar * quantile(reach, 0.9);
    Box box;
    for (Index i = 0; i < bodies.size(); ++i) {
        bodies[i].in_focus = !bodies[i].fixed && flotilla::length(spheres[i].center - middle) <= limit;
        if (bodies[i].in_focus) box.add(spheres[i]);
    }
    return box.sphere();
}

/// Fixed bodies near the dynamic ones and not much larger belong to the picture; an endless floor does not.
Sphere focus_on_fixed(std::span<const Sphere> spheres, std::vector<BodyData>& bodies, const Sphere& dynamic) {
    constexpr double kLarge = 2.2; // times the radius of all dynamic bodies together
    const bool any_dynamic = dynamic.radius > 0;
    Box box;
    if (any_dynamic) box.add(dynamic);
    for (Index i = 0; i < bodies.size(); ++i) {
        const Sphere& s = spheres[i];
        if (!bodies[i].fixed) continue;
        const bool near = flotilla::length(s.center - dynamic.center) <= s.radius + 2 * dynamic.radius;
        bodies[i].in_focus = !any_dynamic || (near && s.radius <= kLarge * dynamic.radius);
        if (bodies[i].in_focus) box.add(s);
    }
    return box.sphere();
}

void place_vertices(Model& model, std::span<const PictureBody> input, std::span<const Sphere> spheres) {
    // A body that flew off to nowhere stays out of sight at a place where single precision does not overflow.
    constexpr Vec3 kFarthest{1e9, 1e9, 1e9};
    model.floor = std::numeric_limits<float>::infinity();
    float reach_sq = 0;
    for (Index i = 0; i < input.size(); ++i) {
        BodyData& body = model.bodies[i];
        body.first_vertex = static_cast<std::uint32_t>(model.vertices.size());
        body.center = to_float((spheres[i].center - model.origin) / model.scale);
        body.radius = static_cast<float>(spheres[i].radius / model.scale);
        const Mat3 r = (1 / model.scale) * matrix(body.rotation);
        const Vec3 offset = (input[i].position - model.origin) / model.scale;
        for (const Vec3& v : model.mesh(body).vertices) {
            const Float3 p = to_float(max(-kFarthest, min(kFarthest, r * v + offset)));
            model.vertices.push_back(p);
            if (!body.in_focus) continue;
            model.floor = std::min(model.floor, p.z);
            reach_sq = std::max(reach_sq, dot(p, p));
        }
    }
    if (!(model.floor < std::numeric_limits<float>::infinity())) model.floor = 0;
    model.focus_radius = reach_sq > 0 ? std::sqrt(reach_sq) : 1;
}

} // namespace

Model build_model(std::span<const PictureBody> bodies) {
    Model model;
    std::unordered_map<const TriangleMesh*, std::uint32_t> known; // looked up only, never walked
    std::vector<Sphere> spheres;
    for (const PictureBody& input : bodies) {
        const auto [entry, added] = known.try_emplace(input.mesh, static_cast<std::uint32_t>(model.meshes.size()));
        if (added) model.meshes.push_back(mesh_data(*input.mesh));
        const MeshData& mesh = model.meshes[entry->second];
        BodyData body;
        body.mesh = entry->second;
        body.rotation = flotilla::normalized(input.rotation);
        body.fixed = input.fixed;
        body.colour = palette(input.colour);
        spheres.push_back({input.position + rotate(body.rotation, mesh.center), mesh.radius});
        model.bodies.push_back(std::move(body));
    }
    const Sphere dynamic = focus_on_dynamic(spheres, model.bodies);
    const Sphere focus = focus_on_fixed(spheres, model.bodies, dynamic);
    for (BodyData& body : model.bodies)
        if (body.fixed)
            body.colour = body.in_focus ? Float3{io::kFixedColour[0], io::kFixedColour[1], io::kFixedColour[2]}
                                        : Float3{0.37F, 0.38F, 0.38F};
    model.origin = focus.center;
    model.scale = focus.radius > 0 ? focus.radius : 1;
    const Sphere& subject = dynamic.radius > 0 ? dynamic : focus;
    model.dynamic_center = to_float((subject.center - model.origin) / model.scale);
    model.dynamic_radius = static_cast<float>(subject.radius / model.scale);
    place_vertices(model, bodies, spheres);
    return model;
}

void cut_open(Model& model, Float3 eye) {
    constexpr float kEnclosing = 0.5F; // of the radius of the dynamic bodies: smaller ones hide little
    // Bodies that lie on a floor stick out on both sides of it by little or nothing; they are not behind it.
    constexpr float kClear = 0.1F; // of the radius of the dynamic bodies
    if (std::ranges::all_of(model.bodies, [](const BodyData& b) { return b.fixed; })) return;
    const Float3 inside = model.dynamic_center;
    for (BodyData& body : model.bodies) {
        if (!body.fixed || body.radius < kEnclosing * model.dynamic_radius) continue;
        const TriangleMesh& mesh = model.mesh(body);
        const std::span<const Float3> v = model.vertices_of(body);
        body.glass.assign(mesh.triangles.size(), 0);
        bool any = false;
        for (Index k = 0; k < mesh.triangles.size(); ++k) {
            const Triangle& t = mesh.triangles[k];
            const Float3 a = v[at(t[0])], n = normalized(cross(v[at(t[1])] - a, v[at(t[2])] - a));
            const float depth = dot(n, inside - a);
            const bool between =
                std::abs(depth) > kClear * model.dynamic_radius && (dot(n, eye - a) > 0) != (depth > 0);
            body.glass[k] = between ? 1 : 0;
            any = any || between;
        }
        if (!any) body.glass.clear();
    }
}

} // namespace flotilla::picture
