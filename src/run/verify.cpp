// SPDX-License-Identifier: MIT
#include <flotilla/verify.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include <flotilla/edit_file.hpp>
#include <flotilla/environment.hpp>
#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "audit/audit.hpp"
#include "base/assumptions.hpp"
#include "base/floating_point.hpp"
#include "base/stopwatch.hpp"
#include "base/text.hpp"
#include "parallel/parallel_for.hpp"
#include "run_folder/poses_csv.hpp"
#include "run_folder/run_bodies.hpp"
#include "run_folder/run_folder.hpp"
#include "scene/scene.hpp"

namespace flotilla {
namespace {

using Kind = VerifyFault::Kind;

audit::Scene make_audit_scene(const io::RunScene& scene, int threads) {
    audit::Scene result;
    result.shapes.resize(scene.shapes.size());
    parallel_for(scene.shapes.size(), threads, [&](std::size_t k) {
        result.shapes[k] = audit::make_shape(scene.shapes[k].mesh, scene.shapes[k].center_of_mass);
    });
    for (const auto& body : scene.bodies) result.bodies.push_back({body.shape, body.type != BodyType::dynamic});
    return result;
}

/// `bodies`, of an edited run, says who is there; null: all.
std::vector<audit::Pose> poses_of(const io::Frame& frame, const io::RunBodies* bodies) {
    std::vector<audit::Pose> poses;
    for (std::size_t i = 0; i < frame.position.size(); ++i)
        poses.push_back({frame.position[i], frame.rotation[i], bodies == nullptr || bodies->place_of(i) >= 0});
    return poses;
}

/// What an edited run's bodies are called, of which shapes, and what may pass through what, as its scene says.
SceneDescription scene_of_run(const io::RunScene& run, const io::RunInfo& info, std::size_t scene_bodies) {
    SceneDescription scene;
    scene.settings.time_step = info.time_step;
    for (const io::RunShape& shape : run.shapes) {
        scene.shapes.emplace_back();
        scene.shapes.back().name = shape.name;
    }
    for (std::size_t i = 0; i < scene_bodies; ++i) {
        const io::RunBody& body = run.bodies[i];
        scene.bodies.emplace_back();
        scene.bodies.back().name = body.name;
        scene.bodies.back().shape = body.shape;
        scene.bodies.back().type = body.type;
        for (const NamedPair& group : info.groups)
            if (group.a == body.name) scene.bodies.back().group = group.b;
    }
    scene.ignored_groups = info.ignored_groups;
    scene.ignored_bodies = info.ignored_bodies;
    return scene;
}

/// The bodies of a run that is edited, or whose scene lets some pass through each other.
struct EditedRun {
    EditedRun(const io::RunScene& run, const io::RunInfo& info) {
        const std::size_t all = run.bodies.size(), of_scene = info.edits_json.empty() ? all : info.scene_bodies;
        const SceneDescription scene = scene_of_run(run, info, std::min(of_scene, all));
        if (!info.edits_json.empty()) edits = parse_edits(info.edits_json, "edits.json", {}, scene);
        bodies.emplace(scene, edits);
        if (bodies->size() != all) throw IoError("edits.json: adds other bodies than the run has");
    }
    [[nodiscard]] static bool is_one(const io::RunInfo& info) {
        return !info.edits_json.empty() || !info.ignored_groups.empty() || !info.ignored_bodies.empty();
    }
    std::vector<Edit> edits;
    std::optional<io::RunBodies> bodies;
};

int threads_of(const VerifyOptions& options) {
    check_environment();
    if (options.threads < 0)
        throw InputError(std::to_string(options.threads) + " threads: must be one or more, or 0 for the default");
    return options.threads > 0 ? options.threads : free_threads();
}

/// Takes the frames of a trajectory in order and collects what is wrong with them.
class Verifier {
  public:
    /// `edited`: see EditedRun; null where all bodies are there all the time and may not meet.
    Verifier(const io::RunScene& scene, audit::Motion motion, const VerifyOptions& options,
             io::RunBodies* edited = nullptr)
        : edited_(edited),
          bodies_(scene.bodies),
          threads_(threads_of(options)),
          scene_(make_audit_scene(scene, threads_)),
          motion_(motion),
          options_(options) {
        report_.bodies = static_cast<std::int64_t>(bodies_.size());
        if (edited_ != nullptr)
            scene_.ignored = [edited](std::size_t a, std::size_t b) { return edited->ignored(a, b); };
    }

