// SPDX-License-Identifier: MIT
#include "sweep/plan.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <sstream>

#include <flotilla/error.hpp>
#include <flotilla/names.hpp>
#include <flotilla/scene_library.hpp>

#include "base/text.hpp"
#include "io/file.hpp"
#include "io/number.hpp"

namespace flotilla::sweep {
namespace {

constexpr std::size_t kMostMembers = 10000; // run folders; a slip of the pen, not a campaign
constexpr std::size_t kMostName = 200;      // bytes; file systems take 255

/// All that is wrong, a line each.
class Faults {
  public:
    void add(const std::string& text) { (text_ += text_.empty() ? "" : "\n") += text; }
    template <class Work>
    void collect(Work&& work) {
        try {
            work();
        } catch (const InputError& e) {
            add(e.what());
        }
    }
    void throw_if_any() const {
        if (!text_.empty()) throw InputError(text_);
    }

  private:
    std::string text_;
};

std::string file_name(std::string text) {
    for (char& c : text)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0 &&
            std::string_view("._=,@+-").find(c) == std::string::npos)
            c = '_';
    if (text.size() <= kMostName) return text;
    const std::uint64_t rest = io::checksum(std::as_bytes(std::span(text)));
    return text.substr(0, kMostName) + "+" + std::to_string(rest);
}

/// The value as the settings print it, so that 0.02 and 2e-2 are one.
std::string canonical(const std::string& key, const std::string& value) {
    if (key == kPreset) {
        (void)preset(value);
        return value;
    }
    Settings scratch;
    set_setting(scratch, key, value);
    return setting_value(scratch, key);
}

struct Axes {
    std::vector<SweepAxis> varied;
    std::vector<std::uint64_t> seeds;
};

Axes read_axes(const SweepOptions& options, Faults& faults) {
    Axes axes;
    std::set<std::string> keys;
    if (options.vary.empty()) faults.add("sweep: nothing is varied: give --vary key=a,b,...");
    for (const SweepAxis& given : options.vary) {
        SweepAxis axis{given.key == "dt" ? std::string(kTimeStep) : given.key, {}};
        if (!keys.insert(axis.key).second) faults.add("sweep: " + axis.key + " is varied twice");
        if (given.values.empty()) faults.add("sweep: " + axis.key + " has no values");
        for (const std::string& value : given.values)
            faults.collect([&] {
                const std::string text = canonical(axis.key, value);
                if (std::find(axis.values.begin(), axis.values.end(), text) != axis.values.end())
                    throw InputError("sweep: " + axis.key + " has the value " + text + " twice");
                axis.values.push_back(text);
            });
        for (const auto& [key, value] : options.overrides)
            if (key == axis.key) faults.add("sweep: " + key + " is both set and varied");
        if (axis.key != kSeed) {
            axes.varied.push_back(axis);
            continue;
        }
        for (const std::string& value : axis.values) {
            std::uint64_t seed = 0;
            if (io::parse_number(value, seed)) axes.seeds.push_back(seed);
        }
    }
    return axes;
}

bool in_library(const std::string& name) {
    const auto scenes = list_scenes();
    return std::any_of(scenes.begin(), scenes.end(), [&](const LibraryScene& s) { return s.name == name; });
}

Start library_start(const std::string& name, const SweepOptions& options, std::optional<std::uint64_t> seed) {
    Start start{name + (seed ? "-seed-" + std::to_string(*seed) : ""), {}, true, {}, seed};
    std::ostringstream text;
    write_scene(text, make_scene(name, options.bodies, seed.value_or(0)));
    start.text = text.str();
    start.file = std::filesystem::absolute(options.output) / "scenes" / (start.name + ".json");
    return start;
}

Start file_start(const std::string& path, std::optional<std::uint64_t> seed) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        throw InputError("sweep: " + path +
                         " is neither a scene file nor a scene of the library (flotilla scene --list)");
    const std::string stem = std::filesystem::path(path).stem().string();
    return {stem + (seed ? "-seed-" + std::to_string(*seed) : ""), std::filesystem::absolute(path), false,
            io::read_text(path), seed};
}

std::vector<Start> read_starts(const SweepOptions& options, const std::vector<std::uint64_t>& seeds, Faults& faults) {
    std::vector<Start> starts;
    std::vector<std::optional<std::uint64_t>> given(seeds.begin(), seeds.end());
    if (given.empty()) given.emplace_back();
    if (options.scenes.empty()) faults.add("sweep: give a SCENE");
    bool generated = false;
    for (const std::string& scene : options.scenes)
        for (const auto& seed : given)
            faults.collect([&] {
                const bool library = !std::filesystem::exists(scene) && in_library(scene);
                starts.push_back(library ? library_start(scene, options, seed) : file_start(scene, seed));
                generated = generated || library;
            });
    if (options.bodies > 0 && !generated && !starts.empty()) faults.add("sweep: --bodies is of scenes of the library");
    std::map<std::string, int> count;
    for (Start& start : starts)
        if (const int n = ++count[start.name]; n > 1) (start.name += "-") += std::to_string(n);
    return starts;
}

