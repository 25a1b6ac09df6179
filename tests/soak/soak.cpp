// SPDX-License-Identifier: MIT
// Long runs on one thread, every step of them under the audit: a pile that a scripted paddle stirs, and boats in a
// drum that turns. Fails where a promise breaks or memory grows. flotilla_soak [PAGE.md] writes what it measured
// there, and to stdout as it goes.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>

#include <flotilla/error.hpp>

#include "base/rotation.hpp"
#include "mesh/primitives.hpp"
#include "scene/library.hpp"
#include "step/audited_run.hpp"
#include "step/scene_parts.hpp"

namespace flotilla::soak {
namespace {

using scenario::add_body;
using scenario::add_shape;
using scenario::kPi;

/// A body that turns about an axis through its origin for as long as the run lasts, a quarter of a turn from keyframe
/// to keyframe.
void turn(BodyDescription& body, const Vec3& axis, double seconds_a_turn, double seconds) {
    const Vec3 place = body.position;
    const double quarter = seconds_a_turn / 4;
    for (int k = 0; k * quarter < seconds + quarter; ++k)
        body.keyframes.push_back({k * quarter, place, rotation_from_vector((k % 4) * 0.5 * kPi * axis)});
}

/// 24 solids in a bowl, where all slide back to the middle, and a paddle that goes round there in 4 s.
SceneDescription stirred_pile(int steps) {
    SceneDescription scene;
    scene.settings.time_step = 1.0 / 60;
    constexpr double kFriction = 0.3, kRadius = 2; // m
    const std::array shapes{
        add_shape(scene, make_box(0.3, 0.25, 0.2), 12), add_shape(scene, scenario::make_octahedron(0.18), 6),
        add_shape(scene, make_ring(0.15, 0.04, 10, 5), 2), add_shape(scene, make_sphere(0.14, 1), 8)};
    for (int i = 0; i < 24; ++i) {
        const double turned = 0.5 * kPi * i + 0.4;
        const Vec3 at{0.8 * std::cos(turned), 0.8 * std::sin(turned), 0.6 + 0.12 * i};
        add_body(scene, shapes[static_cast<std::size_t>(i % 4)], BodyType::dynamic, at, kFriction);
    }
    const auto bowl = add_shape(scene, library::bowl_mesh(kRadius, 0.48 * kPi, 6, 24)),
               paddle = add_shape(scene, make_box(0.9, 0.06, 0.5));
    add_body(scene, bowl, BodyType::fixed, {}, kFriction);
    turn(add_body(scene, paddle, BodyType::kinematic, {0, 0, 0.35}, kFriction), {0, 0, 1}, 4,
         steps * scene.settings.time_step);
    return scene;
}

/// 102 boats of 3 m in a closed drum of 16 m that goes round in 20 s about its horizontal axis.
SceneDescription boats_in_drum(int steps) {
    SceneDescription scene;
    const auto boat = add_shape(scene, library::boat_mesh());
    scene.shapes[0].mass_kind = MassKind::surface_density;
    scene.shapes[0].mass_value = 10;
    constexpr int kRow = 3, kColumn = 5;
    for (int i = 0; i < 102; ++i) {
        const double x = 3.7 * (i % kRow - 1), y = 1.9 * (i / kRow % kColumn - 2), z = 1.3 * (i / kRow / kColumn) - 4;
        add_body(scene, boat, BodyType::dynamic, {x, y, z});
    }
    TriangleMesh mesh = make_cylinder(8, 13, 24);
    for (Vec3& v : mesh.vertices) v = {v.z, v.y, -v.x}; // its axis along x
    const auto drum = add_shape(scene, std::move(mesh));
    turn(add_body(scene, drum, BodyType::kinematic, {}), {1, 0, 0}, 20, steps * scene.settings.time_step);
    return scene;
}

double resident_mb() {
    std::ifstream file("/proc/self/statm");
    double total = 0, resident = 0;
    file >> total >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

/// What happened since the last row of the table.
struct Stretch {
    int steps = 0;
    double ms = 0, min_distance = 1e300;
    std::int64_t held = 0, merges = 0, corrections = 0, delayed = 0;

    void add(const StepReport& r) {
        ++steps;
        ms += r.total_ms;
        min_distance = std::min(min_distance, r.min_distance);
        held += r.held;
        merges += r.merges;
        corrections += r.energy_corrections;
        delayed += (r.warnings & kScriptDelayed) != 0 ? 1 : 0;
    }
};

constexpr const char* kHead = "| step | resident, MB | kinetic energy, J | energy, J | lift, J | corrections | least "
                              "distance, m | ms a step | merges | "
                              "held | delayed steps |\n|---|---|---|---|---|---|---|---|---|---|---|\n";

std::string row(const StepReport& r, const Stretch& s, double resident) {
    std::ostringstream out;
    out << std::setprecision(4) << "| " << r.step << " | " << resident << " | " << r.kinetic_energy << " | " << r.energy
        << " | " << r.lift << " | " << s.corrections << " | " << s.min_distance << " | " << s.ms / s.steps << " | "
        << s.merges << " | " << s.held << " | " << s.delayed << " |\n";
    return out.str();
}

/// Contacts come and go, and lists grow to the most there were; a leak of a kilobyte a step is a tenth of the memory
/// of such a run.
constexpr double kGrowth = 1.25;
constexpr const char* kKept = "Every step was proved, the energy stayed finite, and memory ended within a quarter of "
                              "what it was after a tenth.";

/// Empty, or what broke. Rows of the table go to `table`.
std::string run(const SceneDescription& scene, int steps, std::string& table) {
    scenario::AuditedRun audited(scene);
    Stretch stretch;
    double settled = 0; // MB, after a tenth
    for (int n = 1; n <= steps; ++n) {
        const StepReport r = audited.step();
        stretch.add(r);
        const std::string where = " in step " + std::to_string(n);
        if (audited.findings > 0) return "not proved free of intersections" + where;
        if (!std::isfinite(r.energy) || !std::isfinite(r.kinetic_energy)) return "no finite energy" + where;
        const bool tenth = n == steps / 10;
        if (n != 100 && n != 1000 && !tenth && n != steps) continue;
        const double resident = resident_mb();
        table += row(r, stretch, resident);
        std::cout << row(r, stretch, resident) << std::flush;
        stretch = {};
        if (tenth) settled = resident;
        if (n == steps && resident > kGrowth * settled) return "memory grows" + where;
    }
    return "";
}

int soak(const char* page) {
    struct Case {
        const char* title;
        SceneDescription (*make)(int steps);
        int steps;
    };
    std::string text =
        "# Soak\n\nWritten by `flotilla_soak` (`ctest -L soak`): long runs on one thread, every step of them under the "
        "audit. Counts, times and the least distance are of the steps since the row before; corrections are those of "
        "the last resort that keeps energy from growing.\n";
    bool good = true;
    for (const Case& c : {Case{"24 solids that a paddle stirs", stirred_pile, 10000},
                          Case{"102 boats in a turning drum", boats_in_drum, 2000}}) {
        std::cout << c.title << '\n' << kHead << std::flush;
        std::string table = kHead, broken;
        try {
            broken = run(c.make(c.steps), c.steps, table);
        } catch (const std::exception& error) {
            broken = error.what();
        }
        good = good && broken.empty();
        text += std::string("\n## ") + c.title + "\n\n" + table + "\n" +
                (broken.empty() ? std::string(kKept) : "BROKEN: " + broken) + "\n";
        std::cout << (broken.empty() ? "kept" : broken) << std::endl;
        if (page != nullptr) std::ofstream(page) << text;
    }
    return good ? 0 : 3;
}

} // namespace
} // namespace flotilla::soak

int main(int argc, char** argv) {
    setenv("FLOTILLA_NUM_THREADS", "1", 1);
    return flotilla::soak::soak(argc > 1 ? argv[1] : nullptr);
}