    /// Why motions are skipped, for people.
    void explain(std::string reason) { why_skipped_ = std::move(reason); }

    /// `one_step`: this frame is one time step after the one before; `way`: what came between, where that step has
    /// inner ones.
    void add(io::Frame frame, bool one_step, const io::Way& way = {}) {
        if (edited_ != nullptr) make_edits(frame.step - 1);
        audit::Placement placement = audit::place(scene_, poses_of(frame, edited_), threads_);
        check_frame(frame, placement);
        if (last_ && wants_motion(one_step))
            check_motion(frame, placement, way);
        else if (last_ || gap_)
            ++report_.motions_skipped;
        gap_ = false;
        last_ = Placed{std::move(frame), std::move(placement)};
    }

    /// A frame that cannot be read: nothing is known about the motion on both sides of it.
    void skip(const std::string& reason) {
        // A damaged segment gives the same message for each of its frames.
        if (report_.unreadable.empty() || report_.unreadable.back() != reason) report_.unreadable.push_back(reason);
        if (last_) ++report_.motions_skipped;
        last_.reset();
        gap_ = true;
    }

    VerifyReport finish() {
        if (report_.motions_skipped > 0 && options_.motion != VerifyMotion::never && report_.unreadable.empty())
            report_.notes.push_back(why_skipped_ + ": " + std::to_string(report_.motions_skipped) +
                                    " of them were checked as states, not the motion before them");
        if (edited_ != nullptr && edited_->ignores_any())
            report_.notes.push_back("some pairs of bodies may pass through each other (ignore): they were left out");
        return std::move(report_);
    }

  private:
    struct Placed {
        io::Frame frame;
        audit::Placement placement;
    };

    [[nodiscard]] bool wants_motion(bool one_step) const {
        return options_.motion == VerifyMotion::always || (options_.motion == VerifyMotion::automatic && one_step);
    }

    /// Those of the steps up to this one, which is the last frame's where there is one for every step: then its bodies
    /// are where edits put them, and apart there.
    void make_edits(std::int64_t step) {
        if (edited_->advance(step).empty()) return;
        for (std::size_t i = 0; i < bodies_.size(); ++i)
            scene_.bodies[i].infinite_mass = edited_->type_of(i) != BodyType::dynamic;
        if (!last_) return;
        for (const io::RunBodies::Placed& p : edited_->placed()) {
            last_->frame.position[p.body] = p.position;
            last_->frame.rotation[p.body] = p.rotation;
        }
        last_->placement = audit::place(scene_, poses_of(last_->frame, edited_), threads_);
        if (last_->frame.step == step) check_frame(last_->frame, last_->placement);
    }

    void check_frame(const io::Frame& frame, const audit::Placement& placement) {
        for (const auto& bad : placement.bad) add_fault(bad_body(Kind::bad_pose, frame, bad));
        const audit::StateReport state = audit::check_state(scene_, placement, threads_);
        for (const auto& hit : state.intersections) {
            VerifyFault fault = pair_fault(Kind::intersection, frame, hit.body_a, hit.body_b);
            fault.triangle_a = hit.triangle_a;
            fault.triangle_b = hit.triangle_b;
            fault.triangle_pairs = hit.triangle_pairs;
            fault.place = hit.place;
            add_fault(std::move(fault));
        }
        ++report_.frames;
        report_.pairs += state.pairs;
        report_.triangle_pairs += state.triangle_pairs;
        if (options_.distance) measure(frame, placement);
    }

    void measure(const io::Frame& frame, const audit::Placement& placement) {
        const audit::SmallestDistance nearest =
            audit::smallest_distance(scene_, placement, threads_, report_.smallest_distance);
        if (!(nearest.distance < report_.smallest_distance)) return;
        report_.smallest_distance = nearest.distance;
        report_.smallest_distance_frame = frame.index;
        report_.smallest_distance_a = name(nearest.body_a);
        report_.smallest_distance_b = name(nearest.body_b);
    }

