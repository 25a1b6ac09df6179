// SPDX-License-Identifier: MIT
#include "run_folder/run_folder.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>
#include <type_traits>

#include <flotilla/error.hpp>

#include "base/assert.hpp"
#include "base/rotation.hpp"
#include "io/flat.hpp"
#include "run_folder/growth.hpp"
#include "run_folder/run_files.hpp"
#include "run_folder/step_csv.hpp"

namespace flotilla::io {
namespace {

namespace fs = std::filesystem;

// A segment is written at whichever limit comes first: the frames bound what a crash between two checkpoints loses, the
// bytes bound memory (the image doubles them).
constexpr std::size_t kSegmentFrames = 120;
constexpr std::size_t kSegmentBytes = std::size_t{32} << 20;

template <class T>
void append(std::vector<T>& to, std::type_identity_t<std::span<const T>> values) {
    to.insert(to.end(), values.begin(), values.end());
}

/// Over everything that a frame holds, so that no part can change unseen.
std::uint64_t frame_checksum(const FrameView& frame, std::span<const PathRotation> path) {
    const auto of = [](auto span) { return checksum(std::as_bytes(span)); };
    std::vector<double> turns;
    for (const auto& turn : path) {
        turns.push_back(turn.body);
        append(turns, flat(std::span<const Vec3>(&turn.rotation, 1)));
    }
    const std::array<std::uint64_t, 7> parts{of(std::span(&frame.step, 1)),
                                             of(std::span(&frame.time, 1)),
                                             of(frame.position),
                                             of(frame.rotation),
                                             of(frame.velocity),
                                             of(frame.angular_velocity),
                                             of(std::span<const double>(turns))};
    return of(std::span(parts));
}

std::uint64_t activity_checksum(const ActivityView& activity) {
    const auto of = [](auto span) { return checksum(std::as_bytes(span)); };
    const std::array<std::uint64_t, 3> parts{of(activity.contacts), of(activity.cluster), of(activity.cost)};
    return of(std::span(parts));
}

std::vector<PathRotation> long_turns(std::span<const Vec3> path_rotation) {
    std::vector<PathRotation> path;
    for (std::size_t i = 0; i < path_rotation.size(); ++i)
        append_long_turn(static_cast<std::int32_t>(i), path_rotation[i], path);
    return path;
}

FrameView view(const Frame& frame) {
    return {frame.step, frame.time,           frame.position, frame.rotation, frame.velocity, frame.angular_velocity,
            {},         frame.activity.view()};
}

std::uint16_t saturated(std::int64_t count) {
    return static_cast<std::uint16_t>(std::min<std::int64_t>(count, std::numeric_limits<std::uint16_t>::max()));
}

} // namespace

void Activity::append(const BodyActivity& body) {
    contacts.push_back(saturated(body.contacts));
    cluster.push_back(static_cast<std::uint8_t>(body.cluster));
    cost.push_back(saturated(body.cost));
}

void Activity::append_absent() { contacts.push_back(0), cluster.push_back(kAbsent), cost.push_back(0); }

void Activity::clear() { contacts.clear(), cluster.clear(), cost.clear(); }

RunScene make_run_scene(const Scene& scene) {
    RunScene result;
    for (const auto& shape : scene.shapes) result.shapes.push_back({shape.name, shape.mesh, shape.center});
    for (const auto& body : scene.bodies) result.bodies.push_back({body.name, body.shape, body.type});
    return result;
}

bool is_run_folder(const fs::path& folder) {
    std::error_code error;
    return fs::exists(folder / kRunJson, error);
}

// ---------------------------------------------------------------------------------------------------------- RunWriter

RunWriter::RunWriter(const fs::path& folder, const RunInfo& info, const RunScene& scene, OpenRun mode)
    : folder_(folder), info_(info), bodies_(scene.bodies.size()), started_(utc_now()) {
    create_folder(folder);
    lock_ = std::make_unique<FolderLock>(folder);
    clear_folder(mode);
    write_meshes(folder / kMeshes, scene);
    write_file(folder / kSceneJson, info.scene_json);
    if (!info.edits_json.empty()) write_file(folder / kEditsJson, info.edits_json);
    write_file(folder / kStepsCsv, step_csv_header());
    write_run_json("running");
    steps_csv_ = std::make_unique<AppendFile>(folder / kStepsCsv);
}

RunWriter::RunWriter(const fs::path& folder, const RunInfo& info, const RunScene& scene, std::int64_t step)
    : folder_(folder), info_(info), bodies_(scene.bodies.size()), started_(utc_now()) {
    lock_ = std::make_unique<FolderLock>(folder);
    RunReader reader(folder);
    check_same_run(reader.info());
    if (reader.info().frame_every != info.frame_every)
        throw InputError(folder.string() + ": the run writes a frame every " +
                         std::to_string(reader.info().frame_every) + " steps; --resume cannot change that");
    started_ = reader.info().record.started;
    info_.record.resumed = resumed_json(reader.info().record.resumed, info, step);
    const std::string steps = read_steps(); // before anything in the folder changes
    keep_frames(reader, step / info.frame_every + 1);
    write_file(folder / kStepsCsv, step_csv_until(steps, step));
    write_run_json("running");
    steps_csv_ = std::make_unique<AppendFile>(folder / kStepsCsv);
}

void RunWriter::clear_folder(OpenRun mode) const {
    if (mode == OpenRun::restart && is_run_folder(folder_))
        check_same_run(parse_run_json(folder_ / kRunJson, read_text(folder_ / kRunJson)));
    if (mode != OpenRun::create) remove_run_files(folder_);
    std::error_code error;
    if (mode != OpenRun::overwrite && (!fs::is_empty(folder_, error) || error))
        throw InputError(folder_.string() +
                         ": the folder is not empty; --resume continues the run in it, --overwrite replaces it");
}

void RunWriter::check_same_run(const RunInfo& earlier) const {
    if (earlier.scene_hash != info_.scene_hash)
        throw InputError(folder_.string() +
                         ": was made from another scene, other settings or other edits; --resume needs the same");
}

/// The run's steps.csv, whose columns must be those of the rows to come.
std::string RunWriter::read_steps() const {
    std::string steps = read_text(folder_ / kStepsCsv);
    const std::string difference = step_csv_difference(steps);
    if (!difference.empty())
        throw IoError((folder_ / kStepsCsv).string() +
                      ": its columns are not those that this version of flotilla writes: " + difference +
                      "; resume the run with the version that began it, or start again with --overwrite");
    return steps;
}

/// Removes the frames from `count` on, once those before are known to be there. A segment on both sides of the border
/// goes back into the buffer and is replaced when the buffer is written; until then its file stays.
void RunWriter::keep_frames(RunReader& reader, std::int64_t count) {
    std::vector<fs::path> later;
    for (const auto& segment : list_segments(folder_)) {
        if (segment.first >= count) {
            later.push_back(segment.path);
        } else if (segment.last >= count) {
            first_frame_ = segment.first;
            for (std::int64_t k = segment.first; k < count; ++k) {
                const Frame frame = reader.frame(k);
                const Way way = reader.way(k);
                FrameView kept = view(frame);
                kept.way = &way;
                append_frame(kept, frame.path);
            }
        } else {
            first_frame_ = segment.last + 1;
        }
    }
    if (frames() < count)
        throw IoError(folder_.string() + ": frames " + std::to_string(frames()) + " to " + std::to_string(count - 1) +
                      " are missing, which come before the checkpoint; --overwrite starts again");
    for (const fs::path& path : later) {
        std::error_code error;
        fs::remove(path, error);
        if (error) throw IoError(path.string() + ": cannot remove: " + error.message());
    }
}

RunWriter::~RunWriter() {
    if (closed_) return;
    try {
        flush();
    } catch (const std::exception&) {
        // A destructor on the way out of another error; the caller that cares calls close().
    }
}

void RunWriter::write_run_json(const std::string& status) const {
    write_file(folder_ / kRunJson, run_json_text(info_, bodies_, started_, status, frames()));
}

std::size_t RunWriter::frame_bytes() const { return bodies_ * frame_bytes_per_body(keeps_ways() ? info_.substeps : 1); }

void RunWriter::add_frame(const FrameView& frame) {
    FLOTILLA_ASSERT(frame.position.size() == bodies_ && frame.rotation.size() == bodies_ &&
                    frame.velocity.size() == bodies_ && frame.angular_velocity.size() == bodies_);
    FLOTILLA_ASSERT(frame.activity.contacts.size() == frame.activity.cluster.size() &&
                    frame.activity.contacts.size() == frame.activity.cost.size());
    append_frame(frame, long_turns(frame.path_rotation));
    if (steps_.size() >= kSegmentFrames || steps_.size() * frame_bytes() >= kSegmentBytes) write_segment();
}

void RunWriter::append_frame(const FrameView& frame, std::span<const PathRotation> path) {
    // All of it or nothing: where memory is refused, the frames before it are still to be written.
    Growth growth(
        std::tuple_cat(ways_.lists(), std::tie(path_index_, path_rotation_, activity_.contacts, activity_.cluster,
                                               activity_.cost, activity_checksums_, steps_, times_, position_,
                                               rotation_, velocity_, angular_velocity_, checksums_)));
    const auto frame_in_segment = static_cast<std::int32_t>(steps_.size());
    for (const auto& turn : path) {
        path_index_.insert(path_index_.end(), {frame_in_segment, turn.body});
        append(path_rotation_, flat(std::span<const Vec3>(&turn.rotation, 1)));
    }
    append_activity(frame.activity);
    append_way(frame);
    steps_.push_back(frame.step);
    times_.push_back(frame.time);
    append(position_, flat(frame.position));
    append(rotation_, flat(frame.rotation));
    append(velocity_, flat(frame.velocity));
    append(angular_velocity_, flat(frame.angular_velocity));
    checksums_.push_back(frame_checksum(frame, path));
    growth.keep();
}

/// A segment has the activity of all its frames or of none: a run that older versions began goes on without it until
/// the next segment.
void RunWriter::append_activity(const ActivityView& activity) {
    if (activity.contacts.size() != bodies_ || activity_checksums_.size() != steps_.size()) return;
    append(activity_.contacts, activity.contacts);
    append(activity_.cluster, activity.cluster);
    append(activity_.cost, activity.cost);
    activity_checksums_.push_back(activity_checksum(activity));
}

void RunWriter::append_way(const FrameView& frame) {
    if (!keeps_ways()) return;
    if (frame.way != nullptr && !frame.way->empty()) return ways_.append(steps_.size(), *frame.way);
    Way still; // the first frame
    for (int k = 1; k < info_.substeps; ++k)
        for (std::size_t i = 0; i < bodies_; ++i) still.append(frame.position[i], frame.rotation[i], {});
    ways_.append(steps_.size(), still);
}

void RunWriter::write_activity(Hdf5Writer& file) const {
    if (activity_checksums_.size() != steps_.size()) return;
    const auto checked = Hdf5Writer::Checked::by_owner;
    file.write<std::uint16_t>("/contacts", activity_.contacts, {steps_.size(), bodies_}, checked);
    file.write<std::uint8_t>("/cluster", activity_.cluster, {steps_.size(), bodies_}, checked);
    file.write<std::uint16_t>("/cost", activity_.cost, {steps_.size(), bodies_}, checked);
    file.write<std::uint64_t>("/activity_checksum", activity_checksums_, {steps_.size()});
}

void RunWriter::write_segment() {
    if (steps_.empty()) return;
    const std::size_t frames_here = steps_.size();
    const std::int64_t last = first_frame_ + static_cast<std::int64_t>(frames_here) - 1;
    Hdf5Writer file;
    file.attribute("/", "flotilla_frames", std::int64_t{1});
    file.attribute("/", "first_frame", first_frame_);
    file.write<std::int64_t>("/step", steps_, {frames_here});
    file.write<double>("/time", times_, {frames_here});
    file.write<double>("/position", position_, {frames_here, bodies_, 3}, Hdf5Writer::Checked::by_owner);
    file.write<double>("/rotation", rotation_, {frames_here, bodies_, 4}, Hdf5Writer::Checked::by_owner);
    file.write<double>("/velocity", velocity_, {frames_here, bodies_, 3}, Hdf5Writer::Checked::by_owner);
    file.write<double>("/angular_velocity", angular_velocity_, {frames_here, bodies_, 3},
                       Hdf5Writer::Checked::by_owner);
    file.write<std::uint64_t>("/checksum", checksums_, {frames_here});
    write_activity(file);
    ways_.write(file, static_cast<std::size_t>(info_.substeps - 1), bodies_);
    file.write<std::int32_t>("/path_index", path_index_, {path_index_.size() / 2, 2});
    file.write<double>("/path_rotation", path_rotation_, {path_rotation_.size() / 3, 3});
    const fs::path path = segment_path(folder_, first_frame_, last);
    write_file(path, file.finish());
    remove_replaced(path);
    first_frame_ = last + 1;
    for (auto* values : {&times_, &position_, &rotation_, &velocity_, &angular_velocity_, &path_rotation_})
        values->clear();
    steps_.clear();
    checksums_.clear();
    path_index_.clear();
    activity_.clear();
    activity_checksums_.clear();
    ways_.clear();
}

/// A segment that begins with the same frame is an older form of the one just written.
void RunWriter::remove_replaced(const fs::path& written) const {
    const std::string prefix = written.filename().string().substr(0, std::string("frames-00000000-").size());
    std::error_code error;
    for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error))
        if (it->path() != written && it->path().filename().string().starts_with(prefix)) fs::remove(it->path(), error);
}

