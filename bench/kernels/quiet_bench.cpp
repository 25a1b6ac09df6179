// SPDX-License-Identifier: MIT
// What a step costs in which little happens: plates of two triangles that lie on a floor, asleep or awake.
// Arguments: plates, and whether one more body flies by far above them.
#include <string>

#include <benchmark/benchmark.h>

#include <flotilla/scene.hpp>
#include <flotilla/world.hpp>

namespace flotilla {
namespace {

constexpr int kStepsToRest = 60;
constexpr double kSpacing = 1.5; // m

ShapeDescription square(const std::string& name, double half) {
    ShapeDescription s;
    s.name = name;
    s.vertices = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
    s.triangles = {{0, 1, 2}, {0, 2, 3}};
    return s;
}

SceneDescription plates_on_floor(int plates, bool flyer) {
    SceneDescription scene;
    int side = 1;
    while (side * side < plates) ++side;
    ShapeDescription plate = square("plate", 0.5);
    plate.mass_kind = MassKind::mass;
    plate.mass_value = 1;
    scene.shapes = {square("floor", kSpacing * side), plate};
    const auto add = [&](const std::string& name, int shape, const Vec3& position) -> BodyDescription& {
        BodyDescription& body = scene.bodies.emplace_back();
        body.name = name;
        body.shape = shape;
        body.position = position;
        body.friction = 0.5;
        body.restitution = 0;
        return body;
    };
    add("floor", 0, {}).type = BodyType::fixed;
    const auto place = [&](int i) { return kSpacing * (i - 0.5 * (side - 1)); };
    for (int i = 0; i < plates; ++i) add("plate " + std::to_string(i), 1, {place(i % side), place(i / side), 0.01});
    if (flyer) add("flyer", 1, {0, 0, 1e5}).angular_velocity = {1, 0, 0};
    return scene;
}

void step(benchmark::State& state, bool sleeping) {
    SceneDescription scene = plates_on_floor(static_cast<int>(state.range(0)), state.range(1) != 0);
    scene.settings.sleeping = sleeping;
    World world(scene, "plates", {.threads = 1});
    StepReport last;
    for (int k = 0; k < kStepsToRest; ++k) last = world.step();
    for (auto _ : state) last = world.step();
    state.counters["asleep"] = static_cast<double>(last.sleeping);
    state.counters["contacts"] = static_cast<double>(last.contacts + last.sleeping_contacts);
}

void asleep(benchmark::State& state) { step(state, true); }
void awake(benchmark::State& state) { step(state, false); }

BENCHMARK(asleep)
    ->ArgNames({"plates", "flyer"})
    ->ArgsProduct({{10, 100, 1000, 10000}, {0, 1}})
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(awake)->ArgNames({"plates", "flyer"})->ArgsProduct({{1, 10, 100}, {0}})->Unit(benchmark::kMicrosecond);

} // namespace
} // namespace flotilla
