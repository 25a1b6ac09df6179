// SPDX-License-Identifier: MIT
// flotilla_problems: the regular problems of tests/physics, as scenes, run by flotilla, and judged whoever ran them.
// Data goes to stdout as JSON, a line each; see bench/accuracy/run.
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <exception>
#include <filesystem>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "physics/problems/problems.hpp"
#include "run_folder/poses_csv.hpp"
#include "run_folder/run_folder.hpp"
#include "scene/scene.hpp"

namespace {

using namespace flotilla;
using namespace flotilla::physics;
using Json = nlohmann::ordered_json;

double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

const Problem& problem_of(const std::string& name) {
    if (const Problem* found = find_problem(name)) return *found;
    throw InputError("no problem \"" + name + "\"; flotilla_problems list names them");
}

/// A motion that blew up is wrong by more than any number.
double error_of(const Problem& problem, const History& history) {
    const double error = problem.error_of(history);
    return std::isfinite(error) ? error : std::numeric_limits<double>::max();
}

struct Measured {
    bool complete = false;
    double error = 0, cpu = 0; ///< CPU s of the steps
};

/// One run; given up after `limit` CPU s.
Measured run_once(const Problem& problem, const SceneDescription& scene, double limit) {
    World world(scene, problem.name, {1, Executor::serial});
    History history(scene.settings.time_step);
    const auto add_instant = [&] {
        Instant now{world.time(), {}};
        for (std::size_t i = 0; i < world.size(); ++i) now.bodies.push_back(world.body(i));
        history.add(std::move(now));
    };
    add_instant();
    Measured out;
    while (world.time() < problem.time - 0.5 * scene.settings.time_step) {
        if (out.cpu > limit) return out;
        const double start = cpu_seconds();
        (void)world.step();
        out.cpu += cpu_seconds() - start;
        add_instant();
    }
    out.complete = true;
    out.error = error_of(problem, history);
    return out;
}

struct Arguments {
    std::string problem, poses;
    std::vector<std::string> presets{"balanced"};
    std::vector<int> rates{24};
    double limit = 60;
    bool others = false;
};

void list() {
    for (const Problem& p : problems())
        std::cout << Json{{"name", p.name},    {"about", p.about},           {"error", p.error},   {"bound", p.bound},
                          {"seconds", p.time}, {"others_gap", p.others_gap}, {"solids", p.solids}, {"sides", p.sides}}
                  << '\n';
}

void run(const Arguments& arguments) {
    // What is over in less is repeated: the least of several times.
    constexpr double kWorthRepeating = 0.1; // s
    constexpr int kMostRuns = 5;
    const Problem& problem = problem_of(arguments.problem);
    for (const std::string& preset : arguments.presets)
        for (const int rate : arguments.rates) {
            const SceneDescription scene = problem.scene(Start(Run{preset, rate}.settings()));
            Measured best = run_once(problem, scene, arguments.limit);
            double sum = best.cpu;
            for (int k = 1; k < kMostRuns && sum < kWorthRepeating; ++k) {
                const Measured again = run_once(problem, scene, arguments.limit);
                sum += again.cpu;
                best.cpu = std::min(best.cpu, again.cpu);
            }
            Json row{{"problem", problem.name}, {"preset", preset}, {"rate", rate}, {"complete", best.complete}};
            if (best.complete) row["error"] = best.error, row["ms_per_second"] = 1000 * best.cpu / problem.time;
            std::cout << row << std::endl;
            if (!best.complete) break; // larger rates cost more
        }
}

/// The scene that other engines start from.
SceneDescription others_scene(const Problem& problem) {
    return problem.scene(Start(Run{}.settings(), problem.others_gap > 0));
}

void judge(const Arguments& arguments) {
    const Problem& problem = problem_of(arguments.problem);
    const SceneDescription description = others_scene(problem);
    const Scene scene = build_scene(description);
    std::vector<std::string> names;
    for (const BodyDescription& b : description.bodies) names.push_back(b.name);
    io::PosesCsvReader reader(arguments.poses, names);
    io::Frame frame;
    std::vector<Instant> instants;
    while (reader.next(frame)) {
        Instant now{frame.time, {}};
        for (std::size_t i = 0; i < names.size(); ++i) {
            const Vec3& center = scene.shapes[static_cast<std::size_t>(scene.bodies[i].shape)].center;
            now.bodies.push_back({frame.position[i], frame.rotation[i],
                                  frame.position[i] + rotate(frame.rotation[i], center), frame.velocity[i],
                                  frame.angular_velocity[i]});
        }
        instants.push_back(std::move(now));
    }
    if (instants.size() < 2) throw InputError(arguments.poses + ": no motion");
    History history(instants[1].time - instants[0].time);
    for (Instant& i : instants) history.add(std::move(i));
    std::cout << Json{{"problem", problem.name}, {"error", error_of(problem, history)}} << '\n';
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app{"Regular problems: their scenes, runs by flotilla, and errors of any engine's motion",
                 "flotilla_problems"};
    Arguments arguments;
    app.require_subcommand(1);
    app.add_subcommand("list", "A line of JSON for each problem");
    auto* scene = app.add_subcommand("scene", "A problem as a scene file, on stdout");
    scene->add_option("PROBLEM", arguments.problem)->required();
    scene->add_flag("--others", arguments.others, "As engines start from it whose solids touch");
    auto* runs = app.add_subcommand("run", "A problem run with every preset at every rate, a line of JSON each");
    runs->add_option("PROBLEM", arguments.problem)->required();
    runs->add_option("--preset", arguments.presets)->delimiter(',');
    runs->add_option("--rate", arguments.rates, "Steps a second")->delimiter(',');
    runs->add_option("--limit", arguments.limit, "CPU s after which a run is given up, and higher rates with it");
    auto* verdict = app.add_subcommand("judge", "The error of a trajectory in the CSV export format");
    verdict->add_option("PROBLEM", arguments.problem)->required();
    verdict->add_option("POSES", arguments.poses)->required();
    CLI11_PARSE(app, argc, argv);
    try {
        if (app.got_subcommand("list")) list();
        if (*scene) {
            const Problem& problem = problem_of(arguments.problem);
            write_scene(std::cout, arguments.others ? others_scene(problem) : problem.scene(Start(Run{}.settings())));
        }
        if (*runs) run(arguments);
        if (*verdict) judge(arguments);
        return 0;
    } catch (const std::exception& e) {
        std::cerr << "flotilla_problems: " << e.what() << '\n';
        return 2;
    }
}
