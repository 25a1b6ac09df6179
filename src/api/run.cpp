// SPDX-License-Identifier: MIT
#include <flotilla/run.hpp>

#include <algorithm>
#include <memory>

#include <flotilla/world.hpp>

#include "io/run_folder.hpp"
#include "scene/scene.hpp"
#include "scene/settings_table.hpp"

namespace flotilla {
namespace {

/// Collects the state of all bodies and hands it to the writer.
class FrameRecorder {
  public:
    FrameRecorder(io::RunWriter& writer, const World& world) : writer_(writer), world_(world) {}

    void record() {
        const std::size_t n = world_.size();
        position_.resize(n), rotation_.resize(n), velocity_.resize(n), angular_.resize(n), turn_.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
            const BodyState b = world_.body(i);
            position_[i] = b.position;
            rotation_[i] = b.rotation;
            velocity_[i] = b.velocity;
            angular_[i] = b.angular_velocity;
            turn_[i] = world_.turn(i);
        }
        writer_.add_frame({world_.steps(), world_.time(), position_, rotation_, velocity_, angular_,
                           world_.steps() == 0 ? std::span<const Vec3>{} : std::span<const Vec3>(turn_)});
    }

  private:
    io::RunWriter& writer_;
    const World& world_;
    std::vector<Vec3> position_, velocity_, angular_, turn_;
    std::vector<Quat> rotation_;
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

std::unique_ptr<io::RunWriter> open_writer(const SceneDescription& scene, const World& world,
                                           const RunOptions& options) {
    if (options.output.empty()) return nullptr;
    io::RunInfo info;
    info.command_line = options.command_line;
    info.seed = scene.settings.seed;
    info.settings_json = settings_json(scene.settings);
    info.scene_json = options.scene_json;
    info.scene_hash = world.state_hash();
    info.trajectory = scene.settings.trajectory;
    info.time_step = scene.settings.time_step;
    info.frame_every = options.frame_every;
    info.threads = static_cast<int>(world.threads().size());
    return std::make_unique<io::RunWriter>(options.output, info, io::make_run_scene(build_scene(scene)),
                                           options.overwrite ? io::OpenRun::overwrite : io::OpenRun::create);
}

} // namespace

RunTotals run_scene(const SceneDescription& scene, const std::string& source, const RunOptions& options) {
    World world(scene, source, options.world);
    RunTotals summary;
    summary.bodies = static_cast<std::int64_t>(world.size());
    const auto writer = open_writer(scene, world, options);
    std::unique_ptr<FrameRecorder> frames;
    if (writer) {
        frames = std::make_unique<FrameRecorder>(*writer, world);
        frames->record();
    }
    bool goes_on = true;
    while (goes_on && summary.steps < options.steps) {
        const StepReport report = world.step();
        add(summary, report);
        if (writer) {
            writer->add_step(report);
            if (world.steps() % options.frame_every == 0) frames->record();
        }
        if (options.after_step) goes_on = options.after_step(report);
    }
    summary.threads = world.threads();
    if (writer) writer->close(goes_on ? "complete" : "stopped");
    return summary;
}

} // namespace flotilla
