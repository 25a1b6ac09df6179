// SPDX-License-Identifier: MIT
#include <flotilla/run.hpp>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <exception>
#include <memory>
#include <optional>
#include <sstream>

#include <flotilla/edit_file.hpp>
#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>
#include <flotilla/world.hpp>

#include "api/edited_bodies.hpp"
#include "api/world_access.hpp"
#include "base/floating_point.hpp"
#include "base/stopwatch.hpp"
#include "base/text.hpp"
#include "base/vec3.hpp"
#include "io/file.hpp"
#include "parallel/background.hpp"
#include "run_folder/checkpoint.hpp"
#include "run_folder/contacts_csv.hpp"
#include "run_folder/earlier_contacts.hpp"
#include "run_folder/run_bodies.hpp"
#include "run_folder/run_folder.hpp"
#include "scene/scene.hpp"
#include "scene/settings_table.hpp"
#include "trace/measure_costs.hpp"
#include "trace/trace_file.hpp"

namespace flotilla {
namespace {

/// A frame on its way to the writer.
struct OwnedFrame {
    /// `bodies`: of an edited run, else null.
    OwnedFrame(const World& world, bool with_way, const io::RunBodies* bodies)
        : step(world.steps()), time(world.time()) {
        const std::size_t n = bodies != nullptr ? bodies->size() : world.size();
        const auto place = [&](std::size_t i) {
            return bodies != nullptr ? bodies->place_of(i) : static_cast<std::int32_t>(i);
        };
        position.resize(n), rotation.resize(n), velocity.resize(n), angular.resize(n);
        if (step > 0) turn.resize(n);
        const std::vector<BodyActivity> did = world.activity();
        for (std::size_t i = 0; i < n; ++i) {
            if (place(i) < 0) {
                activity.append_absent();
                continue;
            }
            const auto at = static_cast<std::size_t>(place(i));
            const BodyState b = world.body(at);
            position[i] = b.position;
            rotation[i] = b.rotation;
            velocity[i] = b.velocity;
            angular[i] = b.angular_velocity;
            if (step > 0) turn[i] = world.turn(at);
            activity.append(did[at]);
        }
        if (step > 0 && with_way) add_way(world, n, place);
    }
    [[nodiscard]] io::FrameView view() const {
        return {step, time, position, rotation, velocity, angular, turn, activity.view(), &way};
    }
    template <class Place>
    void add_way(const World& world, std::size_t n, Place&& place) {
        const auto substeps = static_cast<std::size_t>(world.settings().substeps);
        std::vector<std::vector<WayPoint>> ways;
        for (std::size_t i = 0; i < n; ++i)
            ways.push_back(place(i) < 0 ? std::vector<WayPoint>(substeps)
                                        : world.way(static_cast<std::size_t>(place(i))));
        for (std::size_t k = 0; k + 1 < substeps; ++k)
            for (const auto& points : ways) {
                const WayPoint& p = points[k];
                way.append(p.position, p.rotation, p.turn);
            }
    }

    std::int64_t step;
    double time;
    std::vector<Vec3> position, velocity, angular, turn;
    std::vector<Quat> rotation;
    io::Activity activity;
    io::Way way;
};

/// Records the tasks of every k-th step. The world must outlive it.
class TaskTrace {
  public:
    TaskTrace(World& world, std::vector<ThreadCosts> costs, const RunOptions& options)
        : options_(options), world_(world), team_(WorldAccess::team(world)), recorder_(team_.size()) {
        recorder_.set_active(false);
        team_.record_to(&recorder_);
        info_.threads = team_.size();
        info_.command_line = options.command_line;
        info_.trace_every = options.trace_every;
        info_.costs = std::move(costs);
    }
    ~TaskTrace() { team_.record_to(nullptr); }
    TaskTrace(const TaskTrace&) = delete;
    TaskTrace& operator=(const TaskTrace&) = delete;

    StepReport step() {
        using Clock = std::chrono::steady_clock;
        if (world_.steps() % options_.trace_every != 0) return world_.step();
        recorder_.set_step(world_.steps() + 1);
        recorder_.set_active(true);
        const std::clock_t cpu = std::clock(); // of all threads of the process
        const Clock::time_point wall = Clock::now();
        const StepReport report = step_or_drop();
        info_.wall_seconds += std::chrono::duration<double>(Clock::now() - wall).count();
        info_.cpu_seconds += static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
        recorder_.set_active(false);
        ++info_.steps;
        return report;
    }

