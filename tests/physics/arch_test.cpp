// SPDX-License-Identifier: MIT
// What stands by form and friction: arches, leaning cards, card houses, the pinched block.
#include "physics/physics.hpp"

namespace flotilla::physics {
namespace {

/// The position of each dynamic body at the start, to tell how far one got.
bool stands(const Motion& motion, double most) { return motion.farthest() < most; }

// A semicircle of equal wedges of mean radius R and thickness t stands from a least t / R on, by linear programming over all
// statically possible forces: 0.0962 for 7 stones, 0.1049 for 11, 0.1070 for 25. With t / R = 0.15 it needs friction of 0.352.
// The gaps between stones are 2e-5 of the radius, so that their closing does not change the form.
void arch(const Run& run, int stones, double thickness, double friction, bool due) {
    constexpr double kRadius = 10, kWidth = 3, kRest = 2e-4;
    SceneDescription scene = make_scene_with(run.settings());
    scene.settings.rest_distance = kRest;
    const double inner = kRadius * (1 - thickness / 2), outer = kRadius * (1 + thickness / 2);
    const double angle = kPi / stones, gap = 1.0001 * kRest;
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
    Motion motion(scene);
    // From 5 % inside the safe range an arch that falls takes about 3 s = 3 sqrt(R / g) to move by a centimetre.
    motion.run(8, [](const StepReport&) {});
    motion.print("%d stones, t / R %.4f, friction %.3f: moved by %.3g m", stones, thickness, friction,
                 motion.farthest());
    EXPECT_EQ(stands(motion, 0.02), due);
    if (due) {
        expect_rest(motion);
        expect_weight_on(motion, static_cast<std::size_t>(stones));
    }
    expect_no_rise(motion);
}

// Two cards of length l lean on each other at the angle phi from vertical: they stand from friction tan(phi) / 2 on. The cards have
// a hundredth of their length in thickness, feet cut level and tops cut upright, which changes that by as much.
void leaning_cards(const Run& run, double share) {
    constexpr double kAngle = 25 * kDegree, kLength = 1, kWidth = 0.7, kThick = 0.01;
    SceneDescription scene = make_scene_with(run.settings());
    scene.settings.rest_distance = 1e-4;
    const double gap = 1.0001e-4, foot = kThick / std::cos(kAngle), run_out = kLength * std::sin(kAngle),
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
    Motion motion(scene);
    motion.run(4);
    motion.print("%.2f of the least friction: moved by %.3g m", share, motion.farthest());
    if (share > 1) {
        EXPECT_LT(motion.farthest(), 1e-3);
        expect_rest(motion);
    } else {
        EXPECT_GT(motion.farthest(), 0.05);
    }
    expect_no_rise(motion);
}

/// `levels` of leaning pairs, a floor card between each two pairs' tops: 15 cards for 3 levels, 26 for 4. Cards have no thickness.
SceneDescription card_house(const Settings& settings, int levels, double friction) {
    constexpr double kLength = 0.09, kWidth = 0.06, kAngle = 20 * kDegree;
    SceneDescription scene = make_scene_with(settings);
    const TriangleMesh card = make_plate(kLength, kWidth);
    const double gap = rest_gap(card), reach = kLength * std::sin(kAngle), high = kLength * std::cos(kAngle);
    // Tops of a pair are one gap apart; floors end above it, each over the card of its own side, and cover both tops at the ends of
    // a level.
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

void card_house_stands(const Run& run, int levels, double friction) {
    Motion motion(card_house(run.settings(), levels, friction));
    motion.run(5);
    motion.print("%zu cards, moved by %.3g m", motion.world().size() - 1, motion.farthest());
    EXPECT_LT(motion.farthest(), 0.005);
    expect_rest(motion);
    expect_weight_on(motion, motion.world().size() - 1);
    expect_no_rise(motion);
}

// The block between two cylinders between two planes: the least coefficients from the balance of forces and torques.
void pinched_block(const Run& run, double block_share, double plane_share) {
    constexpr double kSlope = 60 * kDegree, kRadius = 1, kSide = 1, kRest = 2e-4;
    const double sine = std::sin(kSlope), cosine = std::cos(kSlope);
    const double block_friction = block_share / (2 * sine / cosine + (1 + sine) / cosine);
    const double plane_friction = plane_share * cosine / (3 + sine);
    SceneDescription scene = make_scene_with(run.settings());
    scene.settings.rest_distance = kRest;
    const auto block = add_shape(scene, make_box(kSide, kSide, kSide), 100);
    const auto cylinder = add_shape(scene, make_tube(kRadius, kSide, 720), 100);
    const auto plane = add_shape(scene, make_plate(8, 8));
    const double gap = 1.0001 * kRest;
    // A pair's friction is the geometric mean; the cylinders have 1.
    add_body(scene, block, BodyType::dynamic, {}, block_friction * block_friction, 0);
    for (const double side : {-1.0, 1.0}) {
        const Vec3 center{side * (kSide / 2 + gap + kRadius), 0, 0}, up{-side * sine, 0, cosine};
        add_body(scene, cylinder, BodyType::dynamic, center, 1, 0).rotation = rotation_from_vector({kPi / 2, 0, 0});
        add_body(scene, plane, BodyType::fixed, center - (kRadius + gap) * up, plane_friction * plane_friction, 0)
            .rotation = rotation_from_vector({0, -side * kSlope, 0});
    }
    Motion motion(scene);
    // Friction holds all three, but they can roll past each other: from that unstable equilibrium they leave as exp(9.4 t / s) of what
    // rounding or tolerance began, and stand 0.5 mm on, on facets: 1e-12 m takes 2.1 s.
    const bool holds = std::min(block_share, plane_share) > 1;
    motion.run(holds ? 5 : 3);
    const double sunk = -motion.body(0).center_of_mass.z;
    motion.print("block %.2f, plane %.2f of the threshold: sunk %.3g m", block_share, plane_share, sunk);
    if (holds) {
        EXPECT_LT(sunk, 1e-3);
        expect_rest(motion);
    } else {
        EXPECT_GT(sunk, 0.1);
    }
    expect_no_rise(motion);
}

[[maybe_unused]] const bool registered = [] {
    const std::vector<Run> once = runs({24});
    struct Least {
        int stones;
        double thickness;
    };
    for (const Least& least : {Least{7, 0.0962}, Least{11, 0.1049}, Least{25, 0.1070}}) {
        const std::string name = "ArchOf" + std::to_string(least.stones);
        const bool fast = least.stones <= 11;
        add_runs("Arch", name + "StonesStandsAt5PercentMore", least.stones == 7 ? runs() : once, fast,
                 [=](const Run& r) { arch(r, least.stones, 1.05 * least.thickness, 1, true); });
        add_runs("Arch", name + "StonesFallsAt5PercentLess", least.stones == 7 ? runs() : once, fast,
                 [=](const Run& r) { arch(r, least.stones, 0.95 * least.thickness, 1, false); });
    }
    add_runs("Arch", "StandsWith5PercentMoreFriction", once, true,
             [](const Run& r) { arch(r, 11, 0.15, 1.05 * 0.352, true); });
    add_runs("Arch", "FallsWith5PercentLessFriction", once, true,
             [](const Run& r) { arch(r, 11, 0.15, 0.95 * 0.352, false); });
    add_runs("Cards", "PairLeansAt5PercentMore", runs(), true, [](const Run& r) { leaning_cards(r, 1.05); });
    add_runs("Cards", "PairSlipsAt5PercentLess", runs(), true, [](const Run& r) { leaning_cards(r, 0.95); });
    for (const int levels : {2, 3, 4})
        for (const int friction : {50, 90})
            add_runs("Cards", "HouseOf" + std::to_string(levels) + "LevelsFriction0_" + std::to_string(friction),
                     runs(), levels <= 3, [=](const Run& r) { card_house_stands(r, levels, 0.01 * friction); });
    add_runs("PinchedBlock", "HoldsAt5PercentMore", once, true, [](const Run& r) { pinched_block(r, 1.05, 1.05); });
    add_runs("PinchedBlock", "SlipsAtTheBlock", once, true, [](const Run& r) { pinched_block(r, 0.95, 2); });
    add_runs("PinchedBlock", "SlipsAtThePlanes", once, true, [](const Run& r) { pinched_block(r, 2, 0.95); });
    return true;
}();

} // namespace
} // namespace flotilla::physics