std::vector<Point> product(const std::vector<SweepAxis>& axes, const SweepOptions& options) {
    std::vector<Point> points(1);
    points.front().options = {options.preset, options.overrides};
    for (const SweepAxis& axis : axes) {
        std::vector<Point> longer;
        for (const Point& point : points)
            for (const std::string& value : axis.values) {
                Point p = point;
                p.values.push_back(value);
                p.label += (p.label.empty() ? "" : " ") + axis.key + "=" + value;
                if (axis.key == kPreset)
                    p.options.preset = value;
                else
                    p.options.overrides.emplace_back(axis.key, value);
                longer.push_back(std::move(p));
            }
        if (longer.size() > kMostMembers) throw InputError("sweep: more than 10000 runs");
        points = std::move(longer);
    }
    if (axes.empty()) points.front().label = options.preset;
    return points;
}

/// Half of the shortest time step that is varied: with that one itself, what it does wrong would be called right.
Point reference_point(const std::vector<SweepAxis>& axes, const SweepOptions& options) {
    Point point{"preset=" + options.reference, {}, {}, {options.reference, options.overrides}, true, true};
    (void)preset(options.reference);
    const auto dt = std::find_if(axes.begin(), axes.end(), [](const SweepAxis& a) { return a.key == kTimeStep; });
    if (dt == axes.end() || dt->values.empty()) return point;
    double shortest = 0;
    for (const std::string& text : dt->values) {
        double value = 0;
        (void)io::parse_number(text, value);
        if (shortest == 0 || value < shortest) shortest = value;
    }
    point.options.overrides.emplace_back(kTimeStep, to_text(shortest / 2));
    point.label += " time_step=" + to_text(shortest / 2);
    return point;
}

SceneFileOptions with_seed(SceneFileOptions options, const Start& start) {
    if (start.seed) options.overrides.emplace_back(kSeed, std::to_string(*start.seed));
    return options;
}

SceneDescription parse(const Start& start, const SceneFileOptions& options) {
    return parse_scene(start.text, start.generated ? start.name : start.file.string(), start.file.parent_path(),
                       options);
}

/// Of everything that the results depend on, meshes included.
std::uint64_t input_of(SceneDescription scene, const SweepMember& run) {
    for (ShapeDescription& shape : scene.shapes) shape.mesh_path.clear();
    std::ostringstream text;
    write_scene(text, scene);
    const std::string all = text.str() + std::to_string(run.steps) + ' ' + std::to_string(run.frame_every);
    return io::checksum(std::as_bytes(std::span(all)));
}

/// Frames at the times of the steps that are not varied, where these are times of `steps` as well.
int frame_every(double base, double dt, std::int64_t steps) {
    const double whole = std::round(base / dt);
    if (whole <= 1 || std::abs(base / dt - whole) > 1e-9 * whole) return 1;
    const auto every = static_cast<int>(std::min(whole, 1e6));
    return steps % every == 0 ? every : 1;
}

/// Whether frames are at times of the steps that are not varied.
bool on_grid(double base, double frame_time) {
    const double whole = std::round(frame_time / base);
    return whole >= 1 && std::abs(frame_time / base - whole) <= 1e-9 * whole;
}

/// Steps and frames of every member. Where some have frames at other times, poses of the reference are interpolated,
/// between all its steps.
void add_times(Plan& plan, const std::vector<double>& dts, double base_dt) {
    bool together = true;
    for (std::size_t i = 0; i < plan.members.size(); ++i) {
        SweepMember& run = plan.members[i].run;
        run.steps = static_cast<std::int64_t>(std::ceil(plan.duration / dts[i] - 1e-9));
        run.frame_every = frame_every(base_dt, dts[i], run.steps);
        together = together && on_grid(base_dt, run.frame_every * dts[i]);
    }
    for (Member& member : plan.members)
        if (!together && plan.points[member.point].reference) member.run.frame_every = 1;
}

void add_members(Plan& plan, const SweepOptions& options, double base_dt, Faults& faults) {
    std::vector<double> dts;
    for (std::size_t s = 0; s < plan.starts.size(); ++s)
        for (std::size_t p = 0; p < plan.points.size(); ++p) {
            const Start& start = plan.starts[s];
            const Point& point = plan.points[p];
            Member member{{}, p, s, 0};
            SweepMember& run = member.run;
            run.name = file_name(point.name + "@" + start.name);
            run.scene = start.file;
            run.folder = options.output / "members" / run.name;
            run.log = options.output / "members" / (run.name + ".log");
            const SceneFileOptions settings = with_seed(point.options, start);
            run.preset = settings.preset;
            run.overrides = settings.overrides;
            run.threads = options.threads;
            double dt = base_dt;
            faults.collect([&] { dt = parse(start, settings).settings.time_step; });
            dts.push_back(dt);
            plan.members.push_back(std::move(member));
        }
    faults.throw_if_any();
    add_times(plan, dts, base_dt);
    for (Member& member : plan.members) member.input = input_of(scene_of(plan, member), member.run);
}

/// The time step and values that the scene has where nothing is varied.
Settings base_settings(const Plan& plan, const SweepOptions& options) {
    return parse(plan.starts.front(), {options.preset, options.overrides}).settings;
}