    void write() { io::write_trace(options_.trace, info_, recorder_.record()); }
    [[nodiscard]] std::int64_t steps() const { return info_.steps; }

  private:
    /// One that throws is undone, and so are its tasks.
    StepReport step_or_drop() {
        try {
            return world_.step();
        } catch (...) {
            recorder_.set_active(false);
            recorder_.drop_step();
            throw;
        }
    }

    const RunOptions& options_;
    World& world_;
    Team& team_;
    TaskRecorder recorder_;
    io::TraceInfo info_;
};

void add(RunTotals& summary, const StepReport& r) {
    ++summary.steps;
    summary.total_ms += r.total_ms;
    summary.worst_ms = std::max(summary.worst_ms, r.total_ms);
    for (std::size_t p = 0; p < kNumPhases; ++p) summary.phase_ms[p] += r.phase_ms[p];
    summary.collisions += r.collisions;
    summary.merges += r.merges;
    summary.rung_changes += r.rung_changes;
    summary.held += r.held;
    summary.above_tolerance += (r.warnings & kStaticLimit) != 0 ? 1 : 0;
    summary.energy_corrections += r.energy_corrections;
    summary.energy_removed += r.energy_removed;
    summary.min_distance = std::min(summary.min_distance, r.min_distance);
    summary.last = r;
}

/// All settings as a JSON object, as a scene file would hold them.
std::string settings_json(const Settings& settings) {
    std::string text = "{";
    for (const SettingRow& row : settings_table()) {
        const bool is_text = std::holds_alternative<ChoiceField>(row.field);
        const std::string value = setting_value(settings, row.key);
        text +=
            (text.size() > 1 ? ", \"" : "\"") + std::string(row.key) + "\": " + (is_text ? '"' + value + '"' : value);
    }
    return text + "}";
}

/// A folder is whole by itself, wherever it is moved to: its scene and edits refer to no mesh files. The vertices are
/// scaled already.
void hold_mesh(ShapeDescription& shape) {
    shape.mesh_path.clear();
    shape.scale = 1;
}

/// The text as it was given, where that names no mesh files.
std::string recorded_scene(const SceneDescription& scene, const std::string& given) {
    const auto has_file = [](const ShapeDescription& shape) { return !shape.mesh_path.empty(); };
    if (given.empty() || std::ranges::none_of(scene.shapes, has_file)) return given;
    SceneDescription whole = scene;
    std::ranges::for_each(whole.shapes, hold_mesh);
    std::ostringstream text;
    write_scene(text, whole);
    return std::move(text).str();
}

std::string recorded_edits(std::vector<Edit> edits, const SceneDescription& scene) {
    for (Edit& edit : edits)
        if (auto* added = std::get_if<edits::AddShape>(&edit.change)) hold_mesh(added->shape);
    std::ostringstream text;
    write_edits(text, edits, scene);
    return std::move(text).str();
}

io::RunInfo run_info(const SceneDescription& scene, const World& world, const RunOptions& options) {
    io::RunInfo info;
    info.command_line = options.command_line;
    info.seed = scene.settings.seed;
    info.settings_json = settings_json(scene.settings);
    info.scene_json = recorded_scene(scene, options.scene_json);
    info.scene_hash = world.scene_hash();
    info.trajectory = scene.settings.trajectory;
    info.time_step = scene.settings.time_step;
    info.substeps = scene.settings.substeps;
    info.frame_every = options.frame_every;
    info.threads = static_cast<int>(world.threads().size());
    info.ignored_groups = scene.ignored_groups;
    info.ignored_bodies = scene.ignored_bodies;
    for (const BodyDescription& body : scene.bodies)
        if (!body.group.empty()) info.groups.push_back({body.name, body.group});
    if (options.edits.empty()) return info;
    info.scene_bodies = scene.bodies.size();
    info.edits_json = recorded_edits(options.edits, scene);
    for (const Edit& edit : options.edits) info.scene_hash = chained(info.scene_hash, edit, edit.step);
    return info;
}

void note(const RunOptions& options, const std::string& text) {
    if (options.note) options.note(text);
}

std::string moved_text(const SceneDescription& scene, const MovedBody& m) {
    return "body " + in_quotes(scene.bodies[static_cast<std::size_t>(m.body)].name) +
           " intersected another at the start and was moved by " + to_text(length(m.by)) + " m: (" + to_text(m.by.x) +
           ", " + to_text(m.by.y) + ", " + to_text(m.by.z) + ")";
}

std::optional<io::Checkpoint> find_checkpoint(const RunOptions& options) {
    if (!options.resume) return {};
    if (!io::is_run_folder(options.output)) {
        note(options, options.output.string() + ": no run to resume: starting from the beginning");
        return {};
    }
    std::optional<io::Checkpoint> checkpoint = io::read_last_checkpoint(options.output);
    if (!checkpoint)
        note(options, options.output.string() + ": no checkpoint to resume from: starting from the beginning");
    else
        for (const std::string& warning : checkpoint->warnings) note(options, warning + "; using an older checkpoint");
    return checkpoint;
}

World make_world(const SceneDescription& scene, const std::string& source, const RunOptions& options,
                 const std::optional<io::Checkpoint>& checkpoint) {
    if (!checkpoint) {
        World world(scene, source, options.world);
        for (const MovedBody& m : world.moved_bodies()) note(options, moved_text(scene, m));
        return world;
    }
    try {
        return World(scene, checkpoint->state, source, options.world);
    } catch (const InputError& e) {
        throw InputError(options.output.string() + ": cannot resume: " + e.what());
    }
}

/// The bodies that edits bring, with their shapes.
void add_edited(const io::RunBodies& edited, const SceneDescription& scene, io::RunScene& bodies) {
    const Scene built = build_scene(scene);
    std::vector<std::int32_t> shape_of = built.shape_of;
    for (std::size_t k = 0; k < edited.added_shapes().size(); ++k) {
        SceneDescription alone;
        alone.settings = scene.settings;
        alone.shapes.push_back(edited.added_shapes()[k]);
        const io::RunScene added = io::make_run_scene(build_scene(alone, edited.adder_of_shape(k)));
        shape_of.push_back(static_cast<std::int32_t>(bodies.shapes.size()));
        bodies.shapes.push_back(added.shapes.front());
    }
    for (std::size_t i = bodies.bodies.size(); i < edited.size(); ++i) {
        const BodyDescription& body = edited.bodies()[i];
        const auto shape = static_cast<std::size_t>(body.shape);
        if (body.shape < 0 || shape >= shape_of.size())
            throw InputError("edits: body " + in_quotes(body.name) + " has a shape that does not exist");
        bodies.bodies.push_back({body.name, shape_of[shape], body.type});
    }
}

std::unique_ptr<io::RunWriter> open_writer(const SceneDescription& scene, const World& world, const RunOptions& options,
                                           const std::optional<io::Checkpoint>& checkpoint,
                                           const io::RunBodies* edited) {
    if (options.output.empty()) return nullptr;
    const io::RunInfo info = run_info(scene, world, options);
    io::RunScene bodies = io::make_run_scene(build_scene(scene));
    if (edited != nullptr) add_edited(*edited, scene, bodies);
    if (checkpoint) return std::make_unique<io::RunWriter>(options.output, info, bodies, checkpoint->step);
    const io::OpenRun mode = options.resume      ? io::OpenRun::restart
                             : options.overwrite ? io::OpenRun::overwrite
                                                 : io::OpenRun::create;
    return std::make_unique<io::RunWriter>(options.output, info, bodies, mode);
}

/// Decides when the folder gets a checkpoint.
class CheckpointClock {
  public:
    CheckpointClock(std::int64_t step, int every) : every_(every), last_step_(step) {}

