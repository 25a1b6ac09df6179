// SPDX-License-Identifier: MIT
// Writes a trajectory in the CSV export format, so that `flotilla verify SCENE --poses` can judge any program's bodies.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <flotilla/scene.hpp>

namespace flotilla::baseline {

/// A body as the format has it. Position of the mesh's own origin (m), velocity of the centre of mass (m/s), rad/s.
struct PoseRow {
    Vec3 position;
    Quat rotation;
    Vec3 velocity, angular_velocity;
};

class PosesFile {
  public:
    /// Throws IoError where the file cannot be made.
    PosesFile(const std::filesystem::path& path, const SceneDescription& scene);
    ~PosesFile();
    PosesFile(const PosesFile&) = delete;
    PosesFile& operator=(const PosesFile&) = delete;

    /// One frame at `time` (s): a row for each body, in scene order.
    void write(std::int64_t frame, double time, const std::vector<PoseRow>& rows);
    /// Throws IoError where anything was not written. Call it once, at the end.
    void close();

  private:
    std::filesystem::path path_;
    std::vector<std::string> names_; ///< quoted
    std::FILE* file_ = nullptr;
};

} // namespace flotilla::baseline
