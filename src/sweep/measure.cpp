// SPDX-License-Identifier: MIT
#include "sweep/measure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <flotilla/error.hpp>
#include <flotilla/sweep.hpp>
#include <flotilla/world.hpp>

#include "base/rotation.hpp"
#include "base/vec3.hpp"
#include "io/file.hpp"
#include "report/step_columns.hpp"
#include "run_folder/checkpoint.hpp"
#include "run_folder/run_files.hpp"
#include "run_folder/run_folder.hpp"

namespace flotilla {

std::span<const SweepMetric> sweep_metrics() {
    using enum SweepMetric::Truth;
    static constexpr std::array<SweepMetric, sweep::kMetrics> kTable{{
        {"position", "m",
         "distance of the centres of mass from the reference's, root mean square over bodies and times", zero, true},
        {"rotation", "rad", "angle between the bodies and the reference's, root mean square over bodies and times",
         zero, true},
        {"height", "m", "of the pile: mean height of the mass above the lowest point of the moving bodies, at the end"},
        {"energy", "J", "lost from the start to the end"},
        {"support", "", "contact force of fixed and scripted bodies, upwards, by the weight of all; in the last step"},
        {"load", "", "normal contact forces on a body by its weight, mean over the bodies; in the last step"},
        {"creep", "m/s",
         "mean distance between the bodies' places at the beginning and the end of the last tenth, by time", zero},
        {"residual", "m/s", "largest violation that the contact solver left, mean over the steps", zero},
        {"rest_time", "s", "from when on the kinetic energy could not lift the bodies by 1/330 of their size"},
    }};
    return kTable;
}

} // namespace flotilla

namespace flotilla::sweep {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kEnd = 0.9;       // of the time: where the end begins
constexpr double kSameTime = 1e-9; // of a run's time: n dt and (2 n) (dt / 2) differ by rounding

/// Centres of mass and rotations of the moving bodies at one time.
struct Poses {
    double time = 0;
    std::vector<Vec3> center;
    std::vector<Quat> rotation;
};

/// Frames in the order of time.
class Frames {
  public:
    Frames(const Problem& problem, const std::filesystem::path& folder) : problem_(problem), run_(folder) {}

    [[nodiscard]] std::int64_t count() const { return run_.frames(); }
    [[nodiscard]] double end() { return count() > 0 ? run_.frame(count() - 1).time : 0; } ///< s
    [[nodiscard]] Poses poses(std::int64_t k) {
        const io::Frame frame = run_.frame(k);
        const io::RunScene& scene = run_.scene();
        if (frame.position.size() != problem_.scene.bodies.size())
            throw IoError(run_.folder().string() + ": has the frames of another scene");
        Poses out{frame.time, {}, {}};
        for (const std::size_t i : problem_.moving) {
            const Vec3& c = scene.shapes[static_cast<std::size_t>(scene.bodies[i].shape)].center_of_mass;
            out.rotation.push_back(frame.rotation[i]);
            out.center.push_back(frame.position[i] + rotate(frame.rotation[i], c));
        }
        return out;
    }

  private:
    const Problem& problem_;
    io::RunReader run_;
};

/// The poses of a run at times that only grow; between frames on straight lines and arcs.
class Track {
  public:
    Track(const Problem& problem, const std::filesystem::path& folder, double tolerance)
        : frames_(problem, folder), tolerance_(tolerance) {
        if (frames_.count() > 0) after_ = frames_.poses(next_++);
    }
    /// Nothing beyond the last frame.
    [[nodiscard]] std::optional<Poses> at(double time) {
        while (after_ && after_->time < time - tolerance_) {
            before_ = std::move(after_);
            after_.reset();
            if (next_ < frames_.count()) after_ = frames_.poses(next_++);
        }
        if (!after_ || !before_ || after_->time <= time + tolerance_) return after_;
        const double part = (time - before_->time) / (after_->time - before_->time);
        Poses out{time, before_->center, before_->rotation};
        for (std::size_t i = 0; i < out.center.size(); ++i) {
            out.center[i] += part * (after_->center[i] - before_->center[i]);
            const Vec3 turn = rotation_vector(after_->rotation[i] * conjugate(before_->rotation[i]));
            out.rotation[i] = rotation_from_vector(part * turn) * before_->rotation[i];
        }
        return out;
    }

