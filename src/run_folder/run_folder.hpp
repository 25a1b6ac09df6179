// SPDX-License-Identifier: MIT
// The folder of a run:
//   run.json          where the run comes from: version, commit, compiler, machine, threads, settings, command line
//   scene.json        the scene as it was read, for people; with the vertices where it names meshes by their files
//   meshes.h5         what the frames need: every shape once, and the bodies' names, shapes and types
//   edits.json        what was changed between steps (flotilla/edit_file.hpp), with vertices too, where anything was
//   steps.csv         one row per step
//   frames-A-B.h5     frames A..B
//   checkpoint-S.h5   everything needed to go on after step S (run_folder/checkpoint.hpp)
// Every file but steps.csv is written beside its place, synced and renamed, so that a crash leaves whole files only.
//
// A segment holds, float64: position [frames][bodies][3] of the mesh's origin (m), rotation [..][4] as w x y z,
// velocity [..][3] of the centre of mass (m/s), angular_velocity [..][3] (rad/s); step [frames], time [frames] (s), and
// checksum [frames] over all of a frame's values, so that one flipped bit costs one frame and is never taken for data.
// Runs of the solver also have what the step that ended at the frame did with each body, [frames][bodies]: contacts,
// uint16, contact points of the body; cluster, uint8, 0 free, 1 kinematic, 2 rigid, 3 held by the failsafe, 4 asleep,
// 255 not there (run_folder/run_bodies.hpp); cost, uint16, how often the step set the body's end state (the counts end
// at 65535); and activity_checksum [frames] over these. A segment has all four or none. The path of a body between two
// frames one step apart is its centre of mass on a straight line and the orientation R(t w) q. w is the shortest arc
// between the two stored rotations, except for the rows of path_index [rows][2] (frame in the segment, body): their w
// is in path_rotation [rows][3] (rad). Only bodies that turn by nearly half a turn in one step have a row. Where a step
// is made of inner ones this is the path in the last of them, and what came before is in run_folder/frame_way.hpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <flotilla/report.hpp>
#include <flotilla/scene.hpp>

#include "io/file.hpp"
#include "io/frame_size.hpp"
#include "mesh/triangle_mesh.hpp"
#include "run_folder/frame_way.hpp"
#include "run_folder/hdf5.hpp"
#include "run_folder/run_bodies.hpp"
#include "scene/scene.hpp"

namespace flotilla::io {

/// What the program itself writes into run.json; set by reading.
struct RunRecord {
    std::string status; ///< "running", "complete" or why the run ended
    std::string version, commit, compiler, flags, processor;
    std::string started, updated; ///< UTC, ISO 8601
    std::string resumed = "[]";   ///< JSON array: what went on with the run, and after which step
};

/// What run.json says about a run.
struct RunInfo {
    std::vector<std::string> command_line;
    int threads = 1;
    std::uint64_t seed = 0;
    std::string settings_json = "{}"; ///< the resolved settings, a JSON object
    std::string scene_json;           ///< the scene file's text
    std::uint64_t scene_hash = 0;     ///< of all that a run's bits depend on
    Trajectory trajectory = Trajectory::linear;
    double time_step = 0; ///< s
    int substeps = 1;
    int frame_every = 1; ///< steps per frame
    /// What may pass through what at the start: groups, with who is in them, and bodies.
    std::vector<NamedPair> ignored_groups, ignored_bodies;
    std::vector<NamedPair> groups; ///< a: of bodies, b: their group
    std::size_t scene_bodies = 0;  ///< of an edited run: its other bodies came by edits
    std::string edits_json;        ///< of the World, as a file of edits (flotilla/edit_file.hpp); empty: there are none
    RunRecord record;              ///< ignored by writing
};

struct RunShape {
    std::string name;
    TriangleMesh mesh;   ///< scaled, mesh coordinates
    Vec3 center_of_mass; ///< mesh coordinates
};
struct RunBody {
    std::string name;
    std::int32_t shape = 0;
    BodyType type = BodyType::dynamic;
};
struct RunScene {
    std::vector<RunShape> shapes;
    std::vector<RunBody> bodies;
};
[[nodiscard]] RunScene make_run_scene(const Scene& scene);

/// What a step did with each body (BodyActivity), as it is stored. Empty where it is not known.
struct ActivityView {
    std::span<const std::uint16_t> contacts;
    std::span<const std::uint8_t> cluster;
    std::span<const std::uint16_t> cost;
};
struct Activity {
    std::vector<std::uint16_t> contacts;
    std::vector<std::uint8_t> cluster;
    std::vector<std::uint16_t> cost;

