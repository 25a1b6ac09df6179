// SPDX-License-Identifier: MIT
// Random edits of a World in every step, and what must hold through all of them.
#pragma once

#include <gtest/gtest.h>

#include "api/audited_world.hpp"
#include "api/random_edits.hpp"
#include "mesh/primitives.hpp"
#include "step/scene_parts.hpp"

namespace flotilla::test {

/// A tub of 6 m, open at the top, and shapes of 1 m without and with an inside.
inline SceneDescription tub() {
    SceneDescription scene;
    scene.shapes.reserve(5);
    scenario::add_shape(scene, make_plate(1, 1), 1);
    scenario::add_shape(scene, make_box(0.8, 0.8, 0.8), 3);
    scenario::add_shape(scene, make_ring(0.5, 0.1, 12, 6), 2);
    scenario::add_shape(scene, scenario::make_octahedron(0.6), 1);
    const std::int32_t wall = scenario::add_shape(scene, make_box(6, 6, 0.2), 100);
    scenario::add_body(scene, wall, BodyType::fixed, {0, 0, -3}).name = "floor";
    for (int k = 0; k < 4; ++k) {
        const double s = k % 2 == 0 ? 3.2 : -3.2, h = std::sqrt(0.5);
        BodyDescription& body =
            scenario::add_body(scene, wall, BodyType::fixed, k < 2 ? Vec3{s, 0, 0.5} : Vec3{0, s, 0.5});
        body.rotation = k < 2 ? Quat{h, 0, h, 0} : Quat{h, h, 0, 0};
    }
    for (int k = 0; k < 12; ++k)
        scenario::add_body(scene, k % 4, BodyType::dynamic,
                           {-2.0 + 1.4 * (k % 4), -1.5 + 1.5 * (k / 4), 1.0 + 0.1 * k});
    scene.settings.sleeping = true;
    return scene;
}

struct EditedRunCounts {
    int made = 0, refused = 0;
    int steps = 0, balanced = 0; ///< of these, those whose energy was bounded: nothing did work in them
};

/// Makes one random edit; whether it was possible.
inline bool edit_once(World& world, RandomEdits& edits, Ignored& ignored, std::vector<Edit>* made,
                      bool* pushed = nullptr) {
    const Edit edit = edits.draw(world);
    if (pushed != nullptr && std::holds_alternative<edits::ApplyForce>(edit.change)) *pushed = true;
    try {
        if (const auto* e = std::get_if<edits::RemoveBody>(&edit.change); e != nullptr && world.contains(e->body)) {
            const std::string name = world.name(e->body);
            world.apply(edit);
            ignored.forget(name);
        } else {
            world.apply(edit);
            ignored.note(world, edit);
        }
        if (made != nullptr) made->push_back({world.steps(), edit.change});
        return true;
    } catch (const InputError&) {
    } catch (const OverlapError&) {
    }
    return false;
}

/// J: m |g| d_rest of all dynamic bodies, which are about 1 m large; nothing where a script may do work.
inline double most_lift(const World& world) {
    static const SceneDescription scene = tub();
    double mass = 0;
    for (std::size_t i = 0; i < world.size(); ++i) {
        const BodyId id{static_cast<std::int32_t>(i), world.generation(i)};
        if (!world.contains(id)) continue;
        const BodyDescription& body = world.description(id);
        const bool driven = body.force != Vec3{} || body.torque != Vec3{};
        if (body.type == BodyType::kinematic || driven) return std::numeric_limits<double>::infinity();
        if (body.type == BodyType::dynamic) mass += scene.shapes[static_cast<std::size_t>(body.shape)].mass_value;
    }
    const Vec3 g = world.gravity();
    return mass * std::sqrt(g.x * g.x + g.y * g.y + g.z * g.z) * 2 / 330;
}

/// So many edits, some in each step, with every step audited.
inline EditedRunCounts run_edited(std::uint64_t seed, int edits_in_all, int edits_in_a_step) {
    AuditedWorld w(tub(), {1});
    RandomEdits edits(seed, 2.4, 4, 24, seed % 2 == 0);
    Ignored ignored;
    w.ignored = [&](const std::string& a, const std::string& b) { return ignored(w.world, a, b); };
    EditedRunCounts counts;
    while (counts.made + counts.refused < edits_in_all) {
        bool pushed = false; // does work
        for (int k = 0; k < edits_in_a_step; ++k)
            ++(edit_once(w.world, edits, ignored, nullptr, &pushed) ? counts.made : counts.refused);
        const double before = w.world.energy(), lift = most_lift(w.world);
        StepReport report;
        const std::string fault = w.step(&report);
        EXPECT_EQ(fault, "") << "seed " << seed << ", step " << report.step;
        EXPECT_NEAR(report.energy, w.world.energy(), 1e-9 * (1 + std::abs(report.energy)));
        ++counts.steps;
        counts.balanced += !pushed && std::isfinite(lift) ? 1 : 0;
        const double most = pushed ? std::numeric_limits<double>::infinity() : before + lift;
        EXPECT_LE(report.energy, most + 1e-9 * (1 + std::abs(before))) << "seed " << seed << ", step " << report.step;
        if (testing::Test::HasFailure()) break;
    }
    return counts;
}

} // namespace flotilla::test