    /// Inner step by inner step.
    void check_motion(const io::Frame& frame, const audit::Placement& placement, const io::Way& way) {
        const Placed* before = &*last_;
        std::optional<Placed> inner;
        for (io::Frame& next : io::inner_frames(last_->frame, frame, way)) {
            audit::Placement placed = audit::place(scene_, poses_of(next, edited_), threads_);
            for (const auto& bad : placed.bad) add_fault(bad_body(Kind::bad_path, next, bad));
            check_leg(*before, next, placed);
            inner = Placed{std::move(next), std::move(placed)};
            before = &*inner;
        }
        check_leg(*before, frame, placement);
        ++report_.motions;
    }

    void check_leg(const Placed& from, const io::Frame& frame, const audit::Placement& placement) {
        const io::Frame& before = from.frame;
        const auto turns = io::path_rotations(before, frame);
        const audit::MotionReport found =
            audit::check_motion(scene_, from.placement, placement, motion_, turns, threads_);
        for (const auto& bad : found.bad_paths) add_fault(bad_body(Kind::bad_path, before, bad));
        for (const auto& passage : found.passages) {
            VerifyFault fault =
                pair_fault(passage.crossing ? Kind::crossing : Kind::unproved, before, passage.body_a, passage.body_b);
            fault.time += passage.time * (frame.time - before.time);
            fault.triangle_a = passage.triangle_a;
            fault.triangle_b = passage.triangle_b;
            fault.place = passage.place;
            add_fault(std::move(fault));
        }
        report_.motion_pairs += found.pairs;
        report_.triangle_pairs += found.triangle_pairs;
    }

    [[nodiscard]] const std::string& name(std::int32_t body) const {
        return bodies_[static_cast<std::size_t>(body)].name;
    }

    [[nodiscard]] VerifyFault pair_fault(Kind kind, const io::Frame& frame, std::int32_t a, std::int32_t b) const {
        VerifyFault fault;
        fault.kind = kind;
        fault.frame = frame.index;
        fault.time = frame.time;
        fault.body_a = a;
        fault.body_b = b;
        fault.name_a = name(a);
        fault.name_b = name(b);
        return fault;
    }

    [[nodiscard]] VerifyFault bad_body(Kind kind, const io::Frame& frame, const audit::BadPose& bad) const {
        VerifyFault fault;
        fault.kind = kind;
        fault.frame = frame.index;
        fault.time = frame.time;
        fault.body_a = bad.body;
        fault.name_a = name(bad.body);
        fault.reason = bad.reason;
        return fault;
    }

    void add_fault(VerifyFault fault) {
        switch (fault.kind) {
        case Kind::intersection: ++report_.intersecting_pairs; break;
        case Kind::crossing: ++report_.crossing_pairs; break;
        case Kind::unproved: ++report_.unproved_pairs; break;
        case Kind::bad_pose:
        case Kind::bad_path: ++report_.bad_poses; break;
        }
        if (report_.faults.size() < options_.max_faults) report_.faults.push_back(std::move(fault));
    }