void RunWriter::add_step(const StepReport& row) { steps_csv_->append(step_csv_row(row)); }

void RunWriter::flush() {
    write_segment();
    steps_csv_->sync();
}

void RunWriter::close(const std::string& status) {
    flush();
    write_run_json(status);
    closed_ = true;
}

// ---------------------------------------------------------------------------------------------------------- RunReader

RunReader::RunReader(const fs::path& folder) : folder_(folder) {
    if (!is_run_folder(folder)) throw IoError(folder.string() + ": not a run folder (it has no run.json)");
    run_json_ = read_text(folder / kRunJson);
    info_ = parse_run_json(folder / kRunJson, run_json_);
    scene_ = read_meshes(folder / kMeshes);
    std::error_code error;
    if (fs::exists(folder / kEditsJson, error)) info_.edits_json = read_text(folder / kEditsJson);
    segments_ = list_segments(folder);
}

const SegmentFile& RunReader::segment_of(std::int64_t k) const {
    const auto after = std::upper_bound(segments_.begin(), segments_.end(), k,
                                        [](std::int64_t f, const SegmentFile& s) { return f < s.first; });
    if (after == segments_.begin() || k > std::prev(after)->last) {
        const std::int64_t last = after == segments_.end() ? k : after->first - 1;
        const std::int64_t first = after == segments_.begin() ? 0 : std::prev(after)->last + 1;
        throw IoError(folder_.string() + ": frames " + std::to_string(first) + " to " + std::to_string(last) +
                      " are missing");
    }
    return *std::prev(after);
}

