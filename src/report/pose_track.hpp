// SPDX-License-Identifier: MIT
// The poses of all bodies over time, quantised for a page that shows them. 16 bytes per body and frame, which a vertex
// shader reads as they are; most of them are differences that compress well.
//
// A body is placed by the middle c of its shape's bounding box, r = position + R c, so that an error of rotation moves
// no vertex further than it must. Each body has a box of its own in which r is quantised: one that flies off does not
// cost the others their precision. Eight words of 16 bits per body and frame:
//   0..2  (r - origin - low) / extent * 65535     3  sqrt(speed / top_speed) * 65535
//   4..7  x y z w of the unit quaternion * 32767, two's complement, of the sign that is nearer to the frame before; all
//         zero where the body is not there (run_folder/run_bodies.hpp), with the other words as in the frame before
// The stream holds, frame by frame and word by word, the differences d to the frame before (modulo 2^16; the frame
// before the first is zero) as zigzag numbers (d << 1) ^ (d >> 15), first the low bytes of all bodies, then the high
// bytes; zlib.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "run_folder/run_folder.hpp"

namespace flotilla::report {

/// Bodies that are drawn in one call: [first, first + count) of DrawOrder::bodies.
struct DrawGroup {
    std::int32_t shape = 0;
    bool fixed = false; ///< static or kinematic
    std::size_t first = 0, count = 0;
};
/// The bodies sorted by what is drawn together, dynamic ones first.
struct DrawOrder {
    std::vector<std::int32_t> bodies; ///< scene indices
    std::vector<DrawGroup> groups;
};
[[nodiscard]] DrawOrder draw_order(const io::RunScene& scene);

/// The middle of the mesh's bounding box, mesh coordinates (m); zero for a mesh without vertices.
[[nodiscard]] Vec3 middle(const TriangleMesh& mesh);

struct PoseTrack {
    std::int64_t frames_in_run = 0;
    std::int64_t frame_every = 1;      ///< frames of the run per frame here; the last one is always here
    std::vector<std::int64_t> frames;  ///< their indices in the run, ascending
    std::vector<double> times;         ///< s
    std::vector<std::string> problems; ///< what could not be read, naming files and frames
    Vec3 origin;                       ///< m, world
    std::vector<float> boxes;          ///< m, [bodies][low 3, extent 3] about origin
    double top_speed = 0;              ///< m/s, of the centres of mass
    std::vector<std::byte> stream;     ///< empty without frames
    double position_error = 0;         ///< m, largest distance between a decoded and a recorded r
    double rotation_error = 0;         ///< rad, largest angle between a decoded and a recorded rotation
};
/// `frame_every` 0: the least that keeps the poses below kPoseBytes before compression. Frames that cannot be read are
/// named in `problems` and left out.
[[nodiscard]] PoseTrack encode_poses(io::RunReader& run, const DrawOrder& order, std::int64_t frame_every, int threads);

/// What a browser holds in memory and on the graphics card without trouble.
inline constexpr std::size_t kPoseBytes = std::size_t{64} << 20;

} // namespace flotilla::report
