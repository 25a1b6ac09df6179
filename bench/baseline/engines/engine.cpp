// SPDX-License-Identifier: MIT
#include "engine.hpp"

#include <CLI/CLI.hpp>

#include <ctime>
#include <exception>
#include <iostream>

#include <flotilla/scene_file.hpp>

#include "base/rotation.hpp"
#include "scene/scene.hpp"

namespace flotilla::baseline {
namespace {

double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

EngineScene load(const EngineArguments& arguments) {
    EngineScene scene{read_scene(arguments.scene), {}, {}};
    for (const ShapeDescription& shape : scene.description.shapes) {
        auto mass = shape_mass_properties(shape);
        const Primitive primitive = arguments.shape == kPrimitives ? recognize(shape) : Primitive{};
        const bool regular = primitive.kind != Primitive::Kind::mesh && primitive.kind != Primitive::Kind::convex;
        if (mass && regular) mass = primitive_mass(primitive, shape, *mass);
        scene.masses.push_back(mass);
        scene.primitives.push_back(primitive);
    }
    return scene;
}

int simulate(const EngineArguments& arguments, const MakeEngine& make) {
    const EngineScene scene = load(arguments);
    const auto engine = make(scene, arguments);
    PosesFile file(arguments.output, scene.description);
    file.write(0, 0, engine->rows());
    double seconds = 0;
    int k = 1;
    for (; k <= arguments.steps && (arguments.limit <= 0 || seconds < arguments.limit); ++k) {
        const double start = cpu_seconds();
        engine->step(arguments.dt);
        seconds += cpu_seconds() - start;
        if (k % arguments.frame_every == 0) file.write(k / arguments.frame_every, k * arguments.dt, engine->rows());
    }
    file.close();
    std::cout << "cpu seconds: " << seconds << '\n';
    return k > arguments.steps ? 0 : 6;
}

} // namespace

std::vector<Vec3> vertices_about_mass(const ShapeDescription& shape, const std::optional<MassProperties>& mass) {
    std::vector<Vec3> out = shape.vertices;
    if (mass)
        for (Vec3& v : out) v = rotate(conjugate(mass->principal_axes), v - mass->center_of_mass);
    return out;
}

Frame mass_frame(const BodyDescription& body, const std::optional<MassProperties>& mass) {
    if (!mass) return {body.position, body.rotation};
    return {body.position + rotate(body.rotation, mass->center_of_mass), body.rotation * mass->principal_axes};
}

Frame mesh_frame(const Frame& frame, const std::optional<MassProperties>& mass) {
    if (!mass) return frame;
    const Quat rotation = normalized(frame.rotation * conjugate(mass->principal_axes));
    return {frame.position - rotate(rotation, mass->center_of_mass), rotation};
}

int run_engine(int argc, char** argv, const std::string& name, const std::vector<std::string>& shapes,
               const std::vector<std::string>& solvers, const MakeEngine& make) {
    CLI::App app{"A scene simulated by another engine, for comparison", name};
    EngineArguments arguments;
    arguments.shape = shapes.front();
    arguments.solver = solvers.front();
    app.add_option("SCENE", arguments.scene, "Scene file")->required();
    app.add_option("--output", arguments.output, "Trajectory, CSV")->required();
    app.add_option("--steps", arguments.steps, "Steps")->required()->check(CLI::PositiveNumber);
    app.add_option("--dt", arguments.dt, "Time step, s")->check(CLI::PositiveNumber);
    app.add_option("--gap", arguments.gap, "Kept between surfaces, m")->check(CLI::NonNegativeNumber);
    app.add_option(
           "--panel-thickness", arguments.panel_thickness,
           "Of the thin convex panels that meshes are cut into where the engine takes such, m; 0: a panel per triangle")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--iterations", arguments.iterations, "Of the engine's solver (default: its own)");
    app.add_option("--shape", arguments.shape, "How meshes are taken")->check(CLI::IsMember(shapes));
    app.add_option("--solver", arguments.solver, "Of contacts")->check(CLI::IsMember(solvers));
    app.add_option("--frame-every", arguments.frame_every, "Steps between frames (a proof of motions needs every one)")
        ->check(CLI::PositiveNumber);
    app.add_option("--limit", arguments.limit, "CPU seconds after which the run is given up: exit code 6")
        ->check(CLI::NonNegativeNumber);
    CLI11_PARSE(app, argc, argv);
    try {
        return simulate(arguments, make);
    } catch (const std::exception& e) {
        std::cerr << name << ": " << e.what() << '\n';
        return 2;
    }
}

} // namespace flotilla::baseline