    void append(const BodyActivity& body);
    void append_absent();
    void clear();
    [[nodiscard]] bool empty() const { return contacts.empty(); }
    [[nodiscard]] ActivityView view() const { return {contacts, cluster, cost}; }
};

/// One frame to be written: arrays over the bodies in scene order.
struct FrameView {
    std::int64_t step = 0;
    double time = 0; ///< s
    std::span<const Vec3> position;
    std::span<const Quat> rotation;
    std::span<const Vec3> velocity;
    std::span<const Vec3> angular_velocity;
    std::span<const Vec3> path_rotation; ///< rad, of the step that ended here; empty: shortest arcs
    ActivityView activity{};             ///< may be empty
    const Way* way = nullptr;            ///< of a run with inner steps, and not before its first step
};

struct Frame {
    std::int64_t index = 0; ///< in the run, from 0
    std::int64_t step = 0;
    double time = 0; ///< s
    std::vector<Vec3> position;
    std::vector<Quat> rotation;
    std::vector<Vec3> velocity;
    std::vector<Vec3> angular_velocity;
    std::vector<PathRotation> path; ///< of the step, or of its last inner one; sorted by body
    Activity activity{};            ///< empty where the run does not have it

    [[nodiscard]] bool absent(std::size_t body) const { return !activity.empty() && activity.cluster[body] == kAbsent; }
};

/// A file frames-<first>-<last>.h5.
struct SegmentFile {
    std::int64_t first = 0, last = 0; ///< frames
    std::filesystem::path path;
};

class RunReader;

enum class OpenRun {
    create,    ///< the folder is missing or empty
    overwrite, ///< what an earlier run wrote is removed first
    restart,   ///< as overwrite, for an earlier run of the same scene and settings only, and with nothing else in the
               ///< folder
};

/// Writes a run folder. Used from one thread.
class RunWriter {
  public:
    /// Starts a run. InputError where the folder has content that `mode` excludes, IoError where another process writes
    /// into it.
    RunWriter(const std::filesystem::path& folder, const RunInfo& info, const RunScene& scene, OpenRun mode);
    /// Goes on with the run in the folder after step `step`: frames and rows of later steps are removed.
    /// InputError where that run had another scene, other settings or another frame_every; IoError where frames are
    /// missing, or where steps.csv is missing or has other columns than this version writes. Then nothing in the folder
    /// has changed.
    RunWriter(const std::filesystem::path& folder, const RunInfo& info, const RunScene& scene, std::int64_t step);
    /// Writes what is left and swallows errors; close() reports them.
    ~RunWriter();
    RunWriter(const RunWriter&) = delete;
    RunWriter& operator=(const RunWriter&) = delete;

    /// Precondition: arrays of one element per body; frame k is of step k * frame_every.
    void add_frame(const FrameView& frame);
    void add_step(const StepReport& row);
    /// Makes all frames and rows so far durable. Call before a checkpoint is written.
    void flush();
    /// flush, and the final run.json: `status` is "complete" or why the run ended.
    void close(const std::string& status);

    [[nodiscard]] std::int64_t frames() const { return first_frame_ + static_cast<std::int64_t>(steps_.size()); }

