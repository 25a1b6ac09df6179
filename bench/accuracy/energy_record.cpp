// SPDX-License-Identifier: MIT
#include "energy_record.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>

#include <flotilla/world.hpp>

#include "base/rotation.hpp"
#include "base/vec3.hpp"
#include "scene/scene.hpp"

namespace flotilla::survey {
namespace {

// What a last resort took away is read from reports that say it.
template <class Report>
std::int64_t corrections_of(const Report& report) {
    if constexpr (requires { report.energy_corrections; })
        return static_cast<std::int64_t>(report.energy_corrections);
    else
        return 0;
}
template <class Report>
double removed_by(const Report& report) {
    if constexpr (requires { report.energy_removed; })
        return static_cast<double>(report.energy_removed);
    else
        return 0;
}

/// Sums over the dynamic bodies at the start.
struct Start {
    double kinetic = 0, potential = 0;       ///< J
    double potential_terms = 0;              ///< J, sum of the terms' magnitudes: what rounding is relative to
    double mass = 0;                         ///< kg
    double reach = 0;                        ///< m, of the bodies from the origin
    double size_energy = 0, rest_energy = 0; ///< J, sum m |g| size and m |g| d_rest
    Vec3 momentum, angular_momentum;
};

Start measure_start(const Scene& scene, const World& world) {
    Start s;
    for (std::size_t i = 0; i < world.size(); ++i) {
        if (scene.bodies[i].type != BodyType::dynamic) continue;
        const Shape& shape = scene.shapes[static_cast<std::size_t>(scene.bodies[i].shape)];
        const BodyState body = world.body(i);
        const double m = shape.mass->mass, g = length(scene.gravity), size = 2 * shape.radius;
        const Vec3 spin =
            rotate(body.rotation, shape.mass->inertia * rotate(conjugate(body.rotation), body.angular_velocity));
        const Vec3 orbit = cross(body.center_of_mass, m * body.velocity);
        s.kinetic += 0.5 * (m * length_sq(body.velocity) + dot(spin, body.angular_velocity));
        s.potential -= m * dot(scene.gravity, body.center_of_mass);
        s.potential_terms += std::abs(m * dot(scene.gravity, body.center_of_mass));
        s.mass += m;
        s.momentum += m * body.velocity;
        s.reach = std::max(s.reach, length(body.center_of_mass) + shape.radius);
        s.angular_momentum += orbit + spin;
        s.size_energy += m * g * size;
        s.rest_energy +=
            m * g * (scene.settings.rest_distance > 0 ? scene.settings.rest_distance : size / kSizePerRestDistance);
    }
    return s;
}

/// Follows the energy from step to step.
class EnergyWatch {
  public:
    explicit EnergyWatch(const Start& start)
        : allowance_(start.rest_energy + kRounding * start.potential_terms),
          start_(start.kinetic + start.potential),
          lowest_(start_),
          highest_(start_),
          most_kinetic_(start.kinetic),
          low_potential_(start.potential),
          high_potential_(start.potential) {}

    void see(const StepReport& report, EnergyRecord& record) {
        const double potential = report.energy - report.kinetic_energy;
        most_kinetic_ = std::max(most_kinetic_, report.kinetic_energy);
        low_potential_ = std::min(low_potential_, potential);
        high_potential_ = std::max(high_potential_, potential);
        highest_ = std::max(highest_, report.energy);
        const double beyond = report.energy - lowest_ - allowance_;
        lowest_ = std::min(lowest_, report.energy);
        if (beyond > 0 && beyond / scale() > record.rise) {
            record.rise = beyond / scale();
            record.rise_joule = beyond;
            record.rise_step = report.step;
        }
    }

    [[nodiscard]] double scale() const { return std::max(most_kinetic_, high_potential_ - low_potential_); }
    [[nodiscard]] double allowance() const { return allowance_; }
    [[nodiscard]] double gained() const { return highest_ - start_; }

  private:
    /// A sum of a dozen terms and its difference to another, with room to spare.
    static constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();

    double allowance_, start_, lowest_, highest_, most_kinetic_, low_potential_, high_potential_;
};

double share(double part, double whole) { return part > 0 ? part / whole : 0; }

/// Drifts relative to what the energy could carry: sum m |v| <= sqrt(2 M E).
void watch_momentum(const Start& start, const Vec3& gravity, const StepReport& report, EnergyRecord& record) {
    if (!record.free) return;
    const Vec3 fall = start.mass * report.time * gravity;
    const double carried = std::sqrt(2 * start.mass * start.kinetic);
    const double drift = length(report.momentum - start.momentum - fall);
    record.momentum_drift = std::max(record.momentum_drift, share(drift, carried + length(fall)));
    if (record.gravity > 0) return;
    const double turned = length(report.angular_momentum - start.angular_momentum);
    record.angular_drift = std::max(record.angular_drift, share(turned, carried * start.reach));
}

void add_counters(const StepReport& report, EnergyRecord& record) {
    ++record.steps;
    record.collisions += report.collisions;
    record.contacts += report.contacts;
    record.merges += report.merges;
    record.rung_changes += report.rung_changes;
    record.held += report.held;
    record.warnings |= report.warnings;
    record.corrections += corrections_of(report);
    record.removed += removed_by(report);
}

void describe(const SceneDescription& scene, EnergyRecord& record) {
    bool infinite = false;
    for (const BodyDescription& body : scene.bodies) {
        record.bodies += body.type == BodyType::dynamic ? 1 : 0;
        record.scripted |= body.type == BodyType::kinematic;
        infinite |= body.type != BodyType::dynamic;
    }
    record.free = !infinite;
    record.time_step = scene.settings.time_step;
    record.gravity = length(scene.gravity);
    record.friction = scene.settings.friction;
    record.restitution = scene.settings.restitution;
}

void run(const SceneDescription& description, std::int64_t steps, double max_seconds, EnergyRecord& record) {
    using Clock = std::chrono::steady_clock;
    WorldOptions options;
    options.executor = Executor::serial;
    World world(description, "scene", options);
    const Start start = measure_start(build_scene(description), world);
    EnergyWatch watch(start);
    const Clock::time_point began = Clock::now();
    while (record.steps < steps && record.seconds < max_seconds && record.failure[0] == '\0') {
        const StepReport report = world.step();
        add_counters(report, record);
        if (!std::isfinite(report.energy)) {
            set_text(record.failure, "the energy is no number after step " + std::to_string(report.step));
            record.rise = std::numeric_limits<double>::infinity();
        }
        watch.see(report, record);
        watch_momentum(start, description.gravity, report, record);
        record.scale = watch.scale();
        record.seconds = std::chrono::duration<double>(Clock::now() - began).count();
    }
    record.cut = record.steps < steps && record.failure[0] == '\0';
    record.allowance = watch.allowance();
    record.growth = share(watch.gained(), start.kinetic + start.size_energy);
}

} // namespace

void record_energy(const SceneDescription& scene, std::int64_t steps, double max_seconds, EnergyRecord& record) {
    describe(scene, record);
    try {
        run(scene, steps, max_seconds, record);
    } catch (const std::exception& error) {
        set_text(record.failure, error.what());
    }
}

} // namespace flotilla::survey
