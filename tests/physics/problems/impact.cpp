// SPDX-License-Identifier: MIT
#include "physics/problems/impact.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "scene/scene.hpp"

namespace flotilla::physics {
namespace {

const Vec3 kThrownFrom{1, 2, 3}, kThrownWith{4, -3, 10};

} // namespace

SceneDescription projectile(const Start& start) {
    SceneDescription scene = make_scene_with(start.settings);
    const auto box = add_solid(scene, make_box(1, 0.7, 0.4), 500);
    auto& body = add_body(scene, box, BodyType::dynamic, kThrownFrom);
    body.velocity = kThrownWith;
    body.angular_velocity = {1, 5, -2};
    return scene;
}

double off_parabola(const History& history) {
    double worst = 0;
    for (const Instant& i : history.instants()) {
        const Vec3 due = kThrownFrom + i.time * kThrownWith - Vec3{0, 0, 0.5 * kGravity * i.time * i.time};
        worst = std::max(worst, length(i.bodies[0].center_of_mass - due));
    }
    return worst;
}

SceneDescription bouncing(const Start& start, double e) {
    SceneDescription scene = make_scene_with(start.settings);
    add_body(scene, add_shape(scene, scenario::make_octahedron(0.5), 2), BodyType::dynamic, {0.1, 0.23, 0.5 + kDrop}, 0,
             e);
    add_ground(scene, 10, 0, e);
    return scene;
}

double due_end_of_bouncing(double e) { return std::sqrt(2 * kDrop / kGravity) * (1 + e) / (1 - e); }

Bounces bounces(const History& history) {
    Bounces out;
    double peak = 0;
    bool falls = true;
    const double rest = 1.0 / kSizePerRestDistance;
    for (std::size_t k = 1; k < history.instants().size(); ++k) {
        const Instant& i = history.instants()[k];
        const BodyState& s = i.bodies[0];
        const double gap = s.position.z - 0.5;
        if (gap > 2 * rest) out.end_of_bouncing = i.time;
        if (s.velocity.z > 0) {
            falls = false;
            peak = std::max(peak, gap + 0.5 * s.velocity.z * s.velocity.z / kGravity);
        } else if (!falls) {
            out.heights.push_back(peak);
            falls = true, peak = 0;
        }
    }
    return out;
}

SceneDescription flat_crate(const Start& start, double e) {
    SceneDescription scene = make_scene_with(start.settings);
    const auto crate = add_solid(scene, make_box(1, 1, 1), 200);
    add_body(scene, crate, BodyType::dynamic, {0, 0, 0.5 + 1}, 0.3, e).rotation = rotation_from_vector({0, 0, 0.3});
    add_ground(scene, 20, 0.3, e);
    return scene;
}

SceneDescription bar_over_rail(const Start& start, double drop, double aside, double friction, double e) {
    SceneDescription scene = make_scene_with(start.settings);
    TriangleMesh far_ends_first = make_box(0.02, 1, 0.5); // which own the corners, far from the bar
    std::ranges::stable_sort(far_ends_first.triangles, std::greater<>{}, [&](const Triangle& t) {
        double y = 0;
        for (const std::int32_t v : t) y += far_ends_first.vertices[static_cast<std::size_t>(v)].y / 3;
        return std::abs(y);
    });
    const auto bar = add_solid(scene, make_box(1, 0.05, 0.05), 400), rail = add_solid(scene, far_ends_first, 1);
    add_body(scene, bar, BodyType::dynamic, {aside, 0, 0.025 + drop}, friction, e);
    add_body(scene, rail, BodyType::fixed, {0, 0, -0.25}, friction, e);
    return scene;
}

SceneDescription plate_over_block(const Start& start, double drop, double e) {
    SceneDescription scene = make_scene_with(start.settings);
    const auto plate = add_solid(scene, make_box(1, 1, 0.05), 400),
               block = add_solid(scene, make_box(0.3, 0.2, 0.5), 1);
    add_body(scene, plate, BodyType::dynamic, {0, 0, 0.025 + drop}, 0.3, e);
    add_body(scene, block, BodyType::fixed, {0, 0, -0.25}, 0.3, e);
    return scene;
}

SceneDescription flat_boxes(const Start& start, int count, double gap, double e) {
    SceneDescription scene = make_scene_with(start.settings);
    const auto box = add_solid(scene, make_box(0.5, 0.4, 0.2), 1000);
    for (int i = 0; i < count; ++i) add_body(scene, box, BodyType::dynamic, {0, 0, 0.4 + i * (0.2 + gap)}, 0.4, e);
    add_ground(scene, 10, 0.4, e);
    return scene;
}

SceneDescription thrown_box(const Start& start, int i, int cells, double e) {
    SceneDescription scene = make_scene_with(start.settings, {});
    const auto box = add_solid(scene, make_box(0.6, 0.4, 0.2), 1000);
    const double k = i;
    const Vec3 turns[] = {{}, {0, 0, 0.4 * k}, {0.9 * std::fmod(k, 5) - 2, 0.37 * k, 1.3 * std::fmod(k, 7)}};
    BodyDescription& body = add_body(scene, box, BodyType::dynamic, {0.03 * k, -0.02 * k, 0.5}, 0.3, e);
    body.rotation = rotation_from_vector(turns[i % 3]);
    body.velocity = {3 * std::sin(k), 3 * std::cos(1.7 * k), -1.5 - 0.1 * k};
    const auto plate = add_shape(scene, make_plate(10, 10, cells, cells), 1);
    add_body(scene, plate, BodyType::fixed, {0.011, 0.023, 0}, 0.3, e);
    return scene;
}

SceneDescription cradle(const Start& start, double e) {
    SceneDescription scene = make_scene_with(start.settings, {});
    const auto ball = add_solid(scene, make_box(1, 1, 1), 100);
    for (int i = 0; i < kCradleBodies; ++i)
        add_body(scene, ball, BodyType::dynamic, {1.2 * i, 0, 0}, 0, e).velocity = {i == 0 ? kCradleSpeed : 0, 0, 0};
    return scene;
}

double due_cradle_speed(double e) { return std::pow((1 + e) / 2, kCradleBodies - 1) * kCradleSpeed; }

} // namespace flotilla::physics
