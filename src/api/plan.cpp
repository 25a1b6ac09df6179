// SPDX-License-Identifier: MIT
#include <flotilla/plan.hpp>

#include <algorithm>
#include <cstdio>
#include <limits>

#include <flotilla/world.hpp>

#include "base/floating_point.hpp"
#include "base/text.hpp"
#include "base/vec3.hpp"
#include "io/frame_size.hpp"
#include "state/build_model.hpp"
#include "state/loads.hpp"
#include "static_contact/contact_packets.hpp"
#include "step/stepper.hpp"

namespace flotilla {
namespace {

/// Four digits: for people.
std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

std::size_t bytes_of(const TriangleMesh& mesh) {
    return mesh.vertices.size() * sizeof(mesh.vertices[0]) + mesh.triangles.size() * sizeof(mesh.triangles[0]);
}

struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    void add(double x) { low = std::min(low, x), high = std::max(high, x); }
    [[nodiscard]] bool empty() const { return low > high; }
    [[nodiscard]] std::string text(const std::string& unit) const {
        return low == high ? number(low) + " " + unit : number(low) + " to " + number(high) + " " + unit;
    }
};

/// What happens before anything touches.
struct FreeFlight {
    std::int64_t first_contact = 0; ///< step; 0: none was found
    double way =
        0; ///< m, longest of a body in the last step without contact, or what gravity and its velocity give in step 1
    bool intersecting = false; ///< at the start: there are no steps
    std::int64_t steps = 0;    ///< run, with the one of the first contact
    std::int64_t calm = 0;     ///< of these, without an impulse of stage 1
};

constexpr std::int64_t kLongestFlight = 240; // steps, 10 s of the default time step

double longest_way(const World& world, std::vector<Vec3>& places) {
    double way = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Vec3 now = world.body(i).center_of_mass;
        way = std::max(way, length(now - places[i]));
        places[i] = now;
    }
    return way;
}

FreeFlight fly(const SceneDescription& scene, const std::string& source, double first_way) {
    FreeFlight flight{.way = first_way};
    try {
        World world(scene, source);
        std::vector<Vec3> places(scene.bodies.size());
        longest_way(world, places);
        for (std::int64_t step = 1; step <= kLongestFlight; ++step) {
            StepReport report;
            try {
                report = world.step();
            } catch (const ScriptError&) { // touches, and does not give way
                report.contacts = 1;
            }
            ++flight.steps;
            flight.calm += report.collisions == 0 ? 1 : 0;
            if (report.collisions > 0 || report.contacts > 0) {
                flight.first_contact = step;
                break;
            }
            flight.way = longest_way(world, places);
        }
    } catch (const OverlapError&) {
        flight.intersecting = true;
    }
    return flight;
}

const char* script_policy(UnsatisfiableScript policy) {
    switch (policy) {
    case UnsatisfiableScript::follow: return "is held back and catches up as soon as it can";
    case UnsatisfiableScript::error: return "is an error";
    case UnsatisfiableScript::hold: break;
    }
    return "is held back, and comes later";
}

class Planner {
  public:
    Planner(const SceneDescription& description, const Scene& scene, const std::string& source)
        : description_(description),
          source_(source),
          scene_(scene),
          model_(make_model(scene)),
          state_(initial_state(scene, model_)) {}

