// SPDX-License-Identifier: MIT
// flotilla_edit_costs SCENE: what an edit of a World costs, beside a step. The World first makes the given number of
// steps; then, again and again, it is edited, makes a step, and is put back. Medians of CPU time go to stdout, one line
// of CSV for each kind of edit: that of the edit itself, and by how much the step after it is longer than one without.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include <flotilla/scene_file.hpp>
#include <flotilla/world.hpp>

namespace {

using namespace flotilla;

double processor_us() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

struct Row {
    const char* name;
    std::function<void(World&)> edit;
};

} // namespace

int main(int argc, char** argv) {
    CLI::App app{"What an edit of a World costs"};
    std::string scene_file;
    int steps = 100, repetitions = 30;
    app.add_option("scene", scene_file, "scene")->required();
    app.add_option("--steps", steps, "steps before");
    app.add_option("--repetitions", repetitions, "of each edit");
    CLI11_PARSE(app, argc, argv);

    const SceneDescription scene = read_scene(scene_file);
    World world(scene, scene_file, {1});
    for (int i = 0; i < steps; ++i) (void)world.step();
    const auto movable = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                      [](const BodyDescription& b) { return b.type == BodyType::dynamic; });
    if (movable == scene.bodies.end()) return 2;
    const BodyId body = world.id(static_cast<std::size_t>(movable - scene.bodies.begin()));
    BodyDescription added = *movable;
    added.name = "added";
    added.position.z += 200; // above all others
    std::vector<Row> rows{
        {"none", [](World&) {}},
        {"add", [&](World& w) { w.add_body(added); }},
        {"remove", [&](World& w) { w.remove_body(body); }},
        {"pose", [&](World& w) { w.set_pose(body, added.position, added.rotation); }},
        {"impulse",
         [&](World& w) {
             w.apply_impulse(body, {0, 0, 1}, w.body(0).position);
         }},
        {"force",
         [&](World& w) {
             w.apply_torque(body, {0, 0, 1});
         }},
        {"gravity",
         [](World& w) {
             w.set_gravity({0, 0, -9.7});
         }},
    };
    std::vector<std::vector<double>> edit(rows.size()), step(rows.size());
    const World start = world.clone({1});
    for (int k = 0; k < repetitions; ++k)
        for (std::size_t r = 0; r < rows.size(); ++r) {
            World w = start.clone({1});
            (void)w.step(); // what a new solver knows only after a step is known
            const double before = processor_us();
            rows[r].edit(w);
            const double between = processor_us();
            (void)w.step();
            edit[r].push_back(between - before);
            step[r].push_back(processor_us() - between);
        }
    std::cout << "bodies," << world.num_bodies() << "\nedit,edit_us,step_after_us,longer_us\n";
    const double plain = median(step[0]);
    for (std::size_t r = 0; r < rows.size(); ++r)
        std::printf("%s,%.1f,%.1f,%.1f\n", rows[r].name, median(edit[r]), median(step[r]), median(step[r]) - plain);
    return 0;
}
