// SPDX-License-Identifier: MIT
// Heavy bodies that hang from light ones, and swing as if these had no mass.
#include <algorithm>
#include <cmath>

#include "physics/physics.hpp"
#include "physics/problems/tops.hpp"

namespace flotilla::physics {
namespace {

constexpr double kRest = 2e-4; // m, rest distance of all

/// Adds `part`, turned and then moved, to a mesh.
void join(TriangleMesh& mesh, const TriangleMesh& part, const Quat& turn, const Vec3& move) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    for (const Vec3& v : part.vertices) mesh.vertices.push_back(rotate(turn, v) + move);
    for (const Triangle& t : part.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

/// The times at which body `i` passes x = 0, s, and how far it goes to either side between them.
struct Swings {
    std::vector<double> zeros, peaks;
};
Swings swings(Motion& motion, std::size_t i, double time) {
    Swings out;
    double last = motion.body(i).center_of_mass.x, before = 0, peak = 0;
    motion.run(time, [&](const StepReport& r) {
        const double x = motion.body(i).center_of_mass.x;
        if (x * last < 0) {
            if (!out.zeros.empty()) out.peaks.push_back(peak);
            out.zeros.push_back(before + (r.time - before) * last / (last - x));
            peak = 0;
        }
        peak = std::max(peak, std::abs(x));
        last = x, before = r.time;
    });
    return out;
}

// A ball of 5 kg on four links of 0.1 kg, 6 cm wide, let go at 0.2 rad. Links turn to and fro 30 times a second under
// its weight, about three radians a step of 1/60 s. The times are those of preset accurate and of steps of 1/240 s.
void lamp_swings(const Run& run) {
    constexpr double kRing = 0.03, kTube = 0.005, kBall = 0.08, kLean = 0.2, kPitch = 2 * (kRing - kTube) - 2.5 * kRest;
    constexpr int kLinks = 4;
    Settings settings = run.settings();
    settings.rest_distance = kRest;
    SceneDescription scene = make_scene_with(settings);
    const TriangleMesh link = make_ring(kRing, kTube, 32, 8);
    const Quat upright = rotation_from_vector({kPi / 2, 0, 0}),
               across = rotation_from_vector({0, 0, kPi / 2}) * upright;
    TriangleMesh lamp;
    join(lamp, link, across, {});
    join(lamp, make_sphere(kBall, 2), {}, {0, 0, -kRing - kBall});
    const auto fixed = add_shape(scene, link), free = add_solid(scene, link, kSteel), heavy = add_shape(scene, lamp, 5);
    scene.shapes[static_cast<std::size_t>(heavy)].center_of_mass = Vec3{0, 0, -kRing - kBall};
    scene.shapes[static_cast<std::size_t>(heavy)].inertia = 0.4 * 5 * kBall * kBall * Mat3{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const Quat lean = rotation_from_vector({0, -kLean, 0});
    for (int i = 0; i <= kLinks + 1; ++i) {
        const bool last = i == kLinks + 1;
        add_body(scene,
                 i == 0 ? fixed
                 : last ? heavy
                        : free,
                 i == 0 ? BodyType::fixed : BodyType::dynamic, rotate(lean, {0, 0, -i * kPitch}), 0.3, 0)
            .rotation = i == 0 ? upright
                        : last ? lean
                               : lean * (i % 2 == 0 ? upright : across);
    }
    Motion motion(scene);
    const Swings found = swings(motion, kLinks + 1, 3);
    const std::vector<double> due{0.31, 0.87, 1.47, 2.04, 2.63};
    ASSERT_EQ(found.zeros.size(), due.size());
    for (std::size_t i = 0; i < due.size(); ++i) EXPECT_NEAR(found.zeros[i], due[i], 0.03);
    motion.print("passes %.3g %.3g %.3g %.3g %.3g s, goes to %.4f and %.4f m", found.zeros[0], found.zeros[1],
                 found.zeros[2], found.zeros[3], found.zeros[4], found.peaks[0], found.peaks.back());
    EXPECT_GT(found.peaks.front(), 0.058); // 0.061 and 0.066 in turn
    EXPECT_GT(found.peaks.back(), 0.058);
    EXPECT_EQ(motion.outcome().held, 0);
    expect_no_rise(motion);
}

// A seat of 40 kg on two bars of half a kilogramme, whose rings have a millimetre of play on their pins, let go at 0.3
// rad: what a pendulum of 1.04 m does, whose seat keeps swinging on its own pins as well.
void seat_swings(const Run& run) {
    constexpr double kPin = 0.008, kHole = 0.0095, kBar = 0.5, kSeat = 40, kLean = 0.3, kPlay = 0.0013;
    constexpr int kSides = 32;
    const double hole = kHole * std::cos(kPi / kSides);
    Settings settings = run.settings();
    settings.rest_distance = kRest;
    SceneDescription scene = make_scene_with(settings);
    const Quat level = rotation_from_vector({kPi / 2, 0, 0});
    TriangleMesh pins, bar, seat;
    for (const double y : {-0.3, 0.3}) {
        join(pins, make_cylinder(kPin, 0.05, kSides), level, {0, y, 0});
        join(seat, make_cylinder(kPin, 0.05, kSides), level, {0, y, 0});
    }
    join(seat, make_box(0.2, 0.4, 0.03), {}, {0, 0, -0.04});
    for (const double z : {0.0, -1.0}) join(bar, make_hoop(hole, 0.0085, 0.02, kSides), level, {0, 0, z});
    join(bar, make_box(0.01, 0.016, 1 - 0.036), {}, {0, 0, -0.5});
    const auto fixed = add_shape(scene, pins), link = add_shape(scene, bar, kBar),
               heavy = add_shape(scene, seat, kSeat);
    const auto set = [&](std::int32_t shape, const Vec3& center, const Vec3& inertia) {
        ShapeDescription& s = scene.shapes[static_cast<std::size_t>(shape)];
        s.center_of_mass = center;
        s.inertia = Mat3{{inertia.x, 0, 0, 0, inertia.y, 0, 0, 0, inertia.z}};
    };
    set(link, {0, 0, -0.5}, kBar * Vec3{1.0 / 12, 1.0 / 12, 1e-4});
    set(heavy, {0, 0, -0.04}, kSeat * Vec3{0.02, 0.01, 0.02});
    const Quat lean = rotation_from_vector({0, -kLean, 0});
    add_body(scene, fixed, BodyType::fixed, {}, 0.1, 0);
    for (const double y : {-0.3, 0.3})
        add_body(scene, link, BodyType::dynamic, Vec3{0, y, 0} + rotate(lean, {0, 0, -kPlay}), 0.1, 0).rotation = lean;
    add_body(scene, heavy, BodyType::dynamic, rotate(lean, {0, 0, -1 - 2 * kPlay}), 0.1, 0);
    Motion motion(scene);
    const Swings found = swings(motion, 3, 3);
    ASSERT_GE(found.peaks.size(), 2u);
    motion.print("goes to %.3f and %.3f m", found.peaks[0], found.peaks[1]);
    EXPECT_NEAR(found.peaks[0], 0.287, 0.005); // of steps of 1/240 s, as the next
    EXPECT_NEAR(found.peaks[1], 0.290, 0.006);
    EXPECT_EQ(motion.outcome().merges, 0);
    expect_no_rise(motion);
}

const bool kRegistered = [] {
    add_runs("Hanging", "LampOnAChainSwings",
             {{"balanced", 60}, {"balanced", 120}, {"balanced", 240}, {"accurate", 60}}, true, lamp_swings);
    add_runs("Hanging", "SeatSwings",
             {{"balanced", 24}, {"balanced", 60}, {"balanced", 240}, {"preview", 24}, {"accurate", 24}}, true,
             seat_swings);
    return true;
}();

} // namespace
} // namespace flotilla::physics
