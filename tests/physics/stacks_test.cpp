// SPDX-License-Identifier: MIT
// Stacks come to rest and stay, whatever their height and mass ratios, and carry their weight.
#include "physics/physics.hpp"
#include "physics/problems/standing.hpp"
#include "scene/household_meshes.hpp"

namespace flotilla::physics {
namespace {

/// Masses from the ground up, each `ratio` times that below.
std::vector<double> growing(int boxes, double ratio) {
    std::vector<double> masses{1};
    while (static_cast<int>(masses.size()) < boxes) masses.push_back(masses.back() * ratio);
    return masses;
}

/// At rest after 5 s, carrying its weight, about where it was.
void expect_stands(Motion& motion, double edge = 1) {
    motion.run(5);
    const std::size_t ground = motion.world().size() - 1;
    const double carried = -motion.force_on(ground).z / (motion.total_mass() * kGravity);
    motion.print("carries %.5f of its weight, aside by %.3g, moved by %.3g edges", carried,
                 motion.farthest_aside() / edge, motion.farthest() / edge);
    expect_rest(motion);
    expect_weight_on(motion, ground);
    expect_no_rise(motion);
    EXPECT_LT(motion.farthest_aside(), 1e-3 * edge);
    EXPECT_LT(motion.farthest(), 0.01 * edge);
    EXPECT_EQ(motion.outcome().held, 0);
}

void stands(const Run& run, const std::vector<double>& masses, double edge = 1) {
    Motion motion(resting_stack(run.settings(), masses, edge));
    expect_stands(motion, edge);
}

void stays_still(const Run& run, int boxes) {
    Motion motion(resting_stack(run.settings(), std::vector<double>(static_cast<std::size_t>(boxes), 1.0)));
    double fastest = 0;
    motion.run(5, [&](const StepReport& r) {
        if (r.time > 2) fastest = std::max(fastest, motion.outcome().fastest_sizes);
    });
    motion.print("at most %.3g sizes/s from 2 s on", fastest);
    EXPECT_LT(fastest, 1e-4);
}

// Statics does not say how the corners of a box share its load: all alike, where nothing tells them apart.
void corners_carry_alike(const Run& run, int boxes) {
    Motion motion(resting_stack(run.settings(), std::vector<double>(static_cast<std::size_t>(boxes), 1.0)));
    motion.run(1);
    const double seconds = run.settings().time_step;
    double farthest = 0; // from the due share, of that
    for (const ContactState& c : motion.world().contacts()) {
        const std::int32_t below = std::min(c.body_a, c.body_b), above = std::max(c.body_a, c.body_b);
        const bool on_ground = above == boxes;
        const double due = (on_ground ? boxes : boxes - 1 - below) * kGravity * seconds / 4;
        farthest = std::max(farthest, std::abs(std::abs(c.impulse.z) / due - 1));
    }
    motion.print("%zu contacts, the farthest from its share by %.2g of it", motion.world().contacts().size(), farthest);
    EXPECT_EQ(motion.world().contacts().size(), static_cast<std::size_t>(4 * boxes));
    EXPECT_LT(farthest, 1e-3);
}

void dropped_apart(const Run& run, int boxes, double gap) {
    constexpr double kEdge = 1;
    Motion motion(stack(run.settings(), std::vector<double>(static_cast<std::size_t>(boxes), 1.0), kEdge, gap));
    motion.run(5);
    motion.print("aside by %.4g m", motion.farthest_aside());
    expect_rest(motion);
    expect_no_rise(motion);
    EXPECT_LT(motion.farthest_aside(), 0.02 * kEdge);
    expect_weight_on(motion, motion.world().size() - 1);
}

// An island may sleep only when its forces carry its weight: they are looked at in the last step before it does, and
// then with sleeping off, what it stands on must not have been sleep.
void sleeps_only_when_carried(const SceneDescription& scene) {
    SceneDescription sleepy = scene;
    sleepy.settings.sleeping = true;
    Motion motion(sleepy);
    const std::size_t ground = motion.world().size() - 1;
    double carried = 0, before = 0;
    std::int64_t fell_asleep = -1;
    motion.run(5, [&](const StepReport& r) {
        if (r.sleeping > 0 && fell_asleep < 0) fell_asleep = r.step, carried = before;
        before = -motion.force_on(ground).z / (motion.total_mass() * kGravity);
    });
    motion.print("asleep in step %lld, carrying %.5f of its weight", static_cast<long long>(fell_asleep), carried);
    if (fell_asleep >= 0) {
        EXPECT_NEAR(carried, 1, 1e-3) << "of the weight when it fell asleep in step " << fell_asleep;
    }
    EXPECT_LT(motion.farthest(), 0.01);
}

void rests_awake(const SceneDescription& scene) {
    Motion motion(scene);
    motion.run(5);
    motion.print("sleeping off: moved by %.3g m", motion.farthest());
    expect_rest(motion);
    EXPECT_LT(motion.farthest(), 0.01);
}

SceneDescription brick_wall(const Settings& settings, int courses, int bricks) {
    constexpr double kLength = 0.25, kWidth = 0.12, kHeight = 0.065;
    const TriangleMesh whole = make_box(kLength, kWidth, kHeight);
    const double gap = rest_gap(whole);
    SceneDescription scene = make_scene_with(settings);
    const auto brick = add_shape(scene, whole, 4),
               half = add_shape(scene, make_box((kLength - gap) / 2, kWidth, kHeight), 2);
    for (int j = 0; j < courses; ++j) {
        const double z = gap + kHeight / 2 + j * (kHeight + gap), pitch = kLength + gap;
        const bool odd = j % 2 == 1;
        for (int i = 0; i < bricks - (odd ? 1 : 0); ++i)
            add_body(scene, brick, BodyType::dynamic, {(i + (odd ? 0.5 : 0.0)) * pitch, 0, z}, 0.6, 0);
        if (!odd) continue;
        for (const double end : {-pitch / 4, (bricks - 1) * pitch + pitch / 4})
            add_body(scene, half, BodyType::dynamic, {end, 0, z}, 0.6, 0);
    }
    return scene;
}

/// Cubes of 1 m in rows, each on two of the row below.
SceneDescription pyramid(const Settings& settings, int rows, double friction) {
    const TriangleMesh mesh = make_box(1, 1, 1);
    const double pitch = 1 + rest_gap(mesh);
    SceneDescription scene = make_scene_with(settings);
    const auto cube = add_shape(scene, mesh, 600);
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i < rows - row; ++i)
            add_body(scene, cube, BodyType::dynamic,
                     {(i - 0.5 * (rows - row - 1)) * pitch, 0, 0.5 + row * pitch + rest_gap(mesh)}, friction, 0);
    add_ground(scene, 60, friction, 0);
    return scene;
}

/// Eight bricks of 2 by 1 by 1 m a course with 4 cm between them, every second course shifted by half a brick between two
/// cubes.
SceneDescription loose_wall(const Settings& settings, int courses, double pitch) {
    constexpr int kBricks = 8;
    constexpr double kGap = 0.0062, kFriction = 0.4;
    SceneDescription scene = make_scene_with(settings);
    const auto brick = add_shape(scene, make_box(2, 1, 1), 1200), cube = add_shape(scene, make_box(1, 1, 1), 600);
    const auto add = [&](std::int32_t shape, double x, int course) {
        add_body(scene, shape, BodyType::dynamic, {x, 0, 0.5 + kGap + course * (1 + kGap)}, kFriction, 0);
    };
    for (int course = 0; course < courses; ++course) {
        const bool shifted = course % 2 == 1;
        for (int i = 0; i < kBricks - (shifted ? 1 : 0); ++i) add(brick, pitch * (i + (shifted ? 0.5 : 0.0)), course);
        if (!shifted) continue;
        add(cube, -0.5, course);
        add(cube, pitch * (kBricks - 1) + 0.5, course);
    }
    add_ground(scene, 60, kFriction, 0);
    return scene;
}

/// With bodies enough that sweeps alone solve it.
void falls_asleep(SceneDescription scene) {
    scene.settings.sleeping = true;
    Motion motion(scene);
    std::int64_t asleep = -1;
    motion.run(5, [&](const StepReport& r) {
        if (asleep < 0 && r.sleeping == static_cast<std::int64_t>(motion.world().size()) - 1) asleep = r.step;
    });
    motion.print("asleep in step %lld, moved by %.3g m", static_cast<long long>(asleep), motion.farthest());
    EXPECT_GE(asleep, 0);
    EXPECT_LT(motion.farthest(), 0.01);
    expect_no_rise(motion);
}

// What 14 courses do within five seconds is by chance of a millimetre between bricks: from one pitch it was by luck.
void loose_walls_fall_asleep(const Run& run, int courses) {
    const std::vector<double> pitches{2.039, 2.04, 2.041, 2.042, 2.044}; // m
    int asleep = 0;
    for (const double pitch : pitches) {
        SceneDescription scene = loose_wall(run.settings(), courses, pitch);
        scene.settings.sleeping = true;
        Motion motion(scene);
        bool slept = false;
        motion.run(5, [&](const StepReport& r) {
            slept = slept || r.sleeping == static_cast<std::int64_t>(motion.world().size()) - 1;
        });
        motion.print("pitch %.3f m, %s, moved by %.3g m", pitch, slept ? "asleep" : "awake", motion.farthest());
        asleep += slept ? 1 : 0;
        EXPECT_LT(motion.farthest(), 0.01);
        expect_no_rise(motion);
    }
    EXPECT_GE(asleep + 1, static_cast<int>(pitches.size()));
}

/// 44 bricks in eight courses under a beam as long as the wall. The last body is the ground.
SceneDescription wall_under_beam(const Settings& settings, double bricks_of_beam) {
    SceneDescription scene = brick_wall(settings, 8, 5);
    double top = 0;
    for (const BodyDescription& b : scene.bodies) top = std::max(top, b.position.z);
    const TriangleMesh mesh = make_box(1.25, 0.12, 0.2);
    const auto beam = add_shape(scene, mesh, 4 * bricks_of_beam);
    const double brick_gap = rest_gap(make_box(0.25, 0.12, 0.065));
    add_body(scene, beam, BodyType::dynamic, {0.5, 0, top + 0.065 / 2 + brick_gap + 0.1}, 0.6, 0);
    add_ground(scene, 10, 0.6, 0);
    return scene;
}

void wall_stands(const Run& run, double bricks_of_beam) {
    Motion motion(wall_under_beam(run.settings(), bricks_of_beam));
    motion.run(5);
    motion.print("moved by %.3g m", motion.farthest());
    expect_rest(motion);
    expect_no_rise(motion);
    EXPECT_LT(motion.farthest(), 1e-3);
    expect_weight_on(motion, motion.world().size() - 1);
}

/// Cubes of one size, corner over corner but for `aside` m a cube, without friction: what turns them or drives them
/// aside is of the contacts' directions alone.
void flush_cubes_stay(const Run& run, double aside) {
    constexpr double kEdge = 0.2;
    const TriangleMesh mesh = make_box(kEdge, kEdge, kEdge);
    SceneDescription scene = make_scene_with(run.settings());
    const auto cube = add_shape(scene, mesh, 1);
    const double pitch = kEdge + rest_gap(mesh);
    for (int k = 0; k < 4; ++k)
        add_body(scene, cube, k == 0 ? BodyType::fixed : BodyType::dynamic, {k * aside, 0, k * pitch}, 0, 0);
    Motion motion(scene);
    double fastest = 0;
    motion.run(3, [&](const StepReport&) {
        for (std::size_t i = 1; i < 4; ++i)
            fastest =
                std::max({fastest, length(motion.body(i).velocity), kEdge * length(motion.body(i).angular_velocity)});
    });
    motion.print("moves at up to %.3g edges/s", fastest / kEdge);
    EXPECT_LT(fastest / kEdge, 1e-6);
    expect_no_rise(motion);
}

// The force between the boxes k and k + 1 from the ground of a stack of N is (N - k) m g.
void forces_in_a_stack(const Run& run) {
    constexpr int kBoxes = 10;
    Motion motion(resting_stack(run.settings(), std::vector<double>(kBoxes, 2.0)));
    motion.run(5);
    double worst = 0;
    for (int k = 0; k < kBoxes; ++k) {
        double force = 0;
        for (const ContactState& c : motion.world().contacts())
            if (c.body_a == (k == 0 ? 0 : k - 1) && c.body_b == (k == 0 ? kBoxes : k))
                force += std::abs(c.impulse.z) / run.dt();
        worst = std::max(worst, std::abs(force / ((kBoxes - k) * 2 * kGravity) - 1));
    }
    motion.print("forces differ by up to %.3g of (N - k) m g", worst);
    EXPECT_LT(worst, 0.01);
}

// Boxes that landed closer than their rest distances, and have no lift left to part. What slides on them does not pay
// for it.
void top_slides_off(const Run& run, int boxes) {
    constexpr double kWidth = 0.2, kHeight = 0.02, kDrop = 0.002, kFriction = 0.2, kSettled = 1, kPulled = 0.3;
    SceneDescription scene = make_scene_with(run.settings());
    const auto shape = add_solid(scene, make_box(kWidth, kWidth, kHeight), 600);
    for (int k = 0; k < boxes; ++k)
        add_body(scene, shape, BodyType::dynamic, {0, 0, 0.5 * kHeight + 2e-4 + (kHeight + kDrop) * k}, kFriction, 0);
    add_ground(scene, 4, kFriction, 0);
    Motion motion(scene);
    motion.run(kSettled);
    const auto top = static_cast<std::size_t>(boxes - 1);
    motion.world().set_force(motion.world().id(top), {2 * kFriction * motion.mass(top) * kGravity, 0, 0}, {});
    const double from = motion.body(top).position.x, since = motion.world().time();
    while (motion.world().time() < since + kPulled) motion.world().step(); // a Motion takes the work for a gain
    const double time = motion.world().time() - since, way = motion.body(top).position.x - from,
                 due = 0.5 * kFriction * kGravity * time * time;
    motion.print("slides %.4g m, due %.4g", way, due);
    EXPECT_NEAR(way / due, 1, 0.015);
}

// A cube of `edge` m that is pulled for a second at its upper edge, with `share` of the force that tips it, half its
// weight: at the centre of mass, and the torque of its arm.
struct PulledCube {
    Motion motion;
    double force = 0, torque = 0; // N, N m