void RunReader::open(const SegmentFile& segment) {
    if (open_first_ == segment.first) return;
    open_first_ = -1;
    try {
        file_ = std::make_unique<Hdf5Reader>(segment.path);
        if (file_->int_attribute("/", "flotilla_frames") != 1)
            throw IoError(segment.path.string() + ": written by a newer version of flotilla");
        steps_ = file_->read<std::int64_t>("/step");
        times_ = file_->read<double>("/time");
        checksums_ = file_->read<std::uint64_t>("/checksum");
        path_index_ = file_->read<std::int32_t>("/path_index");
        path_rotation_ = file_->read<double>("/path_rotation");
        activity_checksums_.clear();
        if (file_->has("/activity_checksum")) activity_checksums_ = file_->read<std::uint64_t>("/activity_checksum");
        const auto count = static_cast<std::size_t>(segment.last - segment.first + 1);
        if (steps_.size() != count || times_.size() != count || checksums_.size() != count ||
            (!activity_checksums_.empty() && activity_checksums_.size() != count) ||
            path_index_.size() * 3 != path_rotation_.size() * 2)
            throw IoError(segment.path.string() + ": damaged: it does not hold the frames that its name says");
        ways_.open(*file_, count, static_cast<std::size_t>(info_.substeps - 1), scene_.bodies.size());
    } catch (const IoError& error) {
        throw IoError(std::string(error.what()) + "; frames " + std::to_string(segment.first) + " to " +
                      std::to_string(segment.last) + " are lost");
    }
    open_first_ = segment.first;
}

