// SPDX-License-Identifier: MIT
#include "extremes/check.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>
#include <vector>

#include <flotilla/error.hpp>

#include "base/text.hpp"
#include "scene/initial_overlap.hpp"
#include "step/audited_run.hpp"

namespace flotilla::extremes {
namespace {

constexpr double kRise = 1e-6, kDrift = 1e-9; // shares, far above the rounding of a step of a few bodies
constexpr double kRoundOff = 0x1p-53;

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

bool finite(const State& state) {
    for (std::size_t i = 0; i < state.pose.size(); ++i) {
        const Quat& q = state.pose[i].rotation;
        if (!is_finite(state.pose[i].com) || !is_finite(state.pose[i].origin) || !is_finite(state.motion[i].velocity) ||
            !is_finite(state.motion[i].momentum) || !std::isfinite(q.w + q.x + q.y + q.z))
            return false;
    }
    return true;
}

/// Energy and momentum of a run, step by step.
class Account {
  public:
    Account(const SceneDescription& scene, const Model& model) {
        for (const BodyDescription& b : scene.bodies) {
            scripted_ = scripted_ || b.type == BodyType::kinematic;
            alone_ = alone_ && b.type == BodyType::dynamic;
        }
        gravity_ = model.gravity;
        most_gravity_ = length(gravity_);
        for (std::size_t i = 0; i < model.bodies.size(); ++i) {
            if (!model.bodies[i].dynamic()) continue;
            mass_ += model.bodies[i].mass;
            at_rest_distance_ += model.bodies[i].mass * body_lengths(model, i).rest;
        }
    }

    /// Before a step in which gravity is another: what bodies own where they are changes with it, and is no rise.
    void change_gravity(const Vec3& gravity, const State& state, const Model& model) {
        for (std::size_t i = 0; i < model.bodies.size(); ++i)
            if (model.bodies[i].dynamic()) before_ -= model.bodies[i].mass * dot(gravity - gravity_, state.pose[i].com);
        gravity_ = gravity;
        most_gravity_ = std::max(most_gravity_, length(gravity));
    }

    void add(const StepReport& r, const State& state, const Model& model) {
        double moving = 0, farthest = 0;
        for (std::size_t i = 0; i < model.bodies.size(); ++i) {
            if (!model.bodies[i].dynamic()) continue;
            moving += model.bodies[i].mass * length(state.motion[i].velocity);
            farthest = std::max(farthest, max_component(abs(state.pose[i].com)));
        }
        largest_kinetic_ = std::max(largest_kinetic_, r.kinetic_energy);
        largest_moving_ = std::max(largest_moving_, moving);
        // Places are rounded, and so is the potential energy that goes by them.
        const double rounding = 64 * kRoundOff * mass_ * most_gravity_ * farthest;
        const double owned = r.energy - r.lift;
        if (steps_ > 0 && !scripted_) {
            const double most_lift = most_gravity_ * at_rest_distance_;
            const double scale = std::max({largest_kinetic_, most_lift, 1e-300});
            joules = owned - before_ - rounding;
            rise = std::max(rise, joules / scale);
        }
        events_ = events_ || r.merges + r.rung_changes + r.held > 0;
        const Vec3 pulled = momentum_ + mass_ * model.settings.time_step * gravity_;
        if (steps_ > 0 && alone_ && !events_ && largest_moving_ > 0)
            drift = std::max(drift, length(r.momentum - pulled) / largest_moving_);
        before_ = owned;
        momentum_ = r.momentum;
        ++steps_;
    }

    double rise = 0, drift = 0;
    double joules = 0; ///< of the last step

  private:
    bool scripted_ = false, alone_ = true, events_ = false;
    double mass_ = 0, at_rest_distance_ = 0, most_gravity_ = 0; ///< kg, sum of masses times rest distances, m/s^2
    double before_ = 0, largest_kinetic_ = 0, largest_moving_ = 0;
    Vec3 gravity_, momentum_;
    int steps_ = 0;
};

Outcome broken(Outcome out, const std::string& what, int step) {
    out.verdict = Verdict::broken;
    out.message = what + " in step " + std::to_string(step);
    return out;
}

/// The same scene run again, on one thread and on three.
class Repeats {
  public:
    explicit Repeats(const Model& model, const State& start) : timed_(model, start), three_(model, start, kThree) {}

    void set_gravity(const Vec3& gravity) {
        timed_.set_gravity(gravity);
        three_.set_gravity(gravity);
    }

    /// Empty where both end the step with this hash.
    std::string step(std::uint64_t hash, Outcome& out) {
        const double start = processor_seconds();
        const std::uint64_t again = timed_.step().state_hash;
        const double seconds = processor_seconds() - start;
        out.seconds += seconds;
        out.slowest_step = std::max(out.slowest_step, seconds);
        if (again != hash) return "another hash when run again";
        return three_.step().state_hash == hash ? "" : "another hash on 3 threads";
    }

  private:
    inline static const StepperOptions kThree{.team = {.threads = 3}};
    Stepper timed_, three_;
};

Outcome run(const SceneDescription& description, const CheckOptions& options) {
    Outcome out;
    const Scene scene = build_scene(description);
    if (const auto overlaps = find_initial_overlaps(scene).movable; !overlaps.empty()) {
        const auto name = [&](std::int32_t i) { return scene.bodies[static_cast<std::size_t>(i)].name; };
        return {Verdict::refused, name(overlaps[0].a) + " and " + name(overlaps[0].b) + " intersect at t = 0"};
    }
    scenario::AuditedRun audited(description);
    const Model model = make_model(scene);
    std::optional<Repeats> repeats;
    if (options.repeated) repeats.emplace(model, initial_state(scene, model));
    Account account(description, model);
    bool held = false;
    const double began = processor_seconds();
    for (int n = 1; n <= options.steps && processor_seconds() - began < options.seconds; ++n) {
        if (options.gravity) {
            const Vec3 gravity = options.gravity(model.gravity, n);
            account.change_gravity(gravity, audited.stepper().state(), model);
            audited.set_gravity(gravity);
            if (repeats) repeats->set_gravity(gravity);
        }
        StepReport report;
        try {
            report = audited.step();
        } catch (const BlockedScripts&) { // the scene asks for an end of the run then
            held = true;
            break;
        }
        out.steps = n;
        if (audited.findings > 0) return broken(out, "not proved free of intersections", n);
        if (!finite(audited.stepper().state())) return broken(out, "not finite", n);
        if (repeats)
            if (const std::string fault = repeats->step(report.state_hash, out); !fault.empty())
                return broken(out, fault, n);
        account.add(report, audited.stepper().state(), model);
        out.rise = account.rise;
        out.drift = account.drift;
        if (out.rise > kRise) return broken(out, "energy rises by " + to_text(account.joules) + " J", n);
        if (out.drift > kDrift) return broken(out, "momentum changes by " + to_text(out.drift) + " of it", n);
        held = held || report.held > 0 || (report.warnings & kScriptDelayed) != 0;
    }
    if (held) out.verdict = Verdict::held;
    return out;
}

} // namespace

Outcome run_scene(const SceneDescription& scene, const CheckOptions& options) {
    try {
        return run(scene, options);
    } catch (const InputError& error) {
        return {Verdict::refused, error.what()};
    } catch (const std::exception& error) {
        return {Verdict::broken, std::string("an exception: ") + error.what()};
    }
}

Outcome run_cell(const Cell& cell, int steps) {
    return run_scene(cell.scene(), {.steps = steps, .gravity = cell.gravity_of_step()});
}

} // namespace flotilla::extremes