std::size_t base_point(const Plan& plan, const Settings& settings, const SweepOptions& options) {
    std::size_t index = 0;
    for (const SweepAxis& axis : plan.axes) {
        const std::string value = axis.key == kPreset ? options.preset : setting_value(settings, axis.key);
        const auto found = std::find(axis.values.begin(), axis.values.end(), value);
        index = index * axis.values.size() +
                (found == axis.values.end() ? 0 : static_cast<std::size_t>(found - axis.values.begin()));
    }
    return index;
}

/// A point of the product with the settings of the reference is the reference, and needs no second run.
void add_reference(Plan& plan, const SweepOptions& options, Faults& faults) {
    if (options.reference.empty()) return;
    faults.collect([&] {
        Point own = reference_point(plan.axes, options);
        const auto settings = [&](const Point& p) { return parse(plan.starts.front(), p.options).settings; };
        for (Point& point : plan.points)
            if (settings(point) == settings(own)) {
                point.reference = true;
                return;
            }
        plan.points.push_back(std::move(own));
    });
}

/// What the scene or --set takes from a preset.
void note_conflicts(Plan& plan) {
    std::set<std::string> seen;
    for (const Point& point : plan.points) {
        const Settings asked = preset(point.options.preset), used = parse(plan.starts.front(), point.options).settings;
        for (const SettingInfo& info : list_settings()) {
            const std::string wanted = setting_value(asked, info.key), has = setting_value(used, info.key);
            if (wanted == setting_value(Settings{}, info.key) || wanted == has || info.key == kTimeStep) continue;
            const std::string text = "preset " + point.options.preset + " asks for " + std::string(info.key) + "=" +
                                     wanted + ", the scene or an option for " + has;
            if (seen.insert(text).second) plan.notes.push_back(text);
        }
    }
}

/// Runs that cannot differ are a misunderstanding more often than a test of the clock.
void note_repeats(Plan& plan) {
    std::map<std::uint64_t, const Member*> first;
    std::size_t repeats = 0;
    std::string example;
    for (const Member& member : plan.members) {
        const auto [at, is_new] = first.emplace(member.input, &member);
        // A seed changes the scene of the library, and with random tangents the friction.
        const Start &a = plan.starts[at->second->start], &b = plan.starts[member.start];
        if (is_new || (a.seed != b.seed && a.generated)) continue;
        if (++repeats == 1) example = member.run.name + " and " + at->second->run.name;
    }
    if (repeats > 0)
        plan.notes.push_back(std::to_string(repeats) +
                             " runs repeat others with the same settings and scene: " + example);
    const bool seeds_of_files = std::any_of(plan.starts.begin(), plan.starts.end(),
                                            [](const Start& s) { return s.seed.has_value() && !s.generated; });
    const bool random = std::any_of(plan.points.begin(), plan.points.end(), [&](const Point& p) {
        return parse(plan.starts.front(), p.options).settings.tangents == Tangents::random;
    });
    if (seeds_of_files && !random)
        plan.notes.emplace_back(
            "the seeds change nothing: of a scene file, seed is that of random tangents alone; give "
            "several scene files, or a scene of the library");
}

} // namespace

std::optional<std::size_t> Plan::reference() const {
    for (std::size_t p = 0; p < points.size(); ++p)
        if (points[p].reference) return p;
    return {};
}

Plan make_plan(const SweepOptions& options) {
    Faults faults;
    const auto check = [&](bool good, const char* text) {
        if (!good) faults.add(text);
    };
    check(!options.output.empty(), "sweep: give a folder with --output");
    check(options.threads >= 1, "sweep: a run needs at least one thread");
    check(options.jobs >= 0, "sweep: the number of jobs is negative");
    check(options.duration > 0 || options.steps >= 0, "sweep: the duration must be positive");
    check(options.steps != 0, "sweep: no steps: nothing to compare");
    Plan plan;
    Axes axes = read_axes(options, faults);
    plan.axes = std::move(axes.varied);
    plan.starts = read_starts(options, axes.seeds, faults);
    faults.throw_if_any();
    const std::size_t others = options.scenes.size() - 1;
    plan.title = std::filesystem::path(options.scenes.front()).stem().string() +
                 (others > 0 ? " and " + std::to_string(others) + " others" : "");
    plan.points = product(plan.axes, options);
    const Settings base = base_settings(plan, options);
    plan.base = base_point(plan, base, options);
    plan.duration = options.steps >= 0 ? static_cast<double>(options.steps) * base.time_step : options.duration;
    add_reference(plan, options, faults);
    for (Point& point : plan.points) {
        point.name = point.label;
        std::replace(point.name.begin(), point.name.end(), ' ', ',');
    }
    if (plan.points.size() * plan.starts.size() > kMostMembers) throw InputError("sweep: more than 10000 runs");
    add_members(plan, options, base.time_step, faults);
    note_conflicts(plan);
    note_repeats(plan);
    return plan;
}

SceneDescription scene_of(const Plan& plan, const Member& member) {
    return parse(plan.starts[member.start], {member.run.preset, member.run.overrides});
}

} // namespace flotilla::sweep