    [[nodiscard]] bool due(std::int64_t step) const {
        const std::int64_t steps = step - last_step_;
        if (every_ > 0) return steps >= every_;
        return steps >= kDefaultSteps || Clock::now() - last_time_ >= kLongest;
    }
    [[nodiscard]] bool has(std::int64_t step) const { return step == last_step_ && step > 0; }
    void made(std::int64_t step) {
        last_step_ = step;
        last_time_ = Clock::now();
    }

  private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::int64_t kDefaultSteps = 100;
    static constexpr std::chrono::minutes kLongest{5};

    int every_;
    std::int64_t last_step_;
    Clock::time_point last_time_ = Clock::now();
};

/// What is written into the run folder, step by step: collected after a step and written, in order, while the next ones
/// compute. An error is thrown by the next call after it.
class RunRecorder {
  public:
    /// `edited`: null where the World is not edited; `contacts`: null where they are not written.
    RunRecorder(std::unique_ptr<io::RunWriter> writer, const World& world, const RunOptions& options,
                const io::RunBodies* edited, io::ContactsCsv* contacts)
        : world_(world),
          options_(options),
          edited_(edited),
          contacts_(contacts),
          writer_(std::move(writer)),
          clock_(world.steps(), options.checkpoint_every) {
        if (writer_->frames() == 0) add_frame(); // a run that goes on after step 0 has it
    }

