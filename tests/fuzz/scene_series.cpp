// SPDX-License-Identifier: MIT
#include "fuzz/scene_series.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "draws.hpp"
#include "extremes/cells.hpp"
#include "mesh/primitives.hpp"
#include "random_scene.hpp"
#include "step/scene_parts.hpp"

namespace flotilla::fuzz {
namespace {

using survey::Draws;

/// Draws of this series are not those of the survey with the same seed.
constexpr std::uint64_t kSeries = 0x66757a7a;

template <class Enum>
void one_of_two(Draws& draws, Enum& setting, Enum value) {
    if (draws.chance(0.2)) setting = value;
}

void draw_limits(Draws& draws, Settings& s) {
    for (int* limit : {&s.collision_iterations, &s.collision_pair_iterations, &s.dynamic_iterations,
                       &s.dynamic_pair_iterations, &s.static_iterations})
        if (draws.chance(0.15)) *limit = draws.one_of(std::array{0, 1, 3, 10});
    // "Practically never reached" takes minutes where it is.
    s.static_iterations = std::min(s.static_iterations, 2000);
    s.collision_iterations = std::min(s.collision_iterations, 200);
}

/// A preset, and of every setting that has no length a value of its own now and then.
void draw_settings(Draws& draws, Settings& settings) {
    const std::vector<std::string_view> presets = preset_names();
    Settings s = preset(presets[static_cast<std::size_t>(draws.integer(0, static_cast<int>(presets.size()) - 1))]);
    s.time_step = settings.time_step;
    s.friction = settings.friction;
    s.restitution = settings.restitution;
    s.seed = settings.seed;
    one_of_two(draws, s.collisions, Collisions::accumulated);
    one_of_two(draws, s.ccd, CcdMethod::cubic);
    one_of_two(draws, s.trajectory, Trajectory::rigid);
    one_of_two(draws, s.tangents, Tangents::random);
    one_of_two(draws, s.velocity_update, VelocityUpdate::end);
    one_of_two(draws, s.contact_solver, ContactSolver::pgs);
    one_of_two(draws, s.contact_solver, ContactSolver::exact_few);
    one_of_two(draws, s.rigidification, Rigidification::rigid);
    one_of_two(draws, s.unsatisfiable_script, UnsatisfiableScript::follow);
    one_of_two(draws, s.warm_start, false);
    one_of_two(draws, s.shock_propagation, false);
    one_of_two(draws, s.sleeping, false);
    one_of_two(draws, s.substeps, draws.integer(2, 4));
    one_of_two(draws, s.contact_reuse, draws.one_of(std::array{0.0, 0.25}));
    draw_limits(draws, s);
    settings = s;
}

double reach(const SceneDescription& scene) {
    double most = 0;
    for (const BodyDescription& body : scene.bodies)
        for (const Vec3& v : scene.shapes[static_cast<std::size_t>(body.shape)].vertices)
            most = std::max(most, length(body.position) + length(v));
    return most;
}

/// A plate that goes through all the bodies from one side to the other, turning on its way.
void add_sweeping_plate(Draws& draws, SceneDescription& scene) {
    const double r = reach(scene), steps = draws.integer(3, 20);
    const double share = draws.uniform(0.3, 2);
    TriangleMesh plate = make_plate(share * r, r);
    const std::int32_t shape = scenario::add_shape(scene, std::move(plate));
    BodyDescription& body = scenario::add_body(scene, shape, BodyType::kinematic, {});
    const Vec3 start = 3 * r * draws.direction();
    const Quat begin = draws.rotation();
    body.name = "sweep";
    const Quat end = draws.chance(0.5) ? begin : draws.rotation();
    const double time = steps * scene.settings.time_step;
    body.keyframes = {{0, start, begin}, {time, -start, end}, {2 * time, start, begin}};
}

SeriesScene survey_scene(Draws& draws, std::uint64_t seed, std::uint64_t index) {
    survey::RandomScene random = survey::make_random_scene(seed, index);
    SeriesScene out{std::move(random.scene), random.kinds + ", " + random.place};
    draw_settings(draws, out.scene.settings);
    return out;
}

SeriesScene extremes_scene(Draws& draws) {
    const std::vector<extremes::Extreme> all = extremes::all_extremes();
    extremes::Cell cell;
    cell.situation = draws.chance(0.5) ? extremes::Situation::pile : extremes::Situation::clash;
    const auto axes = static_cast<std::size_t>(draws.integer(3, 5));
    while (cell.extremes.size() < axes) {
        const extremes::Extreme& e = all[static_cast<std::size_t>(draws.integer(0, static_cast<int>(all.size()) - 1))];
        const bool taken = std::any_of(cell.extremes.begin(), cell.extremes.end(),
                                       [&](const extremes::Extreme& other) { return other.axis == e.axis; });
        if (!taken) cell.extremes.push_back(e);
    }
    return {cell.scene(), cell.name()};
}

SceneDescription ordinary(Draws& draws, std::uint64_t index) {
    SceneDescription scene;
    scene.settings.time_step = draws.log_uniform(1e-3, 0.2);
    scene.settings.friction = draws.one_of(std::array{0.0, 0.1, 1.0});
    scene.settings.restitution = draws.one_of(std::array{0.0, 0.5, 1.0});
    scene.settings.seed = index;
    if (draws.chance(0.5)) scene.gravity = {};
    draw_settings(draws, scene.settings);
    return scene;
}

void add_moving(Draws& draws, SceneDescription& scene, TriangleMesh mesh, const Vec3& position, double speed) {
    const std::int32_t shape = scenario::add_shape(scene, std::move(mesh), draws.log_uniform(0.1, 100));
    const double friction = scene.settings.friction, restitution = scene.settings.restitution;
    BodyDescription& body = scenario::add_body(scene, shape, BodyType::dynamic, position, friction, restitution);
    body.velocity = speed * draws.direction();
    body.angular_velocity = draws.log_uniform(0.01, 100) * draws.direction();
}

/// Shells in shells, a few or many times their gap a step fast.
SeriesScene nested_scene(Draws& draws, std::uint64_t index) {
    SeriesScene out{ordinary(draws, index), ""};
    const double gap = draws.log_uniform(1e-3, 0.3);
    const double speed = gap / out.scene.settings.time_step * draws.log_uniform(0.1, 300);
    const int shells = draws.integer(2, 6);
    double size = 1;
    for (int i = 0; i < shells; ++i, size *= 1 - gap) {
        const bool box = draws.chance(0.5);
        // A sphere of few triangles leaves the room of its insphere; a box leaves that of its faces.
        if (box) {
            add_moving(draws, out.scene, make_box(size, size, size), {}, speed);
        } else {
            const int subdivisions = draws.integer(1, 2);
            add_moving(draws, out.scene, make_sphere(0.5 * size, subdivisions), {}, speed);
            size *= 0.45;
        }
    }
    out.name = std::to_string(shells) + " shells";
    return out;
}

/// Boxes in a grid on a floor: faces side by side in the same planes, edges and corners in line.
SeriesScene coplanar_scene(Draws& draws, std::uint64_t index) {
    SeriesScene out{ordinary(draws, index), ""};
    SceneDescription& scene = out.scene;
    const double gap = draws.log_uniform(1e-6, 0.1), speed = draws.chance(0.5) ? 0 : draws.log_uniform(0.1, 100);
    const int nx = draws.integer(1, 3), ny = draws.integer(1, 3), nz = draws.integer(1, 3);
    const bool plates = draws.chance(0.4);
    for (int x = 0; x < nx; ++x)
        for (int y = 0; y < ny; ++y)
            for (int z = 0; z < nz; ++z) {
                const double pitch = 1 + gap;
                const double rise = plates ? gap : pitch;
                const Vec3 at{pitch * x, pitch * y, (plates ? gap : 0.5 + gap) + rise * z};
                add_moving(draws, scene, plates ? make_plate(1, 1) : make_box(1, 1, 1), at, speed);
                if (speed == 0) scene.bodies.back().angular_velocity = {};
            }
    const std::int32_t floor = scenario::add_shape(scene, make_plate(20, 20));
    scenario::add_body(scene, floor, BodyType::fixed, {}, scene.settings.friction, scene.settings.restitution);
    if (draws.chance(0.3)) add_sweeping_plate(draws, scene);
    out.name = std::to_string(nx * ny * nz) + (plates ? " plates" : " boxes");
    return out;
}

} // namespace

std::string series_kind(std::uint64_t index) {
    switch (index % 4) {
    case 0: return "survey";
    case 1: return "survey, scripted";
    case 2: return "extremes";
    default: return index % 8 == 3 ? "nested" : "coplanar";
    }
}

SeriesScene series_scene(std::uint64_t seed, std::uint64_t index) {
    Draws draws(seed ^ kSeries, index);
    const std::string kind = series_kind(index);
    if (kind == "extremes") return extremes_scene(draws);
    if (kind == "nested") return nested_scene(draws, index);
    if (kind == "coplanar") return coplanar_scene(draws, index);
    SeriesScene out = survey_scene(draws, seed, index);
    if (kind != "survey") add_sweeping_plate(draws, out.scene);
    return out;
}

} // namespace flotilla::fuzz
