// SPDX-License-Identifier: MIT
#include <flotilla/plan.hpp>

#include <algorithm>
#include <cstdio>
#include <limits>

#include "base/text.hpp"
#include "base/vec3.hpp"
#include "io/run_folder.hpp"
#include "state/build_model.hpp"

namespace flotilla {
namespace {

/// Four digits: for people.
std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    void add(double x) { low = std::min(low, x), high = std::max(high, x); }
    [[nodiscard]] bool empty() const { return low > high; }
    [[nodiscard]] std::string text(const std::string& unit) const {
        return low == high ? number(low) + " " + unit : number(low) + " to " + number(high) + " " + unit;
    }
};

class Planner {
  public:
    explicit Planner(const Scene& scene)
        : scene_(scene), model_(make_model(scene)), state_(initial_state(scene, model_)) {}

    std::vector<PlanLine> run() {
        bodies();
        masses();
        lengths();
        speeds();
        contact_law();
        paths();
        rest();
        frames();
        changed_settings();
        for (const std::string& warning : scene_.warnings) add("warning", warning);
        return std::move(lines_);
    }

  private:
    void add(std::string topic, std::string text) { lines_.push_back({std::move(topic), std::move(text)}); }
    [[nodiscard]] std::size_t count(BodyType type) const {
        return static_cast<std::size_t>(
            std::count_if(model_.bodies.begin(), model_.bodies.end(), [&](const Body& b) { return b.type == type; }));
    }

    void bodies() {
        std::size_t triangles = 0, stored = 0;
        for (std::size_t i = 0; i < model_.size(); ++i) triangles += model_.shape_of(i).mesh.triangles.size();
        for (const RigidShape& shape : model_.shapes) stored += shape.mesh.triangles.size();
        add("bodies", std::to_string(count(BodyType::dynamic)) + " dynamic, " + std::to_string(count(BodyType::fixed)) +
                          " static, " + std::to_string(count(BodyType::kinematic)) + " kinematic");
        add("shapes", std::to_string(model_.shapes.size()) + " meshes with " + std::to_string(stored) +
                          " triangles are stored once for bodies that show " + std::to_string(triangles));
    }
    void masses() {
        Range mass;
        for (const Body& b : model_.bodies)
            if (b.dynamic()) mass.add(b.mass);
        if (!mass.empty()) add("masses", mass.text("kg") + ", ratio " + number(mass.high / mass.low));
    }
    void lengths() {
        Range rest, proximity, separation;
        for (std::size_t i = 0; i < model_.size(); ++i) {
            if (!model_.bodies[i].dynamic()) continue;
            const auto body = static_cast<std::int32_t>(i);
            const PairLengths l = pair_lengths(model_, state_, body, body);
            rest.add(l.rest), proximity.add(l.proximity), separation.add(l.separation);
        }
        if (rest.empty()) return;
        add("lengths", "rest distance " + rest.text("m") + ", proximity " + proximity.text("m") +
                           ", certified separation " + separation.text("m") + ", by the smaller body of a pair");
    }
    void speeds() {
        const double dt = model_.settings.time_step, gravity = length(model_.gravity) * dt;
        Range size, way;
        for (std::size_t i = 0; i < model_.size(); ++i) {
            if (!model_.bodies[i].dynamic()) continue;
            size.add(model_.bodies[i].size);
            way.add(dt * length(state_.motion[i].velocity));
        }
        if (size.empty()) return;
        add("time step", number(dt) + " s; gravity adds " + number(gravity) + " m/s in a step");
        add("first step", "bodies of " + size.text("m") + " move by up to " + number(way.high) +
                              " m: contact on the way is found continuously, whatever the speed");
    }
    void contact_law() {
        Range friction, restitution;
        for (const Body& b : model_.bodies) friction.add(b.friction), restitution.add(b.restitution);
        if (friction.empty()) return;
        add("friction", friction.high == 0 ? "none: contacts push and do not hold"
                                           : friction.text("") + "(geometric mean of a pair); friction " +
                                                 setting_value(model_.settings, "tangents"));
        add("restitution",
            restitution.high == 0 ? "none: collisions are inelastic" : restitution.text("") + "(the larger of a pair)");
    }
    void paths() {
        add("paths", model_.settings.trajectory == Trajectory::rigid
                         ? "vertices turn with their bodies within a step; so does the certificate"
                         : "vertices move along straight lines within a step (trajectory: rigid lets them turn)");
        double last = 0;
        for (const Body& b : model_.bodies)
            if (!b.keyframes.empty()) last = std::max(last, b.keyframes.back().time);
        if (count(BodyType::kinematic) > 0)
            add("scripts", "the last keyframe is at " + number(last) + " s; a script that would crush a body " +
                               (model_.settings.unsatisfiable_script == UnsatisfiableScript::hold ? "is held back"
                                                                                                  : "is an error"));
    }
    void rest() {
        add("rest", model_.settings.sleeping
                        ? "islands that rest for twelve steps sleep until something moves near them"
                        : "no body sleeps: every contact is solved in every step");
    }
    void frames() {
        add("output", "a frame takes " + std::to_string(io::kFrameBytesPerBody * model_.size()) + " bytes");
    }
    void changed_settings() {
        std::string text;
        for (const SettingInfo& info : list_settings()) {
            const std::string value = setting_value(model_.settings, info.key);
            if (value == info.default_value) continue;
            text += (text.empty() ? "" : ", ") + std::string(info.key) + " = " + value;
        }
        add("settings", text.empty() ? "all at their defaults" : text);
    }

    const Scene& scene_;
    Model model_;
    State state_;
    std::vector<PlanLine> lines_;
};

} // namespace

std::vector<PlanLine> plan_scene(const SceneDescription& scene, const std::string& source) {
    const Scene built = build_scene(scene, source);
    return Planner(built).run();
}

} // namespace flotilla
