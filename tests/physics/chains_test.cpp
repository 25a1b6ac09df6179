// SPDX-License-Identifier: MIT
// Chains, ropes and mail of closed links: they swing, hang and come to rest, and no link is ever held.
#include <utility>

#include "physics/physics.hpp"
#include "physics/problems/tops.hpp"

namespace flotilla::physics {
namespace {

/// A torus of 0.65 m; every other link of a chain is turned by a right angle about the chain's axis.
struct Link {
    double ring = 0.28, tube = 0.045; ///< m
    int around = 48, across = 16;     ///< 1,536 triangles
    [[nodiscard]] TriangleMesh mesh() const { return make_ring(ring, tube, around, across); }
    [[nodiscard]] double inner() const { return 2 * (ring - tube); } ///< m, the pitch of a chain whose links touch
};

/// `links` links from the origin; the first one is fixed. The links are `play` m short of tight.
SceneDescription chain(const Settings& settings, int links, const Link& link, double play, bool hangs) {
    return chain_of(settings, links, link.mesh(), link.inner() - play, hangs);
}

// A chain that is let go level has no tension at first: its last link falls freely, and faster once the rest pulls it
// round. It is looked at before it has fallen by 0.4 of the chain's length.
//
// Where vertices move along chords, a hole of radius r that turns by phi in a step is r phi^2 / 8 narrower in the
// middle of the step. A taut link that turns otherwise has no room there with less play than that, whatever impulses it
// gets: then clusters, which move as one, are due. With ten micrometres of play and 6.5 rad/s at 1/100 s it is 0.12 mm.
void swings(const Run& run, int links, double time, const Link& link = {}, double play = 2.5) {
    const Settings settings = run.settings();
    const double room = play * rest_gap(link.mesh());
    Motion motion(chain(settings, links, link, room, false));
    const std::size_t last = static_cast<std::size_t>(links) - 1;
    const double until = std::min(time, std::sqrt(2 * 0.4 * (links - 1) * link.inner() / kGravity));
    double fallen = 0, due = 0, stood_still = 0, most_turn = 0; // radians a step
    std::int64_t avoidable = 0;                                 // merges in steps whose chords had room
    motion.run(time, [&](const StepReport& r) {
        double turn = 0;
        for (std::size_t i = 1; i <= last; ++i) turn = std::max(turn, length(motion.world().turn(i)));
        most_turn = std::max(most_turn, turn);
        const bool chords_have_room =
            settings.trajectory == Trajectory::rigid || 0.5 * link.inner() * turn * turn / 8 < room;
        if (chords_have_room) avoidable += r.merges;
        if (r.held > 0) stood_still += run.dt();
        if (r.time > until) return;
        fallen = -motion.body(last).center_of_mass.z;
        due = 0.5 * kGravity * r.time * r.time;
    });
    motion.print("the last of %d links fell %.3g m, freely %.3g; turns of up to %.2g a step; bodies held for %.2g s",
                 links, fallen, due, most_turn, stood_still);
    EXPECT_EQ(motion.outcome().held, 0);
    EXPECT_EQ(avoidable, 0);
    EXPECT_GT(fallen, 0.9 * due);
    expect_no_rise(motion);
}

/// Level rings on a grid, each two neighbours joined by an upright ring; the first row of the level ones is fixed.
SceneDescription mail(const Settings& settings, int rows, int columns, double size) {
    const double ring = 0.45 * size, tube = 0.05 * size, pitch = 2.4 * ring;
    SceneDescription scene = make_scene_with(settings);
    const TriangleMesh mesh = make_ring(ring, tube, 20, 8);
    const auto free = add_solid(scene, mesh, kSteel), fixed = add_shape(scene, mesh);
    const Quat upright_x = rotation_from_vector({kPi / 2, 0, 0}), upright_y = rotation_from_vector({0, kPi / 2, 0});
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
            const Vec3 at = pitch * Vec3{1.0 * i, 1.0 * j, 0};
            add_body(scene, i == 0 ? fixed : free, i == 0 ? BodyType::fixed : BodyType::dynamic, at, 0, 0);
            if (i + 1 < rows)
                add_body(scene, free, BodyType::dynamic, at + Vec3{pitch / 2, 0, 0}, 0, 0).rotation = upright_x;
            if (j + 1 < columns)
                add_body(scene, free, BodyType::dynamic, at + Vec3{0, pitch / 2, 0}, 0, 0).rotation = upright_y;
        }
    return scene;
}

// Vertices that move along chords narrow the hole of a ring that turns by phi in a step by 1 - cos(phi / 2). From a
// radian on that is more than the thickness of the rings: where they are taut, nothing but a cluster gets through such
// a step (see swings()). What a cluster's rings would have turned by is about what they turned by in the step before.
void mail_moves(const Run& run, int rows, int columns, double size, int steps) {
    constexpr double kHole = 0.4, kTube = 0.05; // of the size
    const Settings settings = run.settings();
    Motion motion(mail(settings, rows, columns, size));
    std::int64_t avoidable = 0;          // merges
    double most_turn = 0, last_turn = 0; // radians a step
    motion.run(run.dt() * steps, [&](const StepReport& r) {
        double now = 0;
        for (std::size_t i = 0; i < motion.world().size(); ++i) now = std::max(now, length(motion.world().turn(i)));
        const double turn = std::max(now, std::exchange(last_turn, now));
        most_turn = std::max(most_turn, turn);
        const bool chords_have_room =
            settings.trajectory == Trajectory::rigid || kHole * (1 - std::cos(0.5 * turn)) < kTube;
        if (chords_have_room) avoidable += r.merges;
    });
    motion.print("%zu rings of %.3g m, turns of up to %.2g a step", motion.world().size(), size, most_turn);
    EXPECT_EQ(motion.outcome().held, 0);
    EXPECT_EQ(avoidable, 0);
    expect_no_rise(motion);
}

// A ring that carries one of ten times its mass, and neither has friction: between that and the ring above it the light
// one hands on in a sweep no more than its own mass takes.
void load_swings_on_a_ring(const Run& run, double speed) {
    constexpr double kLink = 0.78, kLoad = 8, kPlay = 0.6e-3;
    const TriangleMesh mesh = make_ring(0.05, 0.01, 24, 10);
    const double pitch = 2 * (0.05 - 0.01) - kPlay, length = 2 * pitch;
    SceneDescription scene = make_scene_with(run.settings());
    for (int i = 0; i < 3; ++i) {
        const double mass = i == 1 ? kLink : kLoad;
        BodyDescription& ring = add_body(scene, add_shape(scene, mesh, i == 0 ? 0 : mass),
                                         i == 0 ? BodyType::fixed : BodyType::dynamic, {0, 0, -i * pitch}, 0, 0);
        ring.rotation = rotation_from_vector({0, 0, i % 2 * kPi / 2}) * rotation_from_vector({kPi / 2, 0, 0});
        ring.velocity = {speed * i * pitch / length, 0, 0};
        ring.angular_velocity = {0, -speed / length, 0};
    }
    scene.bodies[0].velocity = scene.bodies[0].angular_velocity = {};
    Motion motion(scene);
    double back = 0; // s
    motion.run(0.6 * 2 * kPi * std::sqrt(length / kGravity), [&](const StepReport& r) {
        if (back == 0 && motion.body(2).velocity.x < 0) back = r.time;
    });
    motion.print("turns back after %.3f s", back);
    EXPECT_GT(back, 0);
    EXPECT_EQ(motion.outcome().merges, 0);
    EXPECT_EQ(motion.outcome().held, 0);
    expect_no_rise(motion);
}

/// A chain of `links` free links, `pitch` m from one contact to the next, with the moment of inertia `inertia` m^2 per
/// kg about a diameter.
struct Hanging {
    int links;
    double pitch, inertia;
    /// rad/s, no less than any frequency of its small swings. Links that lean by theta_i have the potential energy of
    /// at most links m g pitch / 2 sum theta_i^2, the tension at the top being links m g, and the kinetic energy of at
    /// least m inertia / 2 sum (d theta_i/dt)^2.
    [[nodiscard]] double fastest_swing() const { return std::sqrt(links * kGravity * pitch / inertia); }
};

// Contacts without friction, and those at one point, take nothing from a chain that swings: what it kept of its fall it
// keeps. But it swings, and does not jitter. Of small swings with the frequencies w_i the accelerations are bounded, in
// the norm of kinetic energy, by the largest w_i times the largest velocities: |dv/dt| <= w sqrt(2 E), and their energy
// E is at most twice the largest kinetic energy, its mean being half of E. Velocities that contacts throw to and fro
// from step to step are beyond that by a factor of 1 / (w dt).
void hangs(const Run& run, const SceneDescription& scene, double time, const Hanging& chain) {
    Motion motion(scene);
    const std::size_t n = motion.world().size();
    std::vector<Vec3> before(n);
    double fastest_change = 0, kinetic = 0; // sqrt(J) a second and J, in the last second
    double force = 0;                       // N, its sum: what swings is carried in the mean
    int steps = 0;
    motion.run(time, [&](const StepReport& r) {
        double change = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3 v = motion.body(i).velocity;
            change += motion.mass(i) * length_sq(v - before[i]);
            before[i] = v;
        }
        if (r.time <= time - 1) return;
        fastest_change = std::max(fastest_change, std::sqrt(change) / run.dt());
        kinetic = std::max(kinetic, r.kinetic_energy);
        force -= motion.force_on(0).z;
        ++steps;
    });
    const double carried = force / (steps * motion.total_mass() * kGravity);
    const double due = 2 * chain.fastest_swing() * std::sqrt(kinetic);
    motion.print(
        "%s: swings with up to %.3g J, accelerations are %.3g of the most due, the fixed link carries %.5f of the "
        "weight",
        run.preset.c_str(), kinetic, fastest_change / due, carried);
    if (motion.outcome().fastest_sizes >= 1e-4) {
        EXPECT_LE(fastest_change, due);
    }
    EXPECT_NEAR(carried, 1, 1e-3) << "of the weight";
    EXPECT_EQ(motion.outcome().held, 0);
    EXPECT_EQ(motion.outcome().merges, 0);
    expect_no_rise(motion);
}

