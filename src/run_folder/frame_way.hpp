// SPDX-License-Identifier: MIT
// What bodies did between two frames, where a step is made of inner ones (Settings::substeps).
//
// Segments of runs with a frame a step then have, float64: way_position [frames][inner][bodies][3] and way_rotation
// [..][4] as those of frames, at the ends of all inner steps but the last, which ends at the frame; way_checksum
// [frames] over a frame's part of all that is said here. The path in an inner step is as that between two frames of a
// run without inner steps: the rows of way_index [rows][2] (frame in the segment, inner step times bodies plus body)
// have their w in way_turn [rows][3] (rad); all others took the shortest arc. The last inner step's are in path_index.
// Before the run's first frame nothing moved.
#pragma once

#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include <flotilla/types.hpp>

#include "run_folder/hdf5.hpp"

namespace flotilla::io {

/// The turn of one body, where it is not the shortest arc.
struct PathRotation {
    std::int32_t body = 0; ///< in a Way: inner step times bodies plus body
    Vec3 rotation;         ///< rad
};

/// Adds those of the turns that two rounded rotations do not tell.
void append_long_turn(std::int32_t body, const Vec3& turn, std::vector<PathRotation>& to);

/// By inner step, then by body. Empty where nothing is known of inner steps, or there are none.
struct Way {
    std::vector<Vec3> position;
    std::vector<Quat> rotation;
    std::vector<PathRotation> turns; ///< sorted

    [[nodiscard]] bool empty() const { return position.empty(); }
    void append(const Vec3& position, const Quat& rotation, const Vec3& turn);
};

/// The ways of the frames of the segment that is being filled.
class WayWriter {
  public:
    /// Precondition: ways of one segment have the same size.
    void append(std::size_t frame, const Way& way);
    void write(Hdf5Writer& file, std::size_t inner_steps, std::size_t bodies) const;
    void clear();
    /// All that append() lengthens.
    [[nodiscard]] auto lists() { return std::tie(position_, rotation_, turn_, index_, checksums_); }

  private:
    std::vector<double> position_, rotation_, turn_;
    std::vector<std::int32_t> index_;
    std::vector<std::uint64_t> checksums_;
};

/// The ways of a segment that is open. A segment without gives empty ones.
class WayReader {
  public:
    /// IoError where what there is does not fit.
    void open(const Hdf5Reader& file, std::size_t frames, std::size_t inner_steps, std::size_t bodies);
    [[nodiscard]] Way read(const Hdf5Reader& file, std::size_t frame) const;

  private:
    std::size_t places_ = 0; ///< of a frame: inner steps times bodies; 0: the segment has no ways
    std::vector<std::int32_t> index_;
    std::vector<double> turn_;
    std::vector<std::uint64_t> checksums_;
};

} // namespace flotilla::io