    void after_step(const StepReport& report) {
        const Stopwatch watch(ms_);
        jobs_.add([this, report] { writer_->add_step(report); });
        if (world_.steps() % options_.frame_every == 0) add_frame();
        if (clock_.due(world_.steps())) add_checkpoint();
    }
    void close(bool complete) {
        const Stopwatch watch(ms_);
        if (!clock_.has(world_.steps())) add_checkpoint();
        jobs_.finish();
        writer_->close(complete ? "complete" : "stopped");
    }
    [[nodiscard]] double milliseconds() const { return ms_; }

  private:
    static constexpr std::size_t kMostJobs = 16; // some frames; of 10,000 bodies each is a megabyte

    void add_frame() {
        const bool with_way = options_.frame_every == 1 && world_.settings().substeps > 1;
        jobs_.add([this, frame = std::make_shared<const OwnedFrame>(world_, with_way, edited_)] {
            writer_->add_frame(frame->view());
        });
    }
    void add_checkpoint() {
        const std::int64_t step = world_.steps();
        std::optional<io::ContactRows> rows;
        if (contacts_ != nullptr) rows = contacts_->flush();
        jobs_.add([this, step, rows, snapshot = world_.snapshot()] {
            writer_->flush(); // a checkpoint may not be newer than the frames, nor than the contacts
            if (contacts_ != nullptr) contacts_->sync();
            io::write_checkpoint(options_.output, step, snapshot, {}, rows);
        });
        clock_.made(step);
    }