void torus_links_hang(const Run& run, int links) {
    const Link link;
    const double inertia = 0.5 * link.ring * link.ring + 0.625 * link.tube * link.tube; // of a torus
    hangs(run, chain(run.settings(), links, link, 2.5 * rest_gap(link.mesh()), true), 5,
          {links - 1, link.inner(), inertia});
}

/// Rings without thickness, 1 m across.
void flat_links_hang(const Run& run, int links) {
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_annulus(0.4, 0.5, 24);
    const auto fixed = add_shape(scene, mesh), free = add_shape(scene, mesh, 1);
    const Quat down = rotation_from_vector({0, kPi / 2, 0});
    for (int i = 0; i < links; ++i)
        add_body(scene, i == 0 ? fixed : free, i == 0 ? BodyType::fixed : BodyType::dynamic,
                 {0, 0, -i * (0.8 - 2.5 * rest_gap(mesh))}, 0.3, 0)
            .rotation = down * rotation_from_vector({i % 2 * kPi / 2, 0, 0});
    hangs(run, scene, 5, {links - 1, 0.8, (0.4 * 0.4 + 0.5 * 0.5) / 4});
}

void frequency_of_a_chain(const Run& run, int links) {
    const HangingChain chain(links);
    Motion motion(chain.scene(run.settings()));
    const double due = chain.frequency();
    const auto [found, crossings] = chain.found(motion.record(2.3 * 2 * kPi / due));
    motion.print("frequency %.5g, due %.5g rad/s (%.4f), %zu crossings", found, due, found / due, crossings);
    EXPECT_NEAR(found / due, 1, 0.02);
    EXPECT_EQ(motion.outcome().held, 0);
    expect_no_rise(motion);
}

