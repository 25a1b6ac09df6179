// SPDX-License-Identifier: MIT
#include "physics/problems/standing.hpp"

#include <cmath>
#include <utility>

namespace flotilla::physics {

SceneDescription stack(const Settings& settings, const std::vector<double>& masses, double edge, double gap) {
    SceneDescription scene = make_scene_with(settings);
    double z = 0;
    for (const double mass : masses) {
        const auto box = add_shape(scene, make_box(edge, edge, edge), mass);
        add_body(scene, box, BodyType::dynamic, {0, 0, z + gap + edge / 2}, 0.5, 0);
        z += gap + edge;
    }
    add_ground(scene, 40 * edge, 0.5, 0);
    return scene;
}

SceneDescription resting_stack(const Start& start, const std::vector<double>& masses, double edge) {
    return stack(start.settings, masses, edge, start.gap(make_box(edge, edge, edge)));
}

SceneDescription arch(const Start& start, int stones, double thickness, double friction) {
    constexpr double kWidth = 3;
    SceneDescription scene = make_scene_with(start.settings);
    scene.settings.rest_distance = kArchGap;
    const double inner = kArchRadius * (1 - thickness / 2), outer = kArchRadius * (1 + thickness / 2);
    const double angle = kPi / stones, gap = start.gap(kArchGap);
    // In its own frame a stone's middle is on the x axis; its faces to the neighbours are half a gap behind the joints.
    const auto corner = [&](double r, double side, double y) {
        const SinCos s = sin_cos(angle / 2);
        return Vec3{r * s.cos, y, side * r * s.sin} + (0.5 * side * gap) * Vec3{s.sin, 0, -s.cos};
    };
    const double y = kWidth / 2;
    const TriangleMesh mesh =
        make_hexahedron({corner(inner, -1, -y), corner(outer, -1, -y), corner(outer, -1, y), corner(inner, -1, y),
                         corner(inner, 1, -y), corner(outer, 1, -y), corner(outer, 1, y), corner(inner, 1, y)});
    const auto stone = add_solid(scene, mesh, 2000);
    for (int i = 0; i < stones; ++i)
        add_body(scene, stone, BodyType::dynamic, {0, 0, 0.5 * gap}, friction, 0).rotation =
            rotation_from_vector({0, -(i + 0.5) * angle, 0});
    add_ground(scene, 60, friction, 0);
    return scene;
}

SceneDescription leaning_cards(const Start& start, double share) {
    constexpr double kAngle = 25 * kDegree, kLength = 1, kWidth = 0.7, kThick = 0.01;
    SceneDescription scene = make_scene_with(start.settings);
    scene.settings.rest_distance = kCardGap;
    const double gap = start.gap(kCardGap), foot = kThick / std::cos(kAngle), run_out = kLength * std::sin(kAngle),
                 high = kLength * std::cos(kAngle), y = kWidth / 2;
    // The right card, in the world's frame: from its foot at x = run_out up to x = 0.
    const double drop = foot / std::tan(kAngle);
    const auto at = [&](double x, double side, double z) { return Vec3{x, side * y, z}; };
    const TriangleMesh right =
        make_hexahedron({at(run_out, -1, 0), at(run_out + foot, -1, 0), at(run_out + foot, 1, 0), at(run_out, 1, 0),
                         at(0, -1, high), at(0, -1, high + drop), at(0, 1, high + drop), at(0, 1, high)});
    TriangleMesh left = right;
    for (Vec3& v : left.vertices) v.x = -v.x;
    for (Triangle& t : left.triangles) std::swap(t[1], t[2]);
    const double friction = share * std::tan(kAngle) / 2;
    add_body(scene, add_solid(scene, right, 700), BodyType::dynamic, {gap / 2, 0, gap}, friction, 0);
    add_body(scene, add_solid(scene, left, 700), BodyType::dynamic, {-gap / 2, 0, gap}, friction, 0);
    add_ground(scene, 20, friction, 0);
    return scene;
}

double house_gap() { return rest_gap(make_plate(kCardLength, kCardWidth)); }

SceneDescription card_house(const Start& start, int levels, double friction) {
    constexpr double kLength = kCardLength, kWidth = kCardWidth, kAngle = 20 * kDegree;
    SceneDescription scene = make_scene_with(start.settings);
    const TriangleMesh card = make_plate(kLength, kWidth);
    const double gap = house_gap(), reach = kLength * std::sin(kAngle), high = kLength * std::cos(kAngle);
    // Tops of a pair are one gap apart; floors end above it, each over the card of its own side, and cover both tops at
    // the ends of a level.
    const double pitch = 2 * reach + 6 * gap, floor = pitch - 0.5 * gap, level_height = high + 2 * gap;
    const auto leaning = add_shape(scene, card, 1.8e-3),
               level_card = add_shape(scene, make_plate(floor, kWidth), 1.8e-3 * floor / kLength);
    for (int level = 0; level < levels; ++level) {
        const int pairs = levels - level;
        const double z = gap + level * level_height;
        for (int i = 0; i < pairs; ++i) {
            const double x = (i - 0.5 * (pairs - 1)) * pitch;
            for (const double side : {-1.0, 1.0})
                add_body(scene, leaning, BodyType::dynamic, {x + side * (gap / 2 + reach / 2), 0, z + high / 2},
                         friction, 0)
                    .rotation = rotation_from_vector({0, side * (kPi / 2 - kAngle), 0});
            if (i + 1 < pairs)
                add_body(scene, level_card, BodyType::dynamic, {x + pitch / 2, 0, z + high + gap}, friction, 0);
        }
    }
    add_ground(scene, 2, friction, 0);
    return scene;
}

SceneDescription pinched_block(const Start& start, double block_share, double plane_share) {
    constexpr double kSlope = 60 * kDegree, kRadius = 1, kSide = 1, kRest = 2e-4;
    const double sine = std::sin(kSlope), cosine = std::cos(kSlope);
    const double block_friction = block_share / (2 * sine / cosine + (1 + sine) / cosine);
    const double plane_friction = plane_share * cosine / (3 + sine);
    SceneDescription scene = make_scene_with(start.settings);
    scene.settings.rest_distance = kRest;
    const auto block = add_shape(scene, make_box(kSide, kSide, kSide), 100);
    const auto cylinder = add_shape(scene, make_tube(kRadius, kSide, 720), 100);
    const auto plane = add_shape(scene, make_plate(8, 8));
    const double gap = start.gap(kRest);
    // A pair's friction is the geometric mean; the cylinders have 1.
    add_body(scene, block, BodyType::dynamic, {}, block_friction * block_friction, 0);
    for (const double side : {-1.0, 1.0}) {
        const Vec3 center{side * (kSide / 2 + gap + kRadius), 0, 0}, up{-side * sine, 0, cosine};
        add_body(scene, cylinder, BodyType::dynamic, center, 1, 0).rotation = rotation_from_vector({kPi / 2, 0, 0});
        add_body(scene, plane, BodyType::fixed, center - (kRadius + gap) * up, plane_friction * plane_friction, 0)
            .rotation = rotation_from_vector({0, -side * kSlope, 0});
    }
    return scene;
}

double sunk(const History& history) { return -history.last(0).center_of_mass.z; }

} // namespace flotilla::physics
