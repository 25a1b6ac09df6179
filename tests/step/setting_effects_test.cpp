// SPDX-License-Identifier: MIT
// No setting is dead: each changes what happens in a scene made for it. The walk goes over the table of settings, so
// that one without a scene fails as well.
#include <algorithm>
#include <exception>
#include <functional>
#include <map>
#include <sstream>

#include <flotilla/scene_file.hpp>

#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

/// A block of edge 1 that comes down on a plate and slides. Friction and restitution are the defaults, so that a scene
/// file has none.
SceneDescription sliding_block() {
    SceneDescription scene = empty_scene();
    const auto plate = add_shape(scene, make_plate(20, 20));
    add_body(scene, plate, BodyType::fixed, {});
    BodyDescription& block = add_body(scene, add_shape(scene, make_box(1, 1, 1), 10), BodyType::dynamic, {0, 0, 0.6});
    block.velocity = {2, 1, -3};
    return scene;
}

SceneDescription with(SceneDescription scene, const std::function<void(Settings&)>& change) {
    change(scene.settings);
    return scene;
}

/// Heavier ones on lighter ones.
SceneDescription tower() {
    SceneDescription scene = empty_scene();
    add_body(scene, add_shape(scene, make_plate(20, 20)), BodyType::fixed, {}, 0.5);
    double mass = 1;
    for (int i = 0; i < 8; ++i, mass *= 3)
        add_body(scene, add_shape(scene, make_box(1, 1, 0.5), mass), BodyType::dynamic, {0, 0, 0.26 + 0.51 * i}, 0.5);
    return scene;
}
SceneDescription swept_tower() {
    return with(tower(), [](Settings& s) { s.contact_solver = ContactSolver::pgs, s.static_iterations = 10; });
}

/// A stack that a ball runs into.
SceneDescription hit_stack() {
    SceneDescription scene = make_scene("stack", 6);
    scene.settings.sleeping = false;
    const auto ball = add_shape(scene, make_sphere(0.6, 1), 800);
    add_body(scene, ball, BodyType::dynamic, {-3, 0.1, 2.2}).velocity = {25, 0, 0};
    return scene;
}
SceneDescription left_to_stage_5() {
    return with(hit_stack(), [](Settings& s) { s.collision_iterations = 0; });
}
SceneDescription left_to_the_failsafe() {
    return with(hit_stack(), [](Settings& s) { s.collision_iterations = s.dynamic_iterations = 0; });
}