  private:
    Frames frames_;
    double tolerance_;
    std::int64_t next_ = 0;
    std::optional<Poses> before_, after_;
};

void compare_poses(Frames& run, Track& reference, std::vector<double>& values) {
    double far = 0, turned = 0;
    std::size_t count = 0;
    for (std::int64_t k = 1; k < run.count(); ++k) {
        const Poses mine = run.poses(k);
        const std::optional<Poses> truth = reference.at(mine.time);
        if (!truth) break;
        for (std::size_t i = 0; i < mine.center.size(); ++i, ++count) {
            far += length_sq(mine.center[i] - truth->center[i]);
            turned += length_sq(rotation_vector(conjugate(truth->rotation[i]) * mine.rotation[i]));
        }
    }
    if (count == 0) return;
    values[position] = std::sqrt(far / static_cast<double>(count));
    values[rotation] = std::sqrt(turned / static_cast<double>(count));
}

double pile_height(const Problem& problem, const Poses& poses) {
    double mean = 0, lowest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < problem.moving.size(); ++k) {
        const std::size_t i = problem.moving[k];
        const Shape& shape = problem.scene.shapes[static_cast<std::size_t>(problem.scene.bodies[i].shape)];
        mean += problem.mass_of(i) / problem.mass * dot(poses.center[k], problem.up);
        const Vec3 down = rotate(conjugate(poses.rotation[k]), problem.up); // in the body's axes
        double least = std::numeric_limits<double>::infinity();
        for (const Vec3& v : shape.mesh.vertices) least = std::min(least, dot(v - shape.center, down));
        lowest = std::min(lowest, dot(poses.center[k], problem.up) + least);
    }
    return mean - lowest;
}

/// Height and creep, from the frames of the end.
void measure_end(const Problem& problem, Frames& run, std::vector<double>& values) {
    if (run.count() < 2) return;
    const Poses last = run.poses(run.count() - 1);
    std::int64_t first = run.count() - 2;
    double heights = pile_height(problem, last);
    Poses begin = run.poses(first);
    for (;; --first) {
        heights += pile_height(problem, begin);
        if (first == 0) break;
        Poses earlier = run.poses(first - 1);
        if (earlier.time < kEnd * last.time - kSameTime * last.time) break;
        begin = std::move(earlier);
    }
    double moved = 0;
    for (std::size_t i = 0; i < last.center.size(); ++i) moved += length(last.center[i] - begin.center[i]);
    values[height] = heights / static_cast<double>(run.count() - first);
    values[creep] = moved / static_cast<double>(last.center.size()) / (last.time - begin.time);
}

/// From steps.csv: the run's cost, energy, residual, time to rest.
double measure_steps(const Problem& problem, const std::filesystem::path& folder, std::vector<double>& values) {
    const report::StepColumns steps = report::read_step_columns(io::read_text(folder / io::kStepsCsv));
    const auto mean = [](std::span<const double> part) {
        return part.empty() ? kNone : std::accumulate(part.begin(), part.end(), 0.0) / static_cast<double>(part.size());
    };
    const std::span<const double> times = steps.column("time"), energies = steps.column("energy");
    if (!times.empty() && energies.size() == times.size()) {
        const auto end = std::lower_bound(times.begin(), times.end(), (kEnd - kSameTime) * times.back());
        values[energy] = problem.start_energy - mean(energies.subspan(static_cast<std::size_t>(end - times.begin())));
    }
    values[residual] = mean(steps.column("residual"));
    if (problem.gravity > 0)
        values[rest_time] = time_to_rest(times, steps.column("kinetic_energy"),
                                         problem.mass * problem.gravity * problem.size / kSizePerRestDistance);
    const std::vector<double>& ms = steps.column("total_ms");
    return std::accumulate(ms.begin(), ms.end(), 0.0) / 1000;
}

