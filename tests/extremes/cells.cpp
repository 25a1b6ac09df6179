// SPDX-License-Identifier: MIT
#include "extremes/cells.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include "base/random.hpp"
#include "base/rotation.hpp"
#include "mesh/primitives.hpp"
#include "step/scene_parts.hpp"

namespace flotilla::extremes {
namespace {

using scenario::add_body;
using scenario::add_shape;

std::string text(double value) {
    std::ostringstream out;
    out << value;
    return out.str();
}

template <class Set>
void add_values(std::vector<Extreme>& out, const std::string& axis, std::initializer_list<double> values, Set set) {
    for (const double value : values) out.push_back({axis, text(value), [=](Knobs& k) { set(k, value); }});
}

void add_numbers(std::vector<Extreme>& out) {
    add_values(out, "time step", {1e-6, 1e-4, 1.0 / 240, 1, 10}, [](Knobs& k, double x) { k.settings.time_step = x; });
    add_values(out, "speed", {0, 1e2, 1e4, 1e6}, [](Knobs& k, double x) { k.speed = x; });
    add_values(out, "spin", {0, 1e2, 1e4, 1e5}, [](Knobs& k, double x) { k.spin = x; });
    add_values(out, "mass ratio", {1e-9, 1e-4, 1e4, 1e9}, [](Knobs& k, double x) { k.mass_ratio = x; });
    add_values(out, "size", {1e-6, 1e-3, 1e3, 1e6}, [](Knobs& k, double x) { k.size = x; });
    add_values(out, "size ratio", {1e-6, 1e-3, 1e3, 1e6}, [](Knobs& k, double x) { k.size_ratio = x; });
    add_values(out, "place", {1e3, 1e6, 5e8}, [](Knobs& k, double x) { k.place = x; });
    add_values(out, "friction", {0, 1e-12, 1, 1e3}, [](Knobs& k, double x) { k.settings.friction = x; });
    add_values(out, "restitution", {0, 1}, [](Knobs& k, double x) { k.settings.restitution = x; });
    add_values(out, "gravity", {0, 9.8e4}, [](Knobs& k, double x) { k.gravity = x; });
    add_values(out, "rest distance", {1e-9, 1e-6, 0.3}, [](Knobs& k, double x) { k.settings.rest_distance = x; });
    add_values(out, "iterations", {0, 1, 1e5}, [](Knobs& k, double x) {
        const int n = static_cast<int>(x);
        k.settings.collision_iterations = k.settings.dynamic_iterations = k.settings.static_iterations = n;
        k.settings.collision_pair_iterations = k.settings.dynamic_pair_iterations = n;
    });
    add_values(out, "tolerance", {0, 1e3}, [](Knobs& k, double x) { k.settings.static_tolerance = x; });
}

void add_shapes(std::vector<Extreme>& out) {
    const auto shape = [&](const char* name, Knobs::Shape s, double aspect = 1) {
        out.push_back({"shape", name, [=](Knobs& k) { k.shape = s, k.aspect = aspect; }});
    };
    shape("needle 1e3", Knobs::Shape::needle, 1e3);
    shape("needle 1e6", Knobs::Shape::needle, 1e6);
    shape("strip 1e6", Knobs::Shape::strip, 1e6);
    shape("flat box", Knobs::Shape::flat_box);
    shape("one triangle", Knobs::Shape::triangle);
    shape("duplicate faces", Knobs::Shape::duplicates);
    shape("zero-area triangles", Knobs::Shape::slivers);
    shape("collinear", Knobs::Shape::collinear);
    shape("soup", Knobs::Shape::soup);
    shape("shell", Knobs::Shape::shell);
    shape("rings", Knobs::Shape::ring);
    shape("chain", Knobs::Shape::chain);
}

void add_crowds(std::vector<Extreme>& out) {
    const auto crowd = [&](const char* name, Knobs::Crowd c) {
        out.push_back({"crowd", name, [=](Knobs& k) { k.crowd = c; }});
    };
    crowd("sheets 1 mm apart", Knobs::Crowd::sheets);
    crowd("sliding sheets", Knobs::Crowd::sliding_sheets);
    crowd("closing walls", Knobs::Crowd::closing_walls);
    crowd("one speed", Knobs::Crowd::convoy);
    crowd("static only", Knobs::Crowd::fixed_only);
    crowd("no bodies", Knobs::Crowd::none);
    crowd("one body", Knobs::Crowd::one);
}

void add_kinds(std::vector<Extreme>& out) {
    for (const char* name : {"paper", "preview", "accurate"})
        out.push_back({"preset", name, [=](Knobs& k) {
                           // Values that another axis set stay.
                           const Settings before = k.settings, ordinary;
                           k.settings = preset(name);
                           if (before.time_step != ordinary.time_step) k.settings.time_step = before.time_step;
                           if (before.friction != ordinary.friction) k.settings.friction = before.friction;
                           if (before.restitution != ordinary.restitution) k.settings.restitution = before.restitution;
                           if (before.rest_distance != 0) k.settings.rest_distance = before.rest_distance;
                       }});
    out.push_back({"trajectory", "rigid", [](Knobs& k) { k.settings.trajectory = Trajectory::rigid; }});
    out.push_back({"failsafe", "rigid", [](Knobs& k) {
                       k.settings.rigidification = Rigidification::rigid;
                       k.settings.collision_iterations = k.settings.dynamic_iterations = 1;
                   }});
    out.push_back({"mesh", "20,480 triangles", [](Knobs& k) { k.deep = true; }});
}

GravityOfStep turning(const Vec3& turn) {
    return [=](const Vec3& gravity, int step) { return rotate(rotation_from_vector((step - 1) * turn), gravity); };
}

TriangleMesh soup(double size) {
    TriangleMesh mesh;
    for (std::uint64_t i = 0; i < 36; ++i)
        mesh.vertices.push_back(size * Vec3{unit_interval(random_bits(7, i, 0)) - 0.5,
                                            unit_interval(random_bits(7, i, 1)) - 0.5,
                                            unit_interval(random_bits(7, i, 2)) - 0.5});
    for (std::int32_t i = 0; i < 36; i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
    return mesh;
}

TriangleMesh mesh_of(const Knobs& k, double size) {
    TriangleMesh mesh = make_box(size, size, size);
    switch (k.shape) {
    case Knobs::Shape::cube: break;
    case Knobs::Shape::needle: return make_box(size, size / k.aspect, size / k.aspect);
    case Knobs::Shape::strip: return make_plate(size, size / k.aspect);
    case Knobs::Shape::flat_box:
        for (Vec3& v : mesh.vertices) v.z = 0;
        break;
    case Knobs::Shape::triangle: return {{{0, 0, 0}, {size, 0, 0}, {0, size, 0.1 * size}}, {{0, 1, 2}}};
    case Knobs::Shape::duplicates: {
        const std::vector<Triangle> once = mesh.triangles;
        for (const Triangle& t : once) mesh.triangles.push_back({t[1], t[2], t[0]}), mesh.triangles.push_back(t);
        break;
    }
    case Knobs::Shape::slivers: {
        const auto n = static_cast<std::int32_t>(mesh.vertices.size());
        mesh.vertices.push_back(0.5 * (mesh.vertices[0] + mesh.vertices[1]));
        for (const Triangle& t : {Triangle{0, 1, n}, Triangle{n, n, n}, Triangle{0, 0, 1}}) mesh.triangles.push_back(t);
        break;
    }
    case Knobs::Shape::collinear: return {{{0, 0, 0}, {size, 0, 0}, {0.3 * size, 0, 0}}, {{0, 1, 2}}};
    case Knobs::Shape::soup: return soup(size);
    case Knobs::Shape::shell: return make_sphere(0.5 * size, 2);
    case Knobs::Shape::ring:
    case Knobs::Shape::chain: return make_ring(0.5 * size, 0.05 * size, 12, 6);
    }
    return mesh;
}

class Builder {
  public:
    Builder(const Knobs& k, Situation situation) : k_(k), pile_(situation == Situation::pile) {
        scene_.gravity = pile_ ? Vec3{0, 0, -k.gravity} : Vec3{};
        scene_.settings = k.settings;
    }

    SceneDescription build() {
        switch (k_.crowd) {
        case Knobs::Crowd::few: bodies(4); break;
        case Knobs::Crowd::one: bodies(1); break;
        case Knobs::Crowd::sheets: sheets(12, 1e-3, {}); break;
        case Knobs::Crowd::sliding_sheets: sheets(6, 1e-3, {k_.speed, 0, 0}); break;
        case Knobs::Crowd::closing_walls: bodies(4), walls(); break;
        case Knobs::Crowd::convoy: bodies(16); break;
        case Knobs::Crowd::fixed_only: bodies(3); break;
        case Knobs::Crowd::none: return std::move(scene_);
        }
        if (pile_) floor();
        if (k_.crowd == Knobs::Crowd::fixed_only)
            for (BodyDescription& b : scene_.bodies) b.type = BodyType::fixed, b.velocity = b.angular_velocity = {};
        return std::move(scene_);
    }

  private:
    std::int32_t shape(TriangleMesh mesh, double mass) {
        const auto s = add_shape(scene_, std::move(mesh), std::clamp(mass, 1e-12, 1e15));
        if (k_.shape == Knobs::Shape::collinear) { // no surface: its inertia is given
            ShapeDescription& d = scene_.shapes[static_cast<std::size_t>(s)];
            const double i = d.mass_value * k_.size * k_.size;
            d.center_of_mass = Vec3{0.4 * k_.size, 0, 0};
            d.inertia = diagonal({i, i, i});
        }
        return s;
    }

    Vec3 at(const Vec3& x) const { return x + Vec3{k_.place, k_.place, k_.place}; }

    /// One above the other, or side by side and flying at the middle; in a chain each through the one before.
    void bodies(int n) {
        double height = 0;
        for (int i = 0; i < n; ++i) {
            const bool first = i % 2 == 0;
            const double size = k_.size * (first ? 1 : k_.size_ratio), mass = 100 * (first ? 1 : k_.mass_ratio);
            const bool deep = k_.deep && i == 0;
            const auto s = shape(deep ? make_sphere(0.5 * size, 5) : mesh_of(k_, size), mass);
            const double pitch = k_.shape == Knobs::Shape::chain ? 0.8 : 1.15;
            const double z = height + 0.5 * pitch * size;
            height += pitch * size;
            auto& body =
                add_body(scene_, s, BodyType::dynamic, at({0.05 * size * i, 0.03 * size * i, z + 0.1 * k_.size}));
            if (k_.shape == Knobs::Shape::chain && i % 2 == 1) body.rotation = rotation_from_vector({1.5, 0, 0});
            if (k_.shape == Knobs::Shape::chain) body.rotation = rotation_from_vector({0, 1.5, 0}) * body.rotation;
            body.friction = k_.settings.friction, body.restitution = k_.settings.restitution;
            const bool convoy = k_.crowd == Knobs::Crowd::convoy;
            const double side = convoy || first ? 1 : -1;
            body.velocity = (pile_ ? Vec3{0.3, 0.1, -1} : Vec3{0, 0.1, side}) * k_.speed;
            if (!pile_) body.velocity.z = convoy ? k_.speed : (first ? k_.speed : -k_.speed);
            body.angular_velocity = convoy ? Vec3{} : k_.spin * Vec3{0.2 * i, 0.6 * side, 0.7};
        }
        height_ = height;
    }

    void sheets(int n, double gap, const Vec3& slide) {
        const auto s = shape(make_plate(k_.size, 0.8 * k_.size), 10);
        for (int i = 0; i < n; ++i) {
            auto& body = add_body(scene_, s, BodyType::dynamic, at({0, 0, gap * k_.size * (i + 1)}));
            body.friction = k_.settings.friction, body.restitution = k_.settings.restitution;
            body.velocity = (i % 2 == 0 ? 1.0 : -1.0) * slide;
            if (!pile_ && slide == Vec3{}) body.velocity = {0, 0, k_.speed * (n / 2 - i)};
        }
        height_ = gap * k_.size * n;
    }

    /// Two scripted walls that close on the bodies from both sides, farther than there is room.
    void walls() {
        const double s = k_.size * std::max(1.0, k_.size_ratio), tall = 3 * std::max(height_, s);
        const auto wall = add_shape(scene_, make_box(0.2 * s, tall, tall));
        for (const double side : {-1.0, 1.0}) {
            auto& body = add_body(scene_, wall, BodyType::kinematic, {});
            const double closed = 6 * scene_.settings.time_step;
            body.keyframes = {{0, at({side * 2 * s, 0, 0.5 * tall}), {}},
                              {closed, at({side * 0.15 * s, 0, 0.5 * tall}), {}}};
        }
    }

    void floor() {
        const double s = 20 * k_.size * std::max(1.0, k_.size_ratio);
        const auto plate = add_shape(scene_, make_plate(s, s));
        add_body(scene_, plate, BodyType::fixed, at({}), k_.settings.friction, k_.settings.restitution);
    }

    const Knobs& k_;
    bool pile_;
    SceneDescription scene_;
    double height_ = 0;
};

} // namespace

std::vector<Extreme> all_extremes() {
    std::vector<Extreme> out;
    add_numbers(out);
    add_shapes(out);
    add_crowds(out);
    add_kinds(out);
    return out;
}

std::vector<Extreme> changing_gravity() {
    std::vector<Extreme> out;
    const auto gravity = [&](const char* name, GravityOfStep of_step) {
        out.push_back({"changing gravity", name, [=](Knobs& k) { k.gravity_of_step = of_step; }});
    };
    gravity("turns by 0.1", turning({0.06, 0.08, 0}));
    gravity("turns by 2", turning({1.2, 1, -1.3}));
    gravity("reverses", [](const Vec3& g, int step) { return step % 2 == 0 ? -g : g; });
    gravity("comes and goes", [](const Vec3& g, int step) { return step % 2 == 0 ? Vec3{} : 100 * g; });
    return out;
}

std::string Cell::name() const {
    if (own_scene) return extremes[0].axis + ", " + extremes[0].value;
    std::string out = situation == Situation::pile ? "pile" : "clash";
    for (const Extreme& e : extremes) out += ", " + e.axis + " " + e.value;
    return out;
}

SceneDescription Cell::scene() const { return own_scene ? own_scene() : Builder(knobs(), situation).build(); }

GravityOfStep Cell::gravity_of_step() const { return own_scene ? GravityOfStep{} : knobs().gravity_of_step; }

Knobs Cell::knobs() const {
    Knobs knobs;
    knobs.settings.sleeping = false;
    for (const Extreme& e : extremes) e.set(knobs);
    return knobs;
}

std::vector<Cell> all_cells() {
    std::vector<Cell> cells;
    for (const Situation situation : {Situation::pile, Situation::clash}) {
        std::vector<Extreme> extremes = all_extremes();
        if (situation == Situation::pile) std::ranges::move(changing_gravity(), std::back_inserter(extremes));
        for (std::size_t i = 0; i < extremes.size(); ++i) {
            cells.push_back({situation, {extremes[i]}, {}});
            for (std::size_t j = i + 1; j < extremes.size(); ++j)
                if (extremes[j].axis != extremes[i].axis) cells.push_back({situation, {extremes[i], extremes[j]}, {}});
        }
    }
    return cells;
}

} // namespace flotilla::extremes
