// SPDX-License-Identifier: MIT
// flotilla_ablation: what every constant of static contact is worth (src/static_contact/contact_tuning.hpp). A scene
// runs with all of them as they are and once for every row of the table, with one rule left out or one constant
// changed. All runs go on side by side, a step of each in turn, several times; of a step's times the least counts. One
// line of CSV per row and step goes to stdout.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "base/floating_point.hpp"
#include "state/build_model.hpp"
#include "step/stepper.hpp"

namespace {

using namespace flotilla;

struct Row {
    const char* name;
    void (*change)(ContactTuning&);
};

constexpr double kNever = std::numeric_limits<double>::infinity();

/// The names that contact_tuning.hpp gives; `as is` twice shows what is noise.
constexpr Row kRows[] = {
    {"as is", [](ContactTuning&) {}},
    {"as is, again", [](ContactTuning&) {}},
    {"momentum: 0", [](ContactTuning& t) { t.most_momentum = 0; }},
    {"momentum: 0.8", [](ContactTuning& t) { t.most_momentum = 0.8; }},
    {"momentum: 0.9", [](ContactTuning& t) { t.most_momentum = 0.9; }},
    {"momentum: 0.97", [](ContactTuning& t) { t.most_momentum = 0.97; }},
    {"visits: 1", [](ContactTuning& t) { t.most_visits = 1; }},
    {"visits: 1, momentum: 0.9", [](ContactTuning& t) { t.most_visits = 1, t.most_momentum = 0.9; }},
    {"visits: 4", [](ContactTuning& t) { t.most_visits = 4; }},
    {"visits: of half of the worst", [](ContactTuning& t) { t.repeat_share = 0.5; }},
    {"rise: none", [](ContactTuning& t) { t.most_rise = kNever; }},
    {"looks: 5", [](ContactTuning& t) { t.look_every = 5; }},
    {"looks: 20", [](ContactTuning& t) { t.look_every = 20; }},
    {"peeks: none", [](ContactTuning& t) { t.peek = 0; }},
    {"patience: none", [](ContactTuning& t) { t.patience = 1 << 20; }},
    {"patience: 100", [](ContactTuning& t) { t.patience = 100; }},
    {"patience: 25", [](ContactTuning& t) { t.patience = 25, t.patience_share = 40; }},
    {"patience at rest: as in motion", [](ContactTuning& t) { t.patient_at_rest = false; }},
    {"jams: none", [](ContactTuning& t) { t.looks_at_jam = 0; }},
    {"aim: at the tolerance", [](ContactTuning& t) { t.aim_at_rest = t.aim_in_motion = 1; }},
    {"aim: an eighth", [](ContactTuning& t) { t.aim_at_rest = 0.125; }},
    {"rest: 1.5", [](ContactTuning& t) { t.rest_speed = 1.5; }},
    {"rest: 4", [](ContactTuning& t) { t.rest_speed = 4; }},
    {"parked: none", [](ContactTuning& t) { t.parked_margin = kNever; }},
    {"parked: 50", [](ContactTuning& t) { t.parked_margin = 50; }},
    {"parts: none", [](ContactTuning& t) { t.part_divisor = 0; }},
    {"settling: none", [](ContactTuning& t) { t.settle_above = 0; }},
    {"part sweeps: 50", [](ContactTuning& t) { t.part_sweeps = 50; }},
    {"packed parts: none", [](ContactTuning& t) { t.packed_divisor = 0; }},
    {"packed sweeps: 40", [](ContactTuning& t) { t.packed_sweeps = 40; }},
    {"to and fro: none", [](ContactTuning& t) { t.to_and_fro = false; }},
    {"level patience: none", [](ContactTuning& t) { t.level_patience = 1 << 20; }},
    {"exact: after 10", [](ContactTuning& t) { t.sweeps_before_exact = 10, t.sweeps_of_many = 30; }},
    {"few in motion: 20", [](ContactTuning& t) { t.sweeps_of_few_in_motion = 20; }},
    {"band: none", [](ContactTuning& t) { t.most_of_rest = 0; }},
    {"load: none", [](ContactTuning& t) { t.of_load = 0; }},
    {"squeezed: none", [](ContactTuning& t) { t.steps_in_vain = 0; }},
    {"squeezed: after 2", [](ContactTuning& t) { t.steps_in_vain = 2; }},
};

struct Arguments {
    std::string scene;
    std::vector<std::string> only;
    int steps = 200, from = 0, repetitions = 3, together = 0;
    bool list = false;
};

struct Measured {
    double ms = kNever;
    std::int64_t visits = 0;
    StepReport report;
};

struct Variant {
    const Row* row;
    std::unique_ptr<Stepper> stepper;
    std::vector<Measured> steps;
};

std::vector<Variant> variants_of(const Arguments& arguments) {
    std::vector<Variant> out;
    for (const Row& row : kRows) {
        const auto asked = [&](const std::string& name) { return std::string(row.name).rfind(name, 0) == 0; };
        if (arguments.only.empty() || std::any_of(arguments.only.begin(), arguments.only.end(), asked))
            out.push_back({&row, nullptr, std::vector<Measured>(static_cast<std::size_t>(arguments.steps))});
    }
    return out;
}

/// The state from which the rows part.
State start_of(const Model& model, const State& first, int from) {
    Stepper stepper(model, first);
    for (int k = 0; k < from; ++k) (void)stepper.step();
    return stepper.state();
}

void begin(const Model& model, const State& state, std::vector<Variant>& variants) {
    for (Variant& v : variants) {
        StepperOptions options;
        v.row->change(options.tuning);
        v.stepper = std::make_unique<Stepper>(model, state, options);
    }
}

void measure(const Arguments& arguments, const Model& model, const State& start, std::vector<Variant>& variants) {
    for (int repetition = 0; repetition < arguments.repetitions; ++repetition) {
        begin(model, start, variants);
        for (int k = 0; k < arguments.steps; ++k) {
            if (k > 0 && arguments.together > 0 && k % arguments.together == 0)
                begin(model, State(variants.front().stepper->state()), variants);
            for (std::size_t i = 0; i < variants.size(); ++i) { // none is always the first, with cold caches
                Variant& v = variants[(i + static_cast<std::size_t>(k)) % variants.size()];
                Measured& m = v.steps[static_cast<std::size_t>(k)];
                m.report = v.stepper->step();
                m.visits = v.stepper->contact_visits();
                m.ms = std::min(m.ms, m.report.ms(Phase::static_response));
            }
        }
        std::cerr << arguments.scene << ": " << repetition + 1 << " of " << arguments.repetitions << '\n';
    }
}

void write(const std::vector<Variant>& variants) {
    std::puts("row,step,ms,visits,sweeps,residual,unsolved,kinetic_energy,contacts,energy_removed");
    for (const Variant& v : variants)
        for (const auto& [ms, visits, r] : v.steps)
            std::printf("\"%s\",%lld,%.6f,%lld,%lld,%.6g,%d,%.9g,%lld,%.6g\n", v.row->name,
                        static_cast<long long>(r.step), ms, static_cast<long long>(visits),
                        static_cast<long long>(r.iterations), r.residual, (r.warnings & kStaticLimit) != 0,
                        r.kinetic_energy, static_cast<long long>(r.contacts), r.energy_removed);
}

int run(const Arguments& arguments) {
    if (arguments.list) {
        for (const Row& row : kRows) std::puts(row.name);
        return 0;
    }
    const DefaultFloatingPoint environment;
    SceneDescription description = read_scene(arguments.scene);
    description.settings.sleeping = false;
    const Scene scene = build_scene(std::move(description), arguments.scene);
    const Model model = make_model(scene);
    std::vector<Variant> variants = variants_of(arguments);
    measure(arguments, model, start_of(model, initial_state(scene, model), arguments.from), variants);
    write(variants);
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    Arguments a;
    CLI::App app("What every constant of static contact is worth");
    app.add_option("scene", a.scene, "Scene file");
    app.add_option("--steps", a.steps, "Steps of each run")->check(CLI::PositiveNumber)->capture_default_str();
    app.add_option("--from", a.from, "Steps before, with all constants as they are")->check(CLI::NonNegativeNumber);
    app.add_option("--repetitions", a.repetitions, "Runs; of a step's times the least counts")
        ->check(CLI::PositiveNumber);
    app.add_option("--together", a.together,
                   "Steps after which all rows go on from the state of the first one: what is measured is then what a "
                   "rule does, and not "
                   "what became of another pile; 0: never")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--only", a.only, "Rows whose names begin so");
    app.add_flag("--list", a.list, "Print the rows");
    CLI11_PARSE(app, argc, argv);
    try {
        return run(a);
    } catch (const std::exception& error) {
        std::cerr << "flotilla_ablation: " << error.what() << '\n';
        return 2;
    }
}