/// Contact forces against weight, from the impulses of the last step, which its checkpoint holds.
void measure_forces(const Problem& problem, const SceneDescription& scene, const std::filesystem::path& folder,
                    std::vector<double>& values) {
    if (problem.gravity == 0) return;
    const std::optional<io::Checkpoint> end = io::read_last_checkpoint(folder);
    if (!end) return;
    const World world(scene, end->state, folder.string(), {1, Executor::serial});
    const double weight_time = problem.gravity * scene.settings.time_step; // impulse of a weight per mass
    double held_up = 0;
    std::vector<double> loads(scene.bodies.size(), 0.0);
    const auto moves = [&](std::int32_t body) {
        return scene.bodies[static_cast<std::size_t>(body)].type == BodyType::dynamic;
    };
    for (const ContactState& c : world.contacts()) {
        for (const std::int32_t body : {c.body_a, c.body_b})
            loads[static_cast<std::size_t>(body)] += std::abs(dot(c.impulse, c.normal));
        if (moves(c.body_a) != moves(c.body_b)) held_up += (moves(c.body_b) ? 1 : -1) * dot(c.impulse, problem.up);
    }
    double sum = 0;
    for (const std::size_t i : problem.moving) sum += loads[i] / (problem.mass_of(i) * weight_time);
    values[support] = held_up / (problem.mass * weight_time);
    values[load] = sum / static_cast<double>(problem.moving.size());
}

} // namespace

Problem::Problem(const SceneDescription& start) : scene(build_scene(start)) {
    gravity = length(scene.gravity);
    if (gravity > 0) up = -scene.gravity / gravity;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyDescription& body = scene.bodies[i];
        if (body.type != BodyType::dynamic) continue;
        moving.push_back(i);
        const Shape& shape = scene.shapes[static_cast<std::size_t>(body.shape)];
        const Vec3 spin = rotate(conjugate(body.rotation), body.angular_velocity);
        mass += shape.mass->mass;
        size += 2 * shape.sphere.radius;
        start_energy += 0.5 * shape.mass->mass * length_sq(body.velocity) +
                        0.5 * dot(spin, shape.mass->inertia * spin) -
                        shape.mass->mass * dot(scene.gravity, world_center(scene, body));
    }
    if (moving.empty()) throw InputError("sweep: no body of the scene can move: there is nothing to compare");
    size /= static_cast<double>(moving.size());
}

double Problem::mass_of(std::size_t body) const {
    return scene.shapes[static_cast<std::size_t>(scene.bodies[body].shape)].mass->mass;
}

double Problem::scale_of(std::size_t metric, double duration) const {
    const double time = gravity > 0 ? std::sqrt(size / gravity) : duration;
    switch (metric) {
    case position:
    case height: return size;
    case energy: return mass * size * size / (time * time);
    case creep:
    case residual: return size / time;
    case rest_time: return time;
    default: return 1;
    }
}

Measures measure(const Problem& problem, const SceneDescription& scene, const std::filesystem::path& folder,
                 const std::filesystem::path& reference) {
    Measures out{0, std::vector<double>(kMetrics, kNone)};
    out.cost = measure_steps(problem, folder, out.values);
    Frames run(problem, folder);
    measure_end(problem, run, out.values);
    measure_forces(problem, scene, folder, out.values);
    if (!reference.empty()) {
        Track truth(problem, reference, kSameTime * run.end());
        compare_poses(run, truth, out.values);
    }
    return out;
}

double time_to_rest(std::span<const double> times, std::span<const double> kinetic, double threshold) {
    if (times.size() != kinetic.size()) return kNone;
    std::size_t resting = kinetic.size();
    while (resting > 0 && kinetic[resting - 1] <= threshold) --resting;
    if (resting == times.size()) return kNone;
    return resting == 0 ? 0 : times[resting];
}

} // namespace flotilla::sweep
