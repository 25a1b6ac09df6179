// SPDX-License-Identifier: MIT
// Trajectories as CSV: one row per body and frame, bodies numbered in scene order from 0, 17 significant digits. p is
// the position of the mesh's own origin, q rotates mesh coordinates into the world, v is the velocity of the centre of
// mass.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <flotilla/types.hpp>

namespace flotilla::io {

inline constexpr std::string_view kPosesHeader = "frame,time,body,name,px,py,pz,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz";

struct Frame;

/// The rows of one frame.
[[nodiscard]] std::string poses_csv_rows(const Frame& frame, std::span<const std::string> names);

/// Reads frame after frame, so that a file may be larger than memory. All problems are InputErrors "<file>:<line>:
/// ...". Values may be nan or inf: whether a pose makes sense is the audit's question.
class PosesCsvReader {
  public:
    /// `names` are the bodies of the scene that the file is about. IoError where the file cannot be opened.
    PosesCsvReader(const std::filesystem::path& path, std::vector<std::string> names);

    /// The next frame. False at the end of the file. Within a frame rows may stand in any order; every body must be
    /// there.
    [[nodiscard]] bool next(Frame& frame);
    /// Bytes read so far, and of the whole file: for progress.
    [[nodiscard]] std::uintmax_t position() const { return position_; }
    [[nodiscard]] std::uintmax_t size() const { return size_; }

  private:
    struct Row {
        std::int64_t frame = 0, body = 0;
        double time = 0;
        std::array<double, 13> values{};
    };
    [[noreturn]] void fail(const std::string& reason) const;
    [[nodiscard]] bool read_line(std::string& line);
    [[nodiscard]] bool read_row();
    void check_complete(const Frame& frame, const std::vector<bool>& seen) const;

    std::filesystem::path path_;
    std::ifstream file_;
    std::vector<std::string> names_;
    std::int64_t line_ = 0;
    std::uintmax_t position_ = 0, size_ = 0;
    Row row_;              ///< read ahead: the first row of the next frame
    bool has_row_ = false; ///< false at the end of the file
};

} // namespace flotilla::io
