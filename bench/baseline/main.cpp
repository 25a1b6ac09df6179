// SPDX-License-Identifier: MIT
// flotilla_baseline: a scene simulated by reference [15] of the paper, to set its figures 2 and 14 side by side:
//   E. Guendelman, R. Bridson, R. Fedkiw, "Nonconvex rigid bodies with stacking", ACM Trans. Graph. 22 (3), 2003.
// It shares with flotilla the scene reader and the mass properties, nothing of the solver. Not implemented: rolling and
// spinning friction (section 7), kinematic bodies. `flotilla verify SCENE --poses FILE` judges what it writes.
#include <CLI/CLI.hpp>

#include <cmath>
#include <iostream>
#include <string>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "bodies.hpp"
#include "poses_file.hpp"
#include "stepper.hpp"

namespace {

using namespace flotilla;

struct Arguments {
    std::string scene, output;
    int steps = 0, samples = 16, substeps = 1;
    double dt = 0, thickness = 0.01;
    baseline::StepOptions options;
};

void simulate(const Arguments& arguments) {
    const SceneDescription scene = read_scene(arguments.scene);
    const double dt = arguments.dt > 0 ? arguments.dt : scene.settings.time_step;
    baseline::Bodies bodies = baseline::make_bodies(scene, arguments.samples, arguments.thickness);
    baseline::PosesFile file(arguments.output, scene);
    file.write(0, 0, baseline::rows(bodies));
    for (int frame = 1; frame <= arguments.steps; ++frame) {
        for (int k = 0; k < arguments.substeps; ++k) baseline::step(bodies, dt / arguments.substeps, arguments.options);
        file.write(frame, frame * dt, baseline::rows(bodies));
    }
    file.close();
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app{"Nonconvex rigid bodies with stacking (2003), for comparison", "flotilla_baseline"};
    Arguments arguments;
    app.add_option("SCENE", arguments.scene, "Scene file")->required();
    app.add_option("--steps", arguments.steps, "Frames")->required()->check(CLI::PositiveNumber);
    app.add_option("--output", arguments.output, "Trajectory, CSV")->required();
    app.add_option("--dt", arguments.dt, "Time between frames, s (default: the scene's time step)");
    app.add_option("--substeps", arguments.substeps, "Steps in each frame")->check(CLI::PositiveNumber);
    app.add_option("--samples", arguments.samples, "Sample points along a body's diagonal; 0: vertices only")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--thickness", arguments.thickness, "Of open meshes, to either side, m")->check(CLI::PositiveNumber);
    app.add_option("--contact-sweeps", arguments.options.contact_sweeps, "Of epsilon scaling")
        ->check(CLI::PositiveNumber);
    app.add_flag("!--no-shock", arguments.options.shock_propagation, "Leave out shock propagation");
    CLI11_PARSE(app, argc, argv);
    try {
        simulate(arguments);
        return 0;
    } catch (const InputError& e) {
        std::cerr << "flotilla_baseline: " << e.what() << '\n';
        return 2;
    } catch (const IoError& e) {
        std::cerr << "flotilla_baseline: " << e.what() << '\n';
        return 5;
    }
}