    PulledCube(const Run& run, double edge, double share) : motion(scene(run, edge)) {
        World& world = motion.world();
        force = 0.5 * share * motion.mass(0) * kGravity;
        torque = 0.5 * edge * force;
        motion.run(4 * run.dt());
        world.set_force(world.id(0), {force, 0, 0}, {0, torque, 0});
        for (int k = 0; k < run.rate; ++k) world.step(); // a Motion takes the work for a gain
    }
    static SceneDescription scene(const Run& run, double edge) {
        SceneDescription out = resting_stack(run.settings(), {1}, edge);
        for (BodyDescription& body : out.bodies) body.friction = 2;
        return out;
    }
    [[nodiscard]] bool stands() const { return rotate(motion.body(0).rotation, {0, 0, 1}).z > 0.999; }
};

// What a floor forbids does not bend arcs: the turn that the torque alone would give.
void carries_a_torque(const Run& run, double edge) {
    PulledCube cube(run, edge, 0.8);
    const BodyContacts carried = cube.motion.world().contacts_of(cube.motion.world().id(0));
    const double weight = cube.motion.mass(0) * kGravity;
    cube.motion.print("contacts carry (%.4f, %.4f) m g, due (%.4f, 1), and %.4f of the torque",
                      carried.force.x / weight, carried.force.z / weight, -cube.force / weight,
                      -carried.torque.y / cube.torque);
    EXPECT_TRUE(cube.stands());
    EXPECT_NEAR(carried.force.x / cube.force, -1, 2e-3);
    EXPECT_NEAR(carried.force.z / weight, 1, 2e-3);
    EXPECT_NEAR(carried.torque.y / cube.torque, -1, 2e-3);
    EXPECT_TRUE(PulledCube(run, edge, 0.97).stands());
    EXPECT_FALSE(PulledCube(run, edge, 1.03).stands());
}

std::string power(double ratio) { return "1e" + std::to_string(static_cast<int>(std::lround(std::log10(ratio)))); }

// Alike pieces let go above each other.
struct Pieces {
    int number;
    double bottom, lift, turn; // m, m, rad: the height of the first; of each above the one before, and about z
    double friction;
};
SceneDescription piled(const Run& run, const TriangleMesh& mesh, double surface_density, const Pieces& pieces) {
    SceneDescription scene = make_scene_with(run.settings());
    scene.settings.sleeping = true;
    const auto shape = add_shape(scene, mesh, surface_density);
    for (int k = 0; k < pieces.number; ++k)
        add_body(scene, shape, BodyType::dynamic, {0, 0, pieces.bottom + pieces.lift * k}, pieces.friction, 0)
            .rotation = rotation_from_vector({0, 0, pieces.turn * k});
    add_ground(scene, 4, pieces.friction, 0);
    return scene;
}

// s, when all but the ground first sleep; 0: not by `time`.
double asleep_by(Motion& motion, double time) {
    const auto all = static_cast<std::int64_t>(motion.world().size()) - 1;
    double slept = 0;
    motion.run(time, [&](const StepReport& r) {
        if (slept == 0 && r.sleeping == all) slept = r.time;
    });
    motion.print("asleep after %.3g s", slept);
    EXPECT_GT(slept, 0);
    expect_no_rise(motion);
    expect_weight_on(motion, motion.world().size() - 1);
    return slept;
}

// Crockery on each other, with hundreds of contacts a pair, few of which carry.
// In the mean of several starts: some take twice as long as others.
void crockery_falls_asleep(const Run& run, const TriangleMesh& mesh, const Pieces& pieces, int starts) {
    double sum = 0; // s
    for (int start = 0; start < starts; ++start) {
        Pieces turned = pieces;
        turned.turn += 0.02 * start;
        Motion motion(piled(run, mesh, 6, turned));
        const double slept = asleep_by(motion, 4);
        EXPECT_LT(slept, 2) << "s";
        sum += slept;
        EXPECT_LT(motion.outcome().above, 8)
            << "steps whose contacts were left unsolved: 9 to 72 with all of them at once";
    }
    EXPECT_LT(sum / starts, 1) << "s";
}

// What lands nearer than its rest distance and has no energy left to part: what solves leave undone would raise it.
// Held for that it would carry nothing and never sleep.
void pressed_fall_asleep(const Run& run, const TriangleMesh& mesh, const Pieces& pieces) {
    Motion motion(piled(run, mesh, 1, pieces));
    asleep_by(motion, 2);
    EXPECT_LT(motion.outcome().held_steps, 3);
}

// Cups without thickness fall into each other and wedge, nearer than their rest distance in places. Sweeps that push one
// pair after the other resolve none of them for long: merged in each step, the heap hung where it was, with the velocity
// that half a step of gravity gives.
void cups_nest(const Run& run, int cups, double friction, int start) {
    constexpr double kTime = 3, kWatched = 0.5;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = library::revolve({{0, 0}, {0.03, 0}, {0.04, 0.1}}, 14);
    const auto cup = add_shape(scene, mesh, 0.01);
    for (int i = 0; i < cups; ++i) {
        const double a = 12.9898 * (i + 1 + cups * start), b = 78.233 * (i + 1 + cups * start);
        add_body(scene, cup, BodyType::dynamic, {0.0005 * std::sin(a), 0.0005 * std::sin(b), 0.002 + 0.03 * i},
                 friction, 0);
    }
    add_ground(scene, 3, 0.2, 0);
    Motion motion(scene);
    double fastest = 0;
    std::int64_t merges = 0;
    motion.run(kTime, [&](const StepReport& r) {
        if (r.time < kTime - kWatched) return;
        merges += r.merges;
        for (int i = 0; i < cups; ++i)
            fastest = std::max(fastest, length(motion.body(static_cast<std::size_t>(i)).velocity));
    });
    motion.print("%d cups, start %d: at most %.3g m/s in the last half second", cups, start, fastest);
    EXPECT_LT(fastest, 1e-3);
    EXPECT_EQ(merges, 0);
    expect_weight_on(motion, static_cast<std::size_t>(cups));
    expect_no_rise(motion);
}

[[maybe_unused]] const bool registered = [] {
    const std::vector<Run> once = runs({24});
    for (const int boxes : {5, 8})
        add_runs("Stacks", "TopOf" + std::to_string(boxes) + "PressedBoxesSlidesOff",
                 {{"preview", 60}, {"balanced", 24}, {"balanced", 60}, {"balanced", 120}, {"accurate", 60}}, true,
                 [=](const Run& r) { top_slides_off(r, boxes); });
    for (const int boxes : {2, 3, 5, 10, 20, 50}) {
        const std::vector<double> equal(static_cast<std::size_t>(boxes), 1.0);
        add_runs("Stacks", std::to_string(boxes) + "BoxesRest", boxes <= 20 ? runs() : once, boxes <= 20,
                 [=](const Run& r) { stands(r, equal); });
    }
    for (const int boxes : {1, 3})
        add_runs("Stacks", "CornersOf" + std::to_string(boxes) + "BoxesCarryAlike", runs({24, 120}), boxes == 3,
                 [=](const Run& r) { corners_carry_alike(r, boxes); });
    for (const double ratio : {1e1, 1e2, 1e3, 1e4, 1e5, 1e6}) {
        add_runs("Stacks", "HeavyOnLight" + power(ratio), runs(), true, [=](const Run& r) { stands(r, {1, ratio}); });
        add_runs("Stacks", "LightOnHeavy" + power(ratio), runs(), true, [=](const Run& r) { stands(r, {ratio, 1}); });
    }
    for (const int ratio : {2, 5, 10})
        add_runs("Stacks", "TenBoxesEach" + std::to_string(ratio) + "TimesHeavier", once, true,
                 [=](const Run& r) { stands(r, growing(10, ratio)); });
    add_runs("Stacks", "TenBoxesOfMixedMasses", once, true, [](const Run& r) {
        stands(r, {1, 1000, 3, 300, 1e4, 10, 1, 2e4, 50, 5e3});
    });
    add_runs("Stacks", "1e7TimesHeavierOnTop", runs(), true, [](const Run& r) { stands(r, {1, 1e7}); });
    add_runs("Stacks", "HundredWith1e9OnTop", once, false, [](const Run& r) {
        std::vector<double> masses(100, 1.0);
        masses.back() = 1e9;
        stands(r, masses);
    });
    add_runs("Stacks", "FiveWith1000TimesOnTopSleepWhenCarried", once, true, [](const Run& r) {
        const SceneDescription stack = resting_stack(r.settings(), {1, 1, 1, 1, 1, 1000});
        sleeps_only_when_carried(stack);
        rests_awake(stack);
    });
    for (const int rows : {14, 16, 20, 24})
        for (const int friction : {10, 50})
            add_runs("Stacks",
                     "PyramidOf" + std::to_string(rows) + "RowsFriction0_" + std::to_string(friction) + "Sleeps",
                     {{"balanced", 24}}, rows == 16,
                     [=](const Run& r) { falls_asleep(pyramid(r.settings(), rows, 0.01 * friction)); });
    for (const int courses : {12, 14, 16})
        add_runs("Stacks", "LooseWallOf" + std::to_string(courses) + "CoursesSleeps", {{"balanced", 24}}, courses == 12,
                 [=](const Run& r) { loose_walls_fall_asleep(r, courses); });
    const auto wall = [](const Run& r) {
        SceneDescription scene = brick_wall(r.settings(), 10, 5);
        add_ground(scene, 10, 0.6, 0);
        return scene;
    };
    add_runs("Stacks", "BrickWallSleepsWhenCarried", once, true,
             [=](const Run& r) { sleeps_only_when_carried(wall(r)); });
    add_runs("Stacks", "BrickWallStaysStillAwake", once, true, [=](const Run& r) { rests_awake(wall(r)); });
    for (const int beam : {61, 182, 606})
        add_runs("Stacks", "WallUnderABeamOf" + std::to_string(beam) + "Bricks", once, beam == 61,
                 [=](const Run& r) { wall_stands(r, beam); });
    add_runs("Stacks", "TenDiceOf1mmStand", runs(), true,
             [](const Run& r) { stands(r, std::vector<double>(10, 2.5e-6), 1e-3); });
    add_runs("Stacks", "TwentyBoxesDropped3cmApartStand", once, true, [](const Run& r) { dropped_apart(r, 20, 0.03); });
    add_runs("Stacks", "FiftyBoxesStayStill", {{"preview", 24}, {"balanced", 24}, {"balanced", 120}}, true,
             [](const Run& r) { stays_still(r, 50); });
    for (const auto& [name, aside] : {std::pair("FlushCubesStay", 0.0), std::pair("CubesAHairAsideStay", 1e-6)})
        add_runs("Stacks", std::string(name) + "WithoutFriction",
                 {{"preview", 24}, {"preview", 120}, {"balanced", 24}, {"balanced", 120}, {"accurate", 24}}, true,
                 [=](const Run& r) { flush_cubes_stay(r, aside); });
    const TriangleMesh plate = library::revolve({{0, 0}, {0.07, 0}, {0.12, 0.02}}, 48);
    const TriangleMesh cup =
        library::revolve({{0, 0}, {0.032, 0}, {0.034, 0.025}, {0.036, 0.05}, {0.038, 0.075}, {0.04, 0.1}}, 24);
    add_runs("Stacks", "TwentyPlatesFallAsleep", {{"balanced", 24}, {"balanced", 60}}, true, [=](const Run& r) {
        crockery_falls_asleep(r, plate, {20, 0.004, 0.008, 0.07, 0.2}, 1);
    });
    const TriangleMesh cone = library::revolve({{0.001, 0}, {0.2, 0}, {0.3, 0.4}}, 24);
    add_runs("Stacks", "ConesInEachOtherFallAsleep", {{"balanced", 60}, {"preview", 60}, {"balanced", 24}}, true,
             [=](const Run& r) {
                 Motion motion(piled(r, cone, 3, {8, 0.02, 0.15, 0.05, 0.3}));
                 EXPECT_LT(asleep_by(motion, 4), 1.5) << "s";
             });
    add_runs("Stacks", "CupsInEachOtherFallAsleep", {{"balanced", 24}, {"accurate", 24}}, true, [=](const Run& r) {
        crockery_falls_asleep(r, cup, {4, 0.004, 0.03, 0.1, 0.3}, 5);
    });
    add_runs("Stacks", "ThinCupsNest", {{"balanced", 60}, {"balanced", 24}, {"preview", 60}}, true, [](const Run& r) {
        for (const int start : {0, 1}) cups_nest(r, 6, 0, start);
    });
    add_runs("Stacks", "TwelveThinCupsNest", {{"balanced", 24}, {"balanced", 60}}, false,
             [](const Run& r) { cups_nest(r, 12, 0.2, 0); });
    std::vector<library::OutlinePoint> side{{0.0005, 0}};
    for (int k = 0; k < 7; ++k) {
        const SinCos angle = sin_cos(0.1 + 0.2 * k);
        side.push_back({0.1 * angle.sin, 0.1 * (1 - angle.cos)});
    }
    const TriangleMesh bowl = library::revolve(side, 32), sheet = make_box(0.2, 0.3, 0.0005);
    add_runs("Stacks", "WedgedBowlsFallAsleep", {{"balanced", 60}, {"preview", 60}}, true, [=](const Run& r) {
        pressed_fall_asleep(r, bowl, {2, 0.002, 0.02, 0.3, 0.3});
    });
    add_runs("Stacks", "FortySheetsFallAsleep", {{"preview", 60}}, true, [=](const Run& r) {
        pressed_fall_asleep(r, sheet, {40, 0.00045, 0.001, 0, 0.2});
    });
    add_runs("Stacks", "FortySheetsThatLandFallAsleep", {{"preview", 60}, {"balanced", 60}}, false, [=](const Run& r) {
        pressed_fall_asleep(r, sheet, {40, 0.00045, 0.00101, 0, 0.2});
    });
    for (const int rate : {24, 60, 240})
        for (const int edge : {2, 10})
            add_runs("Stacks", "CubeOf" + std::to_string(edge) + "cmCarriesTheTorqueThatPullsAtIt",
                     {{"balanced", rate}}, true, [=](const Run& r) { carries_a_torque(r, 0.01 * edge); });
    add_runs("Stacks", "ForcesAreThoseOfTheWeightAbove", runs(), true, forces_in_a_stack);
    return true;
}();

} // namespace
} // namespace flotilla::physics