    io::RunBodies* edited_;
    std::vector<io::RunBody> bodies_;
    int threads_;
    audit::Scene scene_;
    audit::Motion motion_;
    const VerifyOptions& options_;
    std::optional<Placed> last_;
    std::string why_skipped_ = "frames are more than one time step apart";
    bool gap_ = false; ///< the frame before could not be read
    VerifyReport report_;
};

/// What check() reports, with the time that it took.
template <class Check>
VerifyReport timed(Check&& check) {
    const DefaultFloatingPoint environment;
    if (const std::string fault = arithmetic_fault(); !fault.empty()) throw Error("arithmetic: " + fault);
    VerifyReport report;
    double ms = 0;
    {
        const Stopwatch watch(ms);
        report = check();
    }
    report.seconds = ms / 1000;
    return report;
}

void tell(const VerifyOptions& options, double part) {
    if (options.progress) options.progress(std::clamp(part, 0.0, 1.0));
}

audit::Motion motion_of(Trajectory trajectory) {
    return trajectory == Trajectory::rigid ? audit::Motion::rigid : audit::Motion::linear;
}

VerifyReport check_run(const std::filesystem::path& folder, const VerifyOptions& options) {
    io::RunReader reader(folder);
    std::optional<EditedRun> edited;
    if (EditedRun::is_one(reader.info())) edited.emplace(reader.scene(), reader.info());
    Verifier verifier(reader.scene(), motion_of(reader.info().trajectory), options,
                      edited ? &*edited->bodies : nullptr);
    std::optional<std::int64_t> last_step;
    for (std::int64_t k = 0; k < reader.frames(); ++k) {
        try {
            io::Frame frame = reader.frame(k);
            const std::int64_t step = frame.step;
            const io::Way way = reader.way(k);
            const bool has_way = reader.info().substeps == 1 || !way.empty();
            verifier.add(std::move(frame), last_step && step == *last_step + 1 && has_way, way);
            last_step = step;
        } catch (const IoError& error) {
            verifier.skip(error.what());
        }
        tell(options, static_cast<double>(k + 1) / static_cast<double>(reader.frames()));
    }
    return verifier.finish();
}

VerifyReport check_poses(const std::filesystem::path& scene_file, const std::filesystem::path& poses,
                         const VerifyOptions& options) {
    const SceneDescription description = read_scene(scene_file);
    const Scene scene = build_scene(description, scene_file.string());
    const io::RunScene bodies = io::make_run_scene(scene);
    std::vector<std::string> names;
    for (const auto& body : bodies.bodies) names.push_back(body.name);
    io::PosesCsvReader reader(poses, names);
    io::RunBodies named(description, {}); // for what the scene ignores
    Verifier verifier(bodies, motion_of(scene.settings.trajectory), options,
                      scene.filtered.filter.empty() ? nullptr : &named);
    const bool whole = scene.settings.substeps == 1;
    if (!whole) verifier.explain("frames are several inner steps apart");
    std::optional<double> last_time;
    for (io::Frame frame; reader.next(frame);) {
        const double time = frame.time;
        // Times in a file are rounded; half a step tells one step from two.
        verifier.add(std::move(frame),
                     whole && last_time && std::abs(time - *last_time) < 1.5 * scene.settings.time_step);
        last_time = time;
        tell(options,
             static_cast<double>(reader.position()) / static_cast<double>(std::max<std::uintmax_t>(reader.size(), 1)));
    }
    return verifier.finish();
}

} // namespace

std::string to_string(const VerifyFault& fault) {
    const auto body = [](std::int32_t index, const std::string& name) {
        return in_quotes(name) + " (body " + std::to_string(index) + ")";
    };
    const std::string pair = body(fault.body_a, fault.name_a) + " and " + body(fault.body_b, fault.name_b);
    const std::string triangles =
        "triangles " + std::to_string(fault.triangle_a) + " and " + std::to_string(fault.triangle_b);
    const std::string place =
        "near (" + to_text(fault.place.x) + ", " + to_text(fault.place.y) + ", " + to_text(fault.place.z) + ")";
    const std::string after = "after frame " + std::to_string(fault.frame) + ", t = " + to_text(fault.time) + " s: ";
    switch (fault.kind) {
    case Kind::intersection:
        return "frame " + std::to_string(fault.frame) + ": " + pair + " intersect, " +
               std::to_string(fault.triangle_pairs) + " triangle pairs, first " + triangles + ", " + place;
    case Kind::crossing: return after + pair + " pass through each other, " + triangles + ", " + place;
    case Kind::unproved: return after + pair + " not proved apart, " + triangles + ", " + place;
    case Kind::bad_pose:
        return "frame " + std::to_string(fault.frame) + ": " + body(fault.body_a, fault.name_a) + ": " + fault.reason;
    case Kind::bad_path: return after + body(fault.body_a, fault.name_a) + ": " + fault.reason;
    }
    return "";
}

VerifyReport verify_run(const std::filesystem::path& folder, const VerifyOptions& options) {
    return timed([&] { return check_run(folder, options); });
}

VerifyReport verify_poses(const std::filesystem::path& scene_file, const std::filesystem::path& poses,
                          const VerifyOptions& options) {
    return timed([&] { return check_poses(scene_file, poses, options); });
}

} // namespace flotilla