    std::vector<PlanLine> run() {
        bodies();
        masses();
        locks();
        loads();
        lengths();
        speeds();
        contact_law();
        paths();
        rest();
        savings();
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
    /// Names of the bodies that `says` says something of, with that.
    template <class Says>
    [[nodiscard]] std::string named(Says&& says) const {
        constexpr std::size_t kMostNamed = 8;
        std::string text;
        std::size_t found = 0;
        for (const BodyDescription& body : scene_.bodies) {
            const std::string said = says(body);
            if (!said.empty() && ++found <= kMostNamed)
                text += (text.empty() ? "" : ", ") + in_quotes(body.name) + " " + said;
        }
        return found <= kMostNamed ? text : text + " and " + std::to_string(found - kMostNamed) + " more";
    }
    void locks() {
        const std::string text = named([](const BodyDescription& body) {
            std::string axes;
            for (std::size_t k = 0; k < 3; ++k)
                if (body.locked_translation[k]) axes.append(axes.empty() ? "" : " ").append(1, "xyz"[k]);
            for (std::size_t k = 0; k < 3; ++k)
                if (body.locked_rotation[k]) axes.append(axes.empty() ? "r" : " r").append(1, "xyz"[k]);
            return axes.empty() ? axes : axes.insert(0, 1, '(').append(1, ')');
        });
        if (!text.empty()) add("locked", text + ": no inverse mass along and about these axes, exactly");
    }
    void loads() {
        const std::string text = named([](const BodyDescription& body) {
            std::string loads;
            if (body.force != Vec3{}) loads = number(length(body.force)) + " N";
            if (body.torque != Vec3{}) loads += (loads.empty() ? "" : " and ") + number(length(body.torque)) + " N m";
            return loads;
        });
        if (!text.empty()) add("loads", text + ", all the time");
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
        const int substeps = model_.settings.substeps;
        const double dt = model_.settings.time_step, inner = dt / substeps, gravity = length(model_.gravity) * inner;
        Range size, first_way;
        for (std::size_t i = 0; i < model_.size(); ++i) {
            if (!model_.bodies[i].dynamic()) continue;
            size.add(model_.bodies[i].size);
            first_way.add(dt * length(state_.motion[i].velocity + 0.5 * dt * acceleration(model_, i)));
        }
        if (size.empty()) return;
        const std::string parts = substeps == 1 ? "" : " of " + std::to_string(substeps) + " inner ones";
        add("time step", number(dt) + " s" + (substeps == 1 ? "" : ", a step" + parts) + "; gravity adds " +
                             number(gravity) + " m/s in " + (substeps == 1 ? "a step" : "one of these"));
        flight_ = fly(description_, source_, first_way.high);
        const FreeFlight& flight = flight_;
        const std::string way = " by up to " + number(flight.way) + " m";
        std::string text = "bodies of " + size.text("m");
        if (flight.intersecting)
            text += " would move" + way + " in the first step, but some intersect at t = 0";
        else if (flight.first_contact == 0)
            text += " touch nothing in " + std::to_string(kLongestFlight) + " steps and move" + way + " in the last";
        else if (flight.first_contact == 1)
            text += " touch in the first step, in which they are to move" + way;
        else
            text +=
                " move" + way + " in step " + std::to_string(flight.first_contact - 1) + ", the last before they touch";
        add("impact", text + ": contact on the way is found continuously, whatever the speed");
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
                               script_policy(model_.settings.unsatisfiable_script));
    }
    void rest() {
        add("rest", model_.settings.sleeping ? std::string("islands that rest for at least twelve ") +
                                                   (model_.settings.substeps > 1 ? "inner " : "") +
                                                   "steps sleep until something moves near them"
                                             : "no body sleeps: every contact is solved in every step");
    }
    /// What is left out because the scene does not need it: Savings, and what State, Scene and the settings leave out
    /// by themselves.
    void savings() {
        const std::size_t dynamic = count(BodyType::dynamic);
        const auto bodies = [](std::size_t n) { return std::to_string(n) + (n == 1 ? " body" : " bodies"); };
        const auto saved = [&](const std::string& text) { add("saved", text); };
        std::size_t shown = 0, stored = 0;
        for (std::size_t i = 0; i < model_.size(); ++i) shown += bytes_of(model_.shape_of(i).mesh);
        for (const RigidShape& shape : model_.shapes) stored += bytes_of(shape.mesh);
        if (stored < shown)
            saved(bodies(model_.size()) + " on " + std::to_string(model_.shapes.size()) + " meshes: " +
                  std::to_string(stored) + " bytes of vertices and triangles in place of " + std::to_string(shown));
        if (dynamic == 0) return;
        if (std::all_of(model_.bodies.begin(), model_.bodies.end(), [](const Body& b) { return b.friction == 0; }))
            saved("no friction: a contact has 1 row in place of 3, " +
                  std::to_string(sizeof(NormalRow) / kPacketLanes) + " bytes in place of " +
                  std::to_string(sizeof(PacketRow) / kPacketLanes));
        if (model_.settings.trajectory == Trajectory::linear)
            saved("straight paths: 1 segment a body and step in place of up to 64");
        if (model_.settings.sleeping)
            saved("rest: 0 pairs, 0 contacts and 0 rows for islands of up to " + bodies(dynamic) + " that sleep");
        if (!flight_.intersecting) savings_of_steps();
    }
    void savings_of_steps() {
        const auto saved = [&](const std::string& text) { add("saved", text); };
        const auto of = [](auto part, auto whole, const char* what) {
            return std::to_string(part) + " of " + std::to_string(whole) + " " + what;
        };
        if (flight_.calm > 0)
            saved("no impulse needed: no collision pass in " +
                  of(flight_.calm, flight_.steps, "steps up to the first contact"));
        Stepper stepper(model_, state_);
        try {
            (void)stepper.step();
        } catch (const BlockedScripts&) { // what is counted is known by then
        }
        if (stepper.lone_bodies() > 0)
            saved("ballistic: " + of(stepper.lone_bodies(), count(BodyType::dynamic), "bodies") +
                  " cost their bounds alone in the first step");
        std::size_t triangles = 0, large = 0;
        for (const std::int32_t i : stepper.large_still()) {
            triangles += model_.shape_of(static_cast<std::size_t>(i)).mesh.triangles.size();
            ++large;
        }
        if (large > 0)
            saved("not rasterized: " + of(large, model_.size() - count(BodyType::dynamic), "static meshes") + ", " +
                  std::to_string(triangles) + " triangles, asked by their own trees");
        if (!stepper.looks_ahead())
            saved(
                "falls in a step are shorter than contacts are seen: 2 solves of contacts a step in place of up to 5");
        if (!stepper.has_scripts()) saved("no scripts: none of their code in a step, no copy of the state to undo one");
    }
    void frames() {
        add("output", "a frame takes " +
                          std::to_string(io::frame_bytes_per_body(model_.settings.substeps) * model_.size()) +
                          " bytes");
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

    const SceneDescription& description_;
    const std::string& source_;
    const Scene& scene_;
    Model model_;
    State state_;
    FreeFlight flight_;
    std::vector<PlanLine> lines_;
};

} // namespace

std::vector<PlanLine> plan_scene(const SceneDescription& scene, const std::string& source) {
    const DefaultFloatingPoint environment;
    const Scene built = build_scene(scene, source);
    return Planner(scene, built, source).run();
}

} // namespace flotilla
