// SPDX-License-Identifier: MIT
#include <flotilla/run_folder.hpp>

#include <ostream>

#include <flotilla/error.hpp>

#include "base/floating_point.hpp"
#include "run_folder/checkpoint.hpp"
#include "run_folder/export.hpp"
#include "run_folder/run_folder.hpp"

namespace flotilla {

RunSummary summarize_run(const std::filesystem::path& folder) {
    io::RunReader reader(folder);
    const io::RunInfo& info = reader.info();
    RunSummary summary;
    summary.status = info.record.status;
    summary.version = info.record.version;
    summary.commit = info.record.commit;
    summary.compiler = info.record.compiler;
    summary.processor = info.record.processor;
    summary.started = info.record.started;
    summary.updated = info.record.updated;
    summary.command_line = info.command_line;
    summary.threads = info.threads;
    summary.time_step = info.time_step;
    summary.substeps = info.substeps;
    summary.settings_json = info.settings_json;
    const io::RunScene& scene = reader.scene();
    summary.bodies = static_cast<std::int64_t>(scene.bodies.size());
    summary.shapes = static_cast<std::int64_t>(scene.shapes.size());
    for (const auto& body : scene.bodies) {
        summary.dynamic_bodies += body.type == BodyType::dynamic ? 1 : 0;
        summary.triangles +=
            static_cast<std::int64_t>(scene.shapes[static_cast<std::size_t>(body.shape)].mesh.triangles.size());
    }
    summary.frames = reader.frames();
    summary.frame_bytes = reader.frame_file_bytes();
    for (std::int64_t k = 0; k < reader.frames(); ++k) {
        try {
            const io::Frame frame = reader.frame(k);
            summary.last_step = frame.step;
            summary.last_time = frame.time;
        } catch (const IoError& error) {
            // A damaged segment gives the same message for each of its frames.
            if (summary.problems.empty() || summary.problems.back() != error.what())
                summary.problems.emplace_back(error.what());
        }
    }
    try {
        if (const auto checkpoint = io::read_last_checkpoint(folder)) {
            summary.checkpoint_step = checkpoint->step;
            summary.problems.insert(summary.problems.end(), checkpoint->warnings.begin(), checkpoint->warnings.end());
        }
    } catch (const IoError& error) {
        summary.problems.emplace_back(error.what());
    }
    return summary;
}

namespace {

void append(RunFrames& out, const io::Frame& frame) {
    const auto add = [](auto& all, const auto& some) { all.insert(all.end(), some.begin(), some.end()); };
    out.frame.push_back(frame.index);
    out.step.push_back(frame.step);
    out.time.push_back(frame.time);
    add(out.position, frame.position);
    add(out.rotation, frame.rotation);
    add(out.velocity, frame.velocity);
    add(out.angular_velocity, frame.angular_velocity);
    const io::Activity& a = frame.activity;
    for (std::size_t i = 0; i < a.contacts.size(); ++i)
        out.activity.push_back({a.contacts[i], static_cast<ClusterState>(a.cluster[i]), a.cost[i]});
}

} // namespace

RunFrames read_frames(const std::filesystem::path& folder, const FrameRange& range) {
    const DefaultFloatingPoint environment;
    io::RunReader reader(folder);
    const FrameRange wanted = io::frames_of(reader, range);
    RunFrames out;
    for (const auto& body : reader.scene().bodies) out.bodies.push_back(body.name);
    for (std::int64_t k = wanted.first; k <= wanted.last; k += wanted.every) append(out, reader.frame(k));
    if (out.activity.size() != out.position.size()) out.activity.clear();
    return out;
}

void export_csv(const std::filesystem::path& folder, std::ostream& out, const FrameRange& range) {
    const DefaultFloatingPoint environment;
    io::RunReader reader(folder);
    io::export_csv(reader, io::frames_of(reader, range), [&out](std::string_view text) {
        if (!(out << text)) throw IoError("cannot write the CSV");
    });
}

namespace {

/// Part by part: it may be too large for memory.
void export_csv_file(io::RunReader& reader, const FrameRange& range, const std::filesystem::path& output) {
    io::OutputFile file(output);
    io::export_csv(reader, range, [&file](std::string_view text) { file.append(text); });
    file.close();
}

} // namespace

void export_run(const std::filesystem::path& folder, ExportFormat format, const std::filesystem::path& output,
                const FrameRange& range) {
    const DefaultFloatingPoint environment;
    io::RunReader reader(folder);
    const FrameRange frames = io::frames_of(reader, range);
    switch (format) {
    case ExportFormat::csv: return export_csv_file(reader, frames, output);
    case ExportFormat::vtp: return io::export_vtp(reader, frames, output);
    case ExportFormat::obj: return io::export_obj(reader, frames, output);
    case ExportFormat::glb: return io::export_glb(reader, frames, output);
    case ExportFormat::usd: return io::export_usd(reader, frames, output);
    }
}

ExportSize estimate_export(const std::filesystem::path& folder, ExportFormat format, const FrameRange& range) {
    io::RunReader reader(folder);
    const FrameRange frames = io::frames_of(reader, range);
    return {io::count(frames), io::export_bytes(reader, format, frames)};
}

} // namespace flotilla