  private:
    void clear_folder(OpenRun mode) const;
    void check_same_run(const RunInfo& earlier) const;
    [[nodiscard]] std::string read_steps() const;
    void keep_frames(RunReader& reader, std::int64_t count);
    void append_frame(const FrameView& frame, std::span<const PathRotation> path);
    void append_activity(const ActivityView& activity);
    void append_way(const FrameView& frame);
    void write_activity(Hdf5Writer& file) const;
    void write_segment();
    void remove_replaced(const std::filesystem::path& written) const;
    void write_run_json(const std::string& status) const;
    [[nodiscard]] std::size_t frame_bytes() const;
    [[nodiscard]] bool keeps_ways() const { return info_.substeps > 1 && info_.frame_every == 1; }

    std::filesystem::path folder_;
    std::unique_ptr<FolderLock> lock_;
    RunInfo info_;
    std::size_t bodies_ = 0;
    std::string started_;
    std::unique_ptr<AppendFile> steps_csv_;
    bool closed_ = false;

    // Frames of the segment that is being filled.
    std::int64_t first_frame_ = 0;
    std::vector<std::int64_t> steps_;
    std::vector<double> times_;
    std::vector<double> position_, rotation_, velocity_, angular_velocity_;
    std::vector<std::uint64_t> checksums_;
    std::vector<std::int32_t> path_index_;
    std::vector<double> path_rotation_;
    Activity activity_;
    WayWriter ways_;
    std::vector<std::uint64_t> activity_checksums_; ///< shorter than steps_ where a frame's activity is not known
};

/// Reads a run folder, also one that is still being written. Used from one thread.
class RunReader {
  public:
    /// IoError where the folder is not a run folder.
    explicit RunReader(const std::filesystem::path& folder);

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    [[nodiscard]] const RunScene& scene() const { return scene_; }
    [[nodiscard]] const RunInfo& info() const { return info_; }
    [[nodiscard]] const std::string& run_json() const { return run_json_; }
    /// One more than the last frame's index; frames inside may be missing.
    [[nodiscard]] std::int64_t frames() const { return segments_.empty() ? 0 : segments_.back().last + 1; }
    /// Frame k. IoError naming the file and the frames that are lost where it is missing or damaged; the others stay
    /// readable.
    [[nodiscard]] Frame frame(std::int64_t k);
    /// What came between frame k and the one before; IoError as frame(). Empty where the run has no inner steps, or
    /// more than one step a frame.
    [[nodiscard]] Way way(std::int64_t k);
    /// Bytes of all segments.
    [[nodiscard]] std::uintmax_t frame_file_bytes() const;

  private:
    [[nodiscard]] const SegmentFile& segment_of(std::int64_t k) const;
    void open(const SegmentFile& segment);
    [[nodiscard]] Frame read_frame(std::int64_t k, std::size_t row) const;
    [[nodiscard]] Activity read_activity(std::size_t row) const;
    /// What `read` gives for the place of frame k in its segment, which is open then.
    template <class Read>
    auto row_of(std::int64_t k, Read&& read);

    std::filesystem::path folder_;
    std::string run_json_;
    RunInfo info_;
    RunScene scene_;
    std::vector<SegmentFile> segments_;
    std::int64_t open_first_ = -1;
    std::unique_ptr<Hdf5Reader> file_;
    std::vector<std::int64_t> steps_;
    std::vector<double> times_;
    std::vector<std::uint64_t> checksums_;
    std::vector<std::int32_t> path_index_;
    std::vector<double> path_rotation_;
    WayReader ways_;
    std::vector<std::uint64_t> activity_checksums_; ///< empty: the segment has no activity
};

/// The turn of every body from frame a to the next frame b: the recorded one or the shortest arc (rad).
[[nodiscard]] std::vector<Vec3> path_rotations(const Frame& a, const Frame& b);

/// The frames that bodies passed through on their way from frame a to the next one, without velocities. Empty where
/// `way` is.
[[nodiscard]] std::vector<Frame> inner_frames(const Frame& a, const Frame& b, const Way& way);

/// True where `folder` has a run.json.
[[nodiscard]] bool is_run_folder(const std::filesystem::path& folder);

} // namespace flotilla::io