[[maybe_unused]] const bool registered = [] {
    for (const int links : {8, 16, 32, 64})
        add_runs("Chains", "ChainOf" + std::to_string(links) + "LinksSwings", runs({100}), links == 8,
                 [=](const Run& r) { swings(r, links, links <= 16 ? 1 : 0.4); });
    add_runs("Chains", "ChainOf8LinksSwings", runs(), false, [](const Run& r) { swings(r, 8, 0.5); });
    add_runs("Chains", "MailOf29Rings", runs({100}), false, [](const Run& r) { mail_moves(r, 4, 3, 6.5e-3, 15); });
    add_runs("Chains", "MailOf62Rings", runs({100}), false, [](const Run& r) { mail_moves(r, 4, 6, 6.5e-3, 30); });
    add_runs("Chains", "MailOf671Rings", runs({100}), false, [](const Run& r) { mail_moves(r, 13, 18, 6.5e-3, 15); });
    for (const double speed : {0.2, 0.3, 0.4})
        add_runs("Chains", "LoadSwingsOnARingAt" + std::to_string(std::lround(1e3 * speed)) + "mm",
                 {{"balanced", 60}, {"balanced", 24}, {"preview", 60}, {"balanced", 240}}, true,
                 [=](const Run& r) { load_swings_on_a_ring(r, speed); });
    add_runs("Chains", "TenTorusLinksHang", runs({100}), true, [](const Run& r) { torus_links_hang(r, 11); });
    add_runs("Chains", "ThreeTorusLinksHang", runs({100}), true, [](const Run& r) { torus_links_hang(r, 4); });
    add_runs("Chains", "TenFlatLinksHang", runs({100}), false, [](const Run& r) { flat_links_hang(r, 11); });
    add_runs("Chains", "FrequencyOfAHangingChain", runs(), true, [](const Run& r) { frequency_of_a_chain(r, 12); });
    // Ten micrometres of play, links of 4,096 triangles.
    add_runs("Chains", "TightChainOf8LinksSwings", runs({100}), true, [](const Run& r) {
        swings(r, 8, 1, {0.28, 0.045, 64, 32}, 0.005);
    });
    return true;
}();

} // namespace
} // namespace flotilla::physics
