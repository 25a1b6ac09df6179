// SPDX-License-Identifier: MIT
// flotilla_plan_savings: what each saving of `flotilla plan` is worth in a scene. Runs with all of them and with one
// switched off go on side by side, a step of each in turn, several times; of a step's CPU times the least counts. One
// line of CSV per saving goes to stdout.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <flotilla/scene_file.hpp>

#include "base/floating_point.hpp"
#include "state/build_model.hpp"
#include "step/stepper.hpp"

namespace {

using namespace flotilla;

struct Row {
    const char* name;
    void (*without)(Model&, Savings&);
};

void give_own_shapes(Model& model) {
    std::vector<RigidShape> shapes;
    for (std::size_t i = 0; i < model.size(); ++i) {
        shapes.push_back(model.shape_of(i));
        model.bodies[i].shape = static_cast<std::int32_t>(i);
    }
    model.shapes.assign(std::make_move_iterator(shapes.begin()), std::make_move_iterator(shapes.end()));
}

constexpr Row kRows[] = {
    {"all", [](Model&, Savings&) {}},
    {"all, again", [](Model&, Savings&) {}},
    {"no friction", [](Model&, Savings& s) { s.normal_rows = false; }},
    {"no impulse needed", [](Model&, Savings& s) { s.calm_pairs = false; }},
    {"ballistic", [](Model&, Savings& s) { s.kept_pairs = false; }},
    {"not rasterized", [](Model&, Savings& s) { s.large_bodies = false; }},
    {"rest", [](Model& m, Savings&) { m.settings.sleeping = false; }},
    {"shapes", [](Model& m, Savings&) { give_own_shapes(m); }},
    {"straight paths", [](Model& m, Savings&) { m.settings.trajectory = Trajectory::rigid; }},
    {"falls", [](Model&, Savings& s) { s.look_ahead = false; }},
    {"no scripts", [](Model&, Savings& s) { s.scripts = false; }},
};

struct Run {
    const Row* row;
    Model model;
    Savings savings;
    std::unique_ptr<Stepper> stepper;
    std::vector<double> ms;
    std::uint64_t hash = 0;
};

double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// All from one state, so that nothing but the saving differs; savings that change results go on from it in their own
/// way.
void measure(const State& start, int steps, int repetitions, std::vector<Run>& runs) {
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        for (Run& run : runs) {
            StepperOptions options;
            options.savings = run.savings;
            State own = start;
            if (!run.model.settings.sleeping) own.sleep.assign(own.sleep.size(), {});
            run.stepper = std::make_unique<Stepper>(run.model, std::move(own), options);
        }
        for (int n = 0; n < steps; ++n)
            for (std::size_t k = 0; k < runs.size(); ++k) { // none is always the first, with cold caches
                Run& run = runs[(k + static_cast<std::size_t>(n)) % runs.size()];
                const double begin = cpu_ms();
                run.hash = run.stepper->step().state_hash;
                double& least = run.ms[static_cast<std::size_t>(n)];
                least = std::min(least, cpu_ms() - begin);
            }
    }
}

int run(const std::string& file, int from, int steps, int repetitions) {
    const DefaultFloatingPoint environment;
    const Scene scene = build_scene(read_scene(file), file);
    const Model model = make_model(scene);
    Stepper before(model, initial_state(scene, model));
    for (int n = 0; n < from; ++n) (void)before.step();
    std::vector<Run> runs;
    for (const Row& row : kRows) {
        Run& run = runs.emplace_back();
        run.row = &row;
        run.model = model;
        row.without(run.model, run.savings);
        run.ms.assign(static_cast<std::size_t>(steps), std::numeric_limits<double>::infinity());
    }
    measure(before.state(), steps, repetitions, runs);
    std::puts("row,ms,same");
    for (const Run& run : runs) {
        double sum = 0;
        for (const double ms : run.ms) sum += ms;
        std::printf("\"%s\",%.6f,%d\n", run.row->name, sum / steps, run.hash == runs.front().hash);
    }
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    std::string scene;
    int from = 0, steps = 40, repetitions = 3;
    CLI::App app("What each saving of flotilla plan is worth in a scene");
    app.add_option("scene", scene, "Scene file")->required();
    app.add_option("--from", from, "Steps before")->check(CLI::NonNegativeNumber);
    app.add_option("--steps", steps, "Steps of each run")->check(CLI::PositiveNumber);
    app.add_option("--repetitions", repetitions, "Runs; of a step's times the least counts")
        ->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    try {
        return run(scene, from, steps, repetitions);
    } catch (const std::exception& error) {
        std::cerr << "flotilla_plan_savings: " << error.what() << '\n';
        return 2;
    }
}