/// A plate that falls edge first on an edge in its own plane, which the cubic does not see.
SceneDescription edge_on_edge() {
    SceneDescription scene = empty_scene();
    const TriangleMesh plate{{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
    const std::int32_t falling = add_shape(scene, plate, 5), ground = add_shape(scene, plate);
    add_body(scene, falling, BodyType::dynamic, {0.3, 0, 2.5}).velocity = {0, 0, -120};
    add_body(scene, ground, BodyType::fixed, {});
    return scene;
}

SceneDescription overlapping_blocks() {
    SceneDescription scene = empty_scene();
    const auto block = add_shape(scene, make_box(1, 1, 1), 10);
    add_body(scene, block, BodyType::dynamic, {});
    add_body(scene, block, BodyType::dynamic, {0.9, 0.1, 0.2});
    return scene;
}

struct Effect {
    const char* value; ///< in place of the scene's
    std::function<SceneDescription()> scene;
    int steps;
};

/// By key.
const std::map<std::string_view, Effect>& effects() {
    const auto block = sliding_block;
    const auto random_block = [] { return with(sliding_block(), [](Settings& s) { s.tangents = Tangents::random; }); };
    const auto library = [](const char* name) { return [name] { return make_scene(name); }; };
    static const std::map<std::string_view, Effect> all{
        {"time_step", {"0.01", block, 5}},
        {"substeps", {"3", block, 5}},
        {"friction", {"0.6", block, 10}},
        {"restitution", {"0.9", block, 10}},
        {"seed", {"7", random_block, 20}},
        {"rest_distance", {"0.02", block, 20}},
        {"proximity_distance", {"0.1", block, 20}},
        {"separation", {"0.002", edge_on_edge, 5}},
        {"proximity_angle", {"60", library("triangles-on-pegs"), 40}},
        {"approach_threshold", {"0", block, 20}},
        {"collisions", {"accumulated", hit_stack, 10}},
        {"collision_iterations", {"1", hit_stack, 10}},
        {"collision_pair_iterations", {"1", hit_stack, 10}},
        {"dynamic_iterations", {"0", left_to_stage_5, 10}},
        {"dynamic_pair_iterations", {"0", left_to_stage_5, 10}},
        {"static_iterations", {"1", swept_tower, 10}},
        {"static_tolerance", {"0.5", tower, 10}},
        {"tolerance_share", {"1000", tower, 10}},
        {"contact_reuse", {"0", library("falling-boats"), 60}},
        {"warm_start", {"false", swept_tower, 10}},
        {"shock_propagation", {"false", swept_tower, 10}},
        {"sleeping", {"false", library("stack"), 40}},
        {"trajectory", {"rigid", library("turning-strip"), 20}},
        {"ccd", {"cubic", edge_on_edge, 5}},
        {"velocity_update", {"end", block, 10}},
        {"contact_solver", {"pgs", tower, 10}},
        {"tangents", {"random", block, 20}},
        {"rigidification", {"rigid", left_to_the_failsafe, 10}},
        {"unsatisfiable_script", {"error", library("closing-walls"), 35}},
        {"initial_overlap", {"separate", overlapping_blocks, 1}},
    };
    return all;
}

/// All of a run that does not depend on the clock, with what ends it.
std::vector<std::string> history(const SceneDescription& scene, int steps) {
    std::vector<std::string> out;
    try {
        World world(scene);
        for (int n = 0; n < steps; ++n) {
            const StepReport r = world.step();
            std::string step;
            for (const auto count : {r.pairs, r.collisions, r.contacts, r.iterations, r.merges, r.rung_changes, r.held,
                                     r.sleeping, static_cast<std::int64_t>(r.warnings)})
                step += std::to_string(count) + ' ';
            out.push_back(step + std::to_string(r.state_hash));
        }
    } catch (const std::exception& e) {
        out.emplace_back(e.what());
    }
    return out;
}

/// Why a setting is dead; empty where it is not.
std::string complaint(const SettingInfo& setting) {
    const auto found = effects().find(setting.key);
    if (found == effects().end()) return "no scene shows what it does";
    const auto& [value, make, steps] = found->second;
    std::ostringstream file;
    write_scene(file, make());
    const auto run = [&](const SceneFileOptions& options) {
        return history(parse_scene(file.str(), "scene", ".", options), steps);
    };
    return run({}) == run({.overrides = {{std::string(setting.key), value}}}) ? "changes nothing" : "";
}

TEST(SettingEffects, EverySettingChangesSomething) {
    for (const SettingInfo& setting : list_settings()) {
        EXPECT_EQ(complaint(setting), "") << setting.key;
    }
    EXPECT_EQ(effects().size(), list_settings().size()) << "a scene for a setting that is not there";
}

TEST(SettingEffects, ADeadSettingIsFound) {
    const Effect& seed = effects().at("seed"); // does nothing where friction is a cone
    SceneDescription scene = seed.scene();
    scene.settings.tangents = Tangents::cone;
    const auto before = history(scene, seed.steps);
    scene.settings.seed = 7;
    EXPECT_EQ(history(scene, seed.steps), before);
    SettingInfo unknown;
    unknown.key = "planted";
    EXPECT_EQ(complaint(unknown), "no scene shows what it does");
}

} // namespace
} // namespace flotilla::scenario
