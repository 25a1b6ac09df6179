// SPDX-License-Identifier: MIT
// flotilla_random_scenes: many random scenes, each run for some steps under the audit in a process of its own; after
// every step every promise is asked for (extremes/check.hpp), in a share of them the hashes of another run and of
// three threads too. Scenes that break one are named on stdout, and a table at the end; progress goes to stderr.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iostream>
#include <map>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "extremes/apart.hpp"
#include "fuzz/scene_series.hpp"

namespace {

using namespace flotilla;
using extremes::Outcome;
using extremes::Verdict;

struct Arguments {
    std::uint64_t seed = 1, first = 0, scenes = 1000;
    std::int64_t only = -1;
    int steps = 20, repeat_every = 8, seconds = 20, total_seconds = 0;
    std::string write;
};

struct Sum {
    std::map<Verdict, std::int64_t> count;
    std::int64_t steps = 0, repeated = 0;
    double rise = 0, drift = 0;

    void add(const Outcome& outcome, bool again) {
        ++count[outcome.verdict];
        steps += outcome.steps;
        repeated += again ? outcome.steps : 0;
        rise = std::max(rise, outcome.rise);
        drift = std::max(drift, outcome.drift);
    }
};

/// A scene ends after its time; a step of several times it is a fault.
Outcome run(const Arguments& arguments, std::uint64_t index, bool again) {
    const extremes::CheckOptions options{arguments.steps, again, static_cast<double>(arguments.seconds)};
    return extremes::run_apart(
        [&]() -> Outcome {
            try {
                const fuzz::SeriesScene scene = fuzz::series_scene(arguments.seed, index);
                Outcome outcome = extremes::run_scene(scene.scene, options);
                if (!outcome.message.empty()) outcome.message = scene.name + ": " + outcome.message;
                return outcome;
            } catch (const InputError& error) { // no place for a body
                return {Verdict::refused, error.what()};
            }
        },
        4 * arguments.seconds);
}

void write_row(const std::string& kind, Sum& sum) {
    std::cout << "| " << kind;
    for (const Verdict v : {Verdict::pass, Verdict::held, Verdict::refused, Verdict::broken})
        std::cout << " | " << sum.count[v];
    std::cout << " | " << sum.steps << " | " << sum.repeated << " | " << sum.rise << " | " << sum.drift << " |\n";
}

int write_table(std::map<std::string, Sum>& sums) {
    std::cout.precision(3);
    std::cout
        << "| scenes | pass | held | refused | broken | steps | of these also repeated and on 3 threads | worst rise "
           "of energy | worst drift of momentum |\n|---|---|---|---|---|---|---|---|---|\n";
    for (auto& [kind, sum] : sums) write_row(kind, sum);
    return sums["all"].count[Verdict::broken] == 0 ? 0 : 3;
}

int run_all(const Arguments& arguments) {
    std::map<std::string, Sum> sums;
    const std::time_t began = std::time(nullptr);
    std::time_t told = began;
    const std::uint64_t first = arguments.only >= 0 ? static_cast<std::uint64_t>(arguments.only) : arguments.first;
    const std::uint64_t count = arguments.only >= 0 ? 1 : arguments.scenes;
    const auto late = [&] {
        return arguments.total_seconds > 0 && std::time(nullptr) > began + arguments.total_seconds;
    };
    for (std::uint64_t index = first; index < first + count && !late(); ++index) {
        const bool again = arguments.only >= 0 || (index / 8) % static_cast<std::uint64_t>(arguments.repeat_every) == 0;
        const Outcome outcome = run(arguments, index, again);
        sums[fuzz::series_kind(index)].add(outcome, again);
        sums["all"].add(outcome, again);
        if (outcome.verdict == Verdict::broken || arguments.only >= 0)
            std::cout << "seed " << arguments.seed << " scene " << index << " (" << fuzz::series_kind(index)
                      << "): " << outcome.message << std::endl;
        if (std::time(nullptr) < told + 10) continue;
        told = std::time(nullptr);
        std::cerr << "random scenes: " << index - first + 1 << " of " << count << ", " << sums["all"].steps
                  << " steps, " << sums["all"].count[Verdict::broken] << " broken\n";
    }
    return write_table(sums);
}

int write_only(const Arguments& arguments) {
    std::ofstream file(arguments.write);
    write_scene(file, fuzz::series_scene(arguments.seed, static_cast<std::uint64_t>(arguments.only)).scene);
    if (file.flush()) return 0;
    std::cerr << "flotilla_random_scenes: cannot write " << arguments.write << '\n';
    return 5;
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app{"Random scenes under the audit", "flotilla_random_scenes"};
    app.footer("exit code: 0 every promise was kept, 2 usage, 3 one was broken, 5 a file cannot be written");
    Arguments arguments;
    app.add_option("--seed", arguments.seed, "Of the series");
    app.add_option("--first", arguments.first, "Index of the first scene");
    app.add_option("--scenes", arguments.scenes, "How many");
    CLI::Option* only =
        app.add_option("--only", arguments.only, "One scene, by its index")->check(CLI::NonNegativeNumber);
    app.add_option("--write", arguments.write, "Write the scene of --only as JSON instead of running it")->needs(only);
    app.add_option("--steps", arguments.steps, "Of each scene")->check(CLI::PositiveNumber);
    app.add_option("--repeat-every", arguments.repeat_every, "Of so many groups of eight scenes one is run again too")
        ->check(CLI::PositiveNumber);
    app.add_option("--seconds", arguments.seconds,
                   "Processor time after which no step of a scene begins; four times it is a fault")
        ->check(CLI::PositiveNumber);
    app.add_option("--total-seconds", arguments.total_seconds, "Time after which no scene begins (default: never)");
    CLI11_PARSE(app, argc, argv);
    return arguments.write.empty() ? run_all(arguments) : write_only(arguments);
}