    const World& world_;
    const RunOptions& options_;
    const io::RunBodies* edited_;
    io::ContactsCsv* contacts_;
    std::unique_ptr<io::RunWriter> writer_;
    CheckpointClock clock_;
    double ms_ = 0;
    Background jobs_{kMostJobs}; // last: ends before what its jobs use
};

struct RefusedEdit {
    std::exception_ptr reason;
};

/// Those that are due before the next step.
void make_edits(io::RunBodies& edited, World& world) {
    for (const Edit& edit : edited.advance(world.steps())) {
        const auto after = [&](const std::exception& e) { return io::name_of(edit) + ": " + e.what(); };
        try {
            world.apply(edit);
        } catch (const OverlapError& e) {
            throw RefusedEdit{std::make_exception_ptr(OverlapError(after(e), e.pairs()))};
        } catch (const InputError& e) {
            throw RefusedEdit{std::make_exception_ptr(InputError(after(e), e.problems()))};
        }
    }
}

/// Those of the run's last step and later ones are made by no run of so many steps: --resume with more makes them.
void note_edits_left(const RunOptions& options) {
    const auto first = std::ranges::find_if(options.edits, [&](const Edit& e) { return e.step >= options.steps; });
    if (first == options.edits.end()) return;
    const auto left = options.edits.end() - first; // they are sorted by step
    note(options, io::name_of(*first) + (left > 1 ? " and " + std::to_string(left - 1) + " more" : "") +
                      ": not made, the run ends after step " + std::to_string(options.steps));
}

/// What cannot be written is known before the folder changes, where an earlier run may be. The folder itself is made
/// first, as the files may belong there.
void check_outputs(const RunOptions& options) {
    if (options.trace.empty() && options.contacts.empty()) return;
    if (!options.output.empty()) io::create_folder(options.output);
    if (!options.trace.empty()) io::check_writable(options.trace);
    if (options.contacts.empty()) return;
    io::check_writable(options.contacts);
    io::check_writable(io::contact_totals_path(options.contacts));
}

/// Says where contacts will be missing. While nobody else writes there, whose contacts they might be.
std::optional<io::EarlierContacts> find_contacts(const RunOptions& options,
                                                 const std::optional<io::Checkpoint>& checkpoint) {
    if (options.contacts.empty() || !checkpoint) return {};
    const io::FolderLock lock(options.output);
    io::EarlierContacts earlier = io::find_earlier_contacts(options.contacts, *checkpoint);
    if (earlier.rows.from > 1)
        note(options, options.contacts.string() + ": begins with the contacts of step " +
                          std::to_string(earlier.rows.from) + ": nothing there has those of earlier steps");
    return earlier;
}

std::unique_ptr<io::ContactsCsv> open_contacts(const RunOptions& options,
                                               const std::optional<io::EarlierContacts>& earlier) {
    if (options.contacts.empty()) return nullptr;
    if (earlier) return std::make_unique<io::ContactsCsv>(options.contacts, *earlier);
    return std::make_unique<io::ContactsCsv>(options.contacts);
}

void check_options(const RunOptions& options) {
    if (!std::is_sorted(options.edits.begin(), options.edits.end(),
                        [](const Edit& a, const Edit& b) { return a.step < b.step; }))
        throw InputError("edits must be sorted by step");
    const auto at_least = [](const char* name, std::int64_t value, int least) {
        if (value >= least) return;
        throw InputError(std::string(name) + " must be at least " + std::to_string(least) + ", not " +
                         std::to_string(value));
    };
    at_least("steps", options.steps, 0);
    at_least("frame_every", options.frame_every, 1);
    at_least("checkpoint_every", options.checkpoint_every, 0);
    at_least("trace_every", options.trace_every, 1);
}

} // namespace

RunTotals run_scene(const SceneDescription& scene, const std::string& source, const RunOptions& options) {
    const DefaultFloatingPoint environment;
    check_options(options);
    std::vector<ThreadCosts> costs;
    if (!options.trace.empty()) costs = measure_costs(usable_cores());
    const std::optional<io::Checkpoint> checkpoint = find_checkpoint(options);
    World world = make_world(scene, source, options, checkpoint);
    RunTotals summary;
    summary.bodies = static_cast<std::int64_t>(world.size());
    summary.resumed_after = world.steps();
    std::optional<io::RunBodies> edited;
    if (!options.edits.empty()) {
        edited.emplace(scene, options.edits);
        (void)edited->advance(world.steps() - 1); // those are in the checkpoint
    }
    check_outputs(options);
    const std::optional<io::EarlierContacts> earlier = find_contacts(options, checkpoint);
    auto writer = open_writer(scene, world, options, checkpoint, edited ? &*edited : nullptr);
    const std::unique_ptr<io::ContactsCsv> contacts = open_contacts(options, earlier);
    std::optional<RunRecorder> recorder;
    if (writer) recorder.emplace(std::move(writer), world, options, edited ? &*edited : nullptr, contacts.get());
    std::unique_ptr<TaskTrace> trace;
    if (!options.trace.empty()) trace = std::make_unique<TaskTrace>(world, std::move(costs), options);
    if (options.begun) options.begun(world);
    bool goes_on = true;
    std::exception_ptr refused; // the run up to here is whole
    while (goes_on && world.steps() < options.steps) {
        StepReport report;
        try {
            if (edited) make_edits(*edited, world);
            report = trace ? trace->step() : world.step();
        } catch (const ScriptError&) {
            refused = std::current_exception();
            break;
        } catch (const RefusedEdit& e) {
            refused = e.reason;
            break;
        }
        add(summary, report);
        if (contacts) contacts->add(report.step, report.time, world.contacts());
        if (recorder) recorder->after_step(report);
        if (options.after_step) goes_on = options.after_step(report);
    }
    summary.complete = world.steps() >= options.steps;
    if (summary.complete && edited) note_edits_left(options);
    summary.threads = world.threads();
    if (recorder) {
        recorder->close(summary.complete);
        summary.output_ms = recorder->milliseconds();
    }
    if (contacts) contacts->close(); // after the last checkpoint, which still needs them
    if (trace) {
        trace->write();
        summary.traced_steps = trace->steps();
    }
    if (!refused) return summary;
    if (options.blocked) options.blocked(summary);
    std::rethrow_exception(refused);
}

} // namespace flotilla