template <class Read>
auto RunReader::row_of(std::int64_t k, Read&& read) {
    const SegmentFile& segment = segment_of(k);
    open(segment);
    try {
        return read(static_cast<std::size_t>(k - segment.first));
    } catch (const IoError& error) {
        throw IoError(std::string(error.what()) + "; frame " + std::to_string(k) + " is lost");
    }
}

Frame RunReader::frame(std::int64_t k) {
    return row_of(k, [&](std::size_t row) { return read_frame(k, row); });
}

Way RunReader::way(std::int64_t k) {
    return row_of(k, [&](std::size_t row) { return ways_.read(*file_, row); });
}

Frame RunReader::read_frame(std::int64_t k, std::size_t row) const {
    const std::size_t n = scene_.bodies.size();
    Frame frame{k, steps_[row], times_[row], {}, {}, {}, {}, {}, {}};
    frame.position.resize(n), frame.rotation.resize(n), frame.velocity.resize(n), frame.angular_velocity.resize(n);
    const auto read = [&](const char* name, auto& values) {
        constexpr std::size_t width = sizeof(values[0]) / sizeof(double);
        file_->read_row<double>(name, row, {reinterpret_cast<double*>(values.data()), width * values.size()});
    };
    read("/position", frame.position);
    read("/rotation", frame.rotation);
    read("/velocity", frame.velocity);
    read("/angular_velocity", frame.angular_velocity);
    for (std::size_t i = 0; 2 * i < path_index_.size(); ++i)
        if (path_index_[2 * i] == static_cast<std::int32_t>(row))
            frame.path.push_back({path_index_[2 * i + 1],
                                  {path_rotation_[3 * i], path_rotation_[3 * i + 1], path_rotation_[3 * i + 2]}});
    frame.activity = read_activity(row);
    if (frame_checksum(view(frame), frame.path) != checksums_[row] ||
        (!activity_checksums_.empty() && activity_checksum(frame.activity.view()) != activity_checksums_[row]))
        throw IoError(file_->path().string() + ": damaged: data do not match their checksum");
    return frame;
}

Activity RunReader::read_activity(std::size_t row) const {
    Activity activity;
    if (activity_checksums_.empty()) return activity;
    const std::size_t n = scene_.bodies.size();
    activity.contacts.resize(n), activity.cluster.resize(n), activity.cost.resize(n);
    file_->read_row<std::uint16_t>("/contacts", row, activity.contacts);
    file_->read_row<std::uint8_t>("/cluster", row, activity.cluster);
    file_->read_row<std::uint16_t>("/cost", row, activity.cost);
    return activity;
}

std::uintmax_t RunReader::frame_file_bytes() const {
    std::uintmax_t bytes = 0;
    std::error_code error;
    for (const auto& segment : segments_) {
        const auto size = fs::file_size(segment.path, error);
        if (!error) bytes += size;
    }
    return bytes;
}

std::vector<Frame> inner_frames(const Frame& a, const Frame& b, const Way& way) {
    const std::size_t n = a.position.size(), inner = n == 0 ? 0 : way.position.size() / n;
    std::vector<Frame> frames(inner);
    for (std::size_t k = 0; k < inner; ++k) {
        Frame& f = frames[k];
        f.index = a.index;
        f.step = a.step;
        f.time = a.time + (b.time - a.time) * static_cast<double>(k + 1) / static_cast<double>(inner + 1);
        const auto first = static_cast<std::ptrdiff_t>(k * n), last = static_cast<std::ptrdiff_t>((k + 1) * n);
        f.position.assign(way.position.begin() + first, way.position.begin() + last);
        f.rotation.assign(way.rotation.begin() + first, way.rotation.begin() + last);
    }
    for (const PathRotation& turn : way.turns) {
        const auto place = static_cast<std::size_t>(turn.body);
        frames[place / n].path.push_back({static_cast<std::int32_t>(place % n), turn.rotation});
    }
    return frames;
}

std::vector<Vec3> path_rotations(const Frame& a, const Frame& b) {
    std::vector<Vec3> turns(a.rotation.size());
    for (std::size_t i = 0; i < turns.size(); ++i)
        if (a.rotation[i] != b.rotation[i]) turns[i] = rotation_vector(b.rotation[i] * conjugate(a.rotation[i]));
    for (const auto& turn : b.path) turns[static_cast<std::size_t>(turn.body)] = turn.rotation;
    return turns;
}

} // namespace flotilla::io
